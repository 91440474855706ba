// SPDX-License-Identifier: Apache-2.0
#include "igf/base/whole_file.h"

#include <filesystem>
#include <fstream>
#include <system_error>
#include <utility>

#include "igf/base/staged_file.h"

namespace rsstab {

namespace fs = std::filesystem;

Result<std::string> ReadWholeFile(const std::string& path, std::uint64_t max_bytes) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (!fs::exists(status)) {
    return Fail(ErrorCode::kNotFound, "{}: no such file", path);
  }
  if (!fs::is_regular_file(status)) {
    return Fail(ErrorCode::kIo, "{}: not a regular file", path);
  }
  const std::uintmax_t size = fs::file_size(path, error);
  if (error) {
    return Fail(ErrorCode::kIo, "{}: {}", path, error.message());
  }
  if (size == 0) {
    return Fail(ErrorCode::kCorruptData, "{}: the file is empty", path);
  }
  if (size > max_bytes) {
    return Fail(ErrorCode::kUnsupported, "{}: {} MiB is more than the limit of {} MiB", path,
                size >> 20U, max_bytes >> 20U);
  }
  std::ifstream in(path, std::ios::binary);
  std::string content(static_cast<std::size_t>(size), '\0');
  if (!in.read(content.data(), static_cast<std::streamsize>(size))) {
    return Fail(ErrorCode::kIo, "{}: cannot be read", path);
  }
  return content;
}

Status WriteWholeFile(const std::string& path, const std::string& content) {
  return WriteWholeFile(path, [&content](std::ostream& out) {
    out.write(content.data(), static_cast<std::streamsize>(content.size()));
  });
}

Status WriteWholeFile(const std::string& path,
                      const std::function<void(std::ostream& out)>& write) {
  auto staged = StagedFile::Create(path);
  if (!staged) {
    return Propagate(std::move(staged.error()));
  }
  std::ofstream out(staged->current_path(), std::ios::binary | std::ios::trunc);
  write(out);
  out.close();
  if (!out) {
    return Fail(ErrorCode::kIo, "{}: cannot be written (disk full, or no permission)", path);
  }
  return staged->Commit(true);
}

}  // namespace rsstab
