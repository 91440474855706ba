// SPDX-License-Identifier: Apache-2.0
#include "cli/media/av_error.h"

#include <array>
#include <cerrno>

#include "cli/media/av_handles.h"

namespace rsstab::media {
namespace {

ErrorCode CodeOf(int averror) {
  switch (averror) {
    case AVERROR_INVALIDDATA:
    case AVERROR_EOF:
      return ErrorCode::kCorruptData;
    case AVERROR_STREAM_NOT_FOUND:
    case AVERROR_DECODER_NOT_FOUND:
    case AVERROR_ENCODER_NOT_FOUND:
    case AVERROR_DEMUXER_NOT_FOUND:
    case AVERROR_MUXER_NOT_FOUND:
    case AVERROR(ENOENT):
      return ErrorCode::kNotFound;
    case AVERROR_OPTION_NOT_FOUND:
    case AVERROR(EINVAL):
      return ErrorCode::kInvalidArgument;
    case AVERROR_PATCHWELCOME:
    case AVERROR(ENOSYS):
      return ErrorCode::kUnsupported;
    case AVERROR_EXIT:
      return ErrorCode::kCancelled;
    case AVERROR_BUG:
    case AVERROR_BUG2:
      return ErrorCode::kInternal;
    default:
      return ErrorCode::kIo;
  }
}

}  // namespace

std::string AvErrorText(int averror) {
  switch (averror) {
    case AVERROR(ENOSPC):
      return "the disk is full";
    case AVERROR(EFBIG):
      return "the file is larger than the system allows";
    case AVERROR(ENOENT):
      return "no such file or folder";
    case AVERROR(EACCES):
    case AVERROR(EPERM):
      return "no permission";
    case AVERROR(EROFS):
      return "the file system is read-only";
    case AVERROR(EPIPE):
      return "the reader at the other end of the pipe has gone";
    default:
      break;
  }
  std::array<char, AV_ERROR_MAX_STRING_SIZE> text{};
  av_strerror(averror, text.data(), text.size());
  return text.data();
}

Error AvError(int averror, const std::string& doing) {
  return {CodeOf(averror), doing + ": " + AvErrorText(averror)};
}

}  // namespace rsstab::media
