// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/pipeline/clip_observer.h"

#include <cstddef>

#include "stabilizer/track_cells.h"

namespace rsstab::pipeline {
namespace {

// Synchronisation looks at a minute of the clip at most, thinned to this many points a frame:
// 4 MB, and more would not make it surer.
constexpr std::int64_t kMaxSyncFrames = 1800;
constexpr std::size_t kMaxSyncMatches = 80;

PointTracks Thin(const PointTracks& tracks) {
  PointTracks thinned = tracks;
  const std::size_t n = tracks.matches.size();
  if (n > kMaxSyncMatches) {
    thinned.matches.clear();
    for (std::size_t i = 0; i < kMaxSyncMatches; ++i) {
      thinned.matches.push_back(tracks.matches[i * n / kMaxSyncMatches]);
    }
  }
  return thinned;
}

}  // namespace

ClipObserver::ClipObserver(const StabilizeOptions& options, const ClipGeometry& clip,
                           const RsInputs& inputs)
    : lens_(KnownLens(options, clip, inputs)),
      calibrator_(CalibrationOptions(options, clip, inputs)) {}

void ClipObserver::Push(const PointTracks& tracks) {
  if (num_frames_ > 0 && num_frames_ < kMaxSyncFrames) {
    sync_tracks_.push_back(Thin(tracks));
  }
  ++num_frames_;
  calibrator_.Push(stabilizer::SummarizeTracks(tracks, lens_ ? &*lens_ : nullptr));
}

ClipEvidence ClipObserver::Conclude() { return {sync_tracks_, calibrator_.Calibrate()}; }

}  // namespace rsstab::pipeline
