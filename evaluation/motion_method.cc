// SPDX-License-Identifier: Apache-2.0
#include "evaluation/motion_method.h"

#include <cmath>
#include <optional>
#include <utility>

#include "evaluation/field_reference.h"
#include "igf/base/readout_motion.h"

namespace rsstab::evaluation {

Result<MethodAnswer> EstimateOrDecline(MotionMethod& method, const MethodInput& input,
                                       bool& declined) {
  auto answer = method.Estimate(input);
  declined = !answer && answer.error().code == ErrorCode::kUntrustworthy;
  return declined ? NoCorrection().Estimate(input) : answer;
}

Result<MethodAnswer> NoCorrection::Estimate(const MethodInput& input) {
  MethodAnswer answer{MotionField(input.rs.width, input.rs.height, 2, 2), {}};
  answer.field.set_reference_row(input.ReferenceRow());
  return answer;
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
  MethodAnswer answer{std::move(motion->field), std::move(motion->curves)};
  if (std::abs(input.ReferenceRow() - answer.field.reference_row()) < kSameRow ||
      motion->curve_mean.empty()) {
    return answer;
  }
  // The mean curve tells the same motion as the mean field, and from any row.
  const Camera camera = Camera::Pinhole(
      input.rs.width, input.rs.height,
      focal_px.value_or(static_cast<double>(input.rs.width)));  // the estimator's own assumption
  const int knots = ReadoutMotion::KnotCount(camera.height);
  auto field =
      FieldFromRow(camera, rsdiff::RowRotationsFromCurve(motion->curve_mean, camera, knots),
                   input.ReferenceRow());
  if (!field) {
    return Propagate(field.error());
  }
  answer.field = std::move(*field);
  return answer;
}

}  // namespace rsstab::evaluation
