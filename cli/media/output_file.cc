// SPDX-License-Identifier: Apache-2.0
#include "cli/media/output_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <system_error>
#include <utility>

#include "cli/media/av_error.h"
#include "cli/media/av_handles.h"

namespace rsstab::media {
namespace {

namespace fs = std::filesystem;

bool IsSameFile(const std::string& a, const std::string& b) {
  struct stat first {};
  struct stat second {};
  return stat(a.c_str(), &first) == 0 && stat(b.c_str(), &second) == 0 &&
         first.st_dev == second.st_dev && first.st_ino == second.st_ino;
}

}  // namespace

Result<std::unique_ptr<OutputFile>> OutputFile::Open(const std::string& path, bool overwrite,
                                                     const std::string& source_path) {
  std::unique_ptr<OutputFile> file(new OutputFile());
  file->path_ = path;
  file->overwrite_ = overwrite;
  if (path == "-") {
    file->current_path_ = "standard output";
    file->descriptor_ = STDOUT_FILENO;
    file->owns_descriptor_ = false;
    return file;
  }
  if (!source_path.empty() && IsSameFile(path, source_path)) {
    return Fail(ErrorCode::kInvalidArgument,
                "{}: input and output are the same file; choose another output name", path);
  }
  std::error_code ignored;
  if (!overwrite && fs::is_regular_file(fs::status(path, ignored))) {
    return Fail(ErrorCode::kInvalidArgument,
                "{}: this file exists; give --overwrite to replace it, or choose another name",
                path);
  }
  auto staged = StagedFile::Create(path);
  if (!staged) {
    return Propagate(std::move(staged.error()));
  }
  file->staged_ = std::move(*staged);
  file->current_path_ = file->staged_->current_path();
  file->can_seek_ = file->staged_->is_staged();
  // Readable too where it can be: some containers move their index to the front in the end.
  const int access = file->can_seek_ ? O_RDWR : O_WRONLY;
  file->descriptor_ = open(file->current_path_.c_str(), access | O_CLOEXEC);
  if (file->descriptor_ < 0) {
    return AvFail(AVERROR(errno), "cannot write " + path);
  }
  return file;
}

OutputFile::~OutputFile() {
  if (owns_descriptor_ && descriptor_ >= 0) {
    close(descriptor_);
  }
}

int OutputFile::Write(const std::uint8_t* data, std::size_t size) {
  if (first_error_ != 0) {
    return first_error_;
  }
  std::size_t done = 0;
  while (done < size) {
    const ssize_t count = write(descriptor_, data + done, size - done);
    if (count < 0 && errno == EINTR) {
      continue;
    }
    if (count <= 0) {
      first_error_ = count < 0 ? -errno : -EIO;
      return first_error_;
    }
    done += static_cast<std::size_t>(count);
  }
  return 0;
}

std::int64_t OutputFile::Seek(std::int64_t offset, int whence) {
  const off_t position = lseek(descriptor_, offset, whence);
  return position < 0 ? -errno : position;
}

int OutputFile::Truncate() {
  if (!can_seek_ || ftruncate(descriptor_, 0) != 0 || lseek(descriptor_, 0, SEEK_SET) != 0) {
    return can_seek_ ? -errno : -ESPIPE;
  }
  return 0;
}

Status OutputFile::Commit() {
  if (owns_descriptor_) {
    // Some file systems tell of a full disk only now.
    if (close(descriptor_) != 0 && first_error_ == 0) {
      first_error_ = -errno;
    }
    descriptor_ = -1;
  }
  if (first_error_ != 0) {
    return AvFail(first_error_, "writing " + path_);
  }
  return staged_ ? staged_->Commit(overwrite_) : Status();
}

}  // namespace rsstab::media
