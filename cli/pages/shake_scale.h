// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_PAGES_SHAKE_SCALE_H_
#define RSSTAB_CLI_PAGES_SHAKE_SCALE_H_

#include <Eigen/Core>
#include <optional>

namespace rsstab::cli {

// Tells how much each frame of a clip shakes: the change of the picture's motion from the frame
// before. In order.
class ShakeScale {
 public:
  // `step`: ClipMeter::LastStep() of the frame, px at 640 px width. Empty for the first two frames,
  // and where motion could not be measured.
  [[nodiscard]] std::optional<double> Next(const std::optional<Eigen::Vector2d>& step) {
    std::optional<double> shake;
    if (step && last_) {
      shake = (*step - *last_).norm();
    }
    last_ = step;
    return shake;
  }

 private:
  std::optional<Eigen::Vector2d> last_;
};

}  // namespace rsstab::cli

#endif  // RSSTAB_CLI_PAGES_SHAKE_SCALE_H_
