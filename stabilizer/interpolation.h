// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_STABILIZER_INTERPOLATION_H_
#define RSSTAB_STABILIZER_INTERPOLATION_H_

namespace rsstab::stabilizer {

// How a sample between four pixels is made. Support in pixels: 2x2, 4x4, 8x8.
enum class Interpolation { kBilinear, kBicubic, kLanczos };

}  // namespace rsstab::stabilizer

#endif  // RSSTAB_STABILIZER_INTERPOLATION_H_
