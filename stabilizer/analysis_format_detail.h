// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_STABILIZER_ANALYSIS_FORMAT_DETAIL_H_
#define RSSTAB_STABILIZER_ANALYSIS_FORMAT_DETAIL_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>

#include "stabilizer/analysis_file.h"
#include "stabilizer/byte_stream.h"

// What writer and reader of the analysis file share; docs/analysis-file.md tells every byte.
namespace rsstab::stabilizer::detail {

inline constexpr std::array<char, 8> kMagic = {'R', 'S', 'S', 'T', 'A', 'B', 'A', 'N'};
inline constexpr std::array<char, 8> kEndMagic = {'R', 'S', 'S', 'T', 'A', 'B', 'E', 'N'};
inline constexpr std::uint32_t kVersion = 1;
inline constexpr std::size_t kHeaderSize = kMagic.size() + sizeof(std::uint32_t);
// summary offset, summary size, summary CRC, number of records, CRC of the footer so far, end magic
inline constexpr std::size_t kFooterSize = 8 + 8 + 4 + 8 + 4 + kEndMagic.size();

struct FileCloser {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using FileHandle = std::unique_ptr<std::FILE, FileCloser>;

[[nodiscard]] std::uint32_t Checksum(std::span<const std::uint8_t> bytes);
// Text of errno.
[[nodiscard]] std::string LastError();

void PutField(ByteSink& sink, const MotionField& field);
// Empty when the bytes make no sense.
[[nodiscard]] std::optional<MotionField> GetField(ByteSource& source, int width, int height);

// What a record may hold beyond its fields: parts with a number and a length, so that a reader
// skips those that it does not know.
void PutOptionalParts(ByteSink& sink, const FrameAnalysis& frame);
// Takes all that is left. False when the bytes make no sense.
[[nodiscard]] bool GetOptionalParts(ByteSource& source, FrameAnalysis& frame);

[[nodiscard]] nlohmann::json ToJson(const ClipAnalysis& clip);
// Throws nlohmann::json::exception on a missing key or a wrong type.
[[nodiscard]] ClipAnalysis FromJson(const nlohmann::json& json);

}  // namespace rsstab::stabilizer::detail

#endif  // RSSTAB_STABILIZER_ANALYSIS_FORMAT_DETAIL_H_
