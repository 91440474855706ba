// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_IGF_BASE_STAGED_FILE_H_
#define RSSTAB_IGF_BASE_STAGED_FILE_H_

#include <string>

#include "igf/base/result.h"

namespace rsstab {

// Where the bytes of an output file go until it is complete: a hidden file in the folder of its
// target, with a name that nobody else uses, which Commit() gives the final name and destruction
// without Commit() removes. Symbolic links are followed: the file they point to is replaced, the
// link stays. Pipes and devices have no other place to write to: for them current_path() is the
// path itself, and Commit() does nothing. Not thread safe.
class StagedFile {
 public:
  // Makes the hidden file, empty. Errors: kInvalidArgument (no name, or a folder's), kNotFound (no
  // such folder), kIo (no permission).
  [[nodiscard]] static Result<StagedFile> Create(const std::string& path);
  ~StagedFile();
  StagedFile(StagedFile&& other) noexcept;
  StagedFile& operator=(StagedFile&& other) noexcept;

  // Whether there is a hidden file, and not a pipe or device.
  [[nodiscard]] bool is_staged() const { return is_staged_; }
  // Where to write.
  [[nodiscard]] const std::string& current_path() const { return current_path_; }

  // Gives the hidden file, which the caller has written and closed, its name; call it once. Without
  // `overwrite` a file of that name that somebody made in the meantime is kept.
  // Errors: kInvalidArgument (kept), kIo; the hidden file is then removed by the destructor.
  [[nodiscard]] Status Commit(bool overwrite);

 private:
  StagedFile() = default;
  void Remove() noexcept;

  std::string path_;          // as given
  std::string target_path_;   // symbolic links resolved
  std::string current_path_;  // hidden file, or the pipe or device itself
  bool is_staged_ = false;
};

}  // namespace rsstab

#endif  // RSSTAB_IGF_BASE_STAGED_FILE_H_
