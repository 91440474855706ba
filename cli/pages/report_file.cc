// SPDX-License-Identifier: Apache-2.0
#include "cli/pages/report_file.h"

#include <cstdint>
#include <filesystem>
#include <system_error>
#include <utility>

namespace rsstab::cli {
namespace {

namespace fs = std::filesystem;

// Also for files that are not there yet.
bool IsSamePlace(const std::string& a, const std::string& b) {
  std::error_code ignored;
  const auto whole = [&](const std::string& path) {
    return fs::weakly_canonical(fs::absolute(path, ignored), ignored);
  };
  return fs::equivalent(a, b, ignored) || whole(a) == whole(b);
}

}  // namespace

Result<ReportFile> ReportFile::Open(const std::string& path, bool overwrite,
                                    const std::vector<std::string>& others) {
  if (path == "-") {
    return Fail(ErrorCode::kInvalidArgument,
                "-: name a file; standard output is for what the command itself prints");
  }
  for (const std::string& other : others) {
    if (!other.empty() && other != "-" && IsSamePlace(path, other)) {
      return Fail(ErrorCode::kInvalidArgument,
                  "{}: this would take the place of another file of this command; choose another "
                  "name",
                  path);
    }
  }
  auto file = media::OutputFile::Open(path, overwrite, "");
  if (!file) {
    return Propagate(file.error());
  }
  return ReportFile(std::move(*file));
}

Status ReportFile::Write(const std::string& content) {
  constexpr std::size_t kPiece = std::size_t{1} << 20U;
  for (std::size_t begin = 0; begin < content.size(); begin += kPiece) {
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(content.data()) + begin;
    if (file_->Write(bytes, std::min(kPiece, content.size() - begin)) < 0) {
      break;  // Commit tells why
    }
  }
  return file_->Commit();
}

}  // namespace rsstab::cli
