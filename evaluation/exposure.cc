// SPDX-License-Identifier: Apache-2.0
#include "evaluation/exposure.h"

#include <array>
#include <utility>

namespace rsstab::evaluation {

Result<ExposedPair> Expose(const FrameView& photo, const Camera& camera, const ReadoutCurve& curve,
                           const ExposureOptions& options) {
  const std::array<RowOrientation, 2> exposures = {
      [&](int row) { return curve.RowRotation(camera, row); },
      [](int) { return Eigen::Quaterniond::Identity(); }};
  const auto scene = PhotoScene::Create(photo, camera, exposures);
  if (!scene) {
    return Propagate(scene.error());
  }
  auto rs = scene->Record(exposures[0], options);
  auto gs = scene->Record(exposures[1], {0.0, 0});
  if (!rs || !gs) {
    return Propagate(rs ? gs.error() : rs.error());
  }
  return ExposedPair{std::move(*rs), std::move(*gs), scene->photo_per_pixel()};
}

}  // namespace rsstab::evaluation
