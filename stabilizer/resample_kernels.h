// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_STABILIZER_RESAMPLE_KERNELS_H_
#define RSSTAB_STABILIZER_RESAMPLE_KERNELS_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "stabilizer/interpolation.h"

// The inner loops of PlaneWarper, in integers, so that every kernel set gives the same bytes.

namespace rsstab::stabilizer {

// Source positions are in 1 / kPhases px: at most 1/512 px of rounding.
inline constexpr int kPhaseBits = 8;
inline constexpr int kPhases = 1 << kPhaseBits;

// Filter weights are in 1 / 2^kWeightBits and sum to exactly one, so that flat areas stay flat.
inline constexpr int kWeightBits = 14;

// The weights of one separable interpolation at every phase.
class FilterBank {
 public:
  explicit FilterBank(Interpolation interpolation);

  // Taps per axis: 2, 4 or 6. Tap k of phase p weighs the sample k - (taps() / 2 - 1) to the right
  // of the position's floor.
  [[nodiscard]] int taps() const { return taps_; }

  // kEntry weights, zeros behind the first taps().
  [[nodiscard]] const std::int16_t* Weights(unsigned phase) const {
    return weights_.data() + static_cast<std::size_t>(phase) * kEntry;
  }

  static constexpr std::size_t kEntry = 8;

 private:
  int taps_;
  std::vector<std::int16_t> weights_;
};

inline constexpr int kMaxChannels = 4;

// One row of one output plane. Positions are stated per sample (a pixel of several interleaved
// channels repeats its own), in 1 / kPhases px of the plane.
struct ResampleRow {
  const std::uint8_t* source = nullptr;  // first sample of the source plane
  std::ptrdiff_t source_stride = 0;      // bytes
  int source_width = 0;                  // pixels
  int source_height = 0;
  int channels = 1;   // interleaved samples per pixel
  int bit_depth = 8;  // 8: bytes, 9..16: uint16
  // Per channel, for positions more than half a pixel outside.
  std::array<int, kMaxChannels> black{};
  std::span<const std::int32_t> source_x;  // one per output sample
  std::span<const std::int32_t> source_y;
  std::uint8_t* output = nullptr;
};

// Which machine code does the work.
enum class KernelSet {
  kPortable,  // plain C++
  kAvx2,      // 8 samples at a time; x86-64 with AVX2
};

// The fastest set that this machine runs.
[[nodiscard]] KernelSet BestKernelSet();

// Computes the row. `kernels` must be runnable here. Any thread.
void Resample(const ResampleRow& row, const FilterBank& filter, KernelSet kernels);

}  // namespace rsstab::stabilizer

#endif  // RSSTAB_STABILIZER_RESAMPLE_KERNELS_H_
