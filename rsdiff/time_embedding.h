// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_RSDIFF_TIME_EMBEDDING_H_
#define RSSTAB_RSDIFF_TIME_EMBEDDING_H_

#include <vector>

namespace rsstab::rsdiff {

// Sinusoidal embedding of a time step: [sin(t f_0) .. sin(t f_{h-1}), cos(t f_0) .. cos(t f_{h-1})]
// with h = size / 2 and f_k = max_period^(-k / (h - 1)). `size` even, at least 4; max_period > 1.
[[nodiscard]] std::vector<float> TimeEmbedding(int t, int size, double max_period);

}  // namespace rsstab::rsdiff

#endif  // RSSTAB_RSDIFF_TIME_EMBEDDING_H_
