// SPDX-License-Identifier: Apache-2.0
#include "cli/images/npz_reader.h"

#include <zip.h>

#include <Eigen/Core>
#include <bit>
#include <charconv>
#include <cstring>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <system_error>

namespace rsstab::images {
namespace {

static_assert(std::endian::native == std::endian::little);

constexpr std::uint64_t kMostBytes = 1ULL << 30U;
constexpr std::size_t kMostAxes = 32;  // NumPy's own limit

struct ArchiveCloser {
  void operator()(zip_t* archive) const { zip_discard(archive); }
};
struct EntryCloser {
  void operator()(zip_file_t* entry) const { zip_fclose(entry); }
};

// What follows `'key':` in a .npy header, up to the end of the header.
std::optional<std::string_view> ValueOf(std::string_view header, std::string_view key) {
  for (const char quote : {'\'', '"'}) {
    const std::string quoted = quote + std::string(key) + quote;
    if (const auto at = header.find(quoted); at != std::string_view::npos) {
      std::string_view rest = header.substr(at + quoted.size());
      rest.remove_prefix(std::min(rest.find_first_not_of(" :"), rest.size()));
      return rest;
    }
  }
  return std::nullopt;
}

// "(2, 600, 800), ..." -> 2, 600, 800
std::optional<std::vector<std::size_t>> ParseShape(std::string_view text) {
  if (text.empty() || text.front() != '(' || text.find(')') == std::string_view::npos) {
    return std::nullopt;
  }
  text = text.substr(1, text.find(')') - 1);
  std::vector<std::size_t> shape;
  while (true) {
    text.remove_prefix(std::min(text.find_first_not_of(" ,"), text.size()));
    if (text.empty()) {
      return shape;
    }
    std::size_t size = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), size);
    if (error != std::errc() || shape.size() == kMostAxes) {
      return std::nullopt;
    }
    text.remove_prefix(static_cast<std::size_t>(end - text.data()));
    text.remove_prefix(!text.empty() && text.front() == 'L' ? 1 : 0);  // Python 2 wrote 600L
    shape.push_back(size);
  }
}

// Number of items; empty when they would not fit.
std::optional<std::size_t> CountOf(std::span<const std::size_t> shape, std::size_t item_size) {
  std::size_t count = 1;
  for (const std::size_t size : shape) {
    if (size != 0 && count > kMostBytes / item_size / size) {
      return std::nullopt;
    }
    count *= size;
  }
  return count;
}

// Reorders items whose FIRST index runs fastest.
void ToCOrder(NpyArray& array) {
  const std::vector<std::uint8_t> source = array.bytes;
  std::vector<std::size_t> index(array.shape.size(), 0);
  const std::size_t count = array.Count();
  for (std::size_t item = 0; item < count; ++item) {
    std::size_t at = 0;
    for (std::size_t axis = array.shape.size(); axis-- > 0;) {
      at = at * array.shape[axis] + index[axis];
    }
    std::memcpy(array.bytes.data() + item * array.item_size, source.data() + at * array.item_size,
                array.item_size);
    for (std::size_t axis = array.shape.size(); axis-- > 0;) {
      if (++index[axis] < array.shape[axis]) {
        break;
      }
      index[axis] = 0;
    }
  }
}

template <typename Number>
std::vector<float> Convert(const NpyArray& array) {
  std::vector<float> values(array.Count());
  for (std::size_t i = 0; i < values.size(); ++i) {
    Number number;
    std::memcpy(&number, array.bytes.data() + i * sizeof(Number), sizeof(Number));
    values[i] = static_cast<float>(number);
  }
  return values;
}

Result<std::string> ReadEntry(zip_t* archive, zip_uint64_t index, const char* name) {
  zip_stat_t facts;
  zip_stat_init(&facts);
  if (zip_stat_index(archive, index, 0, &facts) != 0 || (facts.valid & ZIP_STAT_SIZE) == 0) {
    return Fail(ErrorCode::kCorruptData, "{}: {}", name, zip_strerror(archive));
  }
  if (facts.size > kMostBytes) {
    return Fail(ErrorCode::kUnsupported, "{}: an array of {} bytes is more than 1 GiB", name,
                facts.size);
  }
  const std::unique_ptr<zip_file_t, EntryCloser> entry(zip_fopen_index(archive, index, 0));
  if (!entry) {
    return Fail(ErrorCode::kCorruptData, "{}: {}", name, zip_strerror(archive));
  }
  std::string bytes(facts.size, '\0');
  std::size_t done = 0;
  while (done < bytes.size()) {
    const zip_int64_t got = zip_fread(entry.get(), bytes.data() + done, bytes.size() - done);
    if (got <= 0) {
      return Fail(ErrorCode::kCorruptData, "{}: {}", name,
                  got < 0 ? zip_file_strerror(entry.get()) : "the data end early");
    }
    done += static_cast<std::size_t>(got);
  }
  // The checksum is told when the end is reached.
  char beyond = 0;
  if (zip_fread(entry.get(), &beyond, 1) != 0) {
    return Fail(ErrorCode::kCorruptData, "{}: {}", name, zip_file_strerror(entry.get()));
  }
  return bytes;
}

}  // namespace

Result<NpyArray> ParseNpy(std::string_view file) {
  const auto byte = [&](std::size_t i) {
    return static_cast<std::size_t>(static_cast<unsigned char>(file[i]));
  };
  if (file.size() < 12 || file.substr(0, 6) != "\x93NUMPY" || byte(6) < 1 || byte(6) > 3) {
    return Fail(ErrorCode::kCorruptData, "this is no .npy array of version 1 to 3");
  }
  const bool is_long = byte(6) > 1;
  const std::size_t length =
      byte(8) + (byte(9) << 8U) + (is_long ? (byte(10) << 16U) + (byte(11) << 24U) : 0);
  const std::size_t begin = is_long ? 12 : 10;
  if (length > file.size() - begin) {
    return Fail(ErrorCode::kCorruptData, "the .npy header ends early");
  }
  const std::string_view header = file.substr(begin, length);
  const auto type = ValueOf(header, "descr");
  const auto order = ValueOf(header, "fortran_order");
  const auto sizes = ValueOf(header, "shape");
  auto shape = sizes ? ParseShape(*sizes) : std::nullopt;
  if (!type || !order || !shape) {
    return Fail(ErrorCode::kCorruptData, "the .npy header lacks its type, order or shape");
  }
  NpyArray array;
  array.shape = std::move(*shape);
  // '<f4', '|u1', ..: quote, byte order, kind, size, quote
  const bool is_simple = type->size() >= 5 && (type->front() == '\'' || type->front() == '"') &&
                         (*type)[4] == type->front();
  const std::size_t item_size =
      is_simple ? static_cast<std::size_t>((*type)[3]) - static_cast<std::size_t>('0') : 0;
  if (!is_simple || std::string_view("fuib").find((*type)[2]) == std::string_view::npos ||
      (item_size != 1 && item_size != 2 && item_size != 4 && item_size != 8) ||
      ((*type)[1] == '>' && item_size > 1)) {
    return Fail(ErrorCode::kUnsupported,
                "its type {} is none of little-endian floats, whole numbers or truth values",
                type->substr(0, std::min<std::size_t>(type->find(','), 16)));
  }
  array.kind = (*type)[2];
  array.item_size = item_size;
  const auto count = CountOf(array.shape, item_size);
  const std::string_view data = file.substr(begin + length);
  if (!count || *count * item_size != data.size()) {
    return Fail(ErrorCode::kCorruptData, "its shape does not fit its {} bytes", data.size());
  }
  array.bytes.assign(data.begin(), data.end());
  if (order->substr(0, 4) == "True" && array.shape.size() > 1) {
    ToCOrder(array);
  }
  return array;
}

Result<std::map<std::string, NpyArray>> ReadNpz(const std::string& path) {
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) {
    return Fail(ErrorCode::kNotFound, "{}: there is no such file", path);
  }
  int code = 0;
  const std::unique_ptr<zip_t, ArchiveCloser> archive(zip_open(path.c_str(), ZIP_RDONLY, &code));
  if (!archive) {
    zip_error_t error;
    zip_error_init_with_code(&error, code);
    const std::string reason = zip_error_strerror(&error);
    zip_error_fini(&error);
    return Fail(
        code == ZIP_ER_NOZIP || code == ZIP_ER_INCONS ? ErrorCode::kCorruptData : ErrorCode::kIo,
        "{}: {}", path, reason);
  }
  std::map<std::string, NpyArray> arrays;
  const zip_int64_t entries = zip_get_num_entries(archive.get(), 0);
  for (zip_int64_t i = 0; i < entries; ++i) {
    const auto index = static_cast<zip_uint64_t>(i);
    const char* stored = zip_get_name(archive.get(), index, 0);
    std::string name = stored != nullptr ? stored : "";
    constexpr std::string_view kEnding = ".npy";
    if (!name.ends_with(kEnding)) {
      continue;
    }
    const auto bytes = ReadEntry(archive.get(), index, name.c_str());
    if (!bytes) {
      return Propagate(bytes.error(), path);
    }
    name.resize(name.size() - kEnding.size());
    auto array = ParseNpy(*bytes);
    if (!array) {
      return Propagate(array.error(), path + ": array " + name);
    }
    arrays.emplace(std::move(name), std::move(*array));
  }
  return arrays;
}

Result<std::vector<float>> ToFloats(const NpyArray& array) {
  const auto is = [&](char kind, std::size_t size) {
    return array.kind == kind && array.item_size == size;
  };
  if (is('f', 4)) {
    return Convert<float>(array);
  }
  if (is('f', 8)) {
    return Convert<double>(array);
  }
  if (is('f', 2)) {
    return Convert<Eigen::half>(array);
  }
  if (is('u', 1) || is('b', 1)) {
    return Convert<std::uint8_t>(array);
  }
  if (is('u', 2)) {
    return Convert<std::uint16_t>(array);
  }
  if (is('i', 1)) {
    return Convert<std::int8_t>(array);
  }
  if (is('i', 2)) {
    return Convert<std::int16_t>(array);
  }
  if (is('i', 4)) {
    return Convert<std::int32_t>(array);
  }
  if (is('u', 4)) {
    return Convert<std::uint32_t>(array);
  }
  return Fail(ErrorCode::kUnsupported, "values of type {}{} are not read as numbers", array.kind,
              array.item_size);
}

}  // namespace rsstab::images
