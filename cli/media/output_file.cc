// SPDX-License-Identifier: Apache-2.0
#include "cli/media/output_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <system_error>

#include "cli/media/av_error.h"
#include "cli/media/av_handles.h"

namespace rsstab::media {
namespace {

namespace fs = std::filesystem;

// Longest file name on common file systems, less what the hidden name adds.
constexpr std::size_t kLongestStem = 200;
constexpr int kNameAttempts = 100;

bool IsSameFile(const std::string& a, const std::string& b) {
  struct stat first {};
  struct stat second {};
  return stat(a.c_str(), &first) == 0 && stat(b.c_str(), &second) == 0 &&
         first.st_dev == second.st_dev && first.st_ino == second.st_ino;
}

std::string Folder(const std::string& path) {
  const fs::path parent = fs::path(path).parent_path();
  return parent.empty() ? "." : parent.string();
}

// A name beside the target that no other process uses.
std::string HiddenName(const std::string& target, int attempt) {
  std::string stem = fs::path(target).filename().string();
  stem.resize(std::min(stem.size(), kLongestStem));
  return (fs::path(Folder(target)) / fmt::format(".{}.{}-{}.part", stem, getpid(), attempt))
      .string();
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
  if (path.empty()) {
    return Fail(ErrorCode::kInvalidArgument, "no output file was named");
  }
  if (!source_path.empty() && IsSameFile(path, source_path)) {
    return Fail(ErrorCode::kInvalidArgument,
                "{}: input and output are the same file; choose another output name", path);
  }
  std::error_code ignored;
  const fs::file_status status = fs::status(path, ignored);
  if (fs::is_directory(status)) {
    return Fail(ErrorCode::kInvalidArgument, "{}: this is a folder; name a file in it", path);
  }
  if (fs::exists(status) && !fs::is_regular_file(status)) {
    file->current_path_ = path;
    file->descriptor_ = open(path.c_str(), O_WRONLY | O_CLOEXEC);
    if (file->descriptor_ < 0) {
      return AvFail(AVERROR(errno), "cannot write " + path);
    }
    return file;
  }
  if (fs::exists(status) && !overwrite) {
    return Fail(ErrorCode::kInvalidArgument,
                "{}: this file exists; give --overwrite to replace it, or choose another name",
                path);
  }
  // Replacing a symbolic link would leave the file it points to as it was.
  const fs::path resolved = fs::weakly_canonical(path, ignored);
  file->target_path_ = resolved.empty() ? path : resolved.string();
  if (Status staged = file->Stage(); !staged) {
    return Propagate(staged.error());
  }
  return file;
}

Status OutputFile::Stage() {
  for (int attempt = 0; attempt < kNameAttempts; ++attempt) {
    current_path_ = HiddenName(target_path_, attempt);
    constexpr mode_t kUsualMode = 0666;  // less the umask, as for any new file
    // Readable too: some containers move their index to the front in the end.
    descriptor_ = open(current_path_.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, kUsualMode);
    if (descriptor_ >= 0) {
      is_staged_ = true;
      can_seek_ = true;
      return {};
    }
    if (errno != EEXIST) {
      break;
    }
  }
  const int error = errno;
  if (error == ENOENT) {
    return Fail(ErrorCode::kNotFound, "cannot write {}: there is no folder '{}'; make it first",
                path_, Folder(path_));
  }
  return AvFail(AVERROR(error), fmt::format("cannot write into the folder '{}'", Folder(path_)));
}

OutputFile::~OutputFile() {
  if (owns_descriptor_ && descriptor_ >= 0) {
    close(descriptor_);
  }
  if (is_staged_) {
    unlink(current_path_.c_str());
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
  if (!is_staged_) {
    return {};
  }
  // RENAME_NOREPLACE is not offered by every file system, link() is by most: it fails if somebody
  // else made the file in the meantime.
  if (!overwrite_ && link(current_path_.c_str(), target_path_.c_str()) == 0) {
    unlink(current_path_.c_str());
    is_staged_ = false;
    return {};
  }
  if (!overwrite_ && errno == EEXIST) {
    return Fail(ErrorCode::kInvalidArgument,
                "{}: a file of this name was made while this one was being written; it was kept",
                path_);
  }
  if (rename(current_path_.c_str(), target_path_.c_str()) != 0) {
    return AvFail(AVERROR(errno), "giving the finished file its name " + path_);
  }
  is_staged_ = false;
  return {};
}

}  // namespace rsstab::media
