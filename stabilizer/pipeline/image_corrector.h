// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_STABILIZER_PIPELINE_IMAGE_CORRECTOR_H_
#define RSSTAB_STABILIZER_PIPELINE_IMAGE_CORRECTOR_H_

#include <memory>
#include <optional>
#include <vector>

#include "igf/base/frame.h"
#include "igf/base/motion_field.h"
#include "igf/base/result.h"
#include "rsdiff/single_image_motion.h"
#include "stabilizer/interpolation.h"

namespace rsstab::pipeline {

// How the rolling shutter of single pictures is taken out.
struct ImageCorrectionOptions {
  rsdiff::SamplingOptions sampling = {};
  double strength = 1.0;  // share of the estimated motion that is corrected, 0 .. 2
  // False: the picture is enlarged just so far that no border shows. True: its scale is kept, and
  // where nothing was recorded the edge goes on.
  bool full_frame = false;
  stabilizer::Interpolation interpolation = stabilizer::Interpolation::kLanczos;
  int num_threads = 0;  // of the resampling; 0 = one per processor
};

// What one rolling-shutter picture told of its readout, times the strength. At the picture's size,
// reference row the middle.
struct ImageMotion {
  MotionField field;
  std::vector<float> vertex_spread_px;  // standard deviation at each vertex of `field`
  double spread_px = 0.0;               // root mean square over them; infinite for one sample
};

// The picture as a global shutter would have taken it at the instant of its middle row.
struct CorrectedImage {
  Frame picture;            // size and layout of the input
  double kept_ratio = 1.0;  // share of each side that is still seen
};

// Pictures in, corrected pictures out. Not thread safe: one call at a time.
class ImageCorrector {
 public:
  // Errors: kInvalidArgument for a strength outside its range or a negative number of threads.
  [[nodiscard]] static Result<ImageCorrector> Create(rsdiff::SingleImageEstimator estimator,
                                                     const ImageCorrectionOptions& options);
  ImageCorrector(ImageCorrector&&) noexcept;
  ImageCorrector& operator=(ImageCorrector&&) noexcept;
  ~ImageCorrector();

  // `picture` as the sensor recorded it, its rows the sensor's rows. `focal_px` as for
  // SingleImageEstimator::Estimate. Errors: those of it.
  [[nodiscard]] Result<ImageMotion> Estimate(const FrameView& picture,
                                             std::optional<double> focal_px = {});

  // Resamples the picture once. `field` is stated at its size.
  // Errors: kInvalidArgument for a field of another size or a layout that cannot be resampled.
  [[nodiscard]] Result<CorrectedImage> Correct(const FrameView& picture, const MotionField& field);

 private:
  struct Impl;
  explicit ImageCorrector(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace rsstab::pipeline

#endif  // RSSTAB_STABILIZER_PIPELINE_IMAGE_CORRECTOR_H_
