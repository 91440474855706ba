// SPDX-License-Identifier: Apache-2.0
#include "rsdiff/seeded_noise.h"

#include <algorithm>
#include <cmath>
#include <functional>

namespace rsstab::rsdiff {
namespace {

// Numbers are rounded to multiples of this. Logarithm and cosine differ between platforms in the
// last bits of a double; after rounding, two platforms disagree about once in 10^10 numbers.
constexpr double kGrain = 0x1.0p-20;

}  // namespace

SeededNoise::SeededNoise(std::uint64_t seed, int batch) {
  for (int i = 0; i < batch; i += 2) {
    streams_.emplace_back(seed, static_cast<std::uint64_t>(i / 2));
  }
}

void SeededNoise::Fill(Tensor& tensor) {
  for (int i = 0; i < tensor.batch; ++i) {
    if (i % 2 == 1) {
      std::ranges::transform(tensor.Item(i - 1), tensor.Item(i).begin(), std::negate<>());
      continue;
    }
    SeededRandom& stream = streams_[static_cast<std::size_t>(i / 2)];
    for (float& value : tensor.Item(i)) {
      value = static_cast<float>(kGrain * std::nearbyint(stream.Normal() / kGrain));
    }
  }
}

}  // namespace rsstab::rsdiff
