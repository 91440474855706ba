// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_TESTS_SUPPORT_GAUSSIAN_DENOISER_H_
#define RSSTAB_TESTS_SUPPORT_GAUSSIAN_DENOISER_H_

#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "rsdiff/ddim_sampler.h"
#include "rsdiff/denoiser.h"
#include "rsdiff/noise_schedule.h"

namespace rsstab::testing {

// The perfect network for data whose elements are independent Gaussians: mean m_i (zero without the
// image) and one deviation s. With a = sqrt(signal), the best guess of x0 is
//   E[x0 | x_t] = m + a s^2 / (a^2 s^2 + 1 - a^2) (x_t - a m).
class GaussianDenoiser final : public rsdiff::Denoiser {
 public:
  GaussianDenoiser(rsdiff::NoiseSchedule schedule, rsdiff::Objective objective,
                   const rsdiff::Shape& state, const rsdiff::Shape& condition,
                   std::vector<double> mean, double deviation)
      : schedule_(std::move(schedule)),
        objective_(objective),
        state_(state),
        condition_(condition),
        mean_(std::move(mean)),
        deviation_(deviation) {}

  [[nodiscard]] rsdiff::Shape StateShape() const override { return state_; }
  [[nodiscard]] rsdiff::Shape ConditionShape() const override { return condition_; }
  [[nodiscard]] Status Encode(const rsdiff::Tensor& condition) override {
    (void)condition;
    return {};
  }
  [[nodiscard]] Result<rsdiff::Tensor> Predict(const rsdiff::Tensor& states, int t,
                                               rsdiff::Conditioning conditioning) override {
    const bool with_image = conditioning == rsdiff::Conditioning::kWithImage;
    const double a = std::sqrt(schedule_.Signal(t));
    const double s = std::sqrt(1.0 - schedule_.Signal(t));
    const double gain = a * deviation_ * deviation_ / (a * a * deviation_ * deviation_ + s * s);
    rsdiff::Tensor prediction = states;
    for (std::size_t i = 0; i < states.values.size(); ++i) {
      const double m = with_image ? mean_[i % mean_.size()] : 0.0;
      const auto x = static_cast<double>(states.values[i]);
      const double x0 = m + gain * (x - a * m);
      const double noise = (x - a * x0) / s;
      const double v = a * noise - s * x0;
      prediction.values[i] = static_cast<float>(objective_ == rsdiff::Objective::kX0      ? x0
                                                : objective_ == rsdiff::Objective::kNoise ? noise
                                                                                          : v);
    }
    return prediction;
  }

 private:
  rsdiff::NoiseSchedule schedule_;
  rsdiff::Objective objective_;
  rsdiff::Shape state_;
  rsdiff::Shape condition_;
  std::vector<double> mean_;  // one per element of a state
  double deviation_;
};

}  // namespace rsstab::testing

#endif  // RSSTAB_TESTS_SUPPORT_GAUSSIAN_DENOISER_H_
