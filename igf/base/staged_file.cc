// SPDX-License-Identifier: Apache-2.0
#include "igf/base/staged_file.h"

#include <fcntl.h>
#include <spdlog/fmt/fmt.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <system_error>
#include <utility>

namespace rsstab {
namespace {

namespace fs = std::filesystem;

// Longest file name on common file systems, less what the hidden name adds.
constexpr std::size_t kLongestStem = 200;
constexpr int kNameAttempts = 100;

fs::path FolderOf(const std::string& path) {
  const fs::path parent = fs::path(path).parent_path();
  return parent.empty() ? "." : parent;
}

// A name beside the target that no other process uses.
std::string HiddenName(const std::string& target, int attempt) {
  std::string stem = fs::path(target).filename().string();
  stem.resize(std::min(stem.size(), kLongestStem));
  return (FolderOf(target) / fmt::format(".{}.{}-{}.part", stem, getpid(), attempt)).string();
}

std::string TextOf(int error) {
  return error == EACCES || error == EPERM ? "no permission"
                                           : std::system_category().message(error);
}

}  // namespace

Result<StagedFile> StagedFile::Create(const std::string& path) {
  if (path.empty()) {
    return Fail(ErrorCode::kInvalidArgument, "no output file was named");
  }
  StagedFile file;
  file.path_ = path;
  std::error_code ignored;
  const fs::file_status status = fs::status(path, ignored);
  if (fs::is_directory(status)) {
    return Fail(ErrorCode::kInvalidArgument, "{}: this is a folder; name a file in it", path);
  }
  if (fs::exists(status) && !fs::is_regular_file(status)) {
    file.current_path_ = path;
    return file;
  }
  const fs::path resolved = fs::weakly_canonical(path, ignored);
  file.target_path_ = resolved.empty() ? path : resolved.string();
  int error = EEXIST;
  for (int attempt = 0; attempt < kNameAttempts && error == EEXIST; ++attempt) {
    file.current_path_ = HiddenName(file.target_path_, attempt);
    constexpr mode_t kUsualMode = 0666;  // less the umask, as for any new file
    const int descriptor =
        open(file.current_path_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, kUsualMode);
    if (descriptor >= 0) {
      close(descriptor);
      file.is_staged_ = true;
      return file;
    }
    error = errno;
  }
  const fs::path folder = FolderOf(path);
  if (error == ENOENT && !fs::exists(folder, ignored)) {
    return Fail(ErrorCode::kNotFound, "cannot write {}: there is no folder '{}'; make it first",
                path, folder.string());
  }
  return Fail(ErrorCode::kIo, "cannot write {}: the folder '{}' takes no new file: {}", path,
              folder.string(), TextOf(error));
}

StagedFile::StagedFile(StagedFile&& other) noexcept
    : path_(std::move(other.path_)),
      target_path_(std::move(other.target_path_)),
      current_path_(std::move(other.current_path_)),
      is_staged_(std::exchange(other.is_staged_, false)) {}

StagedFile& StagedFile::operator=(StagedFile&& other) noexcept {
  if (this != &other) {
    Remove();
    path_ = std::move(other.path_);
    target_path_ = std::move(other.target_path_);
    current_path_ = std::move(other.current_path_);
    is_staged_ = std::exchange(other.is_staged_, false);
  }
  return *this;
}

StagedFile::~StagedFile() { Remove(); }

void StagedFile::Remove() noexcept {
  if (std::exchange(is_staged_, false)) {
    unlink(current_path_.c_str());
  }
}

Status StagedFile::Commit(bool overwrite) {
  if (!is_staged_) {
    return {};
  }
  // RENAME_NOREPLACE is not offered by every file system, link() is by most: it fails if somebody
  // else made the file in the meantime.
  if (!overwrite) {
    if (link(current_path_.c_str(), target_path_.c_str()) == 0) {
      Remove();
      return {};
    }
    if (errno == EEXIST) {
      return Fail(ErrorCode::kInvalidArgument,
                  "{}: a file of this name was made while this one was being written; it was kept",
                  path_);
    }
  }
  if (rename(current_path_.c_str(), target_path_.c_str()) != 0) {
    return Fail(ErrorCode::kIo, "{}: the finished file cannot be given its name: {}", path_,
                TextOf(errno));
  }
  is_staged_ = false;
  return {};
}

}  // namespace rsstab
