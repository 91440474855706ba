// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/pipeline/rectified_tracks.h"

#include <Eigen/Geometry>

#include "stabilizer/normalized_coordinates.h"

namespace rsstab::pipeline {
namespace {

// Steps of the fixed point that takes a recorded pixel to the corrected picture: x + G(x) = y.
constexpr int kRectifySteps = 3;

// Recorded pixel (size of the tracks) -> rectified, normalised. Empty where the lens has no ray.
std::optional<Eigen::Vector2d> Rectify(const Eigen::Vector2f& pixel, const PointTracks& tracks,
                                       const MotionField& field,
                                       const std::optional<Camera>& camera,
                                       const ClipGeometry& clip) {
  const bool lens = camera && camera->model != LensModel::kPinhole;
  if (field.columns() == 0 && !lens) {
    return stabilizer::ToNormalized(pixel.cast<double>(), tracks.width, tracks.height);
  }
  // The proxy may round its height: scale each axis to the full picture.
  const Eigen::Vector2d recorded((pixel.x() + 0.5) * clip.width / tracks.width - 0.5,
                                 (pixel.y() + 0.5) * clip.height / tracks.height - 0.5);
  Eigen::Vector2d p = recorded;
  if (field.columns() != 0) {
    for (int i = 0; i < kRectifySteps; ++i) {
      p = recorded - field.Sample(p);
    }
  }
  if (lens) {
    const auto ray = camera->UnprojectPixel(p);
    if (!ray) {
      return std::nullopt;
    }
    const Eigen::Vector3d ideal = camera->K() * *ray;
    p = ideal.hnormalized();
  }
  return stabilizer::ToNormalized(p, clip.width, clip.height);
}

}  // namespace

std::vector<stabilizer::RectifiedMatch> RectifyTracks(const PointTracks& tracks,
                                                      const MotionField& from_field,
                                                      const MotionField& to_field,
                                                      const std::optional<Camera>& camera,
                                                      const ClipGeometry& clip) {
  std::vector<stabilizer::RectifiedMatch> matches;
  matches.reserve(tracks.matches.size());
  for (const PointMatch& m : tracks.matches) {
    const auto from = Rectify(m.from, tracks, from_field, camera, clip);
    const auto to = Rectify(m.to, tracks, to_field, camera, clip);
    if (from && to) {
      matches.push_back({*from, *to});
    }
  }
  return matches;
}

}  // namespace rsstab::pipeline
