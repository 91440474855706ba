// SPDX-License-Identifier: Apache-2.0
#include "plugin/frei0r/parameters.h"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace rsstab::frei0r {
namespace {

// What the number 1 stands for.
constexpr double kMaxSmoothness_s = 10.0;
constexpr double kMaxLookahead = 100.0;
// Smallest kept share that the crop option takes.
constexpr double kMinCrop = 0.1;

// Three decimals, so that 0.3, which is not a binary fraction, comes out as 30 and not 29.999.
// Whatever the locale that the host has set.
std::string Text(double value) {
  std::array<char, 32> text{};
  const auto end =
      std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::fixed, 3);
  return {text.data(), end.ptr};
}

}  // namespace

const std::array<ParameterDescription, kNumParameters>& Parameters() {
  static constexpr std::array<ParameterDescription, kNumParameters> kParameters = {{
      {"Analysis file", true,
       "File that `rs-stabilize analyze` wrote for this clip. Empty: the environment variable "
       "RSSTAB_ANALYSIS, and without that live mode. Characters that the host cannot carry may be "
       "written as %3A and the like"},
      {"Rolling shutter", true,
       "Live mode: what tells the motion inside a frame, as the program's --rs (auto, off, "
       "diffusion, ...)"},
      {"Smoothness", false,
       "Live mode: shake quicker than ten times this many seconds is taken out; 0.1 = 1 s, 0 = "
       "rolling shutter only"},
      {"Crop", false, "Live mode: smallest share of width and height that may be kept, from 0.1"},
      {"Zoom", false,
       "Live mode: 0 zooms as much as each moment needs, more is a constant zoom: 0.15 = 15 %"},
      {"Look-ahead", false,
       "Live mode: frames to look ahead, and so to come late, times 100; 0.3 = 30 frames, 0 = no "
       "delay"},
  }};
  return kParameters;
}

std::array<double, kNumParameters> ParameterValues::DefaultNumbers() {
  std::array<double, kNumParameters> numbers{};
  numbers[kSmoothness] = 0.1;
  numbers[kCrop] = 0.8;
  return numbers;
}

bool ParameterValues::SetText(int index, const char* text) {
  const std::string value = text == nullptr ? "" : text;
  std::string& target = index == kAnalysisFile ? analysis_file : rolling_shutter;
  // Hosts that pass parameters by position leave one out by passing nothing.
  const std::string& wanted = index == kRollingShutter && value.empty() ? "auto" : value;
  if (target == wanted) {
    return false;
  }
  target = wanted;
  return true;
}

bool ParameterValues::SetNumber(int index, double number) {
  double& target = numbers.at(static_cast<std::size_t>(index));
  const double value = std::isnan(number) ? DefaultNumbers().at(static_cast<std::size_t>(index))
                                          : std::clamp(number, 0.0, 1.0);
  const bool changed = value != target;
  target = value;
  return changed;
}

std::string ParameterValues::SmoothnessOption() const {
  return Text(kMaxSmoothness_s * numbers[kSmoothness]);
}

std::string ParameterValues::CropOption() const { return Text(std::max(kMinCrop, numbers[kCrop])); }

std::string ParameterValues::ZoomOption() const {
  return numbers[kZoom] == 0.0 ? "adaptive" : Text(1.0 + numbers[kZoom]);
}

std::string ParameterValues::LookaheadOption() const {
  return std::to_string(std::lround(kMaxLookahead * numbers[kLookahead]));
}

}  // namespace rsstab::frei0r
