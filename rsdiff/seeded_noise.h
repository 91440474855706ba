// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_RSDIFF_SEEDED_NOISE_H_
#define RSSTAB_RSDIFF_SEEDED_NOISE_H_

#include <cstdint>
#include <vector>

#include "igf/base/seeded_random.h"
#include "rsdiff/tensor.h"

namespace rsstab::rsdiff {

// Gaussian numbers, mean 0 and standard deviation 1, that are the same on every platform. Items 2i
// and 2i + 1 of a batch get the same numbers with opposite signs (antithetic sampling: each is as
// good a draw as any, and what noise does to a mean over them cancels to first order), every pair
// from a stream of its own: an item's numbers do not depend on how many items there are.
class SeededNoise {
 public:
  SeededNoise(std::uint64_t seed, int batch);

  // The next numbers of every stream. The batch is at most the one given above.
  void Fill(Tensor& tensor);

 private:
  std::vector<SeededRandom> streams_;
};

}  // namespace rsstab::rsdiff

#endif  // RSSTAB_RSDIFF_SEEDED_NOISE_H_
