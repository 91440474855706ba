// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/resample_kernels.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "stabilizer/resample_detail.h"

namespace rsstab::stabilizer {
namespace {

int TapsOf(Interpolation interpolation) {
  switch (interpolation) {
    case Interpolation::kBilinear:
      return 2;
    case Interpolation::kBicubic:
      return 4;
    case Interpolation::kLanczos:
      return 6;
  }
  return 2;
}

// Impulse response at a distance of x pixels.
double Kernel(Interpolation interpolation, double x) {
  x = std::abs(x);
  switch (interpolation) {
    case Interpolation::kBilinear:
      return std::max(0.0, 1.0 - x);
    case Interpolation::kBicubic:  // Keys 1981, eq. 15
      if (x >= 2.0) {
        return 0.0;
      }
      return x < 1.0 ? (1.5 * x - 2.5) * x * x + 1.0 : ((-0.5 * x + 2.5) * x - 4.0) * x + 2.0;
    case Interpolation::kLanczos: {
      constexpr double kLobes = 3.0;
      if (x >= kLobes) {
        return 0.0;
      }
      const double a = std::numbers::pi * x;
      return x == 0.0 ? 1.0 : std::sin(a) * std::sin(a / kLobes) * kLobes / (a * a);
    }
  }
  return 0.0;
}

}  // namespace

FilterBank::FilterBank(Interpolation interpolation)
    // One entry more than there are phases, for reads past the last one's end.
    : taps_(TapsOf(interpolation)), weights_((kPhases + 1) * kEntry) {
  for (int phase = 0; phase < kPhases; ++phase) {
    std::array<double, 6> exact{};
    double sum = 0.0;
    for (int k = 0; k < taps_; ++k) {
      const double tap_position = k - (taps_ / 2 - 1);
      const double x = tap_position - static_cast<double>(phase) / kPhases;
      exact[static_cast<std::size_t>(k)] = Kernel(interpolation, x);
      sum += exact[static_cast<std::size_t>(k)];
    }
    std::int16_t* weights = weights_.data() + phase * kEntry + kMargin;
    int rest = 1 << kWeightBits;
    for (int k = 0; k < taps_; ++k) {
      const double scaled = exact[static_cast<std::size_t>(k)] / sum * (1 << kWeightBits);
      weights[k] = static_cast<std::int16_t>(std::lround(scaled));
      rest -= weights[k];
    }
    // What rounding lost goes to the largest weight, where it matters least.
    std::int16_t& largest = *std::max_element(weights, weights + taps_);
    largest = static_cast<std::int16_t>(largest + rest);
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

template <typename Sample, int kTaps>
void ResampleSamples(const ResampleRow& row, const FilterBank& filter, int begin, int end) {
  constexpr int kBefore = kTaps / 2 - 1;  // taps left of or above the position's floor
  constexpr int kHalfPixel = kPhases / 2;
  const FixedPoint format(row.bit_depth);
  const auto* source = reinterpret_cast<const Sample*>(row.source);
  auto* output = reinterpret_cast<Sample*>(row.output);
  const std::ptrdiff_t stride = row.source_stride / static_cast<std::ptrdiff_t>(sizeof(Sample));
  const int right = row.source_width - 1;
  const int bottom = row.source_height - 1;

  int channel = begin % row.channels;
  for (int i = begin; i < end; ++i) {
    const std::int32_t qx = row.source_x[static_cast<std::size_t>(i)];
    const std::int32_t qy = row.source_y[static_cast<std::size_t>(i)];
    const int x = (qx >> kPhaseBits) - kBefore;
    const int y = (qy >> kPhaseBits) - kBefore;
    const std::int16_t* weights_x = filter.Weights(qx & (kPhases - 1));
    const std::int16_t* weights_y = filter.Weights(qy & (kPhases - 1));
    if (x >= 0 && y >= 0 && x + kTaps - 1 <= right && y + kTaps - 1 <= bottom) {
      const Sample* taps = source + y * stride + x * row.channels + channel;
      output[i] = Filter<Sample, kTaps>(taps, row.channels, stride, weights_x, weights_y, format);
    } else if (qx < -kHalfPixel || qy < -kHalfPixel || qx > (right << kPhaseBits) + kHalfPixel ||
               qy > (bottom << kPhaseBits) + kHalfPixel) {
      output[i] = static_cast<Sample>(row.black[static_cast<std::size_t>(channel)]);
    } else {
      std::array<Sample, static_cast<std::size_t>(kTaps * kTaps)> taps;
      for (int r = 0; r < kTaps; ++r) {
        const Sample* line = source + std::clamp(y + r, 0, bottom) * stride + channel;
        for (int k = 0; k < kTaps; ++k) {
          taps[static_cast<std::size_t>(r * kTaps + k)] =
              line[std::clamp(x + k, 0, right) * row.channels];
        }
      }
      output[i] = Filter<Sample, kTaps>(taps.data(), 1, kTaps, weights_x, weights_y, format);
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
