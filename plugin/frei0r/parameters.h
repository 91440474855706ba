// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_PLUGIN_FREI0R_PARAMETERS_H_
#define RSSTAB_PLUGIN_FREI0R_PARAMETERS_H_

#include <array>
#include <string>

namespace rsstab::frei0r {

// Indices of the parameters: hosts pass them by position, so the order is part of the interface.
enum ParameterIndex {
  kAnalysisFile = 0,
  kRollingShutter = 1,
  kSmoothness = 2,
  kCrop = 3,
  kZoom = 4,
  kLookahead = 5,
  kNumParameters = 6,
};

struct ParameterDescription {
  const char* name;
  bool is_text;  // else a number in [0, 1]
  const char* explanation;
};
[[nodiscard]] const std::array<ParameterDescription, kNumParameters>& Parameters();

// Values as the host set them. Numbers outside [0, 1] are brought inside, NaN becomes the default.
struct ParameterValues {
  std::string analysis_file;
  std::string rolling_shutter = "auto";
  std::array<double, kNumParameters> numbers = DefaultNumbers();

  // Changes one value; true when it was another before.
  bool SetText(int index, const char* text);
  bool SetNumber(int index, double number);
  [[nodiscard]] const std::string& TextAt(int index) const {
    return index == kAnalysisFile ? analysis_file : rolling_shutter;
  }

  // The options of the C interface (and of the program) that the values stand for.
  [[nodiscard]] std::string SmoothnessOption() const;  // s
  [[nodiscard]] std::string CropOption() const;        // smallest kept share of a side
  [[nodiscard]] std::string ZoomOption() const;        // adaptive, or a factor
  [[nodiscard]] std::string LookaheadOption() const;   // frames

  static std::array<double, kNumParameters> DefaultNumbers();
};

}  // namespace rsstab::frei0r

#endif  // RSSTAB_PLUGIN_FREI0R_PARAMETERS_H_
