// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_RSDIFF_BACKEND_BACKEND_OPTIONS_H_
#define RSSTAB_RSDIFF_BACKEND_BACKEND_OPTIONS_H_

#include <array>
#include <string>

namespace rsstab::rsdiff {

// Names of the places where a network may run.
inline constexpr std::array<const char*, 5> kDeviceNames = {"auto", "cpu", "cuda", "opencl",
                                                            "openvino"};

// Where a network runs.
struct BackendOptions {
  // One of kDeviceNames. "cpu" always works, the named others where the network library has them.
  // "auto" is CUDA for libtorch where it has it (those networks are big), else the CPU.
  std::string device = "auto";
  // On the CPU, libtorch only: its threads, 0 = as it likes. OpenCV has one number per process,
  // cv::setNumThreads.
  int num_threads = 0;
};

}  // namespace rsstab::rsdiff

#endif  // RSSTAB_RSDIFF_BACKEND_BACKEND_OPTIONS_H_
