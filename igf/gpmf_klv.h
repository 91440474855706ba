// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_IGF_GPMF_KLV_H_
#define RSSTAB_IGF_GPMF_KLV_H_

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace rsstab::igf {

// One key-length-value item of a GPMF stream (github.com/gopro/gpmf-parser, "KLV design"): a four
// character key, a type letter, the size of one structure and how many follow; big-endian, padded
// to four bytes. The views live as long as the bytes they were read from.
struct KlvItem {
  std::string_view key;
  char type = 0;                        // 0: the value is a list of items itself
  std::size_t row_size = 0;             // bytes of one structure, 0..255
  std::size_t claimed = 0;              // bytes of the value as stated, without padding
  std::span<const std::uint8_t> value;  // what is there of it: shorter when the bytes end early

  [[nodiscard]] bool is_container() const { return type == 0; }
  [[nodiscard]] bool is_whole() const { return value.size() == claimed; }
  // Header, value and padding.
  [[nodiscard]] std::size_t stored_size() const { return 8 + (claimed + 3) / 4 * 4; }
};

// Reads the item at `offset`. Empty at the end of the bytes and where no item can start (a key that
// is not four printable letters).
[[nodiscard]] std::optional<KlvItem> ReadKlv(std::span<const std::uint8_t> bytes,
                                             std::size_t offset);

// Numbers of an item, row by row.
struct KlvTable {
  std::size_t columns = 0;
  std::vector<double> values;  // whole rows only

  [[nodiscard]] std::size_t rows() const { return columns == 0 ? 0 : values.size() / columns; }
};

// The item's value as numbers. `type_definition` is the TYPE string that describes a value of type
// '?' ("Lffff", "f[8]L"). Empty when the type is not numeric or does not fit the structure size; an
// item without rows gives a table without rows.
[[nodiscard]] std::optional<KlvTable> KlvNumbers(const KlvItem& item,
                                                 std::string_view type_definition = {});

// The item's value as text: N x 1 or 1 x N bytes, up to the first NUL, printable characters only.
[[nodiscard]] std::string KlvText(const KlvItem& item);

}  // namespace rsstab::igf

#endif  // RSSTAB_IGF_GPMF_KLV_H_
