// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_TESTS_CLI_IMAGES_NPZ_READER_H_
#define RSSTAB_TESTS_CLI_IMAGES_NPZ_READER_H_

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

namespace rsstab::testing {

struct NpyContent {
  std::string header;  // the dictionary
  std::vector<float> values;
};

// Reads a .npz of stored (not compressed) float arrays by the published layout of ZIP and .npy;
// knows nothing of the writer. Throws std::runtime_error.
[[nodiscard]] inline std::map<std::string, NpyContent> ReadNpz(const std::string& bytes) {
  const auto number = [&bytes](std::size_t at, int size) {
    std::uint64_t value = 0;
    for (int i = size - 1; i >= 0; --i) {
      value = value << 8U | static_cast<unsigned char>(bytes.at(at + static_cast<std::size_t>(i)));
    }
    return static_cast<std::size_t>(value);
  };
  const auto check = [](bool good, const char* what) {
    if (!good) {
      throw std::runtime_error(what);
    }
  };
  const std::size_t end = bytes.rfind("PK\x05\x06");
  check(end != std::string::npos, "no end of a ZIP directory");
  const std::size_t entries = number(end + 10, 2);
  std::size_t at = number(end + 16, 4);
  std::map<std::string, NpyContent> arrays;
  for (std::size_t i = 0; i < entries; ++i) {
    check(bytes.compare(at, 4, "PK\x01\x02") == 0, "no directory entry");
    check(number(at + 10, 2) == 0, "an entry is compressed");
    const std::size_t size = number(at + 24, 4);
    const std::size_t name_size = number(at + 28, 2);
    const std::string name = bytes.substr(at + 46, name_size);
    const std::size_t local = number(at + 42, 4);
    check(bytes.compare(local, 4, "PK\x03\x04") == 0, "no local header");
    const std::size_t begin = local + 30 + number(local + 26, 2) + number(local + 28, 2);
    const std::string npy = bytes.substr(begin, size);
    check(npy.compare(0, 8, std::string("\x93NUMPY\x01\x00", 8)) == 0, "no .npy");
    const std::size_t header_size = number(begin + 8, 2);
    check((10 + header_size) % 64 == 0, "the numbers are not aligned");
    NpyContent content;
    content.header = npy.substr(10, header_size);
    content.values.resize((npy.size() - 10 - header_size) / sizeof(float));
    std::memcpy(content.values.data(), npy.data() + 10 + header_size,
                content.values.size() * sizeof(float));
    arrays[name] = content;
    at += 46 + name_size + number(at + 30, 2) + number(at + 32, 2);
  }
  return arrays;
}

}  // namespace rsstab::testing

#endif  // RSSTAB_TESTS_CLI_IMAGES_NPZ_READER_H_
