// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/rs_motion_residuals.h"

#include <gtest/gtest.h>

#include <functional>
#include <numeric>
#include <random>
#include <vector>

#include "igf/base/rotation.h"

namespace rsstab::stabilizer {
namespace {

constexpr double kInterval = 0.005;
constexpr std::size_t kKnots = 16;
// A central difference of this step is off by its square and by round-off over it.
constexpr double kStep = 1e-6;
constexpr double kRelativeTolerance = 1e-6;

std::vector<Eigen::Quaterniond> Knots(const std::function<Eigen::Vector3d()>& turn) {
  std::vector<Eigen::Quaterniond> knots = {ExpSo3(Eigen::Vector3d(0.3, -0.2, 0.1))};
  while (knots.size() < kKnots) {
    knots.push_back(knots.back() * ExpSo3(turn()));
  }
  return knots;
}

// Parameters of a cost by block, and its residuals at them. Blocks from `first_delta` on are deltas
// of the state's knots.
class CostProbe {
 public:
  CostProbe(SplineState& state, const ceres::CostFunction& cost, std::size_t first_knot,
            std::vector<std::vector<double>> before_knots)
      : state_(state), cost_(cost), own_(std::move(before_knots)) {
    for (std::vector<double>& block : own_) {
      blocks_.push_back(block.data());
    }
    while (blocks_.size() < cost.parameter_block_sizes().size()) {
      blocks_.push_back(state.Delta(first_knot++));
    }
  }

  Eigen::VectorXd Residuals() {
    state_.PrepareForEvaluation(false, true);
    Eigen::VectorXd residuals(cost_.num_residuals());
    EXPECT_TRUE(cost_.Evaluate(blocks_.data(), residuals.data(), nullptr));
    return residuals;
  }

  void ExpectJacobiansAreSlopes() {
    using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    const auto& sizes = cost_.parameter_block_sizes();
    std::vector<RowMajor> jacobians;
    std::vector<double*> pointers;
    for (const int size : sizes) {
      jacobians.emplace_back(cost_.num_residuals(), size);
    }
    for (RowMajor& j : jacobians) {
      pointers.push_back(j.data());
    }
    state_.PrepareForEvaluation(true, true);
    Eigen::VectorXd residuals(cost_.num_residuals());
    ASSERT_TRUE(cost_.Evaluate(blocks_.data(), residuals.data(), pointers.data()));
    for (std::size_t b = 0; b < sizes.size(); ++b) {
      for (int i = 0; i < sizes[b]; ++i) {
        const double value = blocks_[b][i];
        blocks_[b][i] = value + kStep;
        const Eigen::VectorXd more = Residuals();
        blocks_[b][i] = value - kStep;
        const Eigen::VectorXd less = Residuals();
        blocks_[b][i] = value;
        const Eigen::VectorXd slope = (more - less) / (2.0 * kStep);
        EXPECT_LT((jacobians[b].col(i) - slope).norm(), kRelativeTolerance * (1.0 + slope.norm()))
            << "block " << b << ", parameter " << i;
      }
    }
  }

 private:
  SplineState& state_;
  const ceres::CostFunction& cost_;
  std::vector<std::vector<double>> own_;
  std::vector<double*> blocks_;
};

std::vector<std::size_t> AllKnots() {
  std::vector<std::size_t> knots(kKnots);
  std::iota(knots.begin(), knots.end(), std::size_t{0});
  return knots;
}

SplineState RandomState(unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-0.03, 0.03);
  const auto vector = [&] {
    return Eigen::Vector3d(uniform(random), uniform(random), uniform(random));
  };
  SplineState state(0.0, kInterval, Knots(vector));
  for (std::size_t k = 0; k < kKnots; ++k) {
    Eigen::Map<Eigen::Vector3d>(state.Delta(k)) = vector();
  }
  return state;
}

constexpr double kFromS = 3.3 * kInterval;
constexpr double kToS = 9.6 * kInterval;

TEST(RowTimedTrackCost, JacobiansAreSlopes) {
  for (const unsigned seed : {1U, 2U, 3U}) {
    SplineState state = RandomState(seed);
    const TrackCell cell = {{0.3, -0.2}, {0.28, -0.15}, -0.35, -0.25, 1.0};
    const RowTimedTrackCost cost(state, kFromS, kToS, cell, 0.1, AllKnots());
    CostProbe probe(state, cost, 0, {{0.012}, {std::log(0.8)}, {0.01, -0.02, 0.03, 0.005}});
    probe.ExpectJacobiansAreSlopes();
  }
}

TEST(JerkCost, JacobiansAreSlopes) {
  SplineState state = RandomState(4);
  const JerkCost cost(state, 5, 30.0);
  CostProbe probe(state, cost, 5, {});
  probe.ExpectJacobiansAreSlopes();
}

TEST(JerkCost, SteadyAccelerationCostsNothing) {
  Eigen::Vector3d turn(0.01, 0.0, 0.0);
  SplineState state(0.0, kInterval, Knots([&] {
                      turn.x() += 0.001;
                      return turn;
                    }));
  const JerkCost cost(state, 3, 1.0);
  CostProbe probe(state, cost, 3, {});
  EXPECT_LT(probe.Residuals().norm(), 1e-12);
}

// A yaw to the right at 1 rad/s, seen by a sensor that reads from the top: what is low in the
// picture is exposed later, and has moved further left.
TEST(RowTimedTrackCost, YawToTheRightMovesLowRowsFurtherLeft) {
  const double rate = 1.0;
  SplineState state(0.0, kInterval,
                    Knots([&] { return Eigen::Vector3d(0.0, rate * kInterval, 0.0); }));
  constexpr double kReadout = 0.012;
  constexpr double kFocal = 0.8;
  // Both ends at the row they show, an eighth of the picture lower in the second frame.
  constexpr double kFromShare = 0.1;
  constexpr double kToShare = 0.225;
  const double angle = rate * (kToS - kFromS + kReadout * (kToShare - kFromShare));
  const Eigen::Vector2d from(0.02, 0.0);
  const Eigen::Vector2d to(kFocal * std::tan(std::atan(from.x() / kFocal) - angle), 0.0);
  EXPECT_LT(to.x(), from.x());
  const TrackCell cell = {from, to, kFromShare, kToShare, 1.0};
  const RowTimedTrackCost cost(state, kFromS, kToS, cell, 1.0, AllKnots());
  CostProbe probe(state, cost, 0, {{kReadout}, {std::log(kFocal)}, {0.0, 0.0, 0.0, 0.0}});
  EXPECT_LT(probe.Residuals().norm(), 1e-9);
  // Read from the bottom, the same match would be off by twice the readout between the two rows.
  CostProbe reversed(state, cost, 0, {{-kReadout}, {std::log(kFocal)}, {0.0, 0.0, 0.0, 0.0}});
  EXPECT_GT(reversed.Residuals().x(), 1.5 * kFocal * rate * kReadout * (kToShare - kFromShare));
}

TEST(RowTimedTrackCost, ParallaxIsAnAffineMotion) {
  SplineState state(0.0, kInterval, Knots([] { return Eigen::Vector3d(0.0, 0.0, 0.0); }));
  const TrackCell still = {{0.3, -0.2}, {0.3, -0.2}, 0.0, 0.0, 1.0};
  const RowTimedTrackCost cost(state, kFromS, kToS, still, 1.0, AllKnots());
  // zoom, shear, stretch, turn: x' += .01 x + .02 y, y' += .04 x + (.01 + .03) y
  CostProbe probe(state, cost, 0, {{0.0}, {0.0}, {0.01, 0.02, 0.03, 0.04}});
  EXPECT_LT((probe.Residuals() - Eigen::Vector2d(0.003 - 0.004, 0.012 - 0.008)).norm(), 1e-12);
}

TEST(RowTimedTrackCost, ARayBehindTheCameraIsRefused) {
  SplineState state(0.0, kInterval, Knots([] { return Eigen::Vector3d(0.0, 0.5, 0.0); }));
  const TrackCell cell = {{0.3, 0.0}, {0.3, 0.0}, 0.0, 0.0, 1.0};
  const RowTimedTrackCost cost(state, kFromS, kToS, cell, 1.0, AllKnots());
  std::vector<double> readout = {0.0}, focal = {0.0}, parallax(4, 0.0);
  std::vector<double*> blocks = {readout.data(), focal.data(), parallax.data()};
  for (std::size_t k = 0; k < kKnots; ++k) {
    blocks.push_back(state.Delta(k));
  }
  Eigen::Vector2d residuals;
  EXPECT_FALSE(cost.Evaluate(blocks.data(), residuals.data(), nullptr));
}

}  // namespace
}  // namespace rsstab::stabilizer
