// SPDX-License-Identifier: Apache-2.0
#include "igf/camera_profile_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <random>
#include <string>

#include "tests/support/test_paths.h"

namespace rsstab::igf {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::string ErrorOf(const Result<CameraProfile>& profile) {
  EXPECT_FALSE(profile.has_value());
  return profile ? std::string() : profile.error().message;
}

TEST(CameraProfileReader, ReadsEveryKey) {
  const auto profile = ParseCameraJson(
      R"({"width": 1280, "height": 720, "fx": 900.5, "fy": 901, "cx": 640, "cy": 359,
          "readout_s": -0.018, "model": "fisheye", "distortion": [0.1, 0.02, 0.003, 0.0004]})");
  ASSERT_TRUE(profile.has_value()) << profile.error().message;
  const Camera& camera = profile->camera;
  EXPECT_TRUE(profile->focal_is_known);
  EXPECT_EQ(camera.width, 1280);
  EXPECT_EQ(camera.height, 720);
  EXPECT_EQ(camera.fx, 900.5);
  EXPECT_EQ(camera.fy, 901);
  EXPECT_EQ(camera.cx, 640);
  EXPECT_EQ(camera.cy, 359);
  EXPECT_EQ(camera.readout_s, -0.018);
  EXPECT_EQ(camera.model, LensModel::kFisheye);
  EXPECT_THAT(camera.distortion, ElementsAre(0.1, 0.02, 0.003, 0.0004));
}

TEST(CameraProfileReader, EveryKeyButTheSizeIsOptional) {
  const auto bare = ParseCameraJson(R"({"width": 1000, "height": 500})");
  ASSERT_TRUE(bare.has_value()) << bare.error().message;
  EXPECT_FALSE(bare->focal_is_known);
  EXPECT_DOUBLE_EQ(bare->camera.fx, 800.0);
  EXPECT_DOUBLE_EQ(bare->camera.fy, 800.0);
  EXPECT_DOUBLE_EQ(bare->camera.cx, 499.5);
  EXPECT_DOUBLE_EQ(bare->camera.cy, 249.5);
  EXPECT_FALSE(bare->camera.readout_s.has_value());
  EXPECT_EQ(bare->camera.model, LensModel::kPinhole);

  for (const char* key : {"fx", "fy"}) {
    const auto one = ParseCameraJson(std::string(R"({"width":1000,"height":500,")") + key +
                                     R"(":700,"cx":null})");
    ASSERT_TRUE(one.has_value()) << one.error().message;
    EXPECT_TRUE(one->focal_is_known);
    EXPECT_EQ(one->camera.fx, 700.0);
    EXPECT_EQ(one->camera.fy, 700.0);
  }
}

TEST(CameraProfileReader, NamesTheKeyThatIsWrong) {
  const std::string size = R"("width": 640, "height": 480)";
  EXPECT_THAT(ErrorOf(ParseCameraJson("")), HasSubstr("not a whole JSON object"));
  EXPECT_THAT(ErrorOf(ParseCameraJson("{" + size)), HasSubstr("not a whole JSON object"));
  EXPECT_THAT(ErrorOf(ParseCameraJson("[]")), HasSubstr("not a whole JSON object"));
  EXPECT_THAT(ErrorOf(ParseCameraJson(std::string(100000, '['))), HasSubstr("not a whole"));
  EXPECT_THAT(ErrorOf(ParseCameraJson(R"({"width": 640})")), HasSubstr("\"height\" is missing"));
  EXPECT_THAT(ErrorOf(ParseCameraJson(R"({"width": 0, "height": 1})")),
              HasSubstr("\"width\" is 0"));
  EXPECT_THAT(ErrorOf(ParseCameraJson(R"({"width": 1.5, "height": 1})")), HasSubstr("\"width\""));
  EXPECT_THAT(ErrorOf(ParseCameraJson(R"({"width": "640", "height": 1})")), HasSubstr("\"width\""));
  EXPECT_THAT(ErrorOf(ParseCameraJson(R"({"width": 1e12, "height": 1})")), HasSubstr("\"width\""));
  EXPECT_THAT(ErrorOf(ParseCameraJson("{" + size + R"(, "fx": "far"})")), HasSubstr("\"fx\""));
  EXPECT_THAT(ErrorOf(ParseCameraJson("{" + size + R"(, "fx": -3})")), HasSubstr("-3"));
  EXPECT_THAT(ErrorOf(ParseCameraJson("{" + size + R"(, "readout": 0.01})")),
              HasSubstr("unknown key \"readout\""));
  EXPECT_THAT(ErrorOf(ParseCameraJson("{" + size + R"(, "readout_s": [1]})")),
              HasSubstr("\"readout_s\""));
  EXPECT_THAT(ErrorOf(ParseCameraJson("{" + size + R"(, "model": "barrel"})")),
              HasSubstr("\"barrel\""));
  EXPECT_THAT(ErrorOf(ParseCameraJson("{" + size + R"(, "model": 3})")), HasSubstr("\"model\""));
  EXPECT_THAT(
      ErrorOf(ParseCameraJson("{" + size + R"(, "model": "brown", "distortion": [1, "x"]})")),
      HasSubstr("\"distortion\"[1]"));
  EXPECT_THAT(
      ErrorOf(ParseCameraJson("{" + size + R"(, "model": "fisheye", "distortion": [1, 2]})")),
      HasSubstr("distortion"));
}

TEST(CameraProfileReader, ReadsWhatItWrites) {
  Camera camera = Camera::Pinhole(1921, 1081, 1234.567890123456789);
  camera.cx += 1.0 / 3.0;
  camera.readout_s = 0.0191;
  camera.model = LensModel::kBrown;
  camera.distortion = {0.1, -0.01, 1e-5, 2e-5, 1.0 / 7.0};
  const rsstab::testing::TemporaryFolder folder;
  const std::string path = (folder / "camera.json").string();
  ASSERT_TRUE(WriteCameraProfile(path, camera).has_value());
  const auto back = ReadCameraProfile(path);
  ASSERT_TRUE(back.has_value()) << back.error().message;
  EXPECT_EQ(back->camera.K(), camera.K());
  EXPECT_EQ(back->camera.width, camera.width);
  EXPECT_EQ(back->camera.height, camera.height);
  EXPECT_EQ(back->camera.readout_s, camera.readout_s);
  EXPECT_EQ(back->camera.model, camera.model);
  EXPECT_EQ(back->camera.distortion, camera.distortion);

  const auto bad_place = WriteCameraProfile((folder / "absent/camera.json").string(), camera);
  ASSERT_FALSE(bad_place.has_value());
  EXPECT_EQ(bad_place.error().code, ErrorCode::kNotFound);
  camera.fx = -1.0;
  EXPECT_FALSE(WriteCameraProfile(path, camera).has_value());
  std::size_t files = 0;
  for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(folder.path())) {
    ++files;
  }
  EXPECT_EQ(files, 1U);  // no half-written leftovers
}

TEST(CameraProfileReader, WhatACalibrationDoesNotTrustIsNotKnown) {
  CalibratedCamera found;
  found.camera = Camera::Pinhole(640, 360, 480.0);
  found.camera.readout_s = -0.015;
  found.focal_sigma_px = 4.0;
  found.readout_sigma_s = 3e-4;
  for (const bool focal_trusted : {true, false}) {
    for (const bool readout_trusted : {true, false}) {
      found.focal_trusted = focal_trusted;
      found.readout_trusted = readout_trusted;
      const std::string text = FormatCameraJson(found);
      const bool both = focal_trusted && readout_trusted;
      EXPECT_THAT(text, HasSubstr(both ? "\"trusted\": true" : "\"trusted\": false"));
      const auto profile = ParseCameraJson(text);
      ASSERT_TRUE(profile.has_value()) << profile.error().message;
      EXPECT_EQ(profile->focal_is_known, focal_trusted);
      EXPECT_EQ(profile->camera.fx, focal_trusted ? 480.0 : kFocalPrior * 640.0);
      EXPECT_EQ(profile->camera.readout_s, readout_trusted ? std::optional(-0.015) : std::nullopt);
      EXPECT_EQ(profile->focal_sigma_px, 4.0);
      EXPECT_EQ(profile->readout_sigma_s, 3e-4);
      const auto larger = ProfileForVideo(*profile, 1280, 720);
      ASSERT_TRUE(larger.has_value());
      EXPECT_EQ(larger->focal_sigma_px, 8.0);
      EXPECT_EQ(larger->focal_is_known, focal_trusted);
    }
  }
  const std::string camera = R"({"width": 640, "height": 360, "fx": 480, "readout_s": 0.02)";
  const auto untrusted = ParseCameraJson(camera + R"(, "trusted": false})");
  ASSERT_TRUE(untrusted.has_value());
  EXPECT_FALSE(untrusted->focal_is_known);
  EXPECT_FALSE(untrusted->camera.readout_s);
  EXPECT_THAT(ErrorOf(ParseCameraJson(camera + R"(, "trusted": "no"})")), HasSubstr("\"trusted\""));
  EXPECT_THAT(ErrorOf(ParseCameraJson(camera + R"(, "focal_sigma_px": -1})")),
              HasSubstr("\"focal_sigma_px\""));
}

constexpr char kLens[] = R"({
  "name": "Action camera", "calib_dimension": {"w": 4000, "h": 3000},
  "orig_dimension": {"w": 4000, "h": 3000}, "input_horizontal_stretch": 1.0,
  "input_vertical_stretch": 1.0, "frame_readout_time": 15.5, "num_images": 8, "fps": 59.94,
  "distortion_model": "opencv_fisheye", "digital_lens": null,
  "fisheye_params": {"RMS_error": 2.6,
    "camera_matrix": [[1752.9, 0.0, 2000.0], [0.0, 1753.2, 1500.0], [0.0, 0.0, 1.0]],
    "distortion_coeffs": [0.067292, -0.052752, 0.121414, -0.077412]}})";

std::string LensWith(const std::string& from, const std::string& to) {
  std::string text = kLens;
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

TEST(CameraProfileReader, ReadsALensProfile) {
  const auto profile = ParseLensProfile(kLens);
  ASSERT_TRUE(profile.has_value()) << profile.error().message;
  const Camera& camera = profile->camera;
  EXPECT_EQ(camera.width, 4000);
  EXPECT_EQ(camera.height, 3000);
  EXPECT_EQ(camera.fx, 1752.9);
  EXPECT_EQ(camera.fy, 1753.2);
  EXPECT_EQ(camera.cx, 2000.0);
  EXPECT_EQ(camera.cy, 1500.0);
  EXPECT_EQ(camera.model, LensModel::kFisheye);
  EXPECT_THAT(camera.distortion, ElementsAre(0.067292, -0.052752, 0.121414, -0.077412));
  EXPECT_NEAR(camera.readout_s.value(), 0.0155, 1e-12);
}

TEST(CameraProfileReader, LensProfileVariants) {
  const auto readout = [](const std::string& text) {
    const auto profile = ParseLensProfile(text);
    EXPECT_TRUE(profile.has_value()) << (profile ? "" : profile.error().message);
    return profile ? profile->camera.readout_s : std::nullopt;
  };
  const std::string time = "\"frame_readout_time\": 15.5";
  EXPECT_NEAR(
      readout(LensWith(time, time + R"(, "frame_readout_direction": "BottomToTop")")).value(),
      -0.0155, 1e-12);
  EXPECT_NEAR(readout(LensWith(time, time + R"(, "frame_readout_direction": 1)")).value(), -0.0155,
              1e-12);
  EXPECT_FALSE(readout(LensWith(time, time + R"(, "frame_readout_direction": "LeftToRight")")));
  EXPECT_FALSE(readout(LensWith("15.5", "null")));
  EXPECT_EQ(readout(LensWith(time, R"("global_shutter": true)")), 0.0);

  const auto brown = ParseLensProfile(LensWith("opencv_fisheye", "opencv_standard"));
  ASSERT_TRUE(brown.has_value());
  EXPECT_EQ(brown->camera.model, LensModel::kBrown);
  const auto padded = ParseLensProfile(LensWith("-0.077412]", "-0.077412, 0, 0.0, 0, 0, 0, 0, 0]"));
  ASSERT_TRUE(padded.has_value());
  EXPECT_EQ(padded->camera.distortion.size(), 4U);
  EXPECT_TRUE(ParseLensProfile(LensWith("\"distortion_model\": \"opencv_fisheye\",", "")));
}

TEST(CameraProfileReader, LensProfileNamesTheKeyThatIsWrong) {
  EXPECT_THAT(ErrorOf(ParseLensProfile("{}")), HasSubstr("\"fisheye_params\" is missing"));
  EXPECT_THAT(ErrorOf(ParseLensProfile(R"({"fisheye_params": 1})")), HasSubstr("fisheye_params"));
  EXPECT_THAT(ErrorOf(ParseLensProfile(LensWith("calib_dimension", "calib"))),
              HasSubstr("\"calib_dimension\""));
  EXPECT_THAT(ErrorOf(ParseLensProfile(LensWith("\"w\": 4000", "\"w\": -1"))),
              HasSubstr("\"calib_dimension\": \"w\""));
  EXPECT_THAT(ErrorOf(ParseLensProfile(LensWith("[0.0, 0.0, 1.0]", "[0.0]"))),
              HasSubstr("camera_matrix"));
  EXPECT_THAT(ErrorOf(ParseLensProfile(LensWith("1752.9", "-1752.9"))), HasSubstr("-1752.9"));
  EXPECT_THAT(ErrorOf(ParseLensProfile(LensWith("0.067292", "true"))),
              HasSubstr("\"distortion_coeffs\"[0]"));
  EXPECT_THAT(ErrorOf(ParseLensProfile(LensWith("-0.077412]", "-0.077412, 1]"))),
              HasSubstr("5 coefficients"));
  EXPECT_THAT(ErrorOf(ParseLensProfile(LensWith("opencv_fisheye", "poly5"))),
              HasSubstr("\"poly5\""));
  EXPECT_THAT(ErrorOf(ParseLensProfile(
                  LensWith("\"digital_lens\": null", "\"digital_lens\": \"gopro_superview\""))),
              HasSubstr("gopro_superview"));
  EXPECT_THAT(ErrorOf(ParseLensProfile(LensWith("\"input_horizontal_stretch\": 1.0",
                                                "\"input_horizontal_stretch\": 1.33"))),
              HasSubstr("input_horizontal_stretch"));
}

TEST(CameraProfileReader, RescalesToAVideoOfTheSameShapeOnly) {
  const auto profile = ParseLensProfile(kLens);
  ASSERT_TRUE(profile.has_value());
  const auto half = ProfileForVideo(*profile, 2000, 1500);
  ASSERT_TRUE(half.has_value());
  EXPECT_DOUBLE_EQ(half->camera.fx, 1752.9 / 2.0);
  EXPECT_DOUBLE_EQ(half->camera.cx, 2000.5 / 2.0 - 0.5);
  EXPECT_EQ(half->camera.readout_s, profile->camera.readout_s);
  EXPECT_TRUE(ProfileForVideo(*profile, 2704, 2028).has_value());  // as the camera rounds it

  for (const auto& [width, height] : {std::pair{1920, 1080}, std::pair{1500, 2000}}) {
    const auto other = ProfileForVideo(*profile, width, height);
    ASSERT_FALSE(other.has_value());
    EXPECT_EQ(other.error().code, ErrorCode::kInvalidArgument);
    EXPECT_THAT(other.error().message, HasSubstr("4000x3000"));
  }
  EXPECT_FALSE(ProfileForVideo(*profile, 0, 10).has_value());
}

TEST(CameraProfileReader, TellsTheTwoFormatsApart) {
  const rsstab::testing::TemporaryFolder folder;
  const std::string path = (folder / "lens.json").string();
  std::ofstream(path) << kLens;
  const auto profile = ReadCameraProfile(path);
  ASSERT_TRUE(profile.has_value()) << profile.error().message;
  EXPECT_EQ(profile->camera.width, 4000);
  std::ofstream(path) << R"({"width": 64})";
  EXPECT_THAT(ErrorOf(ReadCameraProfile(path)), HasSubstr(path + ": \"height\" is missing"));
  EXPECT_EQ(ReadCameraProfile((folder / "absent").string()).error().code, ErrorCode::kNotFound);
}

TEST(CameraProfileReaderDamage, RandomBytesNeverCrash) {
  std::mt19937 random(17);
  const std::string text = kLens;
  for (int round = 0; round < 3000; ++round) {
    std::string damaged = round % 2 == 0 ? text : text.substr(0, random() % text.size());
    for (unsigned i = 0; i < random() % 6 && !damaged.empty(); ++i) {
      damaged[random() % damaged.size()] = static_cast<char>(random() % 128);
    }
    const auto profile = ParseLensProfile(damaged);
    EXPECT_TRUE(profile.has_value() ? profile->camera.Validate().has_value()
                                    : !profile.error().message.empty());
    const auto camera = ParseCameraJson(damaged);
    EXPECT_TRUE(camera.has_value() || !camera.error().message.empty());
  }
}

TEST(CameraProfileReaderRealFiles, CalibrationInAProjectFile) {
  const auto path = rsstab::testing::DevelopmentData("gyro/GX016015.MP4.gyroflow");
  if (!path) {
    GTEST_SKIP() << "development data gyro/GX016015.MP4.gyroflow is not there";
  }
  const auto profile = ReadCameraProfile(path->string());
  ASSERT_TRUE(profile.has_value()) << profile.error().message;
  EXPECT_NEAR(profile->camera.fx, 1752.954, 1e-3);
  EXPECT_NEAR(profile->camera.fy, 1753.195, 1e-3);
  EXPECT_NEAR(profile->camera.distortion.at(3), -0.077412, 1e-6);
  EXPECT_TRUE(ProfileForVideo(*profile, 2704, 2028).has_value());
}

}  // namespace
}  // namespace rsstab::igf
