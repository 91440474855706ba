// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_TESTS_EVALUATION_TEST_METHODS_H_
#define RSSTAB_TESTS_EVALUATION_TEST_METHODS_H_

#include <string>
#include <utility>
#include <vector>

#include "evaluation/motion_method.h"
#include "evaluation/spread_coverage.h"
#include "igf/base/seeded_random.h"

namespace rsstab::testing {

// Answers `share` times the true motion, and says that every one of its curves is that.
class ToldMethod final : public evaluation::MotionMethod {
 public:
  explicit ToldMethod(std::string name, double share = 1.0, int curves = 16, double spread = 0.0)
      : name_(std::move(name)), share_(share), curves_(curves), spread_(spread) {}

  [[nodiscard]] std::string Name() const override { return name_; }
  [[nodiscard]] Result<evaluation::MethodAnswer> Estimate(
      const evaluation::MethodInput& input) override {
    evaluation::ReadoutCurve curve = *input.motion;
    curve.strength *= share_;
    auto field = evaluation::TruthField(curve, *input.camera);
    if (!field) {
      return Propagate(field.error());
    }
    evaluation::MethodAnswer answer{std::move(*field), {}};
    SeededRandom random(input.seed);
    for (int i = 0; i < curves_; ++i) {
      answer.curves.push_back(evaluation::BandsOfCurve(curve, 24));
      for (Eigen::Vector3d& value : answer.curves.back()) {
        value += spread_ * Eigen::Vector3d(random.Normal(), random.Normal(), random.Normal());
      }
    }
    return answer;
  }

 private:
  std::string name_;
  double share_;
  int curves_;
  double spread_;
};

}  // namespace rsstab::testing

#endif  // RSSTAB_TESTS_EVALUATION_TEST_METHODS_H_
