// SPDX-License-Identifier: Apache-2.0
#include "rsdiff/time_embedding.h"

#include <cmath>
#include <cstddef>
#include <numbers>

namespace rsstab::rsdiff {

std::vector<float> TimeEmbedding(int t, int diffusion_steps, int size) {
  const int half = size / 2;
  std::vector<float> embedding(static_cast<std::size_t>(size));
  for (int k = 0; k < half; ++k) {
    const double phase =
        std::ldexp(static_cast<double>(t) / diffusion_steps * std::numbers::pi / 2.0, k);
    embedding[static_cast<std::size_t>(k)] = static_cast<float>(std::cos(phase));
    embedding[static_cast<std::size_t>(half + k)] = static_cast<float>(std::sin(phase));
  }
  return embedding;
}

}  // namespace rsstab::rsdiff
