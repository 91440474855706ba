// SPDX-License-Identifier: Apache-2.0
#include "rsdiff/time_embedding.h"

#include <cmath>
#include <cstddef>
#include <numbers>

namespace rsstab::rsdiff {

std::vector<float> TimeEmbedding(int t, int diffusion_steps, int size) {
  const auto half = static_cast<std::size_t>(size / 2);
  std::vector<float> embedding(2 * half);
  const double share = static_cast<double>(t) / diffusion_steps;
  for (std::size_t k = 0; k < half; ++k) {
    const double phase = std::ldexp(share * std::numbers::pi / 2.0, static_cast<int>(k));
    embedding[k] = static_cast<float>(std::cos(phase));
    embedding[half + k] = static_cast<float>(std::sin(phase));
  }
  return embedding;
}

}  // namespace rsstab::rsdiff
