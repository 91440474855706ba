// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_STABILIZER_BYTE_STREAM_H_
#define RSSTAB_STABILIZER_BYTE_STREAM_H_

#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

namespace rsstab::stabilizer {

static_assert(std::endian::native == std::endian::little,
              "the analysis file is little-endian; a big-endian machine needs byte swaps here");

template <typename T>
concept Scalar = std::integral<T> || std::floating_point<T>;

// Appends numbers to bytes, little-endian, unaligned.
class ByteSink {
 public:
  template <Scalar T>
  void Put(T value) {
    const auto* raw = reinterpret_cast<const std::uint8_t*>(&value);
    Put(std::span(raw, sizeof(T)));
  }
  void Put(std::span<const std::uint8_t> raw) {
    // One by one: GCC 12 sees overflows in insert() and copy() that are not there.
    for (const std::uint8_t byte : raw) {
      bytes_.push_back(byte);
    }
  }
  [[nodiscard]] std::span<const std::uint8_t> bytes() const { return bytes_; }
  void Clear() { bytes_.clear(); }

 private:
  std::vector<std::uint8_t> bytes_;
};

// Takes them out again. Reading past the end gives zeros and turns ok() false for good.
class ByteSource {
 public:
  explicit ByteSource(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}
  template <Scalar T>
  [[nodiscard]] T Get() {
    T value{};
    if (bytes_.size() - position_ < sizeof(T)) {
      ok_ = false;
      return value;
    }
    std::memcpy(&value, bytes_.data() + position_, sizeof(T));
    position_ += sizeof(T);
    return value;
  }
  void Skip(std::size_t size) {
    ok_ = ok_ && size <= remaining();
    position_ += ok_ ? size : 0;
  }
  [[nodiscard]] bool ok() const { return ok_; }
  [[nodiscard]] std::size_t remaining() const { return bytes_.size() - position_; }

 private:
  std::span<const std::uint8_t> bytes_;
  std::size_t position_ = 0;
  bool ok_ = true;
};

}  // namespace rsstab::stabilizer

#endif  // RSSTAB_STABILIZER_BYTE_STREAM_H_
