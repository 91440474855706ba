// SPDX-License-Identifier: Apache-2.0
#include "cli/images/flo_file.h"

#include <bit>
#include <cstdint>
#include <ostream>
#include <vector>

namespace rsstab::images {
namespace {

template <typename Value>
void Put(const Value* values, std::size_t count, std::ostream& out) {
  static_assert(std::endian::native == std::endian::little);
  out.write(reinterpret_cast<const char*>(values),
            static_cast<std::streamsize>(count * sizeof(Value)));
}

}  // namespace

void WriteFlo(const MotionField& field, std::ostream& out) {
  out << "PIEH";
  const std::int32_t size[] = {field.width(), field.height()};
  Put(size, 2, out);
  std::vector<Eigen::Vector2f> row(static_cast<std::size_t>(field.width()));
  for (int y = 0; y < field.height() && out; ++y) {
    for (int x = 0; x < field.width(); ++x) {
      row[static_cast<std::size_t>(x)] = field.Sample({x, y}).cast<float>();
    }
    Put(row.data(), row.size(), out);
  }
}

}  // namespace rsstab::images
