// SPDX-License-Identifier: Apache-2.0
#include "cli/output_names.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <system_error>
#include <utility>

namespace rsstab::cli {
namespace {

// Endings of containers that take H.264 (WebM: VP9) together with its timestamps.
constexpr std::array<const char*, 11> kKeptEndings = {
    ".mp4", ".m4v", ".mov", ".mkv", ".webm", ".ts", ".mts", ".m2ts", ".flv", ".3gp", ".mk3d"};

std::string Lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

}  // namespace

std::string DefaultOutput(const std::string& input) {
  std::filesystem::path path(input);
  const std::string ending = path.extension().string();
  const bool kept =
      std::find(kKeptEndings.begin(), kKeptEndings.end(), Lower(ending)) != kKeptEndings.end();
  path.replace_filename(path.stem().string() + "-stable" + (kept ? ending : ".mkv"));
  return path.string();
}

std::string DefaultAnalysisFile(const std::string& input) {
  return std::filesystem::path(input).replace_extension(".rsstab").string();
}

Status CheckOutput(const std::string& input, const std::string& output, bool overwrite) {
  std::error_code error;
  if (std::filesystem::equivalent(input, output, error)) {
    return Fail(ErrorCode::kInvalidArgument,
                "{}: this is the input itself, name another file to write", output);
  }
  if (!overwrite && std::filesystem::is_regular_file(output, error)) {
    return Fail(ErrorCode::kInvalidArgument, "{}: the file exists; --overwrite replaces it",
                output);
  }
  return {};
}

Result<ScratchFolder> ScratchFolder::Create() {
  std::error_code error;
  std::string pattern = std::filesystem::temp_directory_path(error) / "rs-stabilize-XXXXXX";
  if (error || mkdtemp(pattern.data()) == nullptr) {
    return Fail(ErrorCode::kIo, "{}: cannot make a folder for temporary files ({}); set TMPDIR",
                pattern, error ? error.message() : std::strerror(errno));
  }
  return ScratchFolder(pattern);
}

ScratchFolder::ScratchFolder(std::filesystem::path path) : path_(std::move(path)) {}

ScratchFolder::ScratchFolder(ScratchFolder&& other) noexcept
    : path_(std::exchange(other.path_, {})) {}

ScratchFolder::~ScratchFolder() {
  if (!path_.empty()) {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
}

std::string ScratchFolder::File(const std::string& name) const { return (path_ / name).string(); }

}  // namespace rsstab::cli
