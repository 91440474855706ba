// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/pipeline/clip_observer.h"

#include <cmath>
#include <cstddef>
#include <utility>

#include "stabilizer/pipeline/camera_knowledge.h"
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
                           const RsInputs& inputs, Logger logger)
    : options_(options),
      frame_interval_s_(1.0 / clip.frames_per_second),
      logger_(std::move(logger)),
      lens_(KnownLens(options, clip, inputs)),
      calibrator_(CalibrationOptions(options, clip, inputs)) {
  if (NeedsPictures(options, inputs)) {
    pictures_.emplace();
  }
}

void ClipObserver::Push(const PointTracks& tracks, stabilizer::GrayImage picture) {
  if (num_frames_ > 0 && num_frames_ < kMaxSyncFrames) {
    sync_tracks_.push_back(Thin(tracks));
  }
  ++num_frames_;
  auto pair = stabilizer::SummarizeTracks(tracks, lens_ ? &*lens_ : nullptr);
  if (pictures_) {
    pictures_->Push(std::move(picture), pair.cells.empty()
                                            ? std::nullopt
                                            : std::optional<Eigen::Vector2d>(pair.affine.col(0)));
  }
  calibrator_.Push(std::move(pair));
}

ClipEvidence ClipObserver::Conclude() {
  ClipEvidence evidence{sync_tracks_, {}, {}};
  std::optional<stabilizer::Estimate> opinion;
  if (pictures_) {
    auto answer = AskPictures(options_, *pictures_, frame_interval_s_);
    if (!answer) {
      logger_->info("single pictures are not asked for the readout time: {}",
                    answer.error().message);
    } else if (std::isfinite(answer->sigma_s)) {
      opinion = {answer->readout_s, answer->sigma_s, true};
      evidence.pictures = std::move(*answer);
    }
  }
  evidence.calibration = calibrator_.Calibrate(opinion);
  return evidence;
}

}  // namespace rsstab::pipeline
