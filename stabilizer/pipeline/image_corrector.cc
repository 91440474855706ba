// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/pipeline/image_corrector.h"

#include <algorithm>
#include <utility>

#include "igf/base/parallel_for.h"
#include "stabilizer/crop_planner.h"
#include "stabilizer/pipeline/covered_map.h"
#include "stabilizer/plane_warper.h"

namespace rsstab::pipeline {
namespace {

constexpr double kMaxStrength = 2.0;

}  // namespace

struct ImageCorrector::Impl {
  Impl(rsdiff::SingleImageEstimator image_estimator, const ImageCorrectionOptions& wanted)
      : estimator(std::move(image_estimator)),
        options(wanted),
        workers(ResolveThreadCount(wanted.num_threads)) {}

  rsdiff::SingleImageEstimator estimator;
  ImageCorrectionOptions options;
  WorkerPool workers;
  stabilizer::PlaneWarper warper;
};

ImageCorrector::ImageCorrector(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
ImageCorrector::ImageCorrector(ImageCorrector&&) noexcept = default;
ImageCorrector& ImageCorrector::operator=(ImageCorrector&&) noexcept = default;
ImageCorrector::~ImageCorrector() = default;

Result<ImageCorrector> ImageCorrector::Create(rsdiff::SingleImageEstimator estimator,
                                              const ImageCorrectionOptions& options) {
  if (!(options.strength >= 0.0 && options.strength <= kMaxStrength)) {
    return Fail(ErrorCode::kInvalidArgument, "strength {} must lie within 0 and {}",
                options.strength, kMaxStrength);
  }
  if (options.num_threads < 0) {
    return Fail(ErrorCode::kInvalidArgument, "{} threads are not possible", options.num_threads);
  }
  return ImageCorrector(std::make_unique<Impl>(std::move(estimator), options));
}

Result<ImageMotion> ImageCorrector::Estimate(const FrameView& picture,
                                             std::optional<double> focal_px) {
  auto estimated = impl_->estimator.Estimate(picture, impl_->options.sampling, focal_px);
  if (!estimated) {
    return Propagate(std::move(estimated.error()));
  }
  const double strength = impl_->options.strength;
  if (strength == 0.0) {  // no motion at all is not uncertain, not even for one sample
    estimated->spread_px = 0.0;
    std::fill(estimated->vertex_spread_px.begin(), estimated->vertex_spread_px.end(), 0.0F);
  }
  ImageMotion motion{std::move(estimated->field), std::move(estimated->vertex_spread_px),
                     strength * estimated->spread_px};
  for (Eigen::Vector2f& displacement : motion.field.vertices()) {
    displacement *= static_cast<float>(strength);
  }
  for (float& spread : motion.vertex_spread_px) {
    spread *= static_cast<float>(strength);
  }
  return motion;
}

Result<CorrectedImage> ImageCorrector::Correct(const FrameView& picture, const MotionField& field) {
  if (field.width() != picture.width || field.height() != picture.height) {
    return Fail(ErrorCode::kInvalidArgument,
                "a motion field for {}x{} pixels does not fit a picture of {}x{}", field.width(),
                field.height(), picture.width, picture.height);
  }
  stabilizer::FrameWarp warp;
  warp.width = picture.width;
  warp.height = picture.height;
  warp.rs_field = field;
  const stabilizer::MapGrid grid = stabilizer::DefaultMapGrid(warp.width, warp.height);
  const CoveredMap covered =
      impl_->options.full_frame ? CoveredMap{stabilizer::ComposeBackwardMap(warp, grid), 1.0}
                                : ComposeCoveredMap(warp, stabilizer::LargestCropRatio(warp), grid);
  auto output = AllocateFrame(picture.layout, picture.width, picture.height);
  if (!output) {
    return Propagate(std::move(output.error()));
  }
  if (Status ok = impl_->warper.Warp(picture, covered.map, impl_->options.interpolation, *output,
                                     impl_->workers, stabilizer::OutsidePixels::kNearestEdge);
      !ok) {
    return Propagate(std::move(ok.error()));
  }
  return CorrectedImage{std::move(*output), covered.crop_ratio};
}

}  // namespace rsstab::pipeline
