// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/pipeline/stabilize_options.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <set>

namespace rsstab::pipeline {
namespace {

using ::testing::HasSubstr;

const OptionSpec<StabilizeOptions>& Spec(const std::string& name) {
  for (const auto& spec : StabilizeOptionTable()) {
    if (spec.name == name) {
      return spec;
    }
  }
  throw std::logic_error("no option " + name);
}

TEST(StabilizeOptions, DefaultsObeyTheirOwnRules) { EXPECT_TRUE(Validate(StabilizeOptions())); }

TEST(StabilizeOptions, EveryOptionIsDescribedOnce) {
  std::set<std::string> names;
  for (const auto& spec : StabilizeOptionTable()) {
    EXPECT_TRUE(names.insert(spec.name).second) << spec.name;
    EXPECT_GT(spec.help.size(), 20U) << spec.name;
    EXPECT_FALSE(spec.group.empty()) << spec.name;
    EXPECT_EQ(spec.help.back(), '.') << spec.name;
  }
}

TEST(StabilizeOptions, TextSurvivesARoundTrip) {
  const std::pair<const char*, const char*> values[] = {
      {"rs", "gyro"},           {"gyro", "a b.csv"},
      {"gyro-offset", "-1.25"}, {"readout", "-16.67"},
      {"focal", "1234.5"},      {"camera", "c.json"},
      {"smoothness", "0.3"},    {"tripod", "true"},
      {"crop", "0.9"},          {"zoom", "1.25"},
      {"zoom", "fixed"},        {"zoom", "adaptive"},
      {"mesh", "8x12"},         {"interpolation", "lanczos"},
      {"threads", "3"},         {"seed", "42"},
      {"rs", "diffusion"},      {"model", "m.json"},
      {"samples", "3"},         {"steps", "5"},
      {"rs-strength", "0.5"},   {"device", "opencl"}};
  for (const auto& [name, text] : values) {
    StabilizeOptions options;
    ASSERT_TRUE(Spec(name).set(options, text)) << name;
    EXPECT_EQ(Spec(name).get(options), text) << name;
  }
}

TEST(StabilizeOptions, UnitsAreConvertedAtTheDoor) {
  StabilizeOptions options;
  ASSERT_TRUE(Spec("readout").set(options, "16"));
  EXPECT_DOUBLE_EQ(*options.readout_s, 0.016);
  ASSERT_TRUE(Spec("mesh").set(options, "4x9"));
  EXPECT_EQ(options.mesh_columns, 4);
  EXPECT_EQ(options.mesh_rows, 9);
}

TEST(StabilizeOptions, BadValuesAreRefusedWithTheRule) {
  const std::pair<const char*, const char*> values[] = {
      {"rs", "yes"},         {"gyro-offset", "nan"}, {"gyro-offset", "1,5"}, {"readout", "2000"},
      {"focal", "0"},        {"smoothness", "-1"},   {"smoothness", "inf"},  {"crop", "0"},
      {"crop", "1.01"},      {"zoom", "0.5"},        {"mesh", "16"},         {"mesh", "0x4"},
      {"mesh", "4x4x4"},     {"threads", "-1"},      {"threads", "2.5"},     {"seed", "-1"},
      {"interpolation", ""}, {"tripod", "maybe"}};
  for (const auto& [name, text] : values) {
    StabilizeOptions options;
    const Status status = Spec(name).set(options, text);
    ASSERT_FALSE(status) << name << " " << text;
    EXPECT_EQ(status.error().code, ErrorCode::kInvalidArgument);
    EXPECT_THAT(status.error().message, HasSubstr(std::string("--") + name));
    EXPECT_EQ(Spec(name).get(options), Spec(name).get(StabilizeOptions())) << name;
  }
}

TEST(StabilizeOptions, ValidateSeesStructsFilledByHand) {
  StabilizeOptions options;
  options.min_crop_ratio = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(Validate(options));
  options = {};
  options.rs = RsChoice::kOff;
  options.gyro_file = "log.csv";
  EXPECT_FALSE(Validate(options));
}

}  // namespace
}  // namespace rsstab::pipeline
