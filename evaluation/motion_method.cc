// SPDX-License-Identifier: Apache-2.0
#include "evaluation/motion_method.h"

#include <optional>

namespace rsstab::evaluation {

Result<MethodAnswer> NoCorrection::Estimate(const MethodInput& input) {
  return MethodAnswer{MotionField(input.rs.width, input.rs.height, 2, 2), {}};
}

Result<MethodAnswer> SingleImageMethod::Estimate(const MethodInput& input) {
  rsdiff::SamplingOptions sampling = sampling_;
  sampling.seed = input.seed;
  std::optional<double> focal_px;
  if (know_focal_ && input.camera != nullptr) {
    focal_px = input.camera->fx;
  }
  auto motion = estimator_->Estimate(input.rs, sampling, focal_px);
  if (!motion) {
    return Propagate(motion.error());
  }
  return MethodAnswer{std::move(motion->field), std::move(motion->curves)};
}

}  // namespace rsstab::evaluation
