// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/clip_calibration.h"

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include "igf/base/parallel_for.h"

namespace rsstab::stabilizer {
namespace {

constexpr double kWidth = 640.0;
constexpr std::size_t kStretchPairs = 40;
constexpr std::size_t kMinStretchPairs = 12;
// From picture to picture, frame intervals: one frame may be missing, or shown twice.
constexpr double kMinInterval = 0.5;
constexpr double kMaxInterval = 2.5;
constexpr std::size_t kMaxStretches = 6;
constexpr std::size_t kCurveStretches = 3;
// Readout times that are tried, frame intervals.
constexpr double kCurveStep = 0.25;
constexpr int kFirstCurveStep = -3;
constexpr int kLastCurveStep = 4;
constexpr std::array<double, 6> kJerkWeights = {0.003, 0.01, 0.03, 0.1, 0.3, 1.0};
// Flexible enough to follow anything, so that robust weights leave out only what is wrong.
constexpr double kFlexibleJerkWeight = 0.01;
constexpr int kCurveIterations = 2;
constexpr int kRefineIterations = 8;
constexpr double kDefaultFocal = 0.8;
constexpr double kFocalPriorSigma = 0.15;

// Below this change of velocity there is nothing to see, px per frame^2 at 640 px width.
constexpr double kMinExcitement_px = 0.15;
// A sensor reads from the top unless the clip clearly says otherwise: the better of the two
// directions must explain this share more of what a global shutter leaves unexplained.
constexpr double kReversedShare = 0.1;
// What a scene that is not far away can feign, frame intervals.
constexpr double kSystematicSigma = 0.02;
// Readouts below this bend a picture by less than can be seen, and parallax feigns them.
constexpr double kVisibleReadout = 0.08;
constexpr double kSigmasToBelieve = 3.0;
// With a motion this little stiff hardly anything is known of what the camera did between two
// readouts, and the motion that asks for the least jerk there pulls the readout towards 0.65 frame
// intervals: simulated vibration of 5, 10, 15, 20, 25 and 30 ms reads 9, 16.5, 19.4, 22, 26, 30.
constexpr double kVibrationJerkWeight = 0.01;
constexpr double kVibrationSigma = 0.12;  // what that can feign, frame intervals
// Evidence must be this much better than that of a global shutter.
constexpr double kMinEvidence = 10.0;
constexpr double kMaxFocalSigma = 0.03;  // of its logarithm
constexpr double kSystematicFocalSigma = 0.015;
// "No rolling shutter" is said when it is known this well, frame intervals.
constexpr double kMaxGlobalSigma = 0.05;
constexpr double kMaxReadoutSigma = 0.1;
constexpr std::size_t kFavourites = 3;
constexpr double kFewStretches = 3.0;
constexpr std::size_t kMinAgreeing = 3;
constexpr double kReadoutPriorSigma = 1.0;  // frame intervals
constexpr double kImpossible = -1e12;

// Mean square change of the affine motion's shift, px^2.
double Excitement(const std::vector<FramePairCells>& pairs) {
  double sum = 0.0;
  for (std::size_t i = 1; i < pairs.size(); ++i) {
    sum += (pairs[i].affine.col(0) - pairs[i - 1].affine.col(0)).squaredNorm();
  }
  return kWidth * kWidth * sum / static_cast<double>(pairs.size());
}

double Median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

RsMotionModel ModelFor(const ClipCalibrationOptions& options, double readout_s,
                       double jerk_weight) {
  RsMotionModel model;
  model.frame_interval_s = options.frame_interval_s;
  model.readout_s = readout_s;
  model.focal = options.focal.value_or(kDefaultFocal);
  model.jerk_weight = jerk_weight;
  return model;
}

RsMotionWindow MakeWindow(const RsMotionModel& model, const std::vector<FramePairCells>& pairs,
                          RsMotionWindow::Freedom freedom) {
  SplineStretch stretch;
  ExtendStretch(model, pairs, stretch);
  return {model, pairs, std::move(stretch), 1, freedom};
}

// The most probable of `readouts_s` (ascending, 0 among them).
template <typename Table>
std::size_t BestReadout(const Table& table, const std::vector<double>& readouts_s) {
  const auto global = static_cast<std::size_t>(
      std::find(readouts_s.begin(), readouts_s.end(), 0.0) - readouts_s.begin());
  std::size_t best = global;
  std::size_t best_reversed = global;
  for (std::size_t i = 0; i < readouts_s.size(); ++i) {
    std::size_t& side = i < global ? best_reversed : best;
    if (table.At(i) > table.At(side)) {
      side = i;
    }
  }
  const double explained = table.At(best_reversed) - table.At(global);
  const double lead = table.At(best_reversed) - table.At(best);
  return explained > 0.0 && lead > kReversedShare * explained ? best_reversed : best;
}

// One stretch's opinion of (readout in frame intervals, log focal length), with its information.
struct Opinion {
  Eigen::Vector2d value = Eigen::Vector2d::Zero();
  Eigen::Matrix2d information = Eigen::Matrix2d::Zero();
};

// Information-weighted mean, and its covariance from how much the opinions differ (the sandwich
// estimator: errors that all tracks of a stretch share count as one), but never less than the
// information promises.
ClipCalibrator::Consensus Join(const std::vector<Opinion>& opinions,
                               const Eigen::Vector2d& prior_sigma, const Eigen::Vector2d& prior) {
  Eigen::Matrix2d total = prior_sigma.array().square().inverse().matrix().asDiagonal();
  Eigen::Vector2d weighted = total * prior;
  for (const Opinion& o : opinions) {
    total += o.information;
    weighted += o.information * o.value;
  }
  const Eigen::Matrix2d covariance = total.inverse();
  ClipCalibrator::Consensus consensus;
  consensus.value = covariance * weighted;
  Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
  for (const Opinion& o : opinions) {
    const Eigen::Vector2d pull = o.information * (o.value - consensus.value);
    spread += pull * pull.transpose();
  }
  const auto n = static_cast<double>(opinions.size());
  const Eigen::Matrix2d sandwich =
      covariance * spread * covariance * (n > 1.0 ? n / (n - 1.0) : 1.0);
  consensus.sigma = sandwich.diagonal().cwiseMax(covariance.diagonal()).cwiseSqrt();
  return consensus;
}

Estimate FocalOf(const ClipCalibrator::Consensus& consensus) {
  const double focal = std::exp(consensus.value.y());
  const double sigma = std::hypot(consensus.sigma.y(), kSystematicFocalSigma);
  if (sigma < kMaxFocalSigma && consensus.parallax_px < kMaxTurningParallax_px) {
    return {focal, focal * sigma, true};
  }
  return {kDefaultFocal, kDefaultFocal * kFocalPriorSigma, false};
}

// Joins what tracks and pictures say of the readout, and says what to make of it.
void Judge(double frame_interval_s, bool beats_global, ClipCalibration& result) {
  double information = 0.0;
  double weighted = 0.0;
  const auto add = [&](const Estimate& e) {
    information += 1.0 / (e.sigma * e.sigma);
    weighted += e.value / (e.sigma * e.sigma);
  };
  const auto& tracks = result.tracks_readout_s;
  const auto& pictures = result.pictures_readout_s;
  if (tracks) {
    add(*tracks);
  }
  // Where the two contradict each other the tracks are believed if they have seen enough: they see
  // motion, the pictures only guess it from what stands upright.
  const bool agree = !tracks || !pictures ||
                     std::abs(tracks->value - pictures->value) <
                         kSigmasToBelieve * std::hypot(tracks->sigma, pictures->sigma);
  if (pictures && std::isfinite(pictures->sigma) && agree) {
    add(*pictures);
  }
  if (!(information > 0.0) || (!agree && result.num_windows < kMinAgreeing)) {
    return;
  }
  const double readout_s = weighted / information;
  const double sigma_s = 1.0 / std::sqrt(information);
  result.readout_s = {0.0, sigma_s, false};
  const bool is_seen = std::abs(readout_s) >
                       std::max(kSigmasToBelieve * sigma_s, kVisibleReadout * frame_interval_s);
  if (is_seen && beats_global) {
    result.verdict = ShutterVerdict::kRolling;
    result.readout_s = {readout_s, sigma_s, true};
  } else if (!is_seen && sigma_s < kMaxGlobalSigma * frame_interval_s) {
    result.verdict = ShutterVerdict::kGlobal;
    result.readout_s.trusted = true;
  }
}

}  // namespace

void ClipCalibrator::Push(FramePairCells pair) {
  if (IsRepeat(pair)) {
    repeated_since_s_ = repeated_since_s_.value_or(pair.from_time_s);
    return;
  }
  pair.from_time_s = repeated_since_s_.value_or(pair.from_time_s);
  repeated_since_s_.reset();
  const double interval_s = pair.to_time_s - pair.from_time_s;
  const bool is_regular = interval_s > kMinInterval * options_.frame_interval_s &&
                          interval_s < kMaxInterval * options_.frame_interval_s;
  if (pair.cells.empty() || !is_regular) {
    FinishStretch();
    return;
  }
  current_.push_back(std::move(pair));
  if (current_.size() == kStretchPairs) {
    FinishStretch();
  }
}

void ClipCalibrator::FinishStretch() {
  if (current_.size() >= kMinStretchPairs) {
    Stretch stretch{std::move(current_), 0.0};
    stretch.excitement = Excitement(stretch.pairs);
    const auto place = std::find_if(kept_.begin(), kept_.end(), [&](const Stretch& s) {
      return s.excitement < stretch.excitement;
    });
    kept_.insert(place, std::move(stretch));
    if (kept_.size() > kMaxStretches) {
      kept_.pop_back();
    }
  }
  current_.clear();
}

ClipCalibration ClipCalibrator::Calibrate(const std::optional<Estimate>& pictures) {
  FinishStretch();
  ClipCalibration result;
  result.focal = {options_.focal.value_or(kDefaultFocal), 0.0, options_.focal.has_value()};
  std::erase_if(
      kept_, [](const Stretch& s) { return s.excitement < kMinExcitement_px * kMinExcitement_px; });
  result.num_windows = kept_.size();
  if (options_.readout_s) {
    result.verdict = ShutterVerdict::kGiven;
    result.readout_s = {*options_.readout_s, 0.0, true};
  } else {
    result.pictures_readout_s = pictures;
  }
  bool beats_global = true;
  if (!kept_.empty()) {
    double start_s = 0.0;
    SearchReadout(result, start_s, beats_global);
    // From there every stretch finds its own readout and focal length.
    const Consensus consensus = Refine(start_s, result.jerk_weight);
    result.parallax_px = consensus.parallax_px;
    if (!options_.focal) {
      result.focal = FocalOf(consensus);
    }
    // Few stretches cannot show how much stretches differ.
    const auto n = static_cast<double>(kept_.size());
    const double sigma =
        std::hypot(consensus.sigma.x() * (1.0 + kFewStretches / (n * n)), kSystematicSigma);
    result.tracks_readout_s = {consensus.value.x() * options_.frame_interval_s,
                               sigma * options_.frame_interval_s, sigma < kMaxReadoutSigma};
  }
  if (!options_.readout_s) {
    Judge(options_.frame_interval_s, beats_global, result);
    if (result.verdict == ShutterVerdict::kRolling && result.tracks_readout_s &&
        result.jerk_weight <= kVibrationJerkWeight) {
      result.vibrates = true;
      const double feigned_s = kVibrationSigma * options_.frame_interval_s;
      for (Estimate* readout : {&result.readout_s, &*result.tracks_readout_s}) {
        readout->sigma = std::hypot(readout->sigma, feigned_s);
        readout->trusted = false;
      }
    }
  }
  return result;
}

void ClipCalibrator::SearchReadout(ClipCalibration& result, double& readout_s,
                                   bool& beats_global) const {
  const std::size_t num_stretches = std::min(kept_.size(), kCurveStretches);
  if (options_.readout_s) {
    readout_s = *options_.readout_s;
    result.jerk_weight = MakeEvidenceTable({readout_s}, 0, num_stretches).JerkWeight(0);
    return;
  }
  // Everything on the most telling stretch, then its favourites and the global shutter on more.
  std::vector<double> grid_s;
  for (int i = kFirstCurveStep; i <= kLastCurveStep; ++i) {
    grid_s.push_back(kCurveStep * i * options_.frame_interval_s);
  }
  const EvidenceTable first = MakeEvidenceTable(grid_s, 0, 1);
  std::vector<std::size_t> order(grid_s.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const std::size_t global = -kFirstCurveStep;
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return (a == global) != (b == global) ? a == global : first.At(a) > first.At(b);
  });
  for (std::size_t i = 0; i < grid_s.size(); ++i) {
    result.curve.push_back({grid_s[i], first.At(i)});
  }
  const double highest =
      std::max_element(result.curve.begin(), result.curve.end(), [](const auto& a, const auto& b) {
        return a.log_evidence < b.log_evidence;
      })->log_evidence;
  for (ReadoutHypothesis& hypothesis : result.curve) {
    hypothesis.log_evidence -= highest;
  }

  order.resize(kFavourites + 1);
  std::sort(order.begin(), order.end());
  std::vector<double> favourites_s;
  EvidenceTable table;
  for (const std::size_t i : order) {
    favourites_s.push_back(grid_s[i]);
    table.by_weight.push_back(first.by_weight[i]);
  }
  if (num_stretches > 1) {
    const EvidenceTable more = MakeEvidenceTable(favourites_s, 1, num_stretches);
    for (std::size_t i = 0; i < table.by_weight.size(); ++i) {
      for (std::size_t j = 0; j < kJerkWeights.size(); ++j) {
        table.by_weight[i][j] += more.by_weight[i][j];
      }
    }
  }
  const std::size_t best = BestReadout(table, favourites_s);
  readout_s = favourites_s[best];
  result.jerk_weight = table.JerkWeight(best);
  const auto without = static_cast<std::size_t>(
      std::find(favourites_s.begin(), favourites_s.end(), grid_s[global]) - favourites_s.begin());
  beats_global = table.At(best) - table.At(without) > kMinEvidence;
}

ClipCalibrator::EvidenceTable ClipCalibrator::MakeEvidenceTable(
    const std::vector<double>& readouts_s, std::size_t first, std::size_t last) const {
  const std::size_t num_stretches = last - first;
  std::vector<std::vector<double>> parts(readouts_s.size() * num_stretches);
  WorkerPool pool(options_.num_threads);
  pool.ForBlocks(static_cast<int>(parts.size()), 1, [&](int begin, int /*end*/) {
    const auto i = static_cast<std::size_t>(begin);
    const RsMotionModel model =
        ModelFor(options_, readouts_s[i / num_stretches], kFlexibleJerkWeight);
    RsMotionWindow window = MakeWindow(model, kept_[first + i % num_stretches].pairs, {});
    if (window.Solve(kCurveIterations)) {
      parts[i] = window.LogEvidence(kJerkWeights);
    } else {
      parts[i].assign(kJerkWeights.size(), kImpossible);
    }
  });
  EvidenceTable table;
  table.by_weight.assign(readouts_s.size(), std::vector<double>(kJerkWeights.size(), 0.0));
  for (std::size_t i = 0; i < parts.size(); ++i) {
    for (std::size_t j = 0; j < kJerkWeights.size(); ++j) {
      table.by_weight[i / num_stretches][j] += parts[i][j];
    }
  }
  return table;
}

double ClipCalibrator::EvidenceTable::At(std::size_t readout) const {
  return *std::max_element(by_weight[readout].begin(), by_weight[readout].end());
}

double ClipCalibrator::EvidenceTable::JerkWeight(std::size_t readout) const {
  const auto& row = by_weight[readout];
  return kJerkWeights[static_cast<std::size_t>(std::max_element(row.begin(), row.end()) -
                                               row.begin())];
}

ClipCalibrator::Consensus ClipCalibrator::Refine(double readout_s, double jerk_weight) const {
  std::vector<Opinion> opinions(kept_.size());
  std::vector<double> parallax_px(kept_.size(), 0.0);
  WorkerPool pool(options_.num_threads);
  pool.ForBlocks(static_cast<int>(opinions.size()), 1, [&](int begin, int /*end*/) {
    const auto i = static_cast<std::size_t>(begin);
    RsMotionWindow window = MakeWindow(ModelFor(options_, readout_s, jerk_weight), kept_[i].pairs,
                                       {!options_.readout_s, !options_.focal});
    if (!window.Solve(kRefineIterations)) {
      return;
    }
    const Eigen::Vector2d unit(options_.frame_interval_s, 1.0);
    opinions[i].value = {window.readout_s() / options_.frame_interval_s, std::log(window.focal())};
    parallax_px[i] = window.Parallax();
    opinions[i].information = unit.asDiagonal() * window.ClipInformation() * unit.asDiagonal();
  });
  Consensus consensus = Join(
      opinions, {kReadoutPriorSigma, kFocalPriorSigma},
      {readout_s / options_.frame_interval_s, std::log(options_.focal.value_or(kDefaultFocal))});
  consensus.parallax_px = Median(parallax_px);
  return consensus;
}

}  // namespace rsstab::stabilizer
