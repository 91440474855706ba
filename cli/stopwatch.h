// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_STOPWATCH_H_
#define RSSTAB_CLI_STOPWATCH_H_

#include <chrono>

namespace rsstab::cli {

// Wall time since it was made.
class Stopwatch {
 public:
  [[nodiscard]] double Seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace rsstab::cli

#endif  // RSSTAB_CLI_STOPWATCH_H_
