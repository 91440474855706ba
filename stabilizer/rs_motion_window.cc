// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/rs_motion_window.h"

#include <ceres/loss_function.h>
#include <ceres/normal_prior.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "igf/base/rotation.h"
#include "stabilizer/rs_motion_residuals.h"
#include "stabilizer/spline_state_detail.h"

namespace rsstab::stabilizer {
namespace {

using SparseRows = Eigen::SparseMatrix<double, Eigen::RowMajor>;
using Sparse = Eigen::SparseMatrix<double>;

constexpr double kWidth = 640.0;  // constants below are px at this width
// What a cell can be better by averaging is limited by what its tracks share.
constexpr double kMaxCellWeight = 4.0;
// Parallax of a scene that is not far away, as an affine motion.
constexpr double kParallaxSigma = 0.3 / kWidth;
// Cauchy scale of a cell, standard deviations.
constexpr double kCellLossScale = 3.0;
// Of its logarithm; wide, since a clip's windows must not count the same prior again and again.
constexpr double kFocalPriorSigma = 0.5;
constexpr int kMarginKnots = 3;

// From px per frame^2.5 to rad between knots: a cubic's third derivative is its third difference
// over the cubed spacing, and each knot stands for one spacing of time.
double JerkWeightPerRad(const RsMotionModel& model) {
  return model.jerk_weight * model.focal * kWidth * std::pow(kKnotsPerFrame, 2.5);
}

// Turn of the camera between two frames: q_to = q_from * turn.
Eigen::Quaterniond TurnOf(const FramePairCells& pair, double focal) {
  // x' - x = f w_y, y' - y = -f w_x, and w_z turns x into y, for to_from = exp(w).
  const Eigen::Vector3d to_from(-pair.affine(1, 0) / focal, pair.affine(0, 0) / focal,
                                0.5 * (pair.affine(1, 1) - pair.affine(0, 2)));
  return ExpSo3(to_from).conjugate();
}

Sparse Jacobian(ceres::Problem& problem, const std::vector<ceres::ResidualBlockId>& rows,
                const std::vector<double*>& columns, Eigen::VectorXd& residuals) {
  ceres::Problem::EvaluateOptions options;
  options.residual_blocks = rows;
  options.parameter_blocks = columns;
  ceres::CRSMatrix crs;
  std::vector<double> values;
  if (!problem.Evaluate(options, nullptr, &values, nullptr, &crs)) {
    residuals.resize(0);
    return {};
  }
  residuals =
      Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
  return Sparse(Eigen::Map<const SparseRows>(crs.num_rows, crs.num_cols,
                                             static_cast<Eigen::Index>(crs.values.size()),
                                             crs.rows.data(), crs.cols.data(), crs.values.data()));
}

}  // namespace

double SplineMargin(const RsMotionModel& model) {
  return model.frame_interval_s * (0.5 + static_cast<double>(kMarginKnots) / kKnotsPerFrame);
}

void ExtendStretch(const RsMotionModel& model, std::span<const FramePairCells> pairs,
                   SplineStretch& stretch) {
  if (pairs.empty()) {
    return;
  }
  const double margin_s = SplineMargin(model);
  if (stretch.knots.empty()) {
    stretch.interval_s = model.frame_interval_s / kKnotsPerFrame;
    stretch.start_s = pairs.front().from_time_s - margin_s;
    stretch.knots.push_back(Eigen::Quaterniond::Identity());
  }
  std::size_t next = 0;
  double rate_end_s = -std::numeric_limits<double>::infinity();
  Eigen::Vector3d rate = Eigen::Vector3d::Zero();
  while (stretch.end_s() < pairs.back().to_time_s + margin_s) {
    // A knot on the border of two pairs belongs to the later one.
    const double time_s = stretch.KnotTime(stretch.knots.size() - 1) + 0.5 * stretch.interval_s;
    while (next < pairs.size() && (time_s >= rate_end_s)) {
      const FramePairCells& pair = pairs[next++];
      rate_end_s = pair.to_time_s;
      rate = LogSo3(TurnOf(pair, model.focal)) /
             std::max(pair.to_time_s - pair.from_time_s, 0.1 * model.frame_interval_s);
    }
    stretch.knots.push_back(
        (stretch.knots.back() * ExpSo3(Eigen::Vector3d(rate * stretch.interval_s))).normalized());
  }
}

struct RsMotionWindow::Impl {
  Impl(const RsMotionModel& rs_model, std::span<const FramePairCells> frame_pairs,
       SplineStretch start, Freedom clip_freedom)
      : model(rs_model),
        freedom(clip_freedom),
        start_s(start.start_s),
        interval_s(start.interval_s),
        state(start.start_s, start.interval_s, std::move(start.knots)),
        readout_s(rs_model.readout_s),
        log_focal(std::log(rs_model.focal)),
        parallax(frame_pairs.size(), Eigen::Vector4d::Zero()),
        problem(ProblemOptions(&state)) {}

  static ceres::Problem::Options ProblemOptions(SplineState* state) {
    ceres::Problem::Options options;
    options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    options.evaluation_callback = state;
    options.enable_fast_removal = false;
    return options;
  }

  RsMotionModel model;
  Freedom freedom;
  double start_s;
  double interval_s;
  SplineState state;
  double readout_s;
  double log_focal;
  std::vector<Eigen::Vector4d> parallax;
  ceres::CauchyLoss loss{kCellLossScale};
  ceres::Problem problem;
  std::vector<ceres::ResidualBlockId> track_blocks;
  std::vector<double> cell_sigmas;                  // of each of them, picture widths
  std::vector<ceres::ResidualBlockId> data_blocks;  // tracks and priors, without the jerk
  std::vector<ceres::ResidualBlockId> jerk_blocks;
  std::vector<double*> motion_blocks;  // free knots and parallax

  // Knots that rule either of two instants. Those in between two frames rule neither, and every one
  // that need not be asked makes the normal equations cheaper.
  [[nodiscard]] std::vector<std::size_t> KnotsRuling(double from_s, double to_s) const {
    // One to spare on either side where the readout, and the instants with it, may move.
    const std::ptrdiff_t spare = freedom.readout ? 1 : 0;
    const auto last_knot = static_cast<std::ptrdiff_t>(state.size()) - 1;
    std::vector<std::size_t> knots;
    const auto add = [&](double time_s) {
      const std::ptrdiff_t first = std::clamp<std::ptrdiff_t>(state.FirstKnotAt(time_s), 0,
                                                              last_knot + 1 - igf::kSplineOrder);
      for (std::ptrdiff_t k = std::max<std::ptrdiff_t>(first - spare, 0);
           k < std::min(first + igf::kSplineOrder + spare, last_knot + 1); ++k) {
        const auto knot = static_cast<std::size_t>(k);
        if (knots.empty() || knot > knots.back()) {
          knots.push_back(knot);
        }
      }
    };
    add(std::min(from_s, to_s));
    add(std::max(from_s, to_s));
    return knots;
  }

  void AddTracks(std::span<const FramePairCells> pairs) {
    for (std::size_t n = 0; n < pairs.size(); ++n) {
      const FramePairCells& pair = pairs[n];
      for (const TrackCell& cell : pair.cells) {
        const double sigma =
            model.track_sigma_px / kWidth / std::sqrt(std::min(cell.weight, kMaxCellWeight));
        std::vector<std::size_t> knots =
            KnotsRuling(pair.from_time_s + readout_s * cell.from_row_share,
                        pair.to_time_s + readout_s * cell.to_row_share);
        std::vector<double*> parameters = {&readout_s, &log_focal, parallax[n].data()};
        for (const std::size_t knot : knots) {
          parameters.push_back(state.Delta(knot));
        }
        cell_sigmas.push_back(sigma);
        track_blocks.push_back(
            problem.AddResidualBlock(new RowTimedTrackCost(state, pair.from_time_s, pair.to_time_s,
                                                           cell, sigma, std::move(knots)),
                                     &loss, parameters));
      }
    }
    data_blocks = track_blocks;
  }

  void AddPriors(std::size_t num_fixed) {
    const Eigen::Matrix4d parallax_weight = Eigen::Matrix4d::Identity() / kParallaxSigma;
    for (Eigen::Vector4d& p : parallax) {
      if (problem.HasParameterBlock(p.data())) {
        data_blocks.push_back(problem.AddResidualBlock(
            new ceres::NormalPrior(parallax_weight, Eigen::Vector4d::Zero()), nullptr, p.data()));
        motion_blocks.push_back(p.data());
      }
    }
    if (problem.HasParameterBlock(&log_focal)) {
      data_blocks.push_back(problem.AddResidualBlock(
          new ceres::NormalPrior(Eigen::MatrixXd::Constant(1, 1, 1.0 / kFocalPriorSigma),
                                 Eigen::VectorXd::Constant(1, log_focal)),
          nullptr, &log_focal));
    }
    for (std::size_t k = 0; k + igf::kSplineOrder <= state.size(); ++k) {
      jerk_blocks.push_back(problem.AddResidualBlock(
          new JerkCost(state, k, JerkWeightPerRad(model)), nullptr, state.Delta(k),
          state.Delta(k + 1), state.Delta(k + 2), state.Delta(k + 3)));
    }
    for (std::size_t k = 0; k < state.size(); ++k) {
      if (k < num_fixed) {
        problem.SetParameterBlockConstant(state.Delta(k));
      } else {
        motion_blocks.push_back(state.Delta(k));
      }
    }
  }

  void Free(double* block, bool free) {
    if (!problem.HasParameterBlock(block)) {
      return;
    }
    if (free) {
      problem.SetParameterBlockVariable(block);
    } else {
      problem.SetParameterBlockConstant(block);
    }
  }
};

RsMotionWindow::RsMotionWindow(const RsMotionModel& model, std::span<const FramePairCells> pairs,
                               SplineStretch stretch, std::size_t num_fixed, Freedom freedom)
    : impl_(std::make_unique<Impl>(model, pairs, std::move(stretch), freedom)) {
  impl_->AddTracks(pairs);
  impl_->AddPriors(num_fixed);
}

RsMotionWindow::~RsMotionWindow() = default;

bool RsMotionWindow::Solve(int max_iterations) {
  Impl& s = *impl_;
  if (s.track_blocks.empty()) {
    return true;
  }
  s.Free(&s.readout_s, s.freedom.readout);
  s.Free(&s.log_focal, s.freedom.focal);
  // However silent, Ceres complains on standard error of a start that cannot be evaluated.
  s.state.PrepareForEvaluation(false, true);
  for (const ceres::ResidualBlockId block : s.track_blocks) {
    if (double cost = 0.0; !s.problem.EvaluateResidualBlockAssumingParametersUnchanged(
            block, false, &cost, nullptr, nullptr)) {
      return false;
    }
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  options.max_num_iterations = max_iterations;
  options.function_tolerance = 1e-4;
  options.initial_trust_region_radius = 1e8;  // nearly linear: take the Gauss-Newton step
  options.num_threads = 1;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &s.problem, &summary);
  s.state.PrepareForEvaluation(true, true);
  return summary.IsSolutionUsable();
}

SplineStretch RsMotionWindow::Stretch() const {
  return {impl_->start_s, impl_->interval_s, impl_->state.knots()};
}
double RsMotionWindow::readout_s() const { return impl_->readout_s; }
double RsMotionWindow::focal() const { return std::exp(impl_->log_focal); }

Eigen::Matrix2d RsMotionWindow::ClipInformation() {
  Impl& s = *impl_;
  if (s.track_blocks.empty()) {
    return Eigen::Matrix2d::Zero();
  }
  std::vector<ceres::ResidualBlockId> rows = s.data_blocks;
  rows.insert(rows.end(), s.jerk_blocks.begin(), s.jerk_blocks.end());
  s.Free(&s.readout_s, true);
  s.Free(&s.log_focal, true);
  Eigen::VectorXd residuals;
  const Sparse by_motion = Jacobian(s.problem, rows, s.motion_blocks, residuals);
  const Eigen::MatrixXd by_clip =
      Jacobian(s.problem, rows, {&s.readout_s, &s.log_focal}, residuals).toDense();
  const Eigen::SimplicialLDLT<Sparse> motion(Sparse(by_motion.transpose() * by_motion));
  if (motion.info() != Eigen::Success) {
    return Eigen::Matrix2d::Zero();
  }
  const Eigen::MatrixXd cross = by_motion.transpose() * by_clip;
  return by_clip.transpose() * by_clip - cross.transpose() * motion.solve(cross);
}

std::vector<double> RsMotionWindow::LogEvidence(std::span<const double> jerk_weights) {
  Impl& s = *impl_;
  std::vector<double> evidence(jerk_weights.size(), 0.0);
  if (s.track_blocks.empty()) {
    return evidence;
  }
  s.Free(&s.readout_s, false);
  s.Free(&s.log_focal, false);
  Eigen::VectorXd data;
  Eigen::VectorXd jerk;
  const Sparse by_data = Jacobian(s.problem, s.data_blocks, s.motion_blocks, data);
  const Sparse by_jerk = Jacobian(s.problem, s.jerk_blocks, s.motion_blocks, jerk);
  const Sparse data_normal = by_data.transpose() * by_data;
  const Sparse jerk_normal = by_jerk.transpose() * by_jerk;
  const Eigen::VectorXd data_gradient = by_data.transpose() * data;
  const Eigen::VectorXd jerk_gradient = by_jerk.transpose() * jerk;
  Eigen::SimplicialLDLT<Sparse> solver;
  solver.analyzePattern(data_normal + jerk_normal);
  for (std::size_t i = 0; i < jerk_weights.size(); ++i) {
    const double scale = jerk_weights[i] / s.model.jerk_weight;
    solver.factorize(data_normal + scale * scale * jerk_normal);
    if (solver.info() != Eigen::Success) {
      evidence[i] = -std::numeric_limits<double>::infinity();
      continue;
    }
    const Eigen::VectorXd step = -solver.solve(data_gradient + scale * scale * jerk_gradient);
    const double cost = (data + by_data * step).squaredNorm() +
                        scale * scale * (jerk + by_jerk * step).squaredNorm();
    evidence[i] = -0.5 * cost - 0.5 * solver.vectorD().array().log().sum() +
                  static_cast<double>(jerk.size()) * std::log(scale);
  }
  return evidence;
}

double RsMotionWindow::Parallax() {
  Impl& s = *impl_;
  if (s.track_blocks.empty()) {
    return 0.0;
  }
  const std::vector<Eigen::Vector4d> fitted = s.parallax;
  std::fill(s.parallax.begin(), s.parallax.end(), Eigen::Vector4d::Zero());
  ceres::Problem::EvaluateOptions options;
  options.residual_blocks = s.track_blocks;
  options.apply_loss_function = false;
  std::vector<double> residuals;
  const bool is_valid = s.problem.Evaluate(options, nullptr, &residuals, nullptr, nullptr);
  std::copy(fitted.begin(), fitted.end(), s.parallax.begin());
  if (!is_valid) {
    return std::numeric_limits<double>::infinity();
  }
  std::vector<double> distances_px(s.cell_sigmas.size());
  for (std::size_t i = 0; i < distances_px.size(); ++i) {
    distances_px[i] =
        kWidth * s.cell_sigmas[i] * std::hypot(residuals[2 * i], residuals[2 * i + 1]);
  }
  const auto middle = distances_px.begin() + static_cast<std::ptrdiff_t>(distances_px.size() / 2);
  std::nth_element(distances_px.begin(), middle, distances_px.end());
  return *middle;
}

}  // namespace rsstab::stabilizer
