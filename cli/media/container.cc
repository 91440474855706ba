// SPDX-License-Identifier: Apache-2.0
#include "cli/media/container.h"

#include <algorithm>
#include <initializer_list>
#include <string_view>

namespace rsstab::media {
namespace {

bool IsNamed(const AVOutputFormat& format, std::initializer_list<std::string_view> names) {
  return std::find(names.begin(), names.end(), std::string_view(format.name)) != names.end();
}

}  // namespace

bool IsMp4Like(const AVOutputFormat& format) {
  return IsNamed(format, {"mp4", "mov", "ipod", "ismv", "3gp", "3g2"});
}

bool IsMatroska(const AVOutputFormat& format) { return IsNamed(format, {"matroska", "webm"}); }

bool HoldsConstantRateOnly(const AVOutputFormat& format) { return IsNamed(format, {"avi"}); }

Result<const AVOutputFormat*> ChooseContainer(const std::string& path, const std::string& format) {
  if (!format.empty()) {
    const AVOutputFormat* named = av_guess_format(format.c_str(), nullptr, nullptr);
    if (named == nullptr) {
      return Fail(ErrorCode::kUnsupported,
                  "there is no container format '{}'; examples are mp4, mov, matroska, webm, nut",
                  format);
    }
    return named;
  }
  if (path == "-") {
    return av_guess_format("matroska", nullptr, nullptr);
  }
  const AVOutputFormat* guessed = av_guess_format(nullptr, path.c_str(), nullptr);
  if (guessed == nullptr || guessed->video_codec == AV_CODEC_ID_NONE) {
    return Fail(ErrorCode::kUnsupported,
                "{}: its name does not say which container to write; end it in .mp4, .mov, .mkv "
                "or .webm",
                path);
  }
  return guessed;
}

}  // namespace rsstab::media
