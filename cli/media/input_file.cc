// SPDX-License-Identifier: Apache-2.0
#include "cli/media/input_file.h"

#include <cerrno>
#include <filesystem>
#include <system_error>

#include "cli/media/av_error.h"
#include "cli/media/av_log.h"
#include "cli/media/video_info.h"

namespace rsstab::media {
namespace {

// A playlist on disk must not make the program talk to the network.
constexpr const char* kProtocols = "file,pipe";

Status CheckPictureSizes(const AVFormatContext& input, const std::string& path) {
  for (unsigned i = 0; i < input.nb_streams; ++i) {
    const AVCodecParameters& parameters = *input.streams[i]->codecpar;
    if (parameters.codec_type == AVMEDIA_TYPE_VIDEO &&
        (parameters.width > kMaxPictureSide || parameters.height > kMaxPictureSide)) {
      return Fail(
          ErrorCode::kUnsupported,
          "{}: it claims pictures of {}x{} pixels, more than the {}x{} that can be handled; "
          "if that is not their real size, the file is damaged",
          path, parameters.width, parameters.height, kMaxPictureSide, kMaxPictureSide);
    }
  }
  return {};
}

Error OpenError(int code, const std::string& path) {
  if (code == AVERROR_INVALIDDATA || code == AVERROR_EOF) {
    return {ErrorCode::kCorruptData,
            path +
                ": this is not a video file that can be read, or its beginning or index is damaged "
                "(a recording that was cut off can lack its index)"};
  }
  return AvError(code, "cannot open " + path);
}

}  // namespace

Result<AvInputPtr> OpenInput(const std::string& path, const Logger* logger) {
  RouteAvLog();
  std::error_code ignored;
  if (path != "-" && std::filesystem::is_directory(path, ignored)) {
    return Fail(ErrorCode::kInvalidArgument, "cannot open {}: it is a folder, not a video file",
                path);
  }
  // avformat_open_input() frees the context itself when it fails.
  AVFormatContext* context = avformat_alloc_context();
  if (context == nullptr) {
    return AvFail(AVERROR(ENOMEM), "cannot open " + path);
  }
  context->opaque = const_cast<Logger*>(logger);
  AvDictionary options;
  options.Set("protocol_whitelist", kProtocols);
  // The explicit protocol keeps libav from reading "12:30.mp4" as protocol "12".
  const std::string url = path == "-" ? std::string("pipe:0") : "file:" + path;
  const int code = avformat_open_input(&context, url.c_str(), nullptr, options.address());
  if (code < 0) {
    return Propagate(OpenError(code, path));
  }
  AvInputPtr input(context);
  // Before stream probing, which decodes and therefore allocates pictures of the claimed size; and
  // after it, for containers that only learn the size from the stream itself.
  if (Status ok = CheckPictureSizes(*input, path); !ok) {
    return Propagate(ok.error());
  }
  if (const int found = avformat_find_stream_info(input.get(), nullptr); found < 0) {
    return Propagate(OpenError(found, path));
  }
  if (Status ok = CheckPictureSizes(*input, path); !ok) {
    return Propagate(ok.error());
  }
  return input;
}

bool IsRegularFile(const std::string& path) {
  std::error_code ignored;
  return path != "-" && std::filesystem::is_regular_file(path, ignored);
}

Result<int> FindVideoStream(AVFormatContext& input, const std::string& path) {
  const int index = av_find_best_stream(&input, AVMEDIA_TYPE_VIDEO, -1, -1, nullptr, 0);
  if (index < 0 || (input.streams[index]->disposition & AV_DISPOSITION_ATTACHED_PIC) != 0) {
    return Fail(ErrorCode::kNotFound, "{}: there is no video stream in this file", path);
  }
  return index;
}

std::string FourLetterKind(const AVCodecParameters& parameters) {
  std::string kind;
  for (int shift = 0; shift < 32; shift += 8) {
    const auto letter = static_cast<char>((parameters.codec_tag >> shift) & 0xffU);
    if (letter == 0) {
      break;
    }
    kind.push_back(letter >= ' ' && letter <= '~' ? letter : '?');
  }
  return kind;
}

}  // namespace rsstab::media
