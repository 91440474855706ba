// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_TESTS_SUPPORT_RANDOM_SCENE_H_
#define RSSTAB_TESTS_SUPPORT_RANDOM_SCENE_H_

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <vector>

namespace rsstab::testing {

// A smooth random picture that is defined everywhere, so that it can be looked at from any position
// without interpolation error: a sum of plane waves with periods of 9 to 60 units.
class WaveScene {
 public:
  explicit WaveScene(std::uint32_t seed) {
    std::uint32_t state = seed * 2654435761U + 1U;
    const auto next = [&state] {
      state = state * 1664525U + 1013904223U;
      return static_cast<double>(state >> 8) / static_cast<double>(1U << 24);
    };
    for (int i = 0; i < 24; ++i) {
      const double period = 9.0 + 51.0 * next() * next();
      const double angle = 6.283185307179586 * next();
      const double k = 6.283185307179586 / period;
      waves_.push_back({k * std::cos(angle), k * std::sin(angle), 6.283185307179586 * next()});
    }
  }

  // Brightness in 8-bit levels, about 40 to 215.
  [[nodiscard]] double At(const Eigen::Vector2d& p) const {
    double sum = 0.0;
    for (const Wave& w : waves_) {
      sum += std::sin(w.kx * p.x() + w.ky * p.y() + w.phase);
    }
    return 127.5 + 25.0 * sum / 1.7;
  }

 private:
  struct Wave {
    double kx;
    double ky;
    double phase;
  };
  std::vector<Wave> waves_;
};

}  // namespace rsstab::testing

#endif  // RSSTAB_TESTS_SUPPORT_RANDOM_SCENE_H_
