// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_TESTS_STABILIZER_METRICS_TEXTURED_PICTURE_H_
#define RSSTAB_TESTS_STABILIZER_METRICS_TEXTURED_PICTURE_H_

#include <Eigen/Core>
#include <Eigen/LU>
#include <functional>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "igf/base/frame.h"
#include "igf/base/homography.h"

namespace rsstab::testing {

inline constexpr int kPictureWidth = 640;
inline constexpr int kPictureHeight = 360;

// A soft random pattern with detail at two scales, larger than a picture by kSceneMargin on each
// side; band-limited, so that it can be sampled between its pixels.
inline constexpr int kSceneMargin = 120;
inline cv::Mat MakeScene() {
  const cv::Size size(kPictureWidth + 2 * kSceneMargin, kPictureHeight + 2 * kSceneMargin);
  cv::RNG random(12345);
  cv::Mat sum = cv::Mat::zeros(size, CV_32F);
  for (const double blur : {1.6, 5.0}) {
    cv::Mat layer(size, CV_32F);
    random.fill(layer, cv::RNG::NORMAL, 0.0, 1.0);
    cv::GaussianBlur(layer, layer, {}, blur);
    cv::Scalar deviation;
    cv::meanStdDev(layer, cv::noArray(), deviation);
    sum += layer / deviation[0];
  }
  cv::Mat scene;
  sum.convertTo(scene, CV_8U, 30.0, 128.0);
  return scene;
}

// The picture whose pixel p shows the scene at `source(p)`, in pixels of the scene's middle part
// (identity: the middle part itself).
inline cv::Mat LookBent(const cv::Mat& scene,
                        const std::function<Eigen::Vector2d(const Eigen::Vector2d&)>& source) {
  cv::Mat map(kPictureHeight, kPictureWidth, CV_32FC2);
  for (int y = 0; y < map.rows; ++y) {
    for (int x = 0; x < map.cols; ++x) {
      const Eigen::Vector2d at = source({x, y}) + Eigen::Vector2d::Constant(kSceneMargin);
      map.at<cv::Vec2f>(y, x) = {static_cast<float>(at.x()), static_cast<float>(at.y())};
    }
  }
  cv::Mat picture;
  cv::remap(scene, picture, map, cv::noArray(), cv::INTER_LANCZOS4, cv::BORDER_REFLECT);
  return picture;
}

inline cv::Mat Look(const cv::Mat& scene, const Eigen::Matrix3d& scene_from_picture) {
  return LookBent(scene, [&](const Eigen::Vector2d& p) { return Project(scene_from_picture, p); });
}

// A gray frame over the picture's samples, which must outlive it.
inline FrameView ViewOf(const cv::Mat& picture) {
  FrameView view;
  view.layout = GrayLayout();
  view.layout.full_range = true;
  view.width = picture.cols;
  view.height = picture.rows;
  view.planes[0] = {picture.data, static_cast<std::ptrdiff_t>(picture.step), picture.cols,
                    picture.rows};
  return view;
}

inline Eigen::Vector2d PictureCentre() {
  return {0.5 * (kPictureWidth - 1), 0.5 * (kPictureHeight - 1)};
}

// p -> centre + linear (p - centre) + shift
inline Eigen::Matrix3d AboutCentre(const Eigen::Matrix2d& linear, const Eigen::Vector2d& shift) {
  Eigen::Matrix3d matrix = Eigen::Matrix3d::Identity();
  matrix.topLeftCorner<2, 2>() = linear;
  matrix.topRightCorner<2, 1>() = PictureCentre() - linear * PictureCentre() + shift;
  return matrix;
}

}  // namespace rsstab::testing

#endif  // RSSTAB_TESTS_STABILIZER_METRICS_TEXTURED_PICTURE_H_
