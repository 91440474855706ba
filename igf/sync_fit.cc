// SPDX-License-Identifier: Apache-2.0
#include "igf/sync_fit.h"

#include <ceres/autodiff_cost_function.h>
#include <ceres/crs_matrix.h>
#include <ceres/loss_function.h>
#include <ceres/ordered_groups.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <vector>

#include "igf/sync_covariance.h"
#include "igf/sync_residuals.h"

namespace rsstab::igf {
namespace {

// Parameters in one array: offset, bias, logarithm of the focal ratio, curvature, readout.
enum Block : std::size_t { kOffset, kBias, kLogFocal, kCurvature, kReadout, kBlocks };
constexpr std::array<std::size_t, kBlocks> kBlockStart = {0, 1, 4, 5, 6};
constexpr std::array<int, kBlocks> kBlockSize = {1, 3, 1, 1, 1};
constexpr std::size_t kParameters = 7;

// Weak priors: what holds for cameras at large, one standard deviation.
constexpr double kBiasSigma_rad_s = 0.03;  // 1.7 deg/s
// A moving camera's parallax looks like a bias: its prior must hold against all matches together.
constexpr double kBiasPriorPerMatch_px2 = 0.003;
constexpr double kLogFocalSigma = 0.4;
constexpr double kReadoutPriorFrames = 0.5;
constexpr double kReadoutSigmaFrames = 0.5;
constexpr double kMaxLogFocal = 1.1;  // a factor of 3
constexpr double kCurvatureSigma = 0.3;
constexpr double kMinCurvature = -0.6;  // beyond any fisheye's
constexpr double kMaxCurvature = 0.05;

// First round: far enough to pull the start in; second round: against outliers.
constexpr double kFirstLossScale_px = 4.0;
constexpr double kMinLossScale_px = 0.3;
constexpr double kLossScaleSigmas = 2.5;
constexpr double kSigmaPerMedian = 1.4826 / 1.414;  // median length of a 2-D error -> per axis
// Drifts: one for every cell of the picture and window of time. Worth so many matches' doubt, and
// free to grow once they exceed the loss scale: far scenery has none, near ground has a lot.
constexpr double kDriftCells = 4.0;
constexpr double kDriftWindow_s = 1.0;
constexpr double kDriftPriorMatches = 12.0;
constexpr double kDriftLossScale_px = 0.2;

// So many pairs in a row may err alike.
constexpr std::size_t kErrorLag = 5;
// More motion than this says no more about the fit (a cut, for one, has any).
constexpr double kMaxPairMotion_px = 10.0;

using TrackCost =
    ceres::AutoDiffCostFunction<SyncTrackResidual, SyncTrackResidual::kResiduals, 1, 3, 1, 1, 1, 2>;

std::array<double, kParameters> Pack(const SyncState& state) {
  return {state.offset_s,  state.bias_rad_s.x(), state.bias_rad_s.y(), state.bias_rad_s.z(),
          state.log_focal, state.curvature,      state.readout_s};
}
SyncState Unpack(const std::array<double, kParameters>& p) {
  return {p[0], {p[1], p[2], p[3]}, p[4], p[5], p[6]};
}

double MedianLength(std::vector<double>& squared) {
  const auto middle = squared.begin() + static_cast<std::ptrdiff_t>(squared.size() / 2);
  std::nth_element(squared.begin(), middle, squared.end());
  return std::sqrt(*middle);
}

double MedianOfCovered(const SyncFit& fit) {
  std::vector<double> values;
  for (std::size_t i = 0; i < fit.residual_px.size(); ++i) {
    if (fit.is_covered[i]) {
      values.push_back(fit.residual_px[i]);
    }
  }
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

constexpr std::array<double, 2> kNoDrift = {0.0, 0.0};

class SyncProblem {
 public:
  SyncProblem(std::span<const SyncPair> pairs, const OrientationTrack& track,
              const SyncState& start, const SyncFitOptions& options)
      : options_(options), start_(start), parameters_(Pack(start)) {
    std::map<std::array<double, 3>, std::size_t> drift_of_cell;
    const double margin =
        options.offset_radius_s +
        0.5 * (options.fit_readout ? options.frame_interval_s : std::abs(start.readout_s));
    for (const SyncPair& pair : pairs) {
      Group group{residuals_.size(), 0,
                  track.Covers(pair.from_time_s - start.offset_s - margin,
                               pair.to_time_s - start.offset_s + margin)};
      const std::size_t stride =
          (pair.matches.size() + options.max_matches - 1) / options.max_matches;
      for (std::size_t i = 0; i < pair.matches.size(); i += stride) {
        const SyncMatch& match = pair.matches[i];
        residuals_.emplace_back(track, pair.from_time_s, pair.to_time_s, match);
        // Whole numbers, kept as double: a damaged timestamp may be any size.
        const std::array<double, 3> cell = {std::floor(pair.from_time_s / kDriftWindow_s),
                                            std::floor((match.from_row_share + 0.5) * kDriftCells),
                                            std::floor((match.column_share + 0.5) * kDriftCells)};
        drift_of_match_.push_back(
            drift_of_cell.try_emplace(cell, drift_of_cell.size()).first->second);
        motion_sq_.push_back(
            ((pair.matches[i].to - pair.matches[i].from) * pair.matches[i].px_per_unit)
                .squaredNorm());
      }
      group.end = residuals_.size();
      groups_.push_back(group);
      num_covered_ += group.is_covered ? 1 : 0;
    }
    // Never resized again: Ceres keeps pointers into it.
    drifts_px_.resize(drift_of_cell.size(), Eigen::Vector2d::Zero());
  }

  [[nodiscard]] std::size_t num_covered() const { return num_covered_; }

  bool Solve(double loss_scale_px) {
    if (!CanStart()) {
      return false;
    }
    ceres::Problem problem;
    Build(loss_scale_px, problem);
    ceres::Solver::Options solver;
    solver.linear_solver_type = ceres::DENSE_SCHUR;
    auto ordering = std::make_shared<ceres::ParameterBlockOrdering>();
    for (Eigen::Vector2d& drift : drifts_px_) {
      if (problem.HasParameterBlock(drift.data())) {
        ordering->AddElementToGroup(drift.data(), 0);
      }
    }
    for (std::size_t b = 0; b < kBlocks; ++b) {
      ordering->AddElementToGroup(Parameter(b), 1);
    }
    solver.linear_solver_ordering = ordering;
    solver.max_num_iterations = options_.max_iterations;
    solver.function_tolerance = 1e-8;
    solver.parameter_tolerance = 1e-9;
    solver.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(solver, &problem, &summary);
    return summary.IsSolutionUsable();
  }

  // Fills what SyncFit says about pairs, for the present parameters.
  void MeasurePairs(SyncFit& fit) const {
    fit.motion_px.clear();
    fit.residual_px.clear();
    fit.is_covered.clear();
    double motion_sum = 0.0;
    double residual_sum = 0.0;
    std::vector<double> residual_sq;
    for (const Group& group : groups_) {
      std::vector<double> motion_sq(motion_sq_.begin() + static_cast<std::ptrdiff_t>(group.begin),
                                    motion_sq_.begin() + static_cast<std::ptrdiff_t>(group.end));
      residual_sq = motion_sq;
      for (std::size_t i = group.begin; group.is_covered && i < group.end; ++i) {
        Eigen::Vector2d r;
        if (ResidualOf(i, kNoDrift.data(), r)) {
          residual_sq[i - group.begin] = r.squaredNorm();
        }
      }
      fit.motion_px.push_back(std::min(MedianLength(motion_sq), kMaxPairMotion_px));
      fit.residual_px.push_back(std::min(MedianLength(residual_sq), kMaxPairMotion_px));
      fit.is_covered.push_back(group.is_covered);
      if (group.is_covered) {
        motion_sum += std::pow(fit.motion_px.back(), 2);
        residual_sum += std::pow(fit.residual_px.back(), 2);
      }
    }
    fit.rms_without_gyro_px = std::sqrt(motion_sum / static_cast<double>(num_covered_));
    fit.rms_px = std::sqrt(residual_sum / static_cast<double>(num_covered_));
  }

  // Standard deviations that hold when errors go together: see sync_covariance.h.
  [[nodiscard]] SyncState Sigma(double loss_scale_px) {
    ceres::Problem problem;
    Build(loss_scale_px, problem);
    ceres::Problem::EvaluateOptions evaluate;
    for (std::size_t b = 0; b < kBlocks; ++b) {
      evaluate.parameter_blocks.push_back(Parameter(b));
    }
    for (Eigen::Vector2d& drift : drifts_px_) {
      if (problem.HasParameterBlock(drift.data())) {
        evaluate.parameter_blocks.push_back(drift.data());
      }
    }
    std::vector<double> residuals;
    ceres::CRSMatrix jacobian;
    SyncState unknown{std::numeric_limits<double>::infinity(),
                      Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity()),
                      std::numeric_limits<double>::infinity(),
                      std::numeric_limits<double>::infinity(),
                      std::numeric_limits<double>::infinity()};
    if (!problem.Evaluate(evaluate, nullptr, &residuals, nullptr, &jacobian)) {
      return unknown;
    }
    std::vector<int> rows_of_group;
    for (const Group& group : groups_) {
      if (group.is_covered) {
        rows_of_group.push_back(static_cast<int>(SyncTrackResidual::kResiduals) *
                                static_cast<int>(group.end - group.begin));
      }
    }
    const auto sigma = SandwichSigma(jacobian, residuals, rows_of_group, kParameters, kErrorLag);
    if (!sigma) {
      return unknown;
    }
    std::array<double, kParameters> packed{};
    std::copy(sigma->begin(), sigma->end(), packed.begin());
    return Unpack(packed);
  }

  [[nodiscard]] SyncState state() const { return Unpack(parameters_); }
  [[nodiscard]] bool OffsetAtBound() const {
    return std::abs(parameters_[0] - start_.offset_s) > 0.98 * options_.offset_radius_s;
  }

 private:
  // Residuals of one frame pair: [begin, end) of residuals_.
  struct Group {
    std::size_t begin;
    std::size_t end;
    bool is_covered;  // uncovered ones are measured, not fitted
  };

  double* Parameter(std::size_t block) { return &parameters_[kBlockStart[block]]; }
  [[nodiscard]] const double* Value(std::size_t block) const {
    return &parameters_[kBlockStart[block]];
  }

  // However silent, Ceres complains on standard error of a start that cannot be evaluated.
  [[nodiscard]] bool CanStart() const {
    for (const Group& group : groups_) {
      for (std::size_t i = group.begin; group.is_covered && i < group.end; ++i) {
        Eigen::Vector2d unused;
        if (!ResidualOf(i, drifts_px_[drift_of_match_[i]].data(), unused)) {
          return false;
        }
      }
    }
    return true;
  }

  bool ResidualOf(std::size_t i, const double* drift_px, Eigen::Vector2d& residual_px) const {
    return residuals_[i](Value(kOffset), Value(kBias), Value(kLogFocal), Value(kCurvature),
                         Value(kReadout), drift_px, residual_px.data());
  }

  // Bounds and a weak prior for a block of one parameter; or holds it where it is.
  void Constrain(ceres::Problem& problem, Block block, bool is_fitted, double low, double high,
                 double expected, double sigma) {
    if (!is_fitted) {
      problem.SetParameterBlockConstant(Parameter(block));
      return;
    }
    problem.SetParameterLowerBound(Parameter(block), 0, low);
    problem.SetParameterUpperBound(Parameter(block), 0, high);
    problem.AddResidualBlock(new ceres::AutoDiffCostFunction<SyncPriorResidual<1>, 1, 1>(
                                 new SyncPriorResidual<1>(expected, sigma)),
                             nullptr, Parameter(block));
  }

  void Build(double loss_scale_px, ceres::Problem& problem) {
    // One loss for all tracks; the problem deletes it, once.
    auto* loss = new ceres::CauchyLoss(loss_scale_px);
    for (std::size_t b = 0; b < kBlocks; ++b) {
      problem.AddParameterBlock(Parameter(b), kBlockSize[b]);
    }
    for (const Group& group : groups_) {
      for (std::size_t i = group.begin; group.is_covered && i < group.end; ++i) {
        problem.AddResidualBlock(new TrackCost(new SyncTrackResidual(residuals_[i])), loss,
                                 Parameter(kOffset), Parameter(kBias), Parameter(kLogFocal),
                                 Parameter(kCurvature), Parameter(kReadout),
                                 drifts_px_[drift_of_match_[i]].data());
      }
    }
    auto* drift_loss = new ceres::CauchyLoss(kDriftLossScale_px * std::sqrt(kDriftPriorMatches));
    for (Eigen::Vector2d& drift : drifts_px_) {
      if (problem.HasParameterBlock(drift.data())) {
        problem.AddResidualBlock(
            new ceres::AutoDiffCostFunction<SyncPriorResidual<2>, 2, 2>(
                new SyncPriorResidual<2>(0.0, 1.0 / std::sqrt(kDriftPriorMatches))),
            drift_loss, drift.data());
      }
    }
    const double radius = options_.offset_radius_s;
    problem.SetParameterLowerBound(Parameter(kOffset), 0, start_.offset_s - radius);
    problem.SetParameterUpperBound(Parameter(kOffset), 0, start_.offset_s + radius);
    const double bias_weight =
        kBiasPriorPerMatch_px2 * static_cast<double>(std::max<std::size_t>(residuals_.size(), 1));
    problem.AddResidualBlock(
        new ceres::AutoDiffCostFunction<SyncPriorResidual<3>, 3, 3>(
            new SyncPriorResidual<3>(0.0, kBiasSigma_rad_s / std::sqrt(bias_weight))),
        nullptr, Parameter(kBias));
    const double frame = options_.frame_interval_s;
    Constrain(problem, kLogFocal, options_.fit_focal, -kMaxLogFocal, kMaxLogFocal, 0.0,
              kLogFocalSigma);
    Constrain(problem, kCurvature, options_.fit_curvature, kMinCurvature, kMaxCurvature, 0.0,
              kCurvatureSigma);
    Constrain(problem, kReadout, options_.fit_readout, -frame, frame, kReadoutPriorFrames * frame,
              kReadoutSigmaFrames * frame);
  }

  SyncFitOptions options_;
  SyncState start_;
  std::array<double, kParameters> parameters_;
  std::vector<SyncTrackResidual> residuals_;
  std::vector<std::size_t> drift_of_match_;  // index into drifts_px_, for each of residuals_
  std::vector<Eigen::Vector2d> drifts_px_;
  std::vector<double> motion_sq_;  // squared displacement of each match, px^2
  std::vector<Group> groups_;
  std::size_t num_covered_ = 0;
};

}  // namespace

std::optional<SyncFit> FitSync(std::span<const SyncPair> pairs, const OrientationTrack& track,
                               const SyncState& start, const SyncFitOptions& options) {
  SyncProblem problem(pairs, track, start, options);
  if (problem.num_covered() < kMinFitPairs || !problem.Solve(kFirstLossScale_px)) {
    return std::nullopt;
  }
  SyncFit fit;
  problem.MeasurePairs(fit);
  const double loss_scale_px = std::clamp(kLossScaleSigmas * kSigmaPerMedian * MedianOfCovered(fit),
                                          kMinLossScale_px, kFirstLossScale_px);
  if (!problem.Solve(loss_scale_px)) {
    return std::nullopt;
  }
  problem.MeasurePairs(fit);
  fit.state = problem.state();
  fit.sigma = problem.Sigma(loss_scale_px);
  fit.offset_at_bound = problem.OffsetAtBound();
  return fit;
}

}  // namespace rsstab::igf
