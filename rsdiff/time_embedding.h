// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_RSDIFF_TIME_EMBEDDING_H_
#define RSSTAB_RSDIFF_TIME_EMBEDDING_H_

#include <vector>

namespace rsstab::rsdiff {

// What a compact denoiser is told of the time step t of T: with phase p_k = t / T * pi/2 * 2^k,
// [cos p_0 .. cos p_{h-1}, sin p_0 .. sin p_{h-1}], h = size / 2. `size` even, at least 2.
[[nodiscard]] std::vector<float> TimeEmbedding(int t, int diffusion_steps, int size);

}  // namespace rsstab::rsdiff

#endif  // RSSTAB_RSDIFF_TIME_EMBEDDING_H_
