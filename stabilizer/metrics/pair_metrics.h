// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_STABILIZER_METRICS_PAIR_METRICS_H_
#define RSSTAB_STABILIZER_METRICS_PAIR_METRICS_H_

#include <cstdint>
#include <optional>

#include "igf/base/frame.h"
#include "igf/base/result.h"

namespace rsstab::stabilizer {

// What stabilizing took from a clip. Per frame pair a homography in_from_out (pixels of both sizes
// stated at 640 px width, origin at the centre) is fitted to tracks between the two pictures.
struct PairMetrics {
  std::int64_t frames = 0;     // pairs that were compared
  std::int64_t unaligned = 0;  // of these, pairs in which nothing agreed; left out below
  std::optional<double> crop;  // cropping ratio (Liu et al. 2013): mean over frames of the scale of
                               // in_from_out at the centre, that is, the kept share of a side
  std::optional<double> smallest_crop;  // of any frame
  // Distortion value (Liu et al. 2013): smallest over frames of the ratio of the two singular
  // values of the homography's affine part; 1 = no stretch or shear. Pairs with fewer than 40
  // matches are left out: their fit is no witness.
  std::optional<double> distortion;
  // Share of output pixels without a source in the input, mean and worst over frames. A pixel
  // counts when its source by the homography lies outside the input by more than 1 px and three
  // times the fit's own residual, or when it belongs to a black area that touches the border and
  // the input is not black there. Content filled in from other frames counts too: it has no
  // source in this one.
  std::optional<double> undefined;
  std::optional<double> worst_undefined;
};

// Compares a stabilized clip with its original. In order, not thread safe; keeps a few numbers.
class PairMeter {
 public:
  // Frames of the same index. Errors: kInvalidArgument for a frame without samples.
  [[nodiscard]] Status Push(const FrameView& input, const FrameView& output);

  [[nodiscard]] PairMetrics Measure() const;

 private:
  std::int64_t frames_ = 0;
  std::int64_t aligned_ = 0;
  std::int64_t with_distortion_ = 0;
  double crop_sum_ = 0.0;
  double smallest_crop_ = 0.0;
  double distortion_ = 1.0;
  double undefined_sum_ = 0.0;
  double worst_undefined_ = 0.0;
};

}  // namespace rsstab::stabilizer

#endif  // RSSTAB_STABILIZER_METRICS_PAIR_METRICS_H_
