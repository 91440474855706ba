// SPDX-License-Identifier: Apache-2.0
#include "cli/images/npz_file.h"

#include <zip.h>

#include <bit>
#include <functional>
#include <memory>
#include <numeric>
#include <string_view>

namespace rsstab::images {
namespace {

// The earliest time that a ZIP can tell: when a file was made is not its content.
constexpr std::uint16_t kDosTime = 0;
constexpr std::uint16_t kDosDate = (1U << 5U) | 1U;  // 1 January 1980

// Discards what was added and not written.
struct ArchiveDiscarder {
  void operator()(zip_t* archive) const { zip_discard(archive); }
};
using Archive = std::unique_ptr<zip_t, ArchiveDiscarder>;

struct SourceReleaser {
  void operator()(zip_source_t* source) const { zip_source_free(source); }
};
using Source = std::unique_ptr<zip_source_t, SourceReleaser>;

// Version 1.0 of the .npy format: magic, version, length of the rest, a Python dictionary filled up
// with spaces so that the numbers begin at a multiple of 64 bytes.
std::string NpyHeader(const char* type, const std::vector<std::size_t>& shape) {
  static_assert(std::endian::native == std::endian::little);
  std::string sizes;
  for (const std::size_t size : shape) {
    sizes += (sizes.empty() ? "" : ", ") + std::to_string(size);
  }
  sizes += shape.size() == 1 ? "," : "";  // else Python takes the brackets for arithmetic
  std::string dictionary =
      std::string("{'descr': '") + type + "', 'fortran_order': False, 'shape': (" + sizes + "), }";
  constexpr std::size_t kPrefix = 10;
  constexpr std::size_t kAlignment = 64;
  const std::size_t unpadded = kPrefix + dictionary.size() + 1;
  dictionary.append((kAlignment - unpadded % kAlignment) % kAlignment, ' ');
  dictionary += '\n';
  std::string header("\x93NUMPY\x01\x00", 8);
  header += static_cast<char>(dictionary.size() % 256);
  header += static_cast<char>(dictionary.size() / 256);
  return header + dictionary;
}

struct Content {
  const char* type;
  std::size_t count;
  std::span<const std::byte> bytes;
};

Content ContentOf(const NpzArray& array) {
  if (const auto* floats = std::get_if<std::span<const float>>(&array.values)) {
    return {"<f4", floats->size(), std::as_bytes(*floats)};
  }
  const auto& bytes = std::get<std::span<const std::uint8_t>>(array.values);
  return {"|u1", bytes.size(), std::as_bytes(bytes)};
}

Status CheckShape(const NpzArray& array, std::size_t values) {
  const std::size_t count =
      std::accumulate(array.shape.begin(), array.shape.end(), std::size_t{1}, std::multiplies<>());
  if (count == values) {
    return {};
  }
  return Fail(ErrorCode::kInvalidArgument, "array {}: its shape is for {} values, not for {}",
              array.name, count, values);
}

// `bytes` must live until the archive is closed.
Status AddEntry(zip_t* archive, const std::string& path, const NpzArray& array,
                const zip_buffer_fragment_t* parts, std::size_t count) {
  zip_error_t error;
  zip_error_init(&error);
  Source source(zip_source_buffer_fragment_create(parts, count, 0, &error));
  zip_error_fini(&error);
  if (!source) {
    return Fail(ErrorCode::kIo, "{}: out of memory", path);
  }
  const std::string name = array.name + ".npy";
  const zip_int64_t index = zip_file_add(archive, name.c_str(), source.get(), ZIP_FL_ENC_UTF_8);
  if (index < 0) {
    return Fail(ErrorCode::kIo, "{}: {}", path, zip_strerror(archive));
  }
  (void)source.release();  // the archive owns it now
  const auto entry = static_cast<zip_uint64_t>(index);
  if (zip_set_file_compression(archive, entry, ZIP_CM_STORE, 0) != 0 ||
      zip_file_set_dostime(archive, entry, kDosTime, kDosDate, 0) != 0) {
    return Fail(ErrorCode::kIo, "{}: {}", path, zip_strerror(archive));
  }
  return {};
}

}  // namespace

Status WriteNpz(const std::string& path, std::span<const NpzArray> arrays) {
  int code = 0;
  Archive archive(zip_open(path.c_str(), ZIP_CREATE | ZIP_TRUNCATE, &code));
  if (!archive) {
    zip_error_t error;
    zip_error_init_with_code(&error, code);
    const std::string reason = zip_error_strerror(&error);
    zip_error_fini(&error);
    return Fail(ErrorCode::kIo, "{}: {}", path, reason);
  }
  // libzip reads them when the archive is closed.
  std::vector<std::string> headers(arrays.size());
  for (std::size_t i = 0; i < arrays.size(); ++i) {
    const NpzArray& array = arrays[i];
    const Content content = ContentOf(array);
    if (Status status = CheckShape(array, content.count); !status) {
      return Propagate(std::move(status.error()), path);
    }
    headers[i] = NpyHeader(content.type, array.shape);
    // libzip only reads what it is told not to free, but its fragments are not const.
    const auto* bytes = reinterpret_cast<const zip_uint8_t*>(content.bytes.data());
    const zip_buffer_fragment_t parts[] = {
        {reinterpret_cast<zip_uint8_t*>(headers[i].data()), headers[i].size()},
        {const_cast<zip_uint8_t*>(bytes),  // NOLINT(cppcoreguidelines-pro-type-const-cast)
         content.bytes.size()}};
    if (Status status = AddEntry(archive.get(), path, array, parts, 2); !status) {
      return status;
    }
  }
  // Writes beside the path and renames.
  if (zip_close(archive.get()) != 0) {
    return Fail(ErrorCode::kIo, "{}: {}", path, zip_strerror(archive.get()));
  }
  (void)archive.release();
  return {};
}

}  // namespace rsstab::images
