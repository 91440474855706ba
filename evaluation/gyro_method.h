// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_EVALUATION_GYRO_METHOD_H_
#define RSSTAB_EVALUATION_GYRO_METHOD_H_

#include <string>
#include <utility>

#include "evaluation/motion_method.h"

namespace rsstab::evaluation {

// The Intra Gyro Field of the picture's own gyro log, with its calibrated lens and readout time.
class GyroMethod final : public MotionMethod {
 public:
  // `bands` = 0: the exact field (fixed point). Otherwise the paper's one-step form with so many
  // row bands, from the band that holds the reference row.
  GyroMethod(std::string name, int bands) : name_(std::move(name)), bands_(bands) {}

  [[nodiscard]] std::string Name() const override { return name_; }
  // Errors: kUnsupported without a log, a lens or a readout time; kUntrustworthy where the log has
  // a gap; those of igf.
  [[nodiscard]] Result<MethodAnswer> Estimate(const MethodInput& input) override;

 private:
  std::string name_;
  int bands_;
};

// Bands of the one-step form where nothing else is said: a homography for every ten rows of a
// picture of 600.
inline constexpr int kUsualBands = 60;

}  // namespace rsstab::evaluation

#endif  // RSSTAB_EVALUATION_GYRO_METHOD_H_
