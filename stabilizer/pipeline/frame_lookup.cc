// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/pipeline/frame_lookup.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace rsstab::pipeline {
namespace {

using stabilizer::LumaFingerprint;
using stabilizer::RecordKey;

// A frame that comes a little early belongs to the record about to begin. Rounding to another time
// base (milliseconds of Matroska) moves a frame by a fiftieth of its interval; frames doubled in
// between come half an interval late.
constexpr double kEarlyShare = 0.25;
constexpr double kExactShare = 0.05;
// The last frame is on show for one interval, an uneven clip's for a little longer.
constexpr double kLastFrameShare = 1.5;
// Limited to full range is 255 / 219 = 1.16; more is another picture.
constexpr double kMinGain = 0.8;
constexpr double kMaxGain = 1.25;
// Fingerprints are whole levels: below this two pictures cannot be told apart.
constexpr double kAlike = 0.05;
constexpr double kDefaultFrameRate = 30.0;

double TickLength(const std::vector<RecordKey>& keys, const stabilizer::ClipAnalysis& clip,
                  double frame_s) {
  if (std::isfinite(clip.seconds_per_tick) && clip.seconds_per_tick > 0.0) {
    return clip.seconds_per_tick;
  }
  // A file that does not say: its frames follow each other at the clip's mean rate.
  const auto [first, last] =
      std::minmax_element(keys.begin(), keys.end(),
                          [](const RecordKey& a, const RecordKey& b) { return a.pts < b.pts; });
  const double ticks = static_cast<double>(last->pts) - static_cast<double>(first->pts);
  return ticks > 0.0 ? static_cast<double>(keys.size() - 1) * frame_s / ticks : frame_s;
}

}  // namespace

double PictureDistance(const LumaFingerprint& seen, const LumaFingerprint& stored) {
  constexpr double kCount = static_cast<double>(std::tuple_size_v<LumaFingerprint>);
  const double mean_seen = std::accumulate(seen.begin(), seen.end(), 0.0) / kCount;
  const double mean_stored = std::accumulate(stored.begin(), stored.end(), 0.0) / kCount;
  double variance = 0.0;
  double covariance = 0.0;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    variance += (seen[i] - mean_seen) * (seen[i] - mean_seen);
    covariance += (seen[i] - mean_seen) * (stored[i] - mean_stored);
  }
  const double gain = variance > 0.0 ? std::clamp(covariance / variance, kMinGain, kMaxGain) : 1.0;
  double sum = 0.0;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    sum += std::abs(gain * (seen[i] - mean_seen) - (stored[i] - mean_stored));
  }
  return sum / kCount;
}

FrameLookup::FrameLookup(std::vector<RecordKey> keys, const stabilizer::ClipAnalysis& clip)
    : keys_(std::move(keys)), by_time_(keys_.size()) {
  const bool rate_is_known = std::isfinite(clip.frames_per_second) && clip.frames_per_second > 0.0;
  frame_s_ = 1.0 / (rate_is_known ? clip.frames_per_second : kDefaultFrameRate);
  seconds_per_tick_ = TickLength(keys_, clip, frame_s_);
  std::iota(by_time_.begin(), by_time_.end(), std::size_t{0});
  std::stable_sort(by_time_.begin(), by_time_.end(),
                   [this](std::size_t a, std::size_t b) { return keys_[a].pts < keys_[b].pts; });
}

double FrameLookup::TimeOf(std::size_t record) const {
  return static_cast<double>(keys_[record].pts) * seconds_per_tick_;
}

std::optional<FrameLookup::Match> FrameLookup::AtTime(double time_s) const {
  const double latest_begin = time_s + kEarlyShare * frame_s_;
  const auto after =
      std::upper_bound(by_time_.begin(), by_time_.end(), latest_begin,
                       [this](double t, std::size_t record) { return t < TimeOf(record); });
  if (after == by_time_.begin()) {
    return std::nullopt;
  }
  const std::size_t record = *std::prev(after);
  const double since = time_s - TimeOf(record);
  if (!(after != by_time_.end() || since < kLastFrameShare * frame_s_)) {
    return std::nullopt;
  }
  return Match{record, std::abs(since) <= kExactShare * frame_s_};
}

std::optional<std::size_t> FrameLookup::ByPicture(const LumaFingerprint& fingerprint,
                                                  double max_distance, double time_s) const {
  std::vector<double> distances(keys_.size());
  std::transform(keys_.begin(), keys_.end(), distances.begin(), [&](const RecordKey& key) {
    return PictureDistance(fingerprint, key.fingerprint);
  });
  const double smallest = *std::min_element(distances.begin(), distances.end());
  if (!(smallest <= max_distance)) {
    return std::nullopt;
  }
  std::optional<std::size_t> best;
  for (std::size_t i = 0; i < keys_.size(); ++i) {
    if (distances[i] <= smallest + kAlike &&
        (!best || std::abs(TimeOf(i) - time_s) < std::abs(TimeOf(*best) - time_s))) {
      best = i;
    }
  }
  return best;
}

}  // namespace rsstab::pipeline
