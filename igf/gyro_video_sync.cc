// SPDX-License-Identifier: Apache-2.0
#include "igf/gyro_video_sync.h"

#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "igf/gyro_integrator.h"
#include "igf/orientation_track.h"
#include "igf/sync_fit.h"
#include "igf/sync_offset_search.h"
#include "igf/sync_pairs.h"
#include "igf/sync_residuals.h"

namespace rsstab::igf {
namespace {

constexpr double kMaxSearch_s = 60.0;
constexpr std::size_t kMinMatches = 8;
// Above the vibrations that bend frames, below what an exposure averages out; left in, a
// propeller's hum makes false minima a few milliseconds apart.
constexpr double kLowPass_hz = 100.0;
constexpr double kFilterMargin_s = 0.1;
// Readout times that the search tries when it is not given, in frame intervals.
constexpr std::array<double, 7> kReadoutHypotheses = {0.55, 0.0, 0.25, 0.85, -0.25, -0.55, -0.85};
// Sizes of the three stages: they bound the cost whatever the clip's length.
constexpr std::size_t kMaxMatches = 120;
constexpr std::size_t kSearchPairs = 120;
constexpr std::size_t kCandidatePairs = 60;
constexpr std::size_t kCandidateMatches = 12;
constexpr int kCandidateIterations = 12;
// Peaks that explain less than this share of the highest are not worth a fit.
constexpr double kMinPeakRatio = 0.5;
constexpr std::size_t kFinalPairs = 120;
constexpr std::size_t kFinalMatches = 40;
constexpr double kFitRadius_s = 10e-3;  // half-width around a peak, and around the best fit
// Two fits nearer than this belong to one minimum with a rough bottom: how rough is the standard
// deviation's business. 60 Hz vibration repeats after 17 ms.
constexpr double kDistinctOffset_s = 12e-3;

// What an estimate must show to be trusted.
constexpr double kMaxOffsetSigma_s = 1.2e-3;
constexpr double kSmallMotion_px = 1.0;
constexpr double kMinExplained = 0.35;  // of the tracks' squared motion
constexpr double kMinRivalRatio = 1.2;  // squared motion left by the second-best offset, over best
constexpr double kMaxReadoutSigmaRatio = 0.05;
constexpr double kMaxReadoutSigma_s = 0.5e-3;
constexpr double kMaxFocalSigma = 0.02;
// A curvature nearer to a pinhole than this bends a 60 degree view by less than 0.4% at its edge.
constexpr double kVisibleCurvature = 0.02;

double MedianInterval(const std::vector<SyncPair>& pairs) {
  std::vector<double> intervals;
  for (const SyncPair& pair : pairs) {
    intervals.push_back(pair.to_time_s - pair.from_time_s);
  }
  const auto middle = intervals.begin() + static_cast<std::ptrdiff_t>(intervals.size() / 2);
  std::nth_element(intervals.begin(), middle, intervals.end());
  return *middle;
}

// The part of the log that any offset in the range can need, integrated; a long log costs memory.
Result<OrientationTrack> IntegrateWindow(const GyroLog& log, const std::vector<SyncPair>& pairs,
                                         const OffsetSearchOptions& search,
                                         double frame_interval_s) {
  double first_s = pairs.front().from_time_s;
  double last_s = pairs.front().to_time_s;
  for (const SyncPair& pair : pairs) {
    first_s = std::min(first_s, pair.from_time_s);
    last_s = std::max(last_s, pair.to_time_s);
  }
  const double margin_s = frame_interval_s + kFitRadius_s + kFilterMargin_s;
  const double begin_s = first_s - search.max_offset_s - margin_s;
  const double end_s = last_s - search.min_offset_s + margin_s;
  std::vector<GyroSample> window;
  for (const GyroSample& sample : log.samples()) {
    if (sample.time_s >= begin_s && sample.time_s <= end_s) {
      window.push_back(sample);
    }
  }
  const GyroIntegrationOptions integration{.low_pass_hz = kLowPass_hz};
  if (window.size() == log.samples().size()) {
    return IntegrateGyro(log, integration);
  }
  const auto part = GyroLog::Create(std::move(window));
  if (!part) {
    return Fail(
        ErrorCode::kUntrustworthy,
        "the gyro log, {:.2f} s to {:.2f} s on its own clock, does not overlap the clip "
        "within the searched offsets: check that it belongs to this clip, or search farther",
        log.start_s(), log.end_s());
  }
  return IntegrateGyro(*part, integration);
}

Status ValidateOptions(const GyroSyncOptions& options, const Camera& camera) {
  if (!std::isfinite(options.initial_offset_s) || !(options.search_s >= 0.0) ||
      !(options.search_s <= kMaxSearch_s)) {
    return Fail(ErrorCode::kInvalidArgument,
                "gyro synchronisation: offset {} s must be finite and its search range {} s within "
                "0 and {}",
                options.initial_offset_s, options.search_s, kMaxSearch_s);
  }
  if (!(options.focal_is_known && options.lens_is_known) && camera.model != LensModel::kPinhole) {
    return Fail(ErrorCode::kInvalidArgument,
                "gyro synchronisation: focal length and lens can be estimated only for a camera "
                "given as a pinhole");
  }
  return {};
}

bool BendsVisibly(const SyncFit& fit) {
  return fit.state.curvature < -std::max(kVisibleCurvature, 2.0 * fit.sigma.curvature);
}

// `camera` with the fitted readout, focal length and lens.
Camera EstimatedCamera(const Camera& camera, const SyncState& state) {
  Camera result = camera;
  result.readout_s = state.readout_s;
  result.fx *= std::exp(state.log_focal);
  result.fy *= std::exp(state.log_focal);
  if (state.curvature == 0.0) {
    return result;
  }
  // The division model as a fisheye polynomial, least squares over the angles that the image shows:
  // theta_d(theta) = theta (1 + k1 theta^2 + .. + k4 theta^8).
  constexpr int kAngles = 64;
  constexpr double kBeyondTheCorner = 1.1;
  constexpr double kMaxAngle = 1.4;
  const double corner =
      std::hypot(std::max(camera.cx, camera.width - 1.0 - camera.cx) / result.fx,
                 std::max(camera.cy, camera.height - 1.0 - camera.cy) / result.fy);
  const double denominator = 1.0 + state.curvature * corner * corner;
  const double max_angle =
      denominator > 0.0 ? std::min(kBeyondTheCorner * std::atan(corner / denominator), kMaxAngle)
                        : kMaxAngle;
  Eigen::Matrix<double, kAngles, 4> powers;
  Eigen::Matrix<double, kAngles, 1> excess;
  for (int i = 0; i < kAngles; ++i) {
    const double theta = max_angle * (i + 1) / kAngles;
    const Eigen::Vector2d bent = BendPlane(Eigen::Vector2d(std::tan(theta), 0.0), state.curvature);
    const double t2 = theta * theta;
    powers.row(i) = theta * Eigen::RowVector4d(t2, t2 * t2, t2 * t2 * t2, t2 * t2 * t2 * t2);
    excess(i) = bent.x() - theta;
  }
  const Eigen::Vector4d k = powers.colPivHouseholderQr().solve(excess);
  result.model = LensModel::kFisheye;
  result.distortion.assign(k.begin(), k.end());
  return result;
}

// Squared motion (px^2) that a fit leaves, over the pairs marked in `among` (all when empty);
// motion that the log does not cover is left altogether.
double Unexplained(const SyncFit& fit, const std::vector<bool>& among = {}) {
  double sum = 0.0;
  for (std::size_t i = 0; i < fit.residual_px.size(); ++i) {
    if (among.empty() || among[i]) {
      sum += std::pow(fit.residual_px[i], 2);
    }
  }
  return sum;
}

struct Candidates {
  SyncFit best;
  // What the best fit at another offset leaves unexplained, over what `best` leaves; infinite when
  // there is no other.
  double rival_ratio;
};

// Refines the peaks of the search on a small sample, each to its own minimum.
std::optional<Candidates> RefineCandidates(const std::vector<SyncPair>& pairs,
                                           const OrientationTrack& track,
                                           const std::vector<OffsetCandidate>& peaks,
                                           SyncFitOptions options) {
  const std::vector<SyncPair> sample = SelectInformativePairs(pairs, kCandidatePairs);
  options.offset_radius_s = kFitRadius_s;
  options.max_matches = kCandidateMatches;
  options.max_iterations = kCandidateIterations;
  std::vector<SyncFit> fits;
  for (const OffsetCandidate& peak : peaks) {
    if (peak.explained < kMinPeakRatio * peaks.front().explained) {
      break;  // sorted: the rest is weaker still
    }
    const SyncState start{peak.offset_s, Eigen::Vector3d::Zero(), 0.0, 0.0, peak.readout_s};
    if (auto fit = FitSync(sample, track, start, options); fit && !fit->offset_at_bound) {
      fits.push_back(*fit);
    }
  }
  if (fits.empty()) {
    return std::nullopt;
  }
  const auto best = std::min_element(fits.begin(), fits.end(), [](const auto& a, const auto& b) {
    return Unexplained(a) < Unexplained(b);
  });
  Candidates result{*best, std::numeric_limits<double>::infinity()};
  for (const SyncFit& fit : fits) {
    if (std::abs(fit.state.offset_s - best->state.offset_s) > kDistinctOffset_s) {
      result.rival_ratio =
          std::min(result.rival_ratio, Unexplained(fit, best->is_covered) /
                                           std::max(Unexplained(*best, best->is_covered), 1e-12));
    }
  }
  return result;
}

// The fit on the full sample, started at the best candidate.
std::optional<SyncFit> FinalFit(const std::vector<SyncPair>& pairs, const OrientationTrack& track,
                                const SyncState& start, SyncFitOptions options) {
  const std::vector<SyncPair> sample = SelectInformativePairs(pairs, kFinalPairs);
  options.offset_radius_s = kFitRadius_s;
  options.max_matches = kFinalMatches;
  auto fit = FitSync(sample, track, start, options);
  if (fit && options.fit_curvature && !BendsVisibly(*fit)) {
    // A pinhole explains the clip as well: keep to the simpler lens.
    options.fit_curvature = false;
    SyncState pinhole = fit->state;
    pinhole.curvature = 0.0;
    fit = FitSync(sample, track, pinhole, options);
  }
  return fit;
}

double ExplainedShare(const SyncFit& fit) {
  return 1.0 - std::pow(fit.rms_px / std::max(fit.rms_without_gyro_px, 1e-9), 2);
}

// Why the estimate must not be used, if so.
Status CheckTrust(const SyncFit& fit, double rival_ratio) {
  const double offset_s = fit.state.offset_s;
  const bool is_precise = fit.sigma.offset_s <= kMaxOffsetSigma_s;
  const double explained = ExplainedShare(fit);
  if (fit.rms_without_gyro_px < kSmallMotion_px && !(is_precise && explained >= kMinExplained)) {
    return Fail(ErrorCode::kUntrustworthy,
                "the picture moves too little to tell the gyro log's offset (best guess {:.3f} s): "
                "give the offset by hand",
                offset_s);
  }
  if (!(explained >= kMinExplained)) {
    return Fail(ErrorCode::kUntrustworthy,
                "the gyro log explains only {:.0f}% of the clip's motion at its best offset "
                "({:.3f} s): check that it belongs to this clip and that its axes are mapped to "
                "the camera's",
                100.0 * std::max(explained, 0.0), offset_s);
  }
  if (!is_precise) {
    return Fail(ErrorCode::kUntrustworthy,
                "the clip's motion follows the gyro log too loosely to tell its offset (best guess "
                "{:.3f} s, uncertain by {:.1f} ms): check that the log belongs to this clip, or "
                "give the offset by hand",
                offset_s, 1e3 * fit.sigma.offset_s);
  }
  if (!(rival_ratio >= kMinRivalRatio)) {
    return Fail(
        ErrorCode::kUntrustworthy,
        "several offsets fit the clip nearly as well as the best one ({:.3f} s): narrow the "
        "search or give the offset by hand",
        offset_s);
  }
  return {};
}

}  // namespace

Result<GyroSyncResult> SynchronizeGyro(std::span<const PointTracks> tracks, const GyroLog& log,
                                       const Camera& camera, const GyroSyncOptions& options) {
  if (const Status valid = ValidateOptions(options, camera); !valid) {
    return Propagate(valid.error());
  }
  const auto pairs = PrepareSyncPairs(tracks, camera, kMinMatches, kMaxMatches);
  if (!pairs) {
    return Propagate(pairs.error());
  }
  if (pairs->size() < kMinFitPairs) {
    return Fail(ErrorCode::kUntrustworthy,
                "only {} of {} frame pairs have enough tracks to compare with the gyro log; at "
                "least {} are needed: give the offset by hand",
                pairs->size(), tracks.size(), kMinFitPairs);
  }
  SyncFitOptions fit_options;
  fit_options.fit_focal = !options.focal_is_known;
  fit_options.fit_curvature = !options.lens_is_known;
  fit_options.fit_readout = !camera.readout_s.has_value();
  fit_options.frame_interval_s = MedianInterval(*pairs);
  OffsetSearchOptions search;
  search.min_offset_s = options.initial_offset_s - options.search_s;
  search.max_offset_s = options.initial_offset_s + options.search_s;
  if (camera.readout_s) {
    search.readouts_s = {*camera.readout_s};
  } else {
    search.readouts_s.clear();
    for (const double frames : kReadoutHypotheses) {
      search.readouts_s.push_back(frames * fit_options.frame_interval_s);
    }
  }

  const auto track = IntegrateWindow(log, *pairs, search, fit_options.frame_interval_s);
  if (!track) {
    return Propagate(track.error());
  }
  const std::vector<OffsetCandidate> peaks =
      SearchOffsets(SelectInformativePairs(*pairs, kSearchPairs), *track, search);
  const auto candidates = RefineCandidates(*pairs, *track, peaks, fit_options);
  const auto fit =
      candidates ? FinalFit(*pairs, *track, candidates->best.state, fit_options) : std::nullopt;
  if (!fit || fit->offset_at_bound) {
    return Fail(ErrorCode::kUntrustworthy,
                "no offset between {:.2f} s and {:.2f} s lets the gyro log (its clock: {:.2f} s to "
                "{:.2f} s) follow the motion of the clip: check that it belongs to this clip, or "
                "give the offset by hand",
                search.min_offset_s, search.max_offset_s, log.start_s(), log.end_s());
  }
  if (const Status trust = CheckTrust(*fit, candidates->rival_ratio); !trust) {
    return Propagate(trust.error());
  }

  GyroSyncResult result;
  result.offset_s = fit->state.offset_s;
  result.offset_sigma_s = fit->sigma.offset_s;
  result.camera = EstimatedCamera(camera, fit->state);
  result.focal_ratio = std::exp(fit->state.log_focal);
  result.focal_ratio_sigma = result.focal_ratio * fit->sigma.log_focal;
  result.readout_s = fit->state.readout_s;
  result.readout_sigma_s = fit->sigma.readout_s;
  result.bias_rad_s = fit->state.bias_rad_s;
  result.focal_is_trusted = fit->sigma.log_focal <= kMaxFocalSigma;
  result.readout_is_trusted =
      fit->sigma.readout_s <=
      std::max(kMaxReadoutSigma_s, kMaxReadoutSigmaRatio * std::abs(fit->state.readout_s));
  result.rms_px = fit->rms_px;
  result.rms_without_gyro_px = fit->rms_without_gyro_px;
  // Each factor falls from 1 towards the limit at which the estimate is refused.
  const double precision = 1.0 - 0.5 * fit->sigma.offset_s / kMaxOffsetSigma_s;
  const double uniqueness = 1.0 - 0.5 * kMinRivalRatio / candidates->rival_ratio;
  result.confidence = std::clamp(ExplainedShare(*fit) * precision * uniqueness, 0.0, 1.0);
  return result;
}

}  // namespace rsstab::igf
