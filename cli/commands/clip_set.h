// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_COMMANDS_CLIP_SET_H_
#define RSSTAB_CLI_COMMANDS_CLIP_SET_H_

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "igf/base/result.h"

namespace rsstab::cli {

enum class ClipKind {
  kReal,       // any video file; nobody knows the truth
  kSimulated,  // what `rs-stabilize simulate` wrote: its rolling-shutter clip
  kTwin,       // the global-shutter twin of such a clip, to be left alone
};

// "real", "simulated", "twin".
[[nodiscard]] std::string_view ClipKindName(ClipKind kind);

// A clip to evaluate on. Nothing of it has been opened yet.
struct EvaluationClip {
  std::string name;  // file or folder name; a twin has "/gs" behind it
  ClipKind kind = ClipKind::kReal;
  std::filesystem::path video;
  std::filesystem::path folder;  // of a simulated clip and its twin; empty for a real one
};

// The clips of a folder, in the order of their names: its video files (known by their ending) and
// its subfolders that hold rs.mp4 or truth.json, each followed by its twin when `twins`. A folder
// that is itself a simulated clip is that one clip.
// Errors: kNotFound for no such folder, or none in it.
[[nodiscard]] Result<std::vector<EvaluationClip>> FindClips(const std::filesystem::path& folder,
                                                            bool twins);

}  // namespace rsstab::cli

#endif  // RSSTAB_CLI_COMMANDS_CLIP_SET_H_
