// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_RSDIFF_TENSOR_H_
#define RSSTAB_RSDIFF_TENSOR_H_

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace rsstab::rsdiff {

// Size of one picture-like array: channels x rows x columns.
struct Shape {
  int channels = 0;
  int rows = 0;
  int columns = 0;

  [[nodiscard]] std::size_t Count() const {
    return static_cast<std::size_t>(channels) * static_cast<std::size_t>(rows) *
           static_cast<std::size_t>(columns);
  }
  friend bool operator==(const Shape&, const Shape&) = default;
};

// `batch` arrays of one shape, batch x channels x rows x columns, the last index fastest.
struct Tensor {
  int batch = 0;
  Shape shape;
  std::vector<float> values;

  Tensor() = default;
  // All zero.
  Tensor(int batch_size, const Shape& each)
      : batch(batch_size),
        shape(each),
        values(static_cast<std::size_t>(batch_size) * each.Count(), 0.0F) {}

  // The values of one array of the batch.
  [[nodiscard]] std::span<const float> Item(int index) const {
    return std::span(values).subspan(static_cast<std::size_t>(index) * shape.Count(),
                                     shape.Count());
  }
  [[nodiscard]] std::span<float> Item(int index) {
    return std::span(values).subspan(static_cast<std::size_t>(index) * shape.Count(),
                                     shape.Count());
  }
};

}  // namespace rsstab::rsdiff

#endif  // RSSTAB_RSDIFF_TENSOR_H_
