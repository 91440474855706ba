// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_PLUGIN_FREI0R_HOST_H_
#define RSSTAB_PLUGIN_FREI0R_HOST_H_

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

namespace rsstab::frei0r {

// frei0r.h asks for seconds. libavfilter hands over milliseconds up to FFmpeg 7.1.
enum class TimeUnit {
  kSeconds,
  kMilliseconds,
  kUnknown,  // the steps between frames have to tell (host_clock.h)
};

// Where a host departs from frei0r.h.
struct HostTraits {
  TimeUnit time_unit = TimeUnit::kSeconds;
  // Rows are this many pixels apart, rounded up; 1 as frei0r.h says.
  unsigned row_alignment_px = 1;
};

// What is known about the module that a call came from. `avfilter_version`: what avfilter_version()
// of that module answers, major << 16 | minor << 8 | micro; empty when it is not libavfilter.
// `is_program`: it is the program itself and no shared library, as in a static build of FFmpeg.
[[nodiscard]] HostTraits TraitsOf(std::optional<std::uint32_t> avfilter_version, bool is_program);

// The same for the caller whose return address this is. Any thread.
[[nodiscard]] HostTraits TraitsOfCaller(const void* return_address);

// Bytes from one row of a picture to the next.
[[nodiscard]] std::ptrdiff_t RowBytes(const HostTraits& host, unsigned width);

}  // namespace rsstab::frei0r

#endif  // RSSTAB_PLUGIN_FREI0R_HOST_H_
