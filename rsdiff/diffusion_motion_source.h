// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_RSDIFF_DIFFUSION_MOTION_SOURCE_H_
#define RSSTAB_RSDIFF_DIFFUSION_MOTION_SOURCE_H_

#include <optional>
#include <string>

#include "igf/base/rs_motion_source.h"
#include "rsdiff/single_image_motion.h"

namespace rsstab::rsdiff {

struct DiffusionSourceOptions {
  SamplingOptions sampling = {};        // one seed for the clip: the same noise for every frame
  std::optional<double> focal_px = {};  // of the clip's frames; 1 frame width unless given
  double strength = 1.0;                // the field and its spread are multiplied by it, 0 .. 2
};

// Readout motion told by each frame's picture alone. Every frame starts from the same noise, so
// that the estimate changes no more than the pictures do. Calls are independent of each other.
class DiffusionMotionSource final : public RsMotionSource {
 public:
  // Errors: kInvalidArgument for options outside their range.
  [[nodiscard]] static Result<DiffusionMotionSource> Create(SingleImageEstimator estimator,
                                                            const DiffusionSourceOptions& options);

  [[nodiscard]] std::string Name() const override { return "diffusion"; }
  [[nodiscard]] bool NeedsImage() const override { return true; }
  // Errors: kInvalidArgument without an image; those of SingleImageEstimator::Estimate.
  [[nodiscard]] Result<RsMotion> EstimateMotion(const FrameContext& frame) override;

 private:
  DiffusionMotionSource(SingleImageEstimator estimator, const DiffusionSourceOptions& options)
      : estimator_(std::move(estimator)), options_(options) {}

  SingleImageEstimator estimator_;
  DiffusionSourceOptions options_;
};

}  // namespace rsstab::rsdiff

#endif  // RSSTAB_RSDIFF_DIFFUSION_MOTION_SOURCE_H_
