// SPDX-License-Identifier: Apache-2.0
#include "cli/media/hdr_metadata.h"

extern "C" {
#include <libavutil/mastering_display_metadata.h>
}

#include <spdlog/fmt/fmt.h>

#include <cmath>

namespace rsstab::media {
namespace {

// Chromaticity in units of 0.00002, luminance in units of 0.0001 cd/m2, as in the SEI message.
long Chromaticity(AVRational value) { return std::lround(av_q2d(value) * 50000.0); }
long Luminance(AVRational value) { return std::lround(av_q2d(value) * 10000.0); }

std::string MasteringDisplay(const AVMasteringDisplayMetadata& display, bool in_fractions) {
  const auto& primaries = display.display_primaries;  // red, green, blue
  if (in_fractions) {
    return fmt::format(
        "G({:.5f},{:.5f})B({:.5f},{:.5f})R({:.5f},{:.5f})WP({:.5f},{:.5f})L({:.4f},{:.4f})",
        av_q2d(primaries[1][0]), av_q2d(primaries[1][1]), av_q2d(primaries[2][0]),
        av_q2d(primaries[2][1]), av_q2d(primaries[0][0]), av_q2d(primaries[0][1]),
        av_q2d(display.white_point[0]), av_q2d(display.white_point[1]),
        av_q2d(display.max_luminance), av_q2d(display.min_luminance));
  }
  return fmt::format("G({},{})B({},{})R({},{})WP({},{})L({},{})", Chromaticity(primaries[1][0]),
                     Chromaticity(primaries[1][1]), Chromaticity(primaries[2][0]),
                     Chromaticity(primaries[2][1]), Chromaticity(primaries[0][0]),
                     Chromaticity(primaries[0][1]), Chromaticity(display.white_point[0]),
                     Chromaticity(display.white_point[1]), Luminance(display.max_luminance),
                     Luminance(display.min_luminance));
}

}  // namespace

std::string HdrParameters(const std::string& encoder, const AVFrame* properties) {
  const bool is_x264 = encoder == "libx264";
  const bool is_x265 = encoder == "libx265";
  const bool is_svt = encoder == "libsvtav1";
  if (properties == nullptr || !(is_x264 || is_x265 || is_svt)) {
    return "";
  }
  std::string text;
  const auto add = [&text](const std::string& word) { text += (text.empty() ? "" : ":") + word; };
  if (const AVFrameSideData* data =
          av_frame_get_side_data(properties, AV_FRAME_DATA_MASTERING_DISPLAY_METADATA)) {
    const auto& display = *reinterpret_cast<const AVMasteringDisplayMetadata*>(data->data);
    if (display.has_primaries != 0 && display.has_luminance != 0) {
      add((is_x265 ? "master-display=" : "mastering-display=") + MasteringDisplay(display, is_svt));
    }
  }
  if (const AVFrameSideData* data =
          av_frame_get_side_data(properties, AV_FRAME_DATA_CONTENT_LIGHT_LEVEL)) {
    const auto& light = *reinterpret_cast<const AVContentLightMetadata*>(data->data);
    const char* key = is_x264 ? "cll" : is_x265 ? "max-cll" : "content-light";
    add(fmt::format("{}={},{}", key, light.MaxCLL, light.MaxFALL));
  }
  return text;
}

}  // namespace rsstab::media
