// SPDX-License-Identifier: Apache-2.0
#include "igf/texture_scene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "igf/base/rotation.h"
#include "igf/scene_painter.h"

namespace rsstab::igf {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;
// Focal length for which a picture 2 wall distances wide has exactly `kSide` texels, so that it is
// not resized: 1.25 texels a view pixel.
constexpr int kSide = 400;
constexpr double kFocalPx = kSide / 2.0 / 1.25;

RgbPicture GrayPicture(int width, int height, auto&& level_at) {
  RgbPicture picture{width, height, {}};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const auto level = static_cast<std::uint8_t>(std::lround(level_at(x, y)));
      picture.pixels.insert(picture.pixels.end(), 3, level);
    }
  }
  return picture;
}

float LumaAt(const TextureScene& scene, const Eigen::Vector3d& direction) {
  std::vector<float> out(1);
  scene.SampleLine(ScenePlane::kLuma, direction, Eigen::Vector3d::Zero(), out);
  return out[0];
}

TEST(TextureScene, HangsThePictureStraightAheadUprightAndUnmirrored) {
  // Brighter to the right, and much brighter downwards.
  const RgbPicture picture =
      GrayPicture(kSide, kSide, [](int x, int y) { return 20.0 + 0.1 * x + 0.4 * y; });
  const auto scene = TextureScene::FromPicture(picture, 2.0, kFocalPx);
  ASSERT_TRUE(scene) << scene.error().message;
  EXPECT_EQ(scene->width_texels(), kSide);
  constexpr double kQuantisation = 1.0 / 255.0;  // the picture has 8 bits
  for (const double a : {-0.4, 0.0, 0.3}) {
    for (const double b : {-0.4, 0.0, 0.3}) {
      const double x = (kSide - 1) / 2.0 + kSide / 2.0 * a;
      const double y = (kSide - 1) / 2.0 + kSide / 2.0 * b;
      EXPECT_NEAR(LumaAt(*scene, {a, b, 1.0}), (20.0 + 0.1 * x + 0.4 * y) / 255.0, kQuantisation)
          << a << " " << b;
    }
  }
}

// A uniform cubic B-spline over samples of a wave is that wave times
// (2 + cos w) / 3 at the samples (w rad a texel); so the value is known between texels, too.
TEST(TextureScene, IsTheSplineOfItsTexels) {
  constexpr double kPeriodTexels = 12.5;
  constexpr double kAmplitude = 100.0;
  const double w = kTurn / kPeriodTexels;
  const RgbPicture picture =
      GrayPicture(kSide, kSide, [&](int x, int) { return 128.0 + kAmplitude * std::cos(w * x); });
  const auto scene = TextureScene::FromPicture(picture, 2.0, kFocalPx);
  ASSERT_TRUE(scene) << scene.error().message;
  const double gain = (2.0 + std::cos(w)) / 3.0;
  // 8-bit texels, averaged by the spline, and the spline's own deviation from the wave.
  constexpr double kTolerance = 1.0 / 255.0;
  for (double a = -0.2; a < 0.2; a += 0.00713) {
    const double x = (kSide - 1) / 2.0 + kSide / 2.0 * a;
    EXPECT_NEAR(LumaAt(*scene, {a, 0.1, 1.0}),
                (128.0 + gain * kAmplitude * std::cos(w * x)) / 255.0, kTolerance)
        << a;
  }
}

TEST(TextureScene, IsContinuousAllRoundAndBeyondThePicture) {
  const auto street = PaintStreet(512, 256, 3);
  ASSERT_TRUE(street) << street.error().message;
  for (const double width_tan : {4.0, 2.0, 1.3}) {
    const auto scene = TextureScene::FromPicture(*street, width_tan, 100.0);
    ASSERT_TRUE(scene) << scene.error().message;
    // 1e-5 rad is a few thousandths of a texel; a seam would jump by many levels.
    constexpr double kStep = 1e-5;
    constexpr double kLargestStep = 0.01;
    for (const double pitch : {-0.9, 0.0, 0.7}) {
      const auto direction = [&](double azimuth) {
        return Eigen::Vector3d(std::sin(azimuth), std::tan(pitch), std::cos(azimuth));
      };
      for (double azimuth = -kTurn; azimuth < kTurn; azimuth += 0.01) {
        EXPECT_NEAR(LumaAt(*scene, direction(azimuth)), LumaAt(*scene, direction(azimuth + kStep)),
                    kLargestStep);
      }
      // The corners of the room and the middle of the wall behind.
      for (const double azimuth : {kTurn / 8.0, kTurn * 3.0 / 8.0, kTurn / 2.0, -kTurn / 8.0}) {
        EXPECT_NEAR(LumaAt(*scene, direction(azimuth - kStep)),
                    LumaAt(*scene, direction(azimuth + kStep)), kLargestStep)
            << azimuth;
      }
    }
  }
}

TEST(TextureScene, LineAndListOfDirectionsAgree) {
  const auto street = PaintStreet(512, 256, 3);
  ASSERT_TRUE(street);
  const auto scene = TextureScene::FromPicture(*street, kPaintedWidthTan, 100.0);
  ASSERT_TRUE(scene);
  const Eigen::Vector3d first(-1.5, -0.3, 1.0);
  const Eigen::Vector3d step(0.01, 0.001, -0.002);
  std::vector<Eigen::Vector3d> directions;
  for (int i = 0; i < 300; ++i) {
    directions.push_back(first + i * step);
  }
  std::vector<float> line(300);
  std::vector<float> list(300);
  for (const ScenePlane plane : {ScenePlane::kLuma, ScenePlane::kCb, ScenePlane::kCr}) {
    scene->SampleLine(plane, first, step, line);
    scene->SampleDirections(plane, directions, list);
    EXPECT_EQ(line, list);
  }
}

TEST(TextureScene, ColourIsBt709) {
  RgbPicture red{8, 8, {}};
  for (int i = 0; i < 64; ++i) {
    red.pixels.insert(red.pixels.end(), {255, 0, 0});
  }
  const auto scene = TextureScene::FromPicture(red, 2.0, 10.0);
  ASSERT_TRUE(scene) << scene.error().message;
  constexpr double kRoundOff = 1e-5;
  const std::vector<Eigen::Vector3d> ahead = {Eigen::Vector3d::UnitZ()};
  std::vector<float> value(1);
  EXPECT_NEAR(LumaAt(*scene, ahead[0]), 0.2126, kRoundOff);
  scene->SampleDirections(ScenePlane::kCb, ahead, value);
  EXPECT_NEAR(value[0], -0.114572, kRoundOff);
  scene->SampleDirections(ScenePlane::kCr, ahead, value);
  EXPECT_NEAR(value[0], 0.5, kRoundOff);
}

TEST(TextureScene, RefusesNonsense) {
  const RgbPicture good = GrayPicture(8, 8, [](int, int) { return 9.0; });
  EXPECT_FALSE(TextureScene::FromPicture({}, 2.0, 100.0));
  EXPECT_FALSE(TextureScene::FromPicture({8, 8, {1, 2, 3}}, 2.0, 100.0));
  EXPECT_FALSE(TextureScene::FromPicture(good, 0.0, 100.0));
  EXPECT_FALSE(TextureScene::FromPicture(good, 9.0, 100.0));
  EXPECT_FALSE(TextureScene::FromPicture(good, 2.0, std::nan("")));
  EXPECT_FALSE(TextureScene::FromPicture(good, 2.0, 1e6));
  EXPECT_TRUE(TextureScene::FromPicture(good, 2.0, 100.0));
}

TEST(TextureScene, StraightUpIsSafe) {
  const RgbPicture good = GrayPicture(8, 8, [](int, int) { return 9.0; });
  const auto scene = TextureScene::FromPicture(good, 2.0, 100.0);
  ASSERT_TRUE(scene);
  EXPECT_TRUE(std::isfinite(LumaAt(*scene, {0.0, -1.0, 0.0})));
}

TEST(ScenePainter, SameSeedSamePictureOtherSeedAnother) {
  const auto a = PaintStreet(256, 128, 1);
  const auto b = PaintStreet(256, 128, 1);
  const auto c = PaintStreet(256, 128, 2);
  ASSERT_TRUE(a && b && c);
  EXPECT_EQ(a->width, 256);
  EXPECT_EQ(a->height, 128);
  EXPECT_EQ(a->pixels, b->pixels);
  EXPECT_NE(a->pixels, c->pixels);
  EXPECT_FALSE(PaintStreet(255, 100, 1));
  EXPECT_FALSE(PaintStreet(1000, 501, 1));
}

}  // namespace
}  // namespace rsstab::igf
