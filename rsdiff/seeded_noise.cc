// SPDX-License-Identifier: Apache-2.0
#include "rsdiff/seeded_noise.h"

#include <cmath>

namespace rsstab::rsdiff {
namespace {

// Numbers are rounded to multiples of this. Logarithm and cosine differ between platforms in the
// last bits of a double; after rounding, two platforms disagree about once in 10^10 numbers.
constexpr double kGrain = 0x1.0p-20;

}  // namespace

SeededNoise::SeededNoise(std::uint64_t seed, int batch) {
  for (int i = 0; i < batch; ++i) {
    streams_.emplace_back(seed, static_cast<std::uint64_t>(i));
  }
}

void SeededNoise::Fill(Tensor& tensor) {
  for (int i = 0; i < tensor.batch; ++i) {
    SeededRandom& stream = streams_[static_cast<std::size_t>(i)];
    for (float& value : tensor.Item(i)) {
      value = static_cast<float>(kGrain * std::nearbyint(stream.Normal() / kGrain));
    }
  }
}

}  // namespace rsstab::rsdiff
