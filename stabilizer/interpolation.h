// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_STABILIZER_INTERPOLATION_H_
#define RSSTAB_STABILIZER_INTERPOLATION_H_

namespace rsstab::stabilizer {

// How a sample between pixels is made.
enum class Interpolation {
  kBilinear,  // from 2x2 pixels
  kBicubic,   // from 4x4: Keys 1981 with a = -1/2, exact for quadratics
  kLanczos,   // from 6x6: three lobes, normalised
};

}  // namespace rsstab::stabilizer

#endif  // RSSTAB_STABILIZER_INTERPOLATION_H_
