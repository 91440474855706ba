// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/resample_kernels.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "stabilizer/resample_detail.h"

namespace rsstab::stabilizer {
namespace {

using Entry = std::array<std::int16_t, FilterBank::kEntry>;

constexpr int kOne = 1 << kWeightBits;

// In integers: the vector kernels compute bilinear and bicubic weights instead of looking them up.
Entry BilinearWeights(int phase) {
  constexpr int kPerPhase = kOne / kPhases;
  return {static_cast<std::int16_t>(kOne - kPerPhase * phase),
          static_cast<std::int16_t>(kPerPhase * phase)};
}

// Keys 1981 with a = -1/2. With t the position between the middle taps and u = 1 - t, the outer
// weights are -a = -t u^2 / 2 and -b = -t^2 u / 2, and the inner ones follow from the sum (1) and
// the first moment (t): u + 2a - b and t + 2b - a. Rounding a and b alone keeps both exact.
Entry BicubicWeights(int phase) {
  constexpr int kPerPhase = kOne / kPhases;
  // kOne t^2 u / 2 = phase^2 (kPhases - phase) / 2^11, to the nearest.
  const auto rounded = [](int t, int u) { return (t * u * t + (1 << 10)) >> 11; };
  const int t = phase;
  const int u = kPhases - phase;
  const int a = rounded(u, t);
  const int b = rounded(t, u);
  return {static_cast<std::int16_t>(-a), static_cast<std::int16_t>(kPerPhase * u + 2 * a - b),
          static_cast<std::int16_t>(kPerPhase * t + 2 * b - a), static_cast<std::int16_t>(-b)};
}

Entry LanczosWeights(int phase) {
  constexpr std::size_t kLobes = 3;
  std::array<double, 2 * kLobes> exact{};
  double sum = 0.0;
  for (std::size_t k = 0; k < exact.size(); ++k) {
    const double tap = static_cast<double>(k) - (kLobes - 1.0);
    const double x = std::numbers::pi * (tap - static_cast<double>(phase) / kPhases);
    exact[k] = x == 0.0 ? 1.0 : std::sin(x) * std::sin(x / kLobes) * kLobes / (x * x);
    sum += exact[k];
  }
  Entry weights{};
  int rest = kOne;
  for (std::size_t k = 0; k < exact.size(); ++k) {
    weights[k] = static_cast<std::int16_t>(std::lround(exact[k] / sum * kOne));
    rest -= weights[k];
  }
  // What rounding lost goes to the largest weight, where it matters least.
  std::int16_t& largest = *std::max_element(weights.begin(), weights.end());
  largest = static_cast<std::int16_t>(largest + rest);
  return weights;
}

struct FilterShape {
  int taps;
  Entry (*weights)(int phase);
};
FilterShape ShapeOf(Interpolation interpolation) {
  switch (interpolation) {
    case Interpolation::kBilinear:
      return {2, BilinearWeights};
    case Interpolation::kBicubic:
      return {4, BicubicWeights};
    case Interpolation::kLanczos:
      return {6, LanczosWeights};
  }
  return {2, BilinearWeights};
}

}  // namespace

FilterBank::FilterBank(Interpolation interpolation) : taps_(ShapeOf(interpolation).taps) {
  weights_.reserve(kPhases * kEntry);
  for (int phase = 0; phase < kPhases; ++phase) {
    const Entry entry = ShapeOf(interpolation).weights(phase);
    weights_.insert(weights_.end(), entry.begin(), entry.end());
  }
}

KernelSet BestKernelSet() {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2")) {
    return KernelSet::kAvx2;
  }
#endif
  return KernelSet::kPortable;
}

namespace detail {
namespace {

std::int32_t Saturate16(std::int32_t value) {
  return std::clamp<std::int32_t>(value, std::numeric_limits<std::int16_t>::min(),
                                  std::numeric_limits<std::int16_t>::max());
}

// `taps`: sample under the top left tap; steps to the next tap in samples.
template <typename Sample, int kTaps>
Sample Filter(const Sample* taps, std::ptrdiff_t step_x, std::ptrdiff_t step_y,
              const std::int16_t* weights_x, const std::int16_t* weights_y,
              const FixedPoint& format) {
  std::int32_t total = 1 << (format.down_shift - 1);
  for (int r = 0; r < kTaps; ++r) {
    std::int32_t along_row = 1 << (format.along_row_shift - 1);
    for (int k = 0; k < kTaps; ++k) {
      along_row += weights_x[k] * (taps[r * step_y + k * step_x] - format.bias);
    }
    total += weights_y[r] * Saturate16(along_row >> format.along_row_shift);
  }
  return static_cast<Sample>(
      std::clamp((total >> format.down_shift) + format.bias, 0, format.maximum));
}

// A plane of Sample, seen through one of its channels.
template <typename Sample>
struct Plane {
  const Sample* data;
  std::ptrdiff_t stride;  // samples
  int channels;
  int right;   // last column
  int bottom;  // last row

  [[nodiscard]] const Sample* At(int x, int y, int channel) const {
    return data + y * stride + static_cast<std::ptrdiff_t>(x) * channels + channel;
  }
  [[nodiscard]] bool HoldsTaps(int x, int y, int taps) const {
    return x >= 0 && y >= 0 && x + taps - 1 <= right && y + taps - 1 <= bottom;
  }
  [[nodiscard]] bool IsNear(std::int32_t qx, std::int32_t qy) const {
    constexpr int kHalfPixel = kPhases / 2;
    return qx >= -kHalfPixel && qx <= (right << kPhaseBits) + kHalfPixel && qy >= -kHalfPixel &&
           qy <= (bottom << kPhaseBits) + kHalfPixel;
  }
};

template <typename Sample, int kTaps>
void ResampleSamples(const ResampleRow& row, const FilterBank& filter, int begin, int end) {
  constexpr int kBefore = kTaps / 2 - 1;  // taps left of or above the position's floor
  const FixedPoint format(row.bit_depth);
  const Plane<Sample> plane{reinterpret_cast<const Sample*>(row.source),
                            row.source_stride / static_cast<std::ptrdiff_t>(sizeof(Sample)),
                            row.channels, row.source_width - 1, row.source_height - 1};
  auto* output = reinterpret_cast<Sample*>(row.output);

  int channel = begin % row.channels;
  for (int i = begin; i < end; ++i) {
    const std::int32_t qx = row.source_x[static_cast<std::size_t>(i)];
    const std::int32_t qy = row.source_y[static_cast<std::size_t>(i)];
    const int x = (qx >> kPhaseBits) - kBefore;
    const int y = (qy >> kPhaseBits) - kBefore;
    const std::int16_t* weights_x = filter.Weights(PhaseOf(qx));
    const std::int16_t* weights_y = filter.Weights(PhaseOf(qy));
    if (plane.HoldsTaps(x, y, kTaps)) {
      output[i] = Filter<Sample, kTaps>(plane.At(x, y, channel), plane.channels, plane.stride,
                                        weights_x, weights_y, format);
    } else if (plane.IsNear(qx, qy)) {
      Sample taps[kTaps][kTaps];
      for (int r = 0; r < kTaps; ++r) {
        for (int k = 0; k < kTaps; ++k) {
          taps[r][k] = *plane.At(std::clamp(x + k, 0, plane.right),
                                 std::clamp(y + r, 0, plane.bottom), channel);
        }
      }
      output[i] = Filter<Sample, kTaps>(taps[0], 1, kTaps, weights_x, weights_y, format);
    } else {
      output[i] = static_cast<Sample>(row.black[static_cast<std::size_t>(channel)]);
    }
    channel = channel + 1 == row.channels ? 0 : channel + 1;
  }
}

}  // namespace

void ResamplePortable(const ResampleRow& row, const FilterBank& filter, int begin, int end) {
  const bool bytes = row.bit_depth == 8;
  switch (filter.taps()) {
    case 2:
      return bytes ? ResampleSamples<std::uint8_t, 2>(row, filter, begin, end)
                   : ResampleSamples<std::uint16_t, 2>(row, filter, begin, end);
    case 4:
      return bytes ? ResampleSamples<std::uint8_t, 4>(row, filter, begin, end)
                   : ResampleSamples<std::uint16_t, 4>(row, filter, begin, end);
    default:
      return bytes ? ResampleSamples<std::uint8_t, 6>(row, filter, begin, end)
                   : ResampleSamples<std::uint16_t, 6>(row, filter, begin, end);
  }
}

}  // namespace detail

void Resample(const ResampleRow& row, const FilterBank& filter, KernelSet kernels) {
#if defined(__x86_64__)
  const bool lanes_hold_whole_pixels = row.channels == 1 || row.channels == 2 || row.channels == 4;
  if (kernels == KernelSet::kAvx2 && lanes_hold_whole_pixels) {
    return detail::ResampleAvx2(row, filter);
  }
#endif
  (void)kernels;
  detail::ResamplePortable(row, filter, 0, static_cast<int>(row.source_x.size()));
}

}  // namespace rsstab::stabilizer
