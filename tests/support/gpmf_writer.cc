// SPDX-License-Identifier: Apache-2.0
#include "tests/support/gpmf_writer.h"

#include <bit>
#include <cstddef>

namespace rsstab::testing {
namespace {

void AppendBigEndian(std::uint64_t value, int bytes, Bytes* out) {
  for (int shift = 8 * (bytes - 1); shift >= 0; shift -= 8) {
    out->push_back(static_cast<std::uint8_t>(value >> static_cast<unsigned>(shift)));
  }
}

}  // namespace

Bytes KlvRaw(std::string_view key, char type, int row_size, int repeat, const Bytes& value) {
  Bytes out(key.begin(), key.end());
  out.push_back(static_cast<std::uint8_t>(type));
  out.push_back(static_cast<std::uint8_t>(row_size));
  AppendBigEndian(static_cast<std::uint64_t>(repeat), 2, &out);
  out.insert(out.end(), value.begin(), value.end());
  out.resize((out.size() + 3) / 4 * 4, 0);
  return out;
}

Bytes KlvNest(std::string_view key, const std::vector<Bytes>& children, int claimed) {
  const Bytes value = Join(children);
  return KlvRaw(key, '\0', 1, claimed >= 0 ? claimed : static_cast<int>(value.size()), value);
}

Bytes KlvString(std::string_view key, std::string_view text, bool as_one_row) {
  const int size = static_cast<int>(text.size());
  const Bytes value(text.begin(), text.end());
  return as_one_row ? KlvRaw(key, 'c', size, 1, value) : KlvRaw(key, 'c', 1, size, value);
}

Bytes KlvInt16(std::string_view key, const std::vector<int>& values, int columns) {
  Bytes value;
  for (const int v : values) {
    AppendBigEndian(static_cast<std::uint16_t>(v), 2, &value);
  }
  return KlvRaw(key, 's', 2 * columns, static_cast<int>(values.size()) / columns, value);
}

Bytes KlvUint32(std::string_view key, std::uint32_t number) {
  Bytes value;
  AppendBigEndian(number, 4, &value);
  return KlvRaw(key, 'L', 4, 1, value);
}

Bytes KlvUint64(std::string_view key, std::uint64_t number) {
  Bytes value;
  AppendBigEndian(number, 8, &value);
  return KlvRaw(key, 'J', 8, 1, value);
}

Bytes KlvFloats(std::string_view key, const std::vector<float>& values, int columns) {
  Bytes value;
  for (const float v : values) {
    AppendBigEndian(std::bit_cast<std::uint32_t>(v), 4, &value);
  }
  return KlvRaw(key, 'f', 4 * columns, static_cast<int>(values.size()) / columns, value);
}

Bytes Join(const std::vector<Bytes>& parts) {
  Bytes out;
  for (const Bytes& part : parts) {
    out.insert(out.end(), part.begin(), part.end());
  }
  return out;
}

}  // namespace rsstab::testing
