// SPDX-License-Identifier: Apache-2.0
#include "igf/gpmf_klv.h"

#include <algorithm>
#include <bit>

namespace rsstab::igf {
namespace {

constexpr std::size_t kHeaderSize = 8;
constexpr std::size_t kMaxRowSize = 255;  // the size field has one byte

bool IsPrintable(std::uint8_t byte) { return byte >= 0x20 && byte < 0x7f; }

// Bytes of one number of a type letter; 0 when it is not a number.
std::size_t NumberSize(char type) {
  switch (type) {
    case 'b':
    case 'B':
      return 1;
    case 's':
    case 'S':
      return 2;
    case 'l':
    case 'L':
    case 'f':
    case 'q':
      return 4;
    case 'd':
    case 'j':
    case 'J':
    case 'Q':
      return 8;
    default:
      return 0;
  }
}

// Big-endian number of `type` at `data`, which holds NumberSize(type) bytes.
double Number(char type, const std::uint8_t* data) {
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < NumberSize(type); ++i) {
    bits = (bits << 8U) | data[i];
  }
  constexpr double kQ16 = 65536.0;
  constexpr double kQ32 = 4294967296.0;
  switch (type) {
    case 'b':
      return static_cast<std::int8_t>(static_cast<std::uint8_t>(bits));
    case 's':
      return static_cast<std::int16_t>(static_cast<std::uint16_t>(bits));
    case 'l':
      return static_cast<std::int32_t>(static_cast<std::uint32_t>(bits));
    case 'j':
      return static_cast<double>(static_cast<std::int64_t>(bits));
    case 'f':
      return static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(bits)));
    case 'd':
      return std::bit_cast<double>(bits);
    case 'q':
      return static_cast<std::int32_t>(static_cast<std::uint32_t>(bits)) / kQ16;
    case 'Q':
      return static_cast<double>(static_cast<std::int64_t>(bits)) / kQ32;
    default:
      return static_cast<double>(bits);
  }
}

// "f[3]L" -> "fffL". Empty when malformed or longer than a structure can be.
std::string ExpandType(std::string_view definition) {
  std::string types;
  for (std::size_t i = 0; i < definition.size() && definition[i] != '\0'; ++i) {
    if (definition[i] != '[') {
      types += definition[i];
      continue;
    }
    std::size_t repeat = 0;
    for (++i; i < definition.size() && definition[i] >= '0' && definition[i] <= '9'; ++i) {
      repeat = std::min(repeat * 10 + static_cast<std::size_t>(definition[i] - '0'), kMaxRowSize);
    }
    if (i >= definition.size() || definition[i] != ']' || repeat == 0 || types.empty()) {
      return {};
    }
    types.append(repeat - 1, types.back());
    if (types.size() > kMaxRowSize) {
      return {};
    }
  }
  return types;
}

}  // namespace

std::optional<KlvItem> ReadKlv(std::span<const std::uint8_t> bytes, std::size_t offset) {
  if (offset > bytes.size() || bytes.size() - offset < kHeaderSize) {
    return std::nullopt;
  }
  const std::span<const std::uint8_t> header = bytes.subspan(offset, kHeaderSize);
  if (!std::all_of(header.begin(), header.begin() + 4, IsPrintable)) {
    return std::nullopt;
  }
  KlvItem item;
  item.key = {reinterpret_cast<const char*>(header.data()), 4};
  item.type = static_cast<char>(header[4]);
  item.row_size = header[5];
  item.claimed = item.row_size * (static_cast<std::size_t>(header[6]) << 8U | header[7]);
  const std::size_t available = bytes.size() - offset - kHeaderSize;
  item.value = bytes.subspan(offset + kHeaderSize, std::min(item.claimed, available));
  return item;
}

std::optional<KlvTable> KlvNumbers(const KlvItem& item, std::string_view type_definition) {
  if (item.is_container()) {
    return std::nullopt;
  }
  std::string types;
  if (item.type == '?') {
    types = ExpandType(type_definition);
  } else if (const std::size_t size = NumberSize(item.type); size > 0) {
    types.assign(item.row_size / size, item.type);
  }
  std::size_t row_size = 0;
  for (const char type : types) {
    const std::size_t size = NumberSize(type);
    if (size == 0) {
      return std::nullopt;
    }
    row_size += size;
  }
  if (row_size == 0 || row_size != item.row_size) {
    return std::nullopt;
  }
  KlvTable table;
  table.columns = types.size();
  const std::size_t rows = item.value.size() / row_size;
  table.values.reserve(rows * table.columns);
  const std::uint8_t* data = item.value.data();
  for (std::size_t row = 0; row < rows; ++row) {
    for (const char type : types) {
      table.values.push_back(Number(type, data));
      data += NumberSize(type);
    }
  }
  return table;
}

std::string KlvText(const KlvItem& item) {
  std::string text;
  for (const std::uint8_t byte : item.value) {
    if (byte == 0) {
      break;
    }
    if (IsPrintable(byte)) {
      text += static_cast<char>(byte);
    }
  }
  return text;
}

}  // namespace rsstab::igf
