// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_OUTPUT_NAMES_H_
#define RSSTAB_CLI_OUTPUT_NAMES_H_

#include <filesystem>
#include <string>

#include "igf/base/result.h"

namespace rsstab::cli {

// Where the steady clip goes when nobody says: "dir/clip.mp4" -> "dir/clip-stable.mp4". Containers
// that do not carry the encodings written today (or none that we know) become Matroska.
[[nodiscard]] std::string DefaultOutput(const std::string& input);

// "dir/clip.mp4" -> "dir/clip.rsstab".
[[nodiscard]] std::string DefaultAnalysisFile(const std::string& input);

// Refuses to write where `input` lies, and over an existing file unless `overwrite`.
// Errors: kInvalidArgument.
[[nodiscard]] Status CheckOutput(const std::string& input, const std::string& output,
                                 bool overwrite);

// A folder for files of the running command only, removed with all in it.
class ScratchFolder {
 public:
  // Below $TMPDIR or /tmp. Errors: kIo.
  [[nodiscard]] static Result<ScratchFolder> Create();
  ~ScratchFolder();
  ScratchFolder(ScratchFolder&& other) noexcept;
  ScratchFolder& operator=(ScratchFolder&&) = delete;
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  [[nodiscard]] std::string File(const std::string& name) const;

 private:
  explicit ScratchFolder(std::filesystem::path path);
  std::filesystem::path path_;
};

}  // namespace rsstab::cli

#endif  // RSSTAB_CLI_OUTPUT_NAMES_H_
