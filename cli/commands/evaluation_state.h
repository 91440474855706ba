// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_COMMANDS_EVALUATION_STATE_H_
#define RSSTAB_CLI_COMMANDS_EVALUATION_STATE_H_

#include <fstream>
#include <set>
#include <string>
#include <vector>

#include "evaluation/picture_protocol.h"
#include "igf/base/result.h"

namespace rsstab::cli {

// What a long evaluation has done so far, in a file that grows clip by clip: one JSON object a
// line, the first of which says which settings the figures belong to. One thread at a time.
class EvaluationState {
 public:
  // Keeps nothing.
  EvaluationState() = default;

  // Goes on with the file of an earlier run with the same `settings`, or begins one. A last line
  // that was cut off is dropped.
  // Errors: kInvalidArgument for a file of other settings or of something else; kIo.
  [[nodiscard]] static Result<EvaluationState> Open(const std::string& path,
                                                    const std::string& settings);

  [[nodiscard]] const std::set<std::string>& DoneClips() const { return done_; }
  [[nodiscard]] const std::vector<evaluation::PictureRecord>& Records() const { return records_; }

  // Adds a clip; it is on its way to the disk when this returns. A clip of which something was left
  // out is not kept, so that another run tries it again. Errors: kIo.
  [[nodiscard]] Status Add(const evaluation::ClipResult& clip);

 private:
  std::string path_;
  std::ofstream file_;
  std::set<std::string> done_;
  std::vector<evaluation::PictureRecord> records_;  // of earlier runs
};

}  // namespace rsstab::cli

#endif  // RSSTAB_CLI_COMMANDS_EVALUATION_STATE_H_
