// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_RSDIFF_BACKEND_BACKEND_OPTIONS_H_
#define RSSTAB_RSDIFF_BACKEND_BACKEND_OPTIONS_H_

#include <array>
#include <string>

namespace rsstab::rsdiff {

// Names of the places where a network may run.
inline constexpr std::array<const char*, 4> kDeviceNames = {"cpu", "cuda", "opencl", "openvino"};

// Where a network runs.
struct BackendOptions {
  // One of kDeviceNames. "cpu" always works, the others where the network library has them.
  std::string device = "cpu";
};

}  // namespace rsstab::rsdiff

#endif  // RSSTAB_RSDIFF_BACKEND_BACKEND_OPTIONS_H_
