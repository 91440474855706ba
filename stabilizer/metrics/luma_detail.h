// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_STABILIZER_METRICS_LUMA_DETAIL_H_
#define RSSTAB_STABILIZER_METRICS_LUMA_DETAIL_H_

#include <opencv2/core.hpp>

#include "igf/base/frame.h"
#include "igf/base/result.h"

namespace rsstab::stabilizer::detail {

// All figures in pixels are stated at this frame width.
inline constexpr double kReferenceWidth = 640.0;

// A frame's brightness at native size, as stored (limited range stays limited): 8 or 16 bit, one
// channel. Luma of YUV is a view of the frame's own samples; of RGB, the mean of the three.
// Errors: kInvalidArgument for a frame without samples.
[[nodiscard]] Result<cv::Mat> NativeLuma(const FrameView& frame);

// The same as 8 bit, shrunk to kReferenceWidth where it is wider (never enlarged), aspect kept;
// owns its samples.
[[nodiscard]] cv::Mat MetricPicture(const cv::Mat& native_luma, int bit_depth);

// Factor from pixels of a metric picture to pixels at kReferenceWidth.
[[nodiscard]] inline double ToReference(int picture_width) {
  return kReferenceWidth / static_cast<double>(picture_width);
}

}  // namespace rsstab::stabilizer::detail

#endif  // RSSTAB_STABILIZER_METRICS_LUMA_DETAIL_H_
