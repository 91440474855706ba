// SPDX-License-Identifier: Apache-2.0
#include "cli/images/color_profile.h"

#include <zlib.h>

#include <algorithm>
#include <string_view>

namespace rsstab::images {
namespace {

using Bytes = std::vector<std::uint8_t>;

void AppendBigEndian(std::uint32_t value, Bytes& bytes) {
  for (const int shift : {24, 16, 8, 0}) {
    bytes.push_back(static_cast<std::uint8_t>(value >> shift));
  }
}

void Append(std::string_view text, Bytes& bytes) {
  bytes.insert(bytes.end(), text.begin(), text.end());
}

Bytes Deflated(std::span<const std::uint8_t> bytes) {
  uLongf size = compressBound(static_cast<uLong>(bytes.size()));
  Bytes deflated(size);
  // Cannot fail: the buffer is large enough.
  compress(deflated.data(), &size, bytes.data(), static_cast<uLong>(bytes.size()));
  deflated.resize(size);
  return deflated;
}

}  // namespace

void InsertPngProfile(std::span<const std::uint8_t> profile, std::vector<std::uint8_t>& png) {
  constexpr std::size_t kBehindHeader = 33;  // 8 bytes of signature, 25 of IHDR
  if (png.size() < kBehindHeader) {
    return;
  }
  Bytes content;
  Append({"ICC profile\0\0", 13}, content);  // name, end of name, method deflate
  const Bytes deflated = Deflated(profile);
  content.insert(content.end(), deflated.begin(), deflated.end());

  Bytes chunk;
  AppendBigEndian(static_cast<std::uint32_t>(content.size()), chunk);
  Append("iCCP", chunk);
  chunk.insert(chunk.end(), content.begin(), content.end());
  constexpr std::size_t kSizeField = 4;  // not part of the checksum
  AppendBigEndian(static_cast<std::uint32_t>(crc32(0, chunk.data() + kSizeField,
                                                   static_cast<uInt>(chunk.size() - kSizeField))),
                  chunk);

  png.insert(png.begin() + kBehindHeader, chunk.begin(), chunk.end());
}

void RepairWebpProfile(std::span<std::uint8_t> webp) {
  // "RIFF" size "WEBP", then "VP8X" size and 10 bytes, then the profile's chunk.
  constexpr std::size_t kProfileChunk = 12 + 8 + 10;
  constexpr std::string_view kWrong = "VP8X";
  constexpr std::string_view kRight = "ICCP";
  if (webp.size() > kProfileChunk + kWrong.size()) {
    const auto name = webp.subspan(kProfileChunk, kWrong.size());
    if (std::equal(name.begin(), name.end(), kWrong.begin())) {
      std::copy(kRight.begin(), kRight.end(), name.begin());
    }
  }
}

}  // namespace rsstab::images
