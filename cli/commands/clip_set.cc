// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/clip_set.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <system_error>

namespace rsstab::cli {
namespace {

namespace fs = std::filesystem;

constexpr std::array<std::string_view, 17> kVideoEndings = {
    ".mp4", ".m4v", ".mov", ".mkv",  ".webm", ".avi", ".ts",  ".mts", ".m2ts",
    ".flv", ".3gp", ".mpg", ".mpeg", ".wmv",  ".ogv", ".mxf", ".360"};

bool IsVideo(const fs::path& file) {
  std::string ending = file.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return std::find(kVideoEndings.begin(), kVideoEndings.end(), ending) != kVideoEndings.end();
}

bool IsSimulated(const fs::path& folder) {
  std::error_code ignored;
  return fs::is_regular_file(folder / "rs.mp4", ignored) ||
         fs::is_regular_file(folder / "truth.json", ignored);
}

void AddSimulated(const fs::path& folder, const std::string& name, bool twins,
                  std::vector<EvaluationClip>& clips) {
  clips.push_back({name, ClipKind::kSimulated, folder / "rs.mp4", folder});
  if (twins) {
    clips.push_back({name + "/gs", ClipKind::kTwin, folder / "gs.mp4", folder});
  }
}

}  // namespace

std::string_view ClipKindName(ClipKind kind) {
  switch (kind) {
    case ClipKind::kReal:
      return "real";
    case ClipKind::kSimulated:
      return "simulated";
    case ClipKind::kTwin:
      return "twin";
  }
  return "?";
}

Result<std::vector<EvaluationClip>> FindClips(const fs::path& folder, bool twins) {
  std::vector<EvaluationClip> clips;
  if (IsSimulated(folder)) {
    const fs::path whole = fs::absolute(folder).lexically_normal();
    AddSimulated(folder, (whole.has_filename() ? whole : whole.parent_path()).filename().string(),
                 twins, clips);
    return clips;
  }
  std::error_code error;
  std::vector<fs::path> entries;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    entries.push_back(it->path());
  }
  if (error) {
    return Fail(ErrorCode::kNotFound, "{}: the folder of clips cannot be read: {}.",
                folder.string(), error.message());
  }
  std::sort(entries.begin(), entries.end());
  for (const fs::path& entry : entries) {
    const std::string name = entry.filename().string();
    if (name.starts_with(".")) {
      continue;
    }
    if (fs::is_directory(entry, error)) {
      if (IsSimulated(entry)) {
        AddSimulated(entry, name, twins, clips);
      }
    } else if (IsVideo(entry)) {
      clips.push_back({name, ClipKind::kReal, entry, {}});
    }
  }
  if (clips.empty()) {
    return Fail(ErrorCode::kNotFound,
                "{}: there is no clip in this folder; it should hold video files, or folders that "
                "`rs-stabilize simulate` wrote.",
                folder.string());
  }
  return clips;
}

}  // namespace rsstab::cli
