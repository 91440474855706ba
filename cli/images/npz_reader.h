// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_IMAGES_NPZ_READER_H_
#define RSSTAB_CLI_IMAGES_NPZ_READER_H_

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "igf/base/result.h"

namespace rsstab::images {

// One array as NumPy stored it, in C order and the machine's byte order.
struct NpyArray {
  char kind = 'f';  // 'f' floating point, 'u' or 'i' whole numbers, 'b' truth values
  std::size_t item_size = 4;
  std::vector<std::size_t> shape;
  std::vector<std::uint8_t> bytes;

  [[nodiscard]] std::size_t Count() const { return bytes.size() / item_size; }
};

// A .npy file in memory: version 1 to 3, little endian or single bytes; arrays in Fortran order are
// turned into C order.
// Errors: kCorruptData for a broken header or a wrong number of bytes; kUnsupported for other
// types (objects, records, complex numbers, big endian).
[[nodiscard]] Result<NpyArray> ParseNpy(std::string_view file);

// The arrays of a .npz file (stored or deflated), by their names without ".npy".
// Errors: kNotFound, kIo; kCorruptData for what is no ZIP or fails its checksum; kUnsupported for
// an array beyond 1 GiB; those of ParseNpy. All name the file.
[[nodiscard]] Result<std::map<std::string, NpyArray>> ReadNpz(const std::string& path);

// An array's values as floats (half, single and double precision, whole numbers up to 32 bits).
// Errors: kUnsupported for another type.
[[nodiscard]] Result<std::vector<float>> ToFloats(const NpyArray& array);

}  // namespace rsstab::images

#endif  // RSSTAB_CLI_IMAGES_NPZ_READER_H_
