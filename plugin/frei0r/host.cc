// SPDX-License-Identifier: Apache-2.0
#include "plugin/frei0r/host.h"

#include <dlfcn.h>

#include <memory>
#include <string_view>

namespace rsstab::frei0r {
namespace {

constexpr std::size_t kBytesPerPixel = 4;

constexpr std::uint32_t Version(std::uint32_t major, std::uint32_t minor) {
  return major << 16 | minor << 8;
}
// FFmpeg 5.1 (8.44) allocates rows of a multiple of 16 pixels and does not tell the plugin; 7.0
// (10.1) packs them.
constexpr std::uint32_t kFirstPadded = Version(8, 44);
constexpr std::uint32_t kFirstPacked = Version(9, 0);
// FFmpeg 7.1 (10.4) still passes milliseconds, 8.1 (11.14) seconds.
constexpr std::uint32_t kLastMilliseconds = Version(11, 0);
constexpr unsigned kPaddedTo = 16;

struct CloseModule {
  void operator()(void* module) const { dlclose(module); }
};

std::string_view FileName(std::string_view path) {
  const std::size_t slash = path.rfind('/');
  return slash == std::string_view::npos ? path : path.substr(slash + 1);
}

}  // namespace

HostTraits TraitsOf(std::optional<std::uint32_t> avfilter_version, bool is_program) {
  HostTraits host;
  if (!avfilter_version) {
    host.time_unit = is_program ? TimeUnit::kUnknown : TimeUnit::kSeconds;
    return host;
  }
  host.time_unit =
      *avfilter_version < kLastMilliseconds ? TimeUnit::kMilliseconds : TimeUnit::kUnknown;
  if (*avfilter_version >= kFirstPadded && *avfilter_version < kFirstPacked) {
    host.row_alignment_px = kPaddedTo;
  }
  return host;
}

HostTraits TraitsOfCaller(const void* return_address) {
  Dl_info caller{};
  if (dladdr(return_address, &caller) == 0 || caller.dli_fname == nullptr) {
    return {};
  }
  const std::string_view name = FileName(caller.dli_fname);
  std::optional<std::uint32_t> version;
  if (name.starts_with("libavfilter")) {
    const std::unique_ptr<void, CloseModule> module(
        dlopen(caller.dli_fname, RTLD_LAZY | RTLD_NOLOAD));
    if (module) {
      using VersionFunction = unsigned (*)();
      const auto function =
          reinterpret_cast<VersionFunction>(dlsym(module.get(), "avfilter_version"));
      if (function != nullptr) {
        version = function();
      }
    }
  }
  return TraitsOf(version, name.find(".so") == std::string_view::npos);
}

std::ptrdiff_t RowBytes(const HostTraits& host, unsigned width) {
  const std::size_t alignment = host.row_alignment_px;
  return static_cast<std::ptrdiff_t>((width + alignment - 1) / alignment * alignment *
                                     kBytesPerPixel);
}

}  // namespace rsstab::frei0r
