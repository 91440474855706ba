// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_TESTS_SUPPORT_GPMF_WRITER_H_
#define RSSTAB_TESTS_SUPPORT_GPMF_WRITER_H_

#include <cstdint>
#include <string_view>
#include <vector>

namespace rsstab::testing {

using Bytes = std::vector<std::uint8_t>;

// Builds GPMF items (key, type, structure size, repeat, padded value) as a camera would, and as a
// broken one would: nothing is checked.
[[nodiscard]] Bytes KlvRaw(std::string_view key, char type, int row_size, int repeat,
                           const Bytes& value);

// Container; its length is right unless `claimed` (bytes) says otherwise.
[[nodiscard]] Bytes KlvNest(std::string_view key, const std::vector<Bytes>& children,
                            int claimed = -1);

[[nodiscard]] Bytes KlvString(std::string_view key, std::string_view text, bool as_one_row = false);
// Big-endian numbers, `columns` to a row.
[[nodiscard]] Bytes KlvInt16(std::string_view key, const std::vector<int>& values, int columns = 1);
[[nodiscard]] Bytes KlvUint32(std::string_view key, std::uint32_t value);
[[nodiscard]] Bytes KlvUint64(std::string_view key, std::uint64_t value);
[[nodiscard]] Bytes KlvFloats(std::string_view key, const std::vector<float>& values,
                              int columns = 1);

[[nodiscard]] Bytes Join(const std::vector<Bytes>& parts);

}  // namespace rsstab::testing

#endif  // RSSTAB_TESTS_SUPPORT_GPMF_WRITER_H_
