// SPDX-License-Identifier: Apache-2.0
#include "cli/images/flo_file.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <ostream>
#include <vector>

#include "igf/base/whole_file.h"

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

Result<NpyArray> ReadFlo(const std::string& path) {
  constexpr std::uint64_t kMostBytes = 1ULL << 30U;
  constexpr std::size_t kHeader = 12;
  constexpr float kUnknown = 1e9F;
  const auto bytes = ReadWholeFile(path, kMostBytes);
  if (!bytes) {
    return Propagate(bytes.error());
  }
  std::int32_t size[2] = {0, 0};
  if (bytes->size() >= kHeader && bytes->starts_with("PIEH")) {
    std::memcpy(size, bytes->data() + 4, sizeof(size));
  }
  const auto pixels = static_cast<std::uint64_t>(std::max(size[0], 0)) *
                      static_cast<std::uint64_t>(std::max(size[1], 0));
  if (pixels == 0 || bytes->size() != kHeader + pixels * 2 * sizeof(float)) {
    return Fail(ErrorCode::kCorruptData, "{}: this is no complete .flo file", path);
  }
  NpyArray array;
  array.shape = {2, static_cast<std::size_t>(size[1]), static_cast<std::size_t>(size[0])};
  array.bytes.resize(bytes->size() - kHeader);
  for (std::size_t i = 0; i < 2 * pixels; ++i) {
    float value = 0.0F;
    std::memcpy(&value, bytes->data() + kHeader + i * sizeof(float), sizeof(float));
    if (!(std::abs(value) < kUnknown)) {
      value = std::numeric_limits<float>::quiet_NaN();
    }
    const std::size_t to = (i % 2) * pixels + i / 2;
    std::memcpy(array.bytes.data() + to * sizeof(float), &value, sizeof(float));
  }
  return array;
}

}  // namespace rsstab::images
