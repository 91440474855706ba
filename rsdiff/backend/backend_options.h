// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_RSDIFF_BACKEND_BACKEND_OPTIONS_H_
#define RSSTAB_RSDIFF_BACKEND_BACKEND_OPTIONS_H_

#include <string>

namespace rsstab::rsdiff {

// Where a network runs.
struct BackendOptions {
  // "cpu" always works. "cuda", "opencl", "openvino" where the network library has them.
  std::string device = "cpu";
};

}  // namespace rsstab::rsdiff

#endif  // RSSTAB_RSDIFF_BACKEND_BACKEND_OPTIONS_H_
