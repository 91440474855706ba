// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_BENCH_SHAKY_WARP_H_
#define RSSTAB_BENCH_SHAKY_WARP_H_

#include "stabilizer/backward_map.h"

namespace rsstab::bench {

inline constexpr int kWidth = 1920;
inline constexpr int kHeight = 1080;
inline constexpr double kFocalPx = 0.8 * kWidth;

// A wide lens of that size.
[[nodiscard]] Camera FisheyeLens();

// The warp of a frame from a turned and vibrating camera: two degrees of roll, one of pan and tilt,
// local paths, and 1.8 cycles of vibration down the frame. With a zoom of 1.25 every output pixel
// has a source, with 1 the corners have none.
[[nodiscard]] stabilizer::FrameWarp ShakyWarp(double zoom);

}  // namespace rsstab::bench

#endif  // RSSTAB_BENCH_SHAKY_WARP_H_
