// SPDX-License-Identifier: Apache-2.0
#include "plugin/frei0r/parameters.h"

#include <gtest/gtest.h>

#include <clocale>
#include <cmath>
#include <memory>

#include "plugin/capi/rsstab.h"

namespace rsstab::frei0r {
namespace {

TEST(Parameters, DefaultsAreTheProgramsButTheLookahead) {
  const ParameterValues values;
  EXPECT_EQ(values.SmoothnessOption(), "1.000");
  EXPECT_EQ(values.CropOption(), "0.800");
  EXPECT_EQ(values.ZoomOption(), "adaptive");
  EXPECT_EQ(values.LookaheadOption(), "0");
  EXPECT_EQ(values.rolling_shutter, "auto");
}

TEST(Parameters, NumbersStandForOptions) {
  ParameterValues values;
  EXPECT_TRUE(values.SetNumber(kSmoothness, 0.25));
  EXPECT_TRUE(values.SetNumber(kCrop, 0.9));
  EXPECT_TRUE(values.SetNumber(kZoom, 0.15));
  EXPECT_TRUE(values.SetNumber(kLookahead, 0.29));  // 28.999999999999996 in binary
  EXPECT_EQ(values.SmoothnessOption(), "2.500");
  EXPECT_EQ(values.CropOption(), "0.900");
  EXPECT_EQ(values.ZoomOption(), "1.150");
  EXPECT_EQ(values.LookaheadOption(), "29");
  EXPECT_FALSE(values.SetNumber(kZoom, 0.15));
}

TEST(Parameters, EveryNumberIsAnOptionTheInterfaceTakes) {
  const std::unique_ptr<rsstab_options, void (*)(rsstab_options*)> options(rsstab_options_create(),
                                                                           &rsstab_options_destroy);
  for (const double number : {-3.0, 0.0, 1e-9, 0.05, 0.5, 0.999, 1.0, 7.0, std::nan("")}) {
    ParameterValues values;
    for (const int index : {kSmoothness, kCrop, kZoom, kLookahead}) {
      values.SetNumber(index, number);
    }
    const auto set = [&](const char* name, const std::string& value) {
      EXPECT_EQ(rsstab_options_set(options.get(), name, value.c_str()), RSSTAB_OK)
          << rsstab_options_error(options.get());
    };
    set("smoothness", values.SmoothnessOption());
    set("crop", values.CropOption());
    set("zoom", values.ZoomOption());
    set("lookahead", values.LookaheadOption());
  }
}

TEST(Parameters, NaNIsTheDefault) {
  ParameterValues values;
  values.SetNumber(kCrop, 0.5);
  values.SetNumber(kCrop, std::nan(""));
  EXPECT_EQ(values.CropOption(), "0.800");
}

TEST(Parameters, ADecimalCommaOfTheHostDoesNotMatter) {
  if (std::setlocale(LC_NUMERIC, "de_DE.UTF-8") == nullptr) {
    GTEST_SKIP() << "the locale de_DE.UTF-8 is not installed";
  }
  const std::string text = ParameterValues().SmoothnessOption();
  std::setlocale(LC_NUMERIC, "C");
  EXPECT_EQ(text, "1.000");
}

TEST(Parameters, TextLeftOutIsTheDefault) {
  ParameterValues values;
  EXPECT_TRUE(values.SetText(kRollingShutter, "off"));
  EXPECT_TRUE(values.SetText(kRollingShutter, ""));
  EXPECT_EQ(values.rolling_shutter, "auto");
  EXPECT_TRUE(values.SetText(kAnalysisFile, "a"));
  EXPECT_TRUE(values.SetText(kAnalysisFile, nullptr));
  EXPECT_EQ(values.analysis_file, "");
}

}  // namespace
}  // namespace rsstab::frei0r
