// SPDX-License-Identifier: Apache-2.0
#include "evaluation/exposure.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "evaluation/photo.h"
#include "tests/evaluation/test_photos.h"

namespace rsstab::evaluation {
namespace {

using rsstab::testing::LevelAt;
using rsstab::testing::MakePhoto;
using rsstab::testing::Waves;

constexpr ExposureOptions kWithoutNoise{0.0, 1};

Camera TestCamera() { return Camera::Pinhole(320, 240, 300.0); }

ReadoutCurve TestMotion() {
  ReadoutCurve curve;
  curve.steady = {0.05, -0.02, 0.04};
  curve.acceleration = {0.02, 0.03, 0.0};
  curve.tones[1] = {0.008, 1.5, 0.4};
  return curve;
}

double Bilinear(const Frame& picture, double x, double y) {
  const int x0 = std::clamp(static_cast<int>(x), 0, picture.width - 2);
  const int y0 = std::clamp(static_cast<int>(y), 0, picture.height - 2);
  const double fx = x - x0;
  const double fy = y - y0;
  return (1 - fy) * ((1 - fx) * LevelAt(picture, x0, y0) + fx * LevelAt(picture, x0 + 1, y0)) +
         fy * ((1 - fx) * LevelAt(picture, x0, y0 + 1) + fx * LevelAt(picture, x0 + 1, y0 + 1));
}

TEST(Exposure, PicturesAreRelatedByTheTruthField) {
  // 8-bit rounding and the bilinear lookup of a smooth photo.
  constexpr double kMeanLevels = 1.0;
  const Frame photo = MakePhoto(400, 300, [](int x, int y) { return Waves(0.5 * x, 0.5 * y); });
  for (const bool top_to_bottom : {true, false}) {
    ReadoutCurve curve = TestMotion();
    curve.top_to_bottom = top_to_bottom;
    const auto pair = Expose(photo.View(), TestCamera(), curve, kWithoutNoise);
    ASSERT_TRUE(pair) << pair.error().message;
    const MotionField truth = TruthField(curve, TestCamera()).value();
    double with_truth = 0.0;
    double without = 0.0;
    double reversed = 0.0;
    int count = 0;
    for (int y = 15; y < 225; y += 3) {
      for (int x = 20; x < 300; x += 3, ++count) {
        const Eigen::Vector2d g = truth.Sample(Eigen::Vector2d(x, y));
        const double gs = LevelAt(pair->gs, x, y);
        with_truth += std::abs(Bilinear(pair->rs, x + g.x(), y + g.y()) - gs);
        without += std::abs(LevelAt(pair->rs, x, y) - gs);
        reversed += std::abs(Bilinear(pair->rs, x - g.x(), y - g.y()) - gs);
      }
    }
    EXPECT_LT(with_truth / count, kMeanLevels);
    EXPECT_GT(without / count, 5.0 * kMeanLevels);
    EXPECT_GT(reversed / count, without / count);
  }
}

TEST(Exposure, NothingIsInventedAtTheBorder) {
  constexpr int kInner = 100;
  const auto framed = [](int width, int height, int thickness) {
    return MakePhoto(width, height, [=](int x, int y) {
      const bool is_edge =
          x < thickness || y < thickness || x >= width - thickness || y >= height - thickness;
      return is_edge ? 250.0 : kInner;
    });
  };
  const auto sees_the_edge = [](const ExposedPair& pair) {
    for (const Frame* picture : {&pair.rs, &pair.gs}) {
      for (int y = 0; y < picture->height; ++y) {
        for (int x = 0; x < picture->width; ++x) {
          if (LevelAt(*picture, x, y) != kInner) {
            return true;
          }
        }
      }
    }
    return false;
  };
  struct Size {
    int width;
    int height;
  };
  for (const Size size : {Size{400, 300}, Size{300, 400}, Size{500, 200}, Size{321, 241}}) {
    // The view keeps clear of the outermost pixel, and no farther than a few pixels inside it.
    const auto clear = Expose(framed(size.width, size.height, 1).View(), TestCamera(), TestMotion(),
                              kWithoutNoise);
    const auto touching = Expose(framed(size.width, size.height, 5).View(), TestCamera(),
                                 TestMotion(), kWithoutNoise);
    ASSERT_TRUE(clear && touching);
    EXPECT_FALSE(sees_the_edge(*clear)) << size.width << "x" << size.height;
    EXPECT_TRUE(sees_the_edge(*touching)) << size.width << "x" << size.height;
  }
}

TEST(Exposure, FinePhotosAreShrunkWithoutAliasing) {
  // A checkerboard of single pixels, six of which make a picture pixel: grey when it is shrunk.
  const Frame photo =
      MakePhoto(2000, 1500, [](int x, int y) { return (x + y) % 2 == 0 ? 40.0 : 200.0; });
  const auto pair = Expose(photo.View(), TestCamera(), TestMotion(), kWithoutNoise);
  ASSERT_TRUE(pair);
  EXPECT_GT(pair->photo_per_pixel, 5.0);
  for (int y = 0; y < 240; y += 7) {
    for (int x = 0; x < 320; x += 7) {
      EXPECT_NEAR(LevelAt(pair->rs, x, y), 120, 12);
    }
  }
}

TEST(Exposure, StillFramesAreTheGlobalShutterPicture) {
  const Frame photo = MakePhoto(400, 300, [](int x, int y) { return Waves(x, y); });
  const auto pair = Expose(photo.View(), TestCamera(), ReadoutCurve(), kWithoutNoise);
  ASSERT_TRUE(pair);
  for (int y = 0; y < 240; ++y) {
    EXPECT_EQ(std::memcmp(pair->rs.planes[0].data + y * pair->rs.planes[0].stride,
                          pair->gs.planes[0].data + y * pair->gs.planes[0].stride, 3 * 320),
              0);
  }
}

TEST(Exposure, NoiseHasTheStatedSize) {
  const Frame photo = MakePhoto(400, 300, [](int, int) { return 128.0; });
  const auto pair = Expose(photo.View(), TestCamera(), TestMotion(), {2.0, 9});
  ASSERT_TRUE(pair);
  double sum = 0.0;
  double squares = 0.0;
  double neighbours = 0.0;
  int count = 0;
  for (int y = 0; y < 240; ++y) {
    for (int x = 0; x + 1 < 320; ++x, ++count) {
      const double level = LevelAt(pair->rs, x, y) - 128.0;
      sum += level;
      squares += level * level;
      neighbours += level * (LevelAt(pair->rs, x + 1, y) - 128.0);
      EXPECT_EQ(LevelAt(pair->gs, x, y), 128);
    }
  }
  EXPECT_NEAR(sum / count, 0.0, 0.04);                    // 5 standard errors
  EXPECT_NEAR(std::sqrt(squares / count), 2.0207, 0.03);  // with the rounding's 1/12
  EXPECT_NEAR(neighbours / count, 0.0, 5.0 * 4.0 / std::sqrt(count));
}

TEST(Exposure, RefusesWhatItCannotRecord) {
  const Frame photo = MakePhoto(64, 48, [](int, int) { return 100.0; });
  const Frame gray = AllocateFrame(GrayLayout(), 64, 48).value();
  const Frame tiny = MakePhoto(8, 48, [](int, int) { return 100.0; });
  EXPECT_EQ(Expose(gray.View(), TestCamera(), {}).error().code, ErrorCode::kInvalidArgument);
  EXPECT_EQ(Expose(tiny.View(), TestCamera(), {}).error().code, ErrorCode::kInvalidArgument);
  ReadoutCurve around;
  around.steady.x() = 10.0;  // looks backwards at the last row
  EXPECT_EQ(Expose(photo.View(), TestCamera(), around).error().code, ErrorCode::kInvalidArgument);
}

}  // namespace
}  // namespace rsstab::evaluation
