// SPDX-License-Identifier: Apache-2.0
#include "cli/report/difference_map.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "cli/report/preview.h"
#include "igf/base/rotation.h"
#include "tests/stabilizer/metrics/textured_picture.h"

namespace rsstab::report {
namespace {

using rsstab::testing::kPictureHeight;
using rsstab::testing::kPictureWidth;
using rsstab::testing::Look;
using rsstab::testing::MakeScene;
using rsstab::testing::ViewOf;

constexpr double kFocal = 700.0;

Frame AsRgb(const cv::Mat& gray) { return MakePreview(ViewOf(gray), gray.cols).value(); }

// Mean brightness of a map without its outermost pixels, 0 to 255.
double Brightness(const Frame& map, int margin = 40) {
  double sum = 0.0;
  int count = 0;
  for (int y = margin; y < map.height - margin; ++y) {
    const std::uint8_t* row = map.planes[0].data + y * map.planes[0].stride;
    for (int x = 3 * margin; x < 3 * (map.width - margin); ++x, ++count) {
      sum += row[x];
    }
  }
  return sum / count;
}

TEST(DifferenceMap, IsDarkWherePicturesAgree) {
  const Frame truth = AsRgb(Look(MakeScene(), Eigen::Matrix3d::Identity()));
  EXPECT_LT(Brightness(*DifferenceMap(truth.View(), truth.View())), 5.0);
}

TEST(DifferenceMap, GrowsWithTheMisalignment) {
  const cv::Mat scene = MakeScene();
  const Frame truth = AsRgb(Look(scene, Eigen::Matrix3d::Identity()));
  double last = Brightness(*DifferenceMap(truth.View(), truth.View()));
  for (const double shift : {0.5, 1.5, 4.0}) {
    Eigen::Matrix3d moved = Eigen::Matrix3d::Identity();
    moved(0, 2) = shift;
    const double now = Brightness(*DifferenceMap(AsRgb(Look(scene, moved)).View(), truth.View()));
    EXPECT_GT(now, last + 5.0) << shift;
    last = now;
  }
}

TEST(DifferenceMap, MarksWhatIsNotCompared) {
  const Frame truth = AsRgb(Look(MakeScene(), Eigen::Matrix3d::Identity()));
  std::vector<std::uint8_t> valid(static_cast<std::size_t>(truth.width * truth.height), 1);
  valid[5] = 0;
  const auto map = DifferenceMap(truth.View(), truth.View(), valid);
  ASSERT_TRUE(map);
  EXPECT_EQ(map->planes[0].data[15], 120);
  EXPECT_LT(map->planes[0].data[18], 5);
  valid.pop_back();
  EXPECT_FALSE(DifferenceMap(truth.View(), truth.View(), valid));
}

TEST(AlignedDifferenceMap, ForgivesTurnAndZoomButNotSkew) {
  const Camera camera = Camera::Pinhole(kPictureWidth, kPictureHeight, kFocal);
  const Eigen::Matrix3d k = camera.K();
  const cv::Mat scene = MakeScene();
  const Frame truth = AsRgb(Look(scene, Eigen::Matrix3d::Identity()));
  const Eigen::Vector3d zoom(0.9, 0.9, 1.0);
  const Eigen::Matrix3d turned =
      k * ExpSo3<double>(Eigen::Vector3d(0.01, 0.03, 0.02)).toRotationMatrix() * zoom.asDiagonal() *
      k.inverse();
  const auto steady = AlignedDifferenceMap(AsRgb(Look(scene, turned)).View(), truth.View(), camera);
  ASSERT_TRUE(steady) << steady.error().message;
  ASSERT_TRUE(*steady);
  Eigen::Matrix3d shear = Eigen::Matrix3d::Identity();
  shear(0, 1) = 0.02;
  const auto skewed =
      AlignedDifferenceMap(AsRgb(Look(scene, turned * shear)).View(), truth.View(), camera);
  ASSERT_TRUE(skewed && *skewed);
  // Resampling leaves a little; turning the other way would leave everything.
  EXPECT_LT(Brightness(**steady), 12.0);
  EXPECT_GT(Brightness(**skewed), 2.5 * Brightness(**steady));
}

TEST(AlignedDifferenceMap, IsEmptyWhereNothingMatches) {
  const Frame truth = AsRgb(Look(MakeScene(), Eigen::Matrix3d::Identity()));
  const Frame flat = AsRgb(cv::Mat(kPictureHeight, kPictureWidth, CV_8U, cv::Scalar(90)));
  const auto map = AlignedDifferenceMap(flat.View(), truth.View(),
                                        Camera::Pinhole(kPictureWidth, kPictureHeight, kFocal));
  ASSERT_TRUE(map);
  EXPECT_FALSE(*map);
}

}  // namespace
}  // namespace rsstab::report
