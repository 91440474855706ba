// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_STAGE_TIMES_H_
#define RSSTAB_CLI_STAGE_TIMES_H_

#include <chrono>
#include <string>
#include <string_view>
#include <vector>

namespace rsstab::cli {

struct StageTime {
  std::string name;
  double seconds = 0.0;  // wall time
};

// How long a command spent on what. One thread.
class StageTimes {
 public:
  // Adds to the stage of that name; stages keep the order in which they first came.
  void Add(std::string_view name, double seconds) {
    for (StageTime& stage : stages_) {
      if (stage.name == name) {
        stage.seconds += seconds;
        return;
      }
    }
    stages_.push_back({std::string(name), seconds});
  }

  // What `work` returns; the time it took counts for the stage.
  template <typename Work>
  auto Measure(std::string_view name, const Work& work) {
    const auto begin = std::chrono::steady_clock::now();
    auto result = work();
    Add(name, std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
    return result;
  }

  [[nodiscard]] const std::vector<StageTime>& stages() const { return stages_; }

 private:
  std::vector<StageTime> stages_;
};

}  // namespace rsstab::cli

#endif  // RSSTAB_CLI_STAGE_TIMES_H_
