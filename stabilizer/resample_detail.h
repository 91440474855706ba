// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_STABILIZER_RESAMPLE_DETAIL_H_
#define RSSTAB_STABILIZER_RESAMPLE_DETAIL_H_

#include <cstdint>

#include "stabilizer/resample_kernels.h"

// What the kernel sets share. Private to resample_*.cc.

namespace rsstab::stabilizer::detail {

// Two-step fixed-point filtering of a sample depth. With w_x, w_y the 14-bit weights of a position
// and s the samples under its taps, every kernel computes
//   h[r]   = saturate16((sum_k w_x[k] (s[r][k] - bias) + 2^(along_row_shift-1)) >> along_row_shift)
//   result = clamp(((sum_r w_y[r] h[r] + 2^(down_shift-1)) >> down_shift) + bias, 0, maximum)
// so that both products are 16 bit by 16 bit, summed in 32 bits. Up to 14 bits deep, h keeps all
// the fraction bits that leave room for the overshoot (factor 1.27 of Lanczos); deeper samples are
// centred on zero, have no room for a fraction, and saturate where a row overshoots their range.
struct FixedPoint {
  std::int32_t bias;
  int along_row_shift;
  int down_shift;
  std::int32_t maximum;

  explicit constexpr FixedPoint(int bit_depth)
      : bias(bit_depth > kWeightBits ? 1 << 15 : 0),
        along_row_shift(bit_depth > kWeightBits ? kWeightBits : bit_depth),
        down_shift(bit_depth > kWeightBits ? kWeightBits : 2 * kWeightBits - bit_depth),
        maximum((1 << bit_depth) - 1) {}
};

inline unsigned PhaseOf(std::int32_t position) {
  return static_cast<unsigned>(position) & (kPhases - 1);
}

// Samples [begin, end) of the row, whatever their positions.
void ResamplePortable(const ResampleRow& row, const FilterBank& filter, int begin, int end);

#if defined(__x86_64__)
// All samples of the row; 1, 2 or 4 channels.
void ResampleAvx2(const ResampleRow& row, const FilterBank& filter);
#endif

}  // namespace rsstab::stabilizer::detail

#endif  // RSSTAB_STABILIZER_RESAMPLE_DETAIL_H_
