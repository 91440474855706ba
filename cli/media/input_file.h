// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_MEDIA_INPUT_FILE_H_
#define RSSTAB_CLI_MEDIA_INPUT_FILE_H_

// Opening of media files for the rest of this module (includes libav).

#include <string>

#include "cli/media/av_handles.h"
#include "igf/base/log.h"
#include "igf/base/result.h"

namespace rsstab::media {

// Opens `path` ("-" = standard input) and finds its streams. Only local files and standard input
// are ever opened, also by playlists and the like. `logger` (may be null; must outlive the result)
// gets libav's own messages at debug level.
// Errors: kNotFound, kIo, kCorruptData; kUnsupported for a side above kMaxPictureSide.
[[nodiscard]] Result<AvInputPtr> OpenInput(const std::string& path, const Logger* logger);

// Whether `path` can be opened and read a second time (a regular file).
[[nodiscard]] bool IsRegularFile(const std::string& path);

// Index of the stream to work on: the best one that is not a cover picture.
// Errors: kNotFound.
[[nodiscard]] Result<int> FindVideoStream(AVFormatContext& input, const std::string& path);

// The container's four-letter name of a track's kind, for example "gpmd"; empty if it has none.
[[nodiscard]] std::string FourLetterKind(const AVCodecParameters& parameters);

}  // namespace rsstab::media

#endif  // RSSTAB_CLI_MEDIA_INPUT_FILE_H_
