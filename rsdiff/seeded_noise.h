// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_RSDIFF_SEEDED_NOISE_H_
#define RSSTAB_RSDIFF_SEEDED_NOISE_H_

#include <cstdint>
#include <vector>

#include "igf/base/seeded_random.h"
#include "rsdiff/tensor.h"

namespace rsstab::rsdiff {

// Gaussian numbers, mean 0 and standard deviation 1, that are the same on every platform. Item i of
// a batch has a stream of its own: it gets the same numbers however many items there are.
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
