// SPDX-License-Identifier: Apache-2.0
#include "rsdiff/diffusion_motion_source.h"

#include <utility>

namespace rsstab::rsdiff {
namespace {

constexpr double kMaxStrength = 2.0;

}  // namespace

Result<DiffusionMotionSource> DiffusionMotionSource::Create(SingleImageEstimator estimator,
                                                            const DiffusionSourceOptions& options) {
  if (!(options.strength >= 0.0 && options.strength <= kMaxStrength)) {
    return Fail(ErrorCode::kInvalidArgument, "strength {} must lie within 0 and {}",
                options.strength, kMaxStrength);
  }
  if (options.focal_px && !(*options.focal_px > 0.0)) {
    return Fail(ErrorCode::kInvalidArgument, "focal length {} px must be positive",
                *options.focal_px);
  }
  return DiffusionMotionSource(std::move(estimator), options);
}

Result<RsMotion> DiffusionMotionSource::EstimateMotion(const FrameContext& frame) {
  if (frame.image == nullptr) {
    return Fail(ErrorCode::kInvalidArgument, "frame {}: its picture is needed, and there is none",
                frame.index);
  }
  auto motion = estimator_.Estimate(*frame.image, options_.sampling, options_.focal_px);
  if (!motion) {
    return Propagate(motion.error(), fmt::format("frame {}", frame.index));
  }
  for (Eigen::Vector2f& displacement : motion->field.vertices()) {
    displacement *= static_cast<float>(options_.strength);
  }
  // No motion at all is not uncertain, not even where one sample says nothing of its error.
  const double spread_px = options_.strength > 0.0 ? options_.strength * motion->spread_px : 0.0;
  return RsMotion{std::move(motion->field), spread_px};
}

}  // namespace rsstab::rsdiff
