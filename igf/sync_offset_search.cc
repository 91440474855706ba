// SPDX-License-Identifier: Apache-2.0
#include "igf/sync_offset_search.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>

namespace rsstab::igf {
namespace {

constexpr int kBands = 4;
constexpr int kColumns = 2;
constexpr std::size_t kMinCellMatches = 3;
constexpr double kTableStep_s = 1e-3;
// The true over the assumed focal length; a larger scale would let a still log explain noise.
constexpr double kMaxScale = 3.0;
// Cells that move more than this many medians count less, so that a cut or one violent second does
// not decide alone.
constexpr double kLargeMotionMedians = 3.0;
constexpr double kSmallMotion_px = 1.0;

double Median(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Running integral of the body rate. Over the time of a frame or two, differences of it are
// rotation vectors to first order.
class RateIntegral {
 public:
  explicit RateIntegral(const OrientationTrack& track) : start_s_(track.start_s()) {
    const auto count =
        static_cast<std::size_t>((track.end_s() - track.start_s()) / kTableStep_s) + 2;
    values_.reserve(count);
    values_.push_back(Eigen::Vector3d::Zero());
    for (std::size_t i = 1; i < count; ++i) {
      const double to_s = start_s_ + static_cast<double>(i) * kTableStep_s;
      const auto rate = track.MeanRate(to_s - kTableStep_s, to_s);
      values_.push_back(values_.back() + kTableStep_s * rate.value_or(Eigen::Vector3d::Zero()));
    }
  }

  [[nodiscard]] Eigen::Vector3d At(double time_s) const {
    const double position = std::clamp((time_s - start_s_) / kTableStep_s, 0.0,
                                       static_cast<double>(values_.size() - 1));
    const std::size_t i = std::min(static_cast<std::size_t>(position), values_.size() - 2);
    const double share = position - static_cast<double>(i);
    return (1.0 - share) * values_[i] + share * values_[i + 1];
  }

 private:
  double start_s_;
  std::vector<Eigen::Vector3d> values_;
};

// The middling motion of the matches in one part of the frame.
struct Cell {
  Eigen::Vector2d motion;                     // px, weighted
  Eigen::Matrix<double, 2, 3> px_per_radian;  // motion = px_per_radian * rotation vector, weighted
  double from_row_share = 0.0;
  double to_row_share = 0.0;
};

struct CellPair {
  double from_time_s = 0.0;
  double to_time_s = 0.0;
  std::vector<Cell> cells;
  // Sums over the cells that no offset changes: of the motion, and of the motion that a constant
  // rate of 1 rad/s about each axis would make.
  double motion_sq = 0.0;
  Eigen::Vector3d motion_constant = Eigen::Vector3d::Zero();
  Eigen::Matrix3d constant_sq = Eigen::Matrix3d::Zero();
};

// Image motion of a camera that turns by a small rotation vector (points turn the other way):
// d(x, y) = -r x (x, y, 1), projected.
Eigen::Matrix<double, 2, 3> PlaneMotion(double x, double y) {
  Eigen::Matrix<double, 2, 3> m;
  m << x * y, -(1.0 + x * x), y, 1.0 + y * y, -x * y, -x;
  return m;
}

Cell MakeCell(const std::vector<const SyncMatch*>& matches) {
  std::array<std::vector<double>, 7> columns;
  for (const SyncMatch* m : matches) {
    const std::array<double, 7> values = {0.5 * (m->from.x() + m->to.x()),
                                          0.5 * (m->from.y() + m->to.y()),
                                          m->to.x() - m->from.x(),
                                          m->to.y() - m->from.y(),
                                          m->from_row_share,
                                          m->to_row_share,
                                          m->px_per_unit};
    for (std::size_t k = 0; k < values.size(); ++k) {
      columns[k].push_back(values[k]);
    }
  }
  std::array<double, 7> middle{};
  for (std::size_t k = 0; k < columns.size(); ++k) {
    middle[k] = Median(columns[k]);
  }
  Cell cell;
  cell.motion = middle[6] * Eigen::Vector2d(middle[2], middle[3]);
  cell.px_per_radian = middle[6] * PlaneMotion(middle[0], middle[1]);
  cell.from_row_share = middle[4];
  cell.to_row_share = middle[5];
  return cell;
}

std::vector<CellPair> MakeCells(std::span<const SyncPair> pairs) {
  std::vector<CellPair> result;
  std::vector<double> lengths;
  for (const SyncPair& pair : pairs) {
    std::array<std::vector<const SyncMatch*>, kBands * kColumns> members;
    for (const SyncMatch& match : pair.matches) {
      const int band =
          std::clamp(static_cast<int>((match.from_row_share + 0.5) * kBands), 0, kBands - 1);
      const int column = match.from.x() > 0.0 ? 1 : 0;
      members[static_cast<std::size_t>(band * kColumns + column)].push_back(&match);
    }
    CellPair cells{pair.from_time_s, pair.to_time_s, {}};
    for (const auto& matches : members) {
      if (matches.size() >= kMinCellMatches) {
        cells.cells.push_back(MakeCell(matches));
        lengths.push_back(cells.cells.back().motion.norm());
      }
    }
    result.push_back(std::move(cells));
  }
  if (lengths.empty()) {
    return {};
  }
  const double large = std::max(kSmallMotion_px, kLargeMotionMedians * Median(lengths));
  for (CellPair& pair : result) {
    const double dt = pair.to_time_s - pair.from_time_s;
    for (Cell& cell : pair.cells) {
      const double weight = std::sqrt(std::min(1.0, large / std::max(cell.motion.norm(), 1e-9)));
      cell.motion *= weight;
      cell.px_per_radian *= weight;
      const Eigen::Matrix<double, 2, 3> constant = dt * cell.px_per_radian;
      pair.motion_sq += cell.motion.squaredNorm();
      pair.motion_constant += constant.transpose() * cell.motion;
      pair.constant_sq += constant.transpose() * constant;
    }
  }
  return result;
}

// Motion energy (px^2) that the log explains at one offset and readout.
double ExplainedEnergy(const std::vector<CellPair>& pairs, const OrientationTrack& track,
                       const RateIntegral& integral, double offset_s, double readout_s) {
  double predicted_sq = 0.0;
  double motion_predicted = 0.0;
  Eigen::Vector3d predicted_constant = Eigen::Vector3d::Zero();
  Eigen::Vector3d motion_constant = Eigen::Vector3d::Zero();
  Eigen::Matrix3d constant_sq = Eigen::Matrix3d::Zero();
  const double margin = 0.5 * std::abs(readout_s);
  for (const CellPair& pair : pairs) {
    const double from_s = pair.from_time_s - offset_s;
    const double to_s = pair.to_time_s - offset_s;
    if (!track.Covers(from_s - margin, to_s + margin)) {
      continue;
    }
    motion_constant += pair.motion_constant;
    constant_sq += pair.constant_sq;
    Eigen::Vector3d pulled = Eigen::Vector3d::Zero();
    for (const Cell& cell : pair.cells) {
      const Eigen::Vector3d turn = integral.At(to_s + readout_s * cell.to_row_share) -
                                   integral.At(from_s + readout_s * cell.from_row_share);
      const Eigen::Vector2d predicted = cell.px_per_radian * turn;
      predicted_sq += predicted.squaredNorm();
      motion_predicted += predicted.dot(cell.motion);
      pulled += cell.px_per_radian.transpose() * predicted;
    }
    predicted_constant += (pair.to_time_s - pair.from_time_s) * pulled;
  }
  if (!(predicted_sq > 0.0)) {
    return 0.0;
  }
  // Take the best constant rate out of both, then fit the scale.
  constant_sq.diagonal().array() += 1e-9 * constant_sq.trace() + 1e-12;
  const Eigen::Vector3d bias = constant_sq.ldlt().solve(predicted_constant);
  const double cross = motion_predicted - motion_constant.dot(bias);
  const double power = predicted_sq - predicted_constant.dot(bias);
  if (!(power > 1e-9 * predicted_sq)) {
    return 0.0;
  }
  const double scale = std::clamp(cross / power, 0.0, kMaxScale);
  return scale * (2.0 * cross - scale * power);
}

}  // namespace

std::vector<OffsetCandidate> SearchOffsets(std::span<const SyncPair> pairs,
                                           const OrientationTrack& track,
                                           const OffsetSearchOptions& options) {
  const std::vector<CellPair> cells = MakeCells(pairs);
  double total = 0.0;
  for (const CellPair& pair : cells) {
    total += pair.motion_sq;
  }
  if (!(total > 0.0)) {
    return {};
  }
  const RateIntegral integral(track);
  const int count = 1 + static_cast<int>(std::ceil(
                            (options.max_offset_s - options.min_offset_s) / options.step_s - 1e-9));
  std::vector<OffsetCandidate> profile;
  for (int i = 0; i < count; ++i) {
    OffsetCandidate best{std::min(options.min_offset_s + i * options.step_s, options.max_offset_s),
                         0.0, 0.0};
    for (const double readout_s : options.readouts_s) {
      const double explained =
          ExplainedEnergy(cells, track, integral, best.offset_s, readout_s) / total;
      if (explained > best.explained) {
        best.explained = explained;
        best.readout_s = readout_s;
      }
    }
    profile.push_back(best);
  }
  std::vector<OffsetCandidate> peaks;
  for (std::size_t i = 0; i < profile.size(); ++i) {
    const bool rises = i == 0 || profile[i].explained > profile[i - 1].explained;
    const bool falls = i + 1 == profile.size() || profile[i].explained >= profile[i + 1].explained;
    if (rises && falls && profile[i].explained > 0.0) {
      peaks.push_back(profile[i]);
    }
  }
  std::stable_sort(peaks.begin(), peaks.end(),
                   [](const auto& a, const auto& b) { return a.explained > b.explained; });
  peaks.resize(std::min(peaks.size(), options.max_candidates));
  return peaks;
}

}  // namespace rsstab::igf
