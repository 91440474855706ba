// SPDX-License-Identifier: Apache-2.0
#include <ceres/ceres.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <memory>
#include <numbers>

#include "igf/base/homography.h"
#include "igf/base/rotation.h"
#include "stabilizer/path_residuals.h"
#include "stabilizer/path_smoother.h"
#include "stabilizer/spatial_modes.h"

namespace rsstab::stabilizer {
namespace {

// Away from borders the smoother passes |P| = |C| / (1 + ((w/w2)^4 + (w/w3)^6) / kDataWeight^2) of
// a motion of angular frequency w; w2 and w3 are these shares of 2 pi / smoothness_s.
constexpr double kAccelerationCutoff = 0.20;
constexpr double kJerkCutoff = 0.25;
// A fast pan is meant: smoothing relaxes by exp(-(speed / kPanSpeed)^2), the Gaussian in path
// difference of Liu et al. 2013, eq. 2. Widths per second, of the motion averaged over kPanWindowS.
// Around two whip pans of 2 widths a second 94% of a side is kept; with 0.9 it was 76%.
constexpr double kPanSpeed = 0.3;
constexpr double kPanWindowS = 0.35;
constexpr double kMinPanWeight = 1e-3;
// How unwillingly the update uses what a turn cannot tell, px per unit of theta (see
// path_residuals.h): shift, zoom, stretch.
constexpr double kShiftReluctance = 1.5 * kReferenceWidthPx;
constexpr double kZoomReluctance = 1.0 * kReferenceWidthPx;
constexpr double kStretchReluctance = 10.0 * kReferenceWidthPx;
// The same when a sensor knows the turn: the tracks' noise must not leak into the picture's shape.
constexpr double kKnownRotationFactor = 100.0;
// With adaptive zoom the update's zoom hides the borders: corners that leave the picture cost
// kBorderWeight a pixel, zooming in kZoomCost a unit of log zoom (px), and how fast it may change
// follows from the smoothness of the output's motion, as for every other move.
constexpr double kBorderWeight = 60.0;
constexpr double kZoomCost = 2.0 * kReferenceWidthPx;
// The crop limit is a penalty, raised tenfold until it is exceeded by no more than
// kMaxCropViolation.
constexpr double kCropWeight = 10.0;
constexpr int kMaxCropRaises = 4;
constexpr double kMaxCropViolation = 0.5 / kReferenceWidthPx;
// Where the crop limit can only be met by bending the picture (anisotropy of the update below
// kMinAnisotropy), or not at all, lambda falls as in Liu et al. 2013, 4.2: the temporal weights of
// the frames within half of smoothness_s are multiplied by kRelaxation and the window is solved
// anew. At a crop ratio of 0.97 on a walking shot without it 21% were cut off, not 3%.
constexpr double kMinAnisotropy = 0.95;
constexpr double kRelaxation = 0.03;
constexpr int kMaxRelaxations = 4;
constexpr int kBisections = 20;
// The zoom moves slowly, so that it may go a little deeper than one frame alone would need.
constexpr double kMaxZoomExcess = 0.03;
constexpr double kTripodWeight = 300.0;
// Pull of the smooth path to the camera's own: weak, since the border keeps them together.
constexpr double kDataWeight = 0.5;
constexpr double kTripodDataWeight = 0.05;
// Local paths: highest mode, pull to the camera's own local path, neighbour term.
constexpr int kMaxModeOrder = 5;
constexpr double kLocalDataWeight = 2.0;
constexpr double kNeighbourWeight = 4.0;
constexpr double kMaxLocalUpdate = 8.0 / kReferenceWidthPx;

// With a short look-ahead the window goes on with frames that nobody has seen yet, up to
// kGuessShare of smoothness_s, at most kMaxGuesses, beyond the frames to be decided: the path then
// knows where it is heading and does not overshoot. The guess is the camera's mean motion of the
// last kIntentWindowS, dying away within kIntentDecayS. (A share of 0.6 instead of 2 at a
// look-ahead of 15 frames: 60% more jitter, and at most 70% of a side kept instead of 84%, over a
// hand-held shot.)
constexpr double kGuessShare = 2.0;
constexpr long kMaxGuesses = 90;
constexpr double kIntentWindowS = 0.2;
constexpr double kIntentDecayS = 0.5;
// What cannot be known cannot be smoothed: smoothness_s is at most this, and so much more for each
// second of look-ahead.
constexpr double kCausalSmoothnessS = 0.5;
constexpr double kSmoothnessPerLookahead = 1.5;
// Below this look-ahead the crop limit is a penalty of one weight: to hold it strictly, the path
// would have to jump after the camera, which shows more than a deeper zoom.
constexpr double kStrictLookaheadS = 0.3;
constexpr double kSoftCropWeight = 1000.0;
// Frames decided at once, as a share of the look-ahead: each solve costs the same.
constexpr int kCommitShare = 4;

constexpr int kMaxIterations = 12;
constexpr int kMaxLiveIterations = 5;  // windows begin where the one before ended
constexpr std::size_t kHistory = 3;    // decided frames that the next window leans on

using Theta = UpdateParameters;

// B(theta) as a matrix; see path_residuals.h.
Eigen::Matrix3d UpdateHomography(const Theta& theta, double focal_ratio) {
  const Eigen::Vector3d k(focal_ratio, focal_ratio, 1.0);
  const Eigen::Matrix3d turn =
      ExpSo3(Eigen::Vector3d(theta[0], theta[1], theta[2])).toRotationMatrix();
  const double zoom = std::exp(theta[5]);
  Eigen::Matrix3d affine;
  affine << zoom * (1.0 + theta[6]), theta[7], theta[3],  //
      theta[7], zoom * (1.0 - theta[6]), theta[4],        //
      0.0, 0.0, 1.0;
  const Eigen::Matrix3d update = k.asDiagonal() * turn * k.cwiseInverse().asDiagonal() * affine;
  return update / update(2, 2);
}

struct Node {
  FrameMotion motion;
  double pan_weight = 1.0;
  double relaxation = 1.0;  // share of the temporal weights that crop limit and shape leave
  Theta theta{};
  std::vector<Eigen::Vector2d> local_path;    // C of every spatial mode, chained motion
  std::vector<Eigen::Vector2d> local_smooth;  // P of every spatial mode
};

class CeresPathSmoother final : public PathSmoother {
 public:
  explicit CeresPathSmoother(const PathSmootherOptions& options)
      : options_(options),
        points_(MakePathPoints(options.aspect)),
        modes_(options.mesh_columns, options.mesh_rows, kMaxModeOrder) {
    UpdateWeights();
    if (options.lookahead_frames) {
      // commit_ + look_ahead_ open frames set off a decision: one more than the look-ahead.
      const auto delay = static_cast<std::size_t>(*options.lookahead_frames);
      commit_ = std::max<std::size_t>(1, delay / kCommitShare);
      look_ahead_ = delay + 1 - commit_;
    } else {
      look_ahead_ =
          static_cast<std::size_t>(std::clamp(std::lround(2.0 * SmoothnessFrames()), 30L, 240L));
      commit_ = std::max<std::size_t>(look_ahead_ / 2, 15);
    }
  }

  Status Push(const FrameMotion& motion) override {
    if (motion.path_begins) {
      if (Status ok = Finish(); !ok) {
        return ok;
      }
      nodes_.clear();
      kept_guesses_.clear();
      decided_ = 0;
      path_ended_ = false;
    }
    Node node;
    node.motion = motion;
    node.motion.path_begins = nodes_.empty();
    AppendLocalPath(node);
    FollowIntent(node.motion);
    if (!kept_guesses_.empty()) {
      node.theta = kept_guesses_.front();
      kept_guesses_.pop_front();
    }
    nodes_.push_back(std::move(node));
    if (nodes_.size() - decided_ >= commit_ + look_ahead_) {
      return Decide(commit_);
    }
    return {};
  }

  Status Finish() override {
    path_ended_ = true;
    return DecideAll();
  }

  Status Update(const PathSmootherOptions& options) override {
    options_.smoothness_s = options.smoothness_s;
    options_.tripod = options.tripod;
    options_.min_crop_ratio = options.min_crop_ratio;
    UpdateWeights();
    return {};
  }

  std::vector<PathUpdate> TakeReady() override { return std::exchange(ready_, {}); }

 private:
  // Infinite in two passes.
  [[nodiscard]] double LookaheadS() const {
    return options_.lookahead_frames ? *options_.lookahead_frames / options_.frames_per_second
                                     : std::numeric_limits<double>::infinity();
  }

  [[nodiscard]] double SmoothnessFrames() const {
    const double attainable_s = kCausalSmoothnessS + kSmoothnessPerLookahead * LookaheadS();
    return std::min(options_.smoothness_s, attainable_s) * options_.frames_per_second;
  }

  // Square roots of the weights, since residuals are squared.
  void UpdateWeights() {
    const double radians_per_frame = 2.0 * std::numbers::pi / std::max(SmoothnessFrames(), 1.0);
    acceleration_weight_ = std::pow(kAccelerationCutoff * radians_per_frame, -2.0);
    jerk_weight_ = std::pow(kJerkCutoff * radians_per_frame, -3.0);
  }

  void AppendLocalPath(Node& node) const {
    std::vector<Eigen::Vector2d> step(modes_.count(), Eigen::Vector2d::Zero());
    if (!node.motion.local.empty() && !nodes_.empty()) {
      step = modes_.Analyze(node.motion.local);
    }
    node.local_path = std::move(step);
    if (!nodes_.empty()) {
      for (std::size_t k = 0; k < modes_.count(); ++k) {
        node.local_path[k] += nodes_.back().local_path[k];
      }
    }
    node.local_smooth = node.local_path;
  }

  Status DecideAll() {
    while (decided_ < nodes_.size()) {
      const std::size_t open = nodes_.size() - decided_;
      // The last window is solved in one piece, so that no short tail is decided without a future.
      if (Status ok = Decide(open <= commit_ + look_ahead_ ? open : commit_); !ok) {
        return ok;
      }
    }
    return {};
  }

  // Solves over all frames at hand and decides the next `count`.
  Status Decide(std::size_t count) {
    if (options_.smoothness_s > 0.0 || options_.tripod) {
      const GuessedFrames guessed(*this, count);
      UpdatePanWeights();
      if (Status ok = SolveGlobal(); !ok) {
        return ok;
      }
      if (Status ok = SolveLocal(); !ok) {
        return ok;
      }
    }
    for (std::size_t i = decided_; i < decided_ + count; ++i) {
      ready_.push_back(MakeUpdate(nodes_[i]));
    }
    decided_ += count;
    while (decided_ > kHistory) {
      nodes_.pop_front();
      --decided_;
    }
    return {};
  }

  // Adds the frames to be guessed for a decision on `count` frames, and takes them off again.
  class GuessedFrames {
   public:
    GuessedFrames(CeresPathSmoother& smoother, std::size_t count) : smoother_(smoother) {
      smoother_.num_guessed_ = smoother_.AppendGuesses(count);
    }
    ~GuessedFrames() {
      smoother_.KeepGuesses();
      smoother_.nodes_.resize(smoother_.nodes_.size() - smoother_.num_guessed_);
      smoother_.num_guessed_ = 0;
    }
    GuessedFrames(const GuessedFrames&) = delete;
    GuessedFrames& operator=(const GuessedFrames&) = delete;

   private:
    CeresPathSmoother& smoother_;
  };

  // The next window begins where this one ended.
  void KeepGuesses() {
    kept_guesses_.clear();
    for (std::size_t i = nodes_.size() - num_guessed_; i < nodes_.size(); ++i) {
      kept_guesses_.push_back(nodes_[i].theta);
    }
  }

  std::size_t AppendGuesses(std::size_t count) {
    const auto horizon = static_cast<std::size_t>(
        std::min(std::lround(kGuessShare * SmoothnessFrames()), kMaxGuesses));
    const std::size_t seen = nodes_.size() - decided_ - count;
    if (!options_.lookahead_frames || path_ended_ || seen >= horizon) {
      return 0;
    }
    for (std::size_t k = 1; k <= horizon - seen; ++k) {
      Node guess;
      const double decay =
          std::exp(-static_cast<double>(k) / (kIntentDecayS * options_.frames_per_second));
      guess.motion.to_from.topRightCorner<2, 1>() = decay * intent_;
      guess.theta = kept_guesses_.empty() ? nodes_.back().theta : kept_guesses_.front();
      if (kept_guesses_.size() > 1) {
        kept_guesses_.pop_front();
      }
      guess.local_path = nodes_.back().local_path;
      guess.local_smooth = nodes_.back().local_smooth;
      nodes_.push_back(std::move(guess));
    }
    return horizon - seen;
  }

  // Mean motion from one frame to the next of late: what the camera means to do.
  void FollowIntent(const FrameMotion& motion) {
    if (motion.path_begins) {
      intent_.setZero();
      return;
    }
    const double share = 1.0 / std::max(1.0, kIntentWindowS * options_.frames_per_second);
    const Eigen::Matrix3d& f = motion.to_from;
    intent_ += share * (Eigen::Vector2d(f.block<2, 1>(0, 2) / f(2, 2)) - intent_);
  }

  // Gaussian mean of the camera's speed around every open frame.
  void UpdatePanWeights() {
    const double sigma = kPanWindowS * options_.frames_per_second;
    const auto reach = static_cast<std::ptrdiff_t>(std::ceil(2.5 * sigma));
    std::vector<Eigen::Vector2d> speed(nodes_.size(), Eigen::Vector2d::Zero());
    for (std::size_t i = 1; i < nodes_.size(); ++i) {
      const Eigen::Matrix3d& f = nodes_[i].motion.to_from;
      speed[i] = f.block<2, 1>(0, 2) / f(2, 2) * options_.frames_per_second;
    }
    for (std::size_t i = decided_; i < nodes_.size(); ++i) {
      Eigen::Vector2d sum = Eigen::Vector2d::Zero();
      double total = 0.0;
      for (std::ptrdiff_t d = -reach; d <= reach; ++d) {
        const std::ptrdiff_t j = static_cast<std::ptrdiff_t>(i) + d;
        if (j < 0 || j >= static_cast<std::ptrdiff_t>(nodes_.size())) {
          continue;
        }
        const double x = static_cast<double>(d) / sigma;
        const double w = std::exp(-0.5 * x * x);
        sum += w * speed[static_cast<std::size_t>(j)];
        total += w;
      }
      const double ratio = sum.norm() / total / kPanSpeed;
      nodes_[i].pan_weight = std::max(kMinPanWeight, std::exp(-ratio * ratio));
    }
  }

  // sqrt of a temporal weight, halfway between the frames it spans.
  [[nodiscard]] double TemporalWeight(double weight, std::size_t last, std::size_t span) const {
    double smallest = 1.0;
    for (std::size_t i = last - span; i <= last; ++i) {
      smallest = std::min(smallest, nodes_[i].pan_weight * nodes_[i].relaxation);
    }
    return weight * std::sqrt(smallest);
  }

  Status SolveGlobal() {
    for (std::size_t i = decided_; i < nodes_.size(); ++i) {
      nodes_[i].relaxation = 1.0;
    }
    if (LookaheadS() < kStrictLookaheadS) {
      return SolveGlobal(kSoftCropWeight);
    }
    for (int relaxed = 0;; ++relaxed) {
      double crop_weight = kCropWeight;
      bool bent = false;
      for (int i = 0; i <= kMaxCropRaises && !bent; ++i, crop_weight *= 10.0) {
        if (Status ok = SolveGlobal(crop_weight); !ok) {
          return ok;
        }
        bent = AnyOpen([this](const Node& node) { return IsBent(node); });
        if (!bent && !AnyOpen([this](const Node& node) { return ExceedsCrop(node); })) {
          return {};
        }
      }
      if (relaxed == kMaxRelaxations) {
        PullInside();
        return {};
      }
      RelaxAround(bent);
    }
  }

  template <typename Predicate>
  [[nodiscard]] bool AnyOpen(const Predicate& predicate) const {
    return std::any_of(nodes_.begin() + static_cast<std::ptrdiff_t>(decided_),
                       nodes_.end() - static_cast<std::ptrdiff_t>(num_guessed_), predicate);
  }

  [[nodiscard]] bool IsBent(const Node& node) const {
    return AffineAnisotropy(UpdateHomography(node.theta, options_.focal_ratio)) < kMinAnisotropy;
  }

  // By its window without the zoom, or by a zoom deeper than hiding its borders takes; a zoom that
  // is not asked for has to stay near one either way.
  [[nodiscard]] bool ExceedsCrop(const Node& node) const {
    const double zoom = std::exp(node.theta[kZoomIndex]);
    const double deepest = options_.adaptive_zoom ? options_.min_crop_ratio : 1.0;
    if (!(zoom > deepest - kMaxZoomExcess) || zoom > 1.0 + kMaxZoomExcess) {
      return true;
    }
    const CropResidual crop{options_.focal_ratio, 1.0, options_.min_crop_ratio, options_.aspect,
                            false};
    std::array<double, CropResidual::kSize> overhang_px{};
    crop(node.theta.data(), overhang_px.data());
    return std::any_of(overhang_px.begin(), overhang_px.end(), [](double d) {
      return !(std::abs(d) < kMaxCropViolation * kReferenceWidthPx);
    });
  }

  // Lets the path follow the camera closer around the open frames that are bent, or else those that
  // leave the picture, and begins anew from the camera's own path, which does neither.
  void RelaxAround(bool bent) {
    const auto reach = static_cast<std::size_t>(std::lround(0.5 * SmoothnessFrames()));
    std::vector<bool> relax(nodes_.size(), false);
    for (std::size_t i = decided_; i < nodes_.size(); ++i) {
      if (bent ? IsBent(nodes_[i]) : ExceedsCrop(nodes_[i])) {
        const std::size_t from = std::max(decided_, i - std::min(i, reach));
        const std::size_t to = std::min(nodes_.size() - 1, i + reach);
        std::fill(relax.begin() + static_cast<std::ptrdiff_t>(from),
                  relax.begin() + static_cast<std::ptrdiff_t>(to + 1), true);
      }
    }
    for (std::size_t i = decided_; i < nodes_.size(); ++i) {
      nodes_[i].relaxation *= relax[i] ? kRelaxation : 1.0;
      nodes_[i].theta = {};
    }
  }

  // The last resort: shrinks the updates of all open frames alike, towards the camera's own path,
  // until none is beyond a limit.
  void PullInside() {
    double share = 1.0;
    for (std::size_t i = decided_; i < nodes_.size(); ++i) {
      Node shrunk;
      const auto is_fine = [&](double factor) {
        std::transform(nodes_[i].theta.begin(), nodes_[i].theta.end(), shrunk.theta.begin(),
                       [factor](double value) { return factor * value; });
        return !IsBent(shrunk) && !ExceedsCrop(shrunk);
      };
      if (is_fine(share)) {
        continue;
      }
      double low = 0.0;
      for (int step = 0; step < kBisections; ++step) {
        const double middle = 0.5 * (low + share);
        (is_fine(middle) ? low : share) = middle;
      }
      share = low;
    }
    for (std::size_t i = decided_; i < nodes_.size(); ++i) {
      for (double& value : nodes_[i].theta) {
        value *= share;
      }
    }
  }

  void AddCropResiduals(ceres::Problem& problem, double crop_weight, Theta& theta) const {
    using CropCost = ceres::AutoDiffCostFunction<CropResidual, CropResidual::kSize, kUpdateSize>;
    const double f = options_.focal_ratio;
    problem.AddResidualBlock(new CropCost(new CropResidual{f, crop_weight, options_.min_crop_ratio,
                                                           options_.aspect, false}),
                             nullptr, theta.data());
    if (options_.adaptive_zoom) {
      problem.AddResidualBlock(
          new CropCost(new CropResidual{f, kBorderWeight, 1.0, options_.aspect, true}), nullptr,
          theta.data());
    }
  }

  Status SolveGlobal(double crop_weight) {
    ceres::Problem problem;
    const double f = options_.focal_ratio;
    const double known = options_.rotation_known ? kKnownRotationFactor : 1.0;
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
      problem.AddParameterBlock(nodes_[i].theta.data(), kUpdateSize);
      if (i < decided_) {
        problem.SetParameterBlockConstant(nodes_[i].theta.data());
        continue;
      }
      DataResidual data{points_, f, options_.tripod ? kTripodDataWeight : kDataWeight, {}};
      data.reluctance = {0.0,
                         0.0,
                         0.0,
                         known * kShiftReluctance,
                         known * kShiftReluctance,
                         options_.adaptive_zoom ? kZoomCost : known * kZoomReluctance,
                         known * kStretchReluctance,
                         known * kStretchReluctance};
      problem.AddResidualBlock(
          new ceres::AutoDiffCostFunction<DataResidual, DataResidual::kSize, kUpdateSize>(
              new DataResidual(data)),
          nullptr, nodes_[i].theta.data());
      AddCropResiduals(problem, crop_weight, nodes_[i].theta);
      if (options_.tripod && i >= 1) {
        problem.AddResidualBlock(
            new ceres::AutoDiffCostFunction<VelocityResidual, VelocityResidual::kSize, kUpdateSize,
                                            kUpdateSize>(
                new VelocityResidual{points_, f, kTripodWeight * std::sqrt(nodes_[i].relaxation),
                                     nodes_[i].motion.to_from}),
            nullptr, nodes_[i - 1].theta.data(), nodes_[i].theta.data());
      }
      if (i >= 2) {
        problem.AddResidualBlock(
            new ceres::AutoDiffCostFunction<AccelerationResidual, AccelerationResidual::kSize,
                                            kUpdateSize, kUpdateSize, kUpdateSize>(
                new AccelerationResidual{points_, f, TemporalWeight(acceleration_weight_, i, 2),
                                         nodes_[i - 1].motion.to_from, nodes_[i].motion.to_from}),
            nullptr, nodes_[i - 2].theta.data(), nodes_[i - 1].theta.data(),
            nodes_[i].theta.data());
      }
      if (i >= 3) {
        problem.AddResidualBlock(
            new ceres::AutoDiffCostFunction<JerkResidual, JerkResidual::kSize, kUpdateSize,
                                            kUpdateSize, kUpdateSize, kUpdateSize>(new JerkResidual{
                points_, f, TemporalWeight(jerk_weight_, i, 3), nodes_[i - 2].motion.to_from,
                nodes_[i - 1].motion.to_from, nodes_[i].motion.to_from}),
            nullptr, nodes_[i - 3].theta.data(), nodes_[i - 2].theta.data(),
            nodes_[i - 1].theta.data(), nodes_[i].theta.data());
      }
    }
    ceres::Solver::Options solver;
    solver.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
    solver.max_num_iterations = options_.lookahead_frames ? kMaxLiveIterations : kMaxIterations;
    solver.function_tolerance = 1e-4;
    solver.initial_trust_region_radius = 1e8;  // nearly linear: begin with a full step
    solver.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(solver, &problem, &summary);
    if (!summary.IsSolutionUsable()) {
      return Fail(ErrorCode::kInternal, "smoothing the camera path failed: {}", summary.message);
    }
    return {};
  }

  Status SolveLocal();

  [[nodiscard]] PathUpdate MakeUpdate(const Node& node) const {
    PathUpdate update;
    update.rung = node.motion.rung;
    update.path_begins = node.motion.path_begins;
    update.rectified_from_output = UpdateHomography(node.theta, options_.focal_ratio);
    std::vector<Eigen::Vector2d> coefficients(modes_.count());
    double largest = 0.0;
    for (std::size_t k = 0; k < coefficients.size(); ++k) {
      coefficients[k] = node.local_path[k] - node.local_smooth[k];
      largest = std::max(largest, coefficients[k].norm());
    }
    if (largest > 0.0) {
      update.mesh_update = modes_.Synthesize(coefficients);
      for (Eigen::Vector2d& d : update.mesh_update) {
        // Soft limit: a local update this large is a wrong one, and must not tear the picture.
        d /= std::sqrt(1.0 + d.squaredNorm() / (kMaxLocalUpdate * kMaxLocalUpdate));
      }
    }
    return update;
  }

  PathSmootherOptions options_;
  PathPoints points_;
  SpatialModes modes_;
  std::size_t look_ahead_ = 60;
  std::size_t commit_ = 30;
  double acceleration_weight_ = 0.0;
  double jerk_weight_ = 0.0;
  std::deque<Node> nodes_;          // kHistory decided frames, then the open ones
  std::size_t decided_ = 0;         // how many of them are decided
  std::size_t num_guessed_ = 0;     // at the end of nodes_, while a window is solved
  std::deque<Theta> kept_guesses_;  // of the frames to come, by the last window
  bool path_ended_ = false;         // no frame will be added to nodes_
  Eigen::Vector2d intent_ = Eigen::Vector2d::Zero();
  std::vector<PathUpdate> ready_;
};

// |P - C|^2 (1 + neighbour term of the mode) for one spatial mode.
class LocalDataCost final : public ceres::SizedCostFunction<2, 2> {
 public:
  LocalDataCost(double weight, Eigen::Vector2d path) : weight_(weight), path_(std::move(path)) {}

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override {
    for (int i = 0; i < 2; ++i) {
      residuals[i] = weight_ * (parameters[0][i] - path_(i));
    }
    if (jacobians != nullptr && jacobians[0] != nullptr) {
      Eigen::Map<Eigen::Matrix<double, 2, 2, Eigen::RowMajor>> j(jacobians[0]);
      j = weight_ * Eigen::Matrix2d::Identity();
    }
    return true;
  }

 private:
  double weight_;
  Eigen::Vector2d path_;
};

// Second and third differences of P for one spatial mode.
class LocalTemporalCost final : public ceres::SizedCostFunction<4, 2, 2, 2, 2> {
 public:
  LocalTemporalCost(double acceleration, double jerk)
      : coefficients_{{{0.0, -jerk},
                       {acceleration, 3.0 * jerk},
                       {-2.0 * acceleration, -3.0 * jerk},
                       {acceleration, jerk}}} {}

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override {
    Eigen::Map<Eigen::Vector4d> r(residuals);
    r.setZero();
    for (std::size_t k = 0; k < coefficients_.size(); ++k) {
      const Eigen::Map<const Eigen::Vector2d> p(parameters[k]);
      r.head<2>() += coefficients_[k][0] * p;
      r.tail<2>() += coefficients_[k][1] * p;
      if (jacobians != nullptr && jacobians[k] != nullptr) {
        Eigen::Map<Eigen::Matrix<double, 4, 2, Eigen::RowMajor>> j(jacobians[k]);
        j.topRows<2>() = coefficients_[k][0] * Eigen::Matrix2d::Identity();
        j.bottomRows<2>() = coefficients_[k][1] * Eigen::Matrix2d::Identity();
      }
    }
    return true;
  }

 private:
  std::array<std::array<double, 2>, 4> coefficients_;
};

Status CeresPathSmoother::SolveLocal() {
  // Without local motion in the window (a gyro clip without parallax, no texture) nothing to do,
  // once the smooth path has come to rest, too.
  double motion = 0.0;
  for (const Node& node : nodes_) {
    for (std::size_t k = 0; k < modes_.count(); ++k) {
      const Eigen::Vector2d& rest = nodes_.front().local_path[k];
      motion = std::max(
          {motion, (node.local_path[k] - rest).norm(), (node.local_smooth[k] - rest).norm()});
    }
  }
  if (motion == 0.0) {
    return {};
  }
  ceres::Problem problem;
  for (std::size_t k = 0; k < modes_.count(); ++k) {
    const double data_weight =
        kLocalDataWeight * std::sqrt(1.0 + kNeighbourWeight * modes_.stiffness(k));
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
      double* p = nodes_[i].local_smooth[k].data();
      problem.AddParameterBlock(p, 2);
      if (i < decided_) {
        problem.SetParameterBlockConstant(p);
        continue;
      }
      problem.AddResidualBlock(new LocalDataCost(data_weight, nodes_[i].local_path[k]), nullptr, p);
      if (i >= 3) {
        problem.AddResidualBlock(new LocalTemporalCost(TemporalWeight(acceleration_weight_, i, 2),
                                                       TemporalWeight(jerk_weight_, i, 3)),
                                 nullptr, nodes_[i - 3].local_smooth[k].data(),
                                 nodes_[i - 2].local_smooth[k].data(),
                                 nodes_[i - 1].local_smooth[k].data(), p);
      }
    }
  }
  ceres::Solver::Options solver;
  solver.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  solver.max_num_iterations = 3;  // linear: one step, one to see that it was right
  solver.initial_trust_region_radius = 1e12;
  solver.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(solver, &problem, &summary);
  if (!summary.IsSolutionUsable()) {
    return Fail(ErrorCode::kInternal, "smoothing the local camera paths failed: {}",
                summary.message);
  }
  return {};
}

}  // namespace

Result<std::unique_ptr<PathSmoother>> MakeCeresPathSmoother(const PathSmootherOptions& options) {
  if (!(options.aspect > 0.0) || !(options.frames_per_second > 0.0) ||
      !(options.focal_ratio > 0.0) || !(options.smoothness_s >= 0.0) ||
      !(options.min_crop_ratio > 0.0 && options.min_crop_ratio <= 1.0) ||
      options.mesh_columns < 1 || options.mesh_rows < 1 ||
      options.lookahead_frames.value_or(0) < 0) {
    return Fail(ErrorCode::kInvalidArgument,
                "path smoother: aspect {}, {} fps, focal ratio {}, smoothness {} s, crop ratio {}, "
                "mesh {}x{}, look-ahead {}: all must be positive, the crop ratio at most 1",
                options.aspect, options.frames_per_second, options.focal_ratio,
                options.smoothness_s, options.min_crop_ratio, options.mesh_columns,
                options.mesh_rows, options.lookahead_frames.value_or(0));
  }
  return std::make_unique<CeresPathSmoother>(options);
}

}  // namespace rsstab::stabilizer
