// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_PAGES_REPORT_FILE_H_
#define RSSTAB_CLI_PAGES_REPORT_FILE_H_

#include <memory>
#include <string>
#include <vector>

#include "cli/media/output_file.h"
#include "igf/base/result.h"

namespace rsstab::cli {

// A file with what a command found out (--report, --csv, --json): opened before the work begins, so
// that a bad name shows at once, and under its name only when it is complete.
class ReportFile {
 public:
  // `others`: files that the same command reads or writes. Errors: kInvalidArgument (exists and not
  // `overwrite`; one of `others`; standard output, where the command's own output goes); those of
  // media::OutputFile.
  [[nodiscard]] static Result<ReportFile> Open(const std::string& path, bool overwrite,
                                               const std::vector<std::string>& others);

  // Writes all of it and gives it its name. Errors: kIo naming the file.
  [[nodiscard]] Status Write(const std::string& content);

 private:
  explicit ReportFile(std::unique_ptr<media::OutputFile> file) : file_(std::move(file)) {}

  std::unique_ptr<media::OutputFile> file_;
};

}  // namespace rsstab::cli

#endif  // RSSTAB_CLI_PAGES_REPORT_FILE_H_
