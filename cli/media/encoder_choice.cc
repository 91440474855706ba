// SPDX-License-Identifier: Apache-2.0
#include "cli/media/encoder_choice.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string_view>

namespace rsstab::media {
namespace {

struct Family {
  std::string_view name;
  std::vector<std::string> encoders;  // best first
};

const std::vector<Family>& Families() {
  static const std::vector<Family> families = {
      {"h264", {"libx264", "libopenh264"}},
      {"hevc", {"libx265", "libkvazaar"}},
      {"vp9", {"libvpx-vp9"}},
      {"vp8", {"libvpx"}},
      {"av1", {"libsvtav1", "libaom-av1", "librav1e"}},
      {"mpeg4", {"mpeg4", "libxvid"}},
      {"mjpeg", {"mjpeg"}},
      {"ffv1", {"ffv1"}},
      {"prores", {"prores_ks", "prores"}},
  };
  return families;
}

std::string FamilyName(const std::string& codec) {
  if (codec == "h265" || codec == "x265") {
    return "hevc";
  }
  if (codec == "x264" || codec == "avc") {
    return "h264";
  }
  return codec;
}

// x264's and x265's own words, fastest first.
constexpr std::array<std::string_view, 10> kPresets = {
    "ultrafast", "superfast", "veryfast", "faster",   "fast",
    "medium",    "slow",      "slower",   "veryslow", "placebo"};
constexpr std::size_t kMedium = 5;

std::string NumberText(double value) { return fmt::format("{:g}", value); }

// The place of `preset` on a scale where `fastest` is ultrafast and `slowest` veryslow.
int OnScale(std::size_t preset, int fastest, int slowest) {
  constexpr double kSteps = 8.0;
  const double share = std::min(1.0, static_cast<double>(preset) / kSteps);
  return static_cast<int>(std::lround(fastest + share * (slowest - fastest)));
}

// In x264 the quantiser step doubles every 6 steps of crf; crf 18 looks like MPEG-4's and JPEG's
// quantiser 2.
double QuantiserOf(double crf) {
  constexpr double kReferenceCrf = 18.0;
  constexpr double kReferenceQuantiser = 2.0;
  return std::clamp(kReferenceQuantiser * std::exp2((crf - kReferenceCrf) / 6.0), 1.0, 31.0);
}

}  // namespace

Result<EncoderChoice> ChooseEncoder(const std::string& codec, const EncoderIsThere& is_there) {
  const bool is_automatic = codec.empty();
  const std::string name = is_automatic ? "h264" : FamilyName(codec);
  std::vector<std::string> wanted;
  for (const Family& family : Families()) {
    if (family.name == name) {
      wanted = family.encoders;
    }
  }
  if (wanted.empty()) {
    wanted = {name};
  }
  if (is_automatic) {
    wanted.insert(wanted.end(), {"mpeg4", "libxvid"});
  }
  for (const std::string& encoder : wanted) {
    if (!is_there(encoder)) {
      continue;
    }
    EncoderChoice choice{encoder, ""};
    if (encoder != wanted.front()) {
      choice.warning = fmt::format(
          "this libavcodec has no encoder '{}'; '{}' is used instead (its quality may differ)",
          wanted.front(), encoder);
    }
    return choice;
  }
  return Fail(ErrorCode::kNotFound,
              "this libavcodec has no encoder for '{}' (looked for: {}); choose another --codec: "
              "h264, hevc, vp9, av1, mpeg4, mjpeg, ffv1, prores or an encoder's name",
              is_automatic ? "h264" : codec, fmt::join(wanted, ", "));
}

Result<EncoderSettings> SettingsFor(const std::string& encoder, std::optional<double> crf,
                                    const std::string& preset, int num_threads) {
  if (crf && !(*crf >= 0.0 && *crf <= 63.0)) {
    return Fail(ErrorCode::kInvalidArgument,
                "a crf of {} is not possible; it goes from 0 (best) to 51, 63 for VP9 and AV1",
                *crf);
  }
  const auto named = std::find(kPresets.begin(), kPresets.end(), preset);
  const bool is_named = preset.empty() || named != kPresets.end();
  const std::size_t speed = preset.empty() || named == kPresets.end()
                                ? kMedium
                                : static_cast<std::size_t>(named - kPresets.begin());
  const bool is_number = !preset.empty() && std::all_of(preset.begin(), preset.end(), [](char c) {
    return c >= '0' && c <= '9';
  });

  EncoderSettings settings;
  const auto set = [&settings](const char* key, std::string value) {
    settings.options.emplace_back(key, std::move(value));
  };
  const auto set_speed = [&](const char* key, int fastest, int slowest) {
    set(key, is_number ? preset : std::to_string(OnScale(speed, fastest, slowest)));
  };

  if (encoder == "libx264" || encoder == "libx264rgb" || encoder == "libx265") {
    if (!is_named) {
      return Fail(ErrorCode::kInvalidArgument, "'{}' is not a preset of {}; its presets are {}",
                  preset, encoder, fmt::join(kPresets, ", "));
    }
    set("preset", std::string(kPresets[speed]));
    set("crf", NumberText(crf.value_or(encoder == "libx265" ? 20.0 : 18.0)));
    return settings;
  }
  if (!is_named && !is_number) {
    return Fail(ErrorCode::kInvalidArgument,
                "'{}' is not a preset; use one of {}, or for {} a number", preset,
                fmt::join(kPresets, ", "), encoder);
  }
  if (encoder == "libvpx-vp9" || encoder == "libvpx") {
    set("crf", NumberText(crf.value_or(24.0)));
    set("b", "0");  // constant quality
    set("deadline", "good");
    set_speed("cpu-used", 5, 0);
    if (encoder == "libvpx-vp9") {
      set("row-mt", "1");
    }
  } else if (encoder == "libaom-av1") {
    set("crf", NumberText(std::round(crf.value_or(24.0))));
    set("b", "0");
    set_speed("cpu-used", 8, 2);
    set("row-mt", "1");
  } else if (encoder == "libsvtav1") {
    set("crf", NumberText(std::round(crf.value_or(24.0))));
    set_speed("preset", 12, 4);
    if (num_threads > 0) {
      set("svtav1-params", fmt::format("lp={}", num_threads));
    }
  } else if (encoder == "librav1e") {
    // Its quantiser goes to 255 where the others' goes to 63.
    set("qp", std::to_string(std::lround(crf.value_or(24.0) * 255.0 / 63.0)));
    set_speed("speed", 10, 2);
  } else if (encoder == "libopenh264" || encoder == "libkvazaar") {
    // No constant quality: 0.2 bits per pixel at crf 18, halved every 6 steps.
    constexpr double kBitsPerPixel = 0.2;
    settings.bits_per_pixel = kBitsPerPixel * std::exp2((18.0 - crf.value_or(18.0)) / 6.0);
  } else if (encoder == "mpeg4" || encoder == "libxvid" || encoder == "mjpeg") {
    settings.quantiser = QuantiserOf(crf.value_or(18.0));
  } else if (crf) {
    // ffv1 has no quality to choose; for the rest this is libav's common scale.
    if (encoder != "ffv1") {
      settings.quantiser = QuantiserOf(*crf);
    }
  }
  return settings;
}

}  // namespace rsstab::media
