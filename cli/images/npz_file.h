// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_IMAGES_NPZ_FILE_H_
#define RSSTAB_CLI_IMAGES_NPZ_FILE_H_

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "igf/base/result.h"

namespace rsstab::images {

// One array to be written: 32-bit floats or bytes in C order, as many as the shape says.
struct NpzArray {
  std::string name;
  std::vector<std::size_t> shape;
  std::variant<std::span<const float>, std::span<const std::uint8_t>> values;
};

// Writes arrays as NumPy's savez does: a ZIP of .npy files, not compressed. The file appears under
// `path` when it is complete, and replaces what lay there. The same arrays give the same bytes.
// Errors: kInvalidArgument for a shape that does not fit its values; kIo.
[[nodiscard]] Status WriteNpz(const std::string& path, std::span<const NpzArray> arrays);

}  // namespace rsstab::images

#endif  // RSSTAB_CLI_IMAGES_NPZ_FILE_H_
