// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_STABILIZER_METRICS_IMAGE_METRICS_H_
#define RSSTAB_STABILIZER_METRICS_IMAGE_METRICS_H_

#include <cstdint>
#include <span>

#include "igf/base/frame.h"
#include "igf/base/result.h"

namespace rsstab::stabilizer {

// Which pixels count: one byte a pixel, row by row, 0 = leave out (no source, black edge). Empty:
// all of them.
using PixelMask = std::span<const std::uint8_t>;

// PSNR of two pictures that are alike ends here, so that a repeated frame cannot make a mean
// infinite.
inline constexpr double kLargestPsnrDb = 60.0;

// Peak signal-to-noise ratio of the brightness (luma as stored; of RGB the mean of the three),
// 10 log10(peak^2 / mean squared difference), peak = 2^bit_depth - 1, at most kLargestPsnrDb.
// Errors: kInvalidArgument for different sizes or depths, a mask of another size, no valid pixel.
[[nodiscard]] Result<double> Psnr(const FrameView& a, const FrameView& b, PixelMask valid = {});

// Structural similarity of the brightness, mean over the valid pixels, in [-1, 1] (Wang et al.
// 2004: 11x11 Gaussian window of 1.5 px, K1 = 0.01, K2 = 0.03). Invalid pixels take no part in any
// window: weights are renormalised over the valid ones. Errors as above.
[[nodiscard]] Result<double> Ssim(const FrameView& a, const FrameView& b, PixelMask valid = {});

// The same over plain 8x8 windows every 4 pixels, as FFmpeg's and x264's `ssim` have it (variances
// over 63, mean over the windows of which every pixel is valid): for comparison with them. On
// ordinary pictures the two forms differ by a few hundredths.
// Errors: as above; kInvalidArgument when no window is left.
[[nodiscard]] Result<double> BlockSsim(const FrameView& a, const FrameView& b,
                                       PixelMask valid = {});

}  // namespace rsstab::stabilizer

#endif  // RSSTAB_STABILIZER_METRICS_IMAGE_METRICS_H_
