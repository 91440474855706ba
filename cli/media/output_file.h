// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_MEDIA_OUTPUT_FILE_H_
#define RSSTAB_CLI_MEDIA_OUTPUT_FILE_H_

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "igf/base/result.h"
#include "igf/base/staged_file.h"

namespace rsstab::media {

// A file that appears under its name only when it is complete: bytes go to a hidden file in the
// same folder, Commit() renames it, destruction without Commit() removes it. "-" (standard output),
// pipes and devices are written directly. Not thread safe.
class OutputFile {
 public:
  // Errors: kInvalidArgument (exists and not `overwrite`; same file as `source_path`, which may be
  // empty), kNotFound (no such folder), kIo (no permission).
  [[nodiscard]] static Result<std::unique_ptr<OutputFile>> Open(const std::string& path,
                                                                bool overwrite,
                                                                const std::string& source_path);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  // All return 0 or more, or a negative errno; the first error is kept and decides Commit().
  [[nodiscard]] int Write(const std::uint8_t* data, std::size_t size);
  [[nodiscard]] std::int64_t Seek(std::int64_t offset, int whence);
  // Forgets what was written so far; only for files that can seek.
  [[nodiscard]] int Truncate();

  // Closes and renames. Errors: kIo with the first thing that went wrong; the hidden file is then
  // removed.
  [[nodiscard]] Status Commit();

  // 0 or the negative errno of the first failure.
  [[nodiscard]] int first_error() const { return first_error_; }
  [[nodiscard]] bool can_seek() const { return can_seek_; }
  // Where the bytes are now, and where they will be.
  [[nodiscard]] const std::string& current_path() const { return current_path_; }
  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  OutputFile() = default;

  std::string path_;                  // as given
  std::optional<StagedFile> staged_;  // none for standard output
  std::string current_path_;
  int descriptor_ = -1;
  bool owns_descriptor_ = true;
  bool can_seek_ = false;
  bool overwrite_ = false;
  int first_error_ = 0;
};

}  // namespace rsstab::media

#endif  // RSSTAB_CLI_MEDIA_OUTPUT_FILE_H_
