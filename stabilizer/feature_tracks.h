// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_STABILIZER_FEATURE_TRACKS_H_
#define RSSTAB_STABILIZER_FEATURE_TRACKS_H_

#include <memory>

#include "igf/base/point_tracks.h"
#include "igf/base/result.h"
#include "stabilizer/luma_proxy.h"

namespace rsstab::stabilizer {

struct FeatureTrackerOptions {
  int cell_px = 20;                      // at most one new point per square of this side
  double min_corner_quality = 0.01;      // of the strongest corner in the frame
  double min_corner_strength = 1e-4;     // smallest eigenvalue; below it "corners" are noise
  double max_forward_backward_px = 0.5;  // a point must come back to where it started
  int border_px = 4;                     // no points this close to the edge
  int window_px = 15;                    // side of the matching window (odd)
  int pyramid_levels = 4;                // including full size: catches jumps of about 60 px at 640
};

// Points followed from one picture to the next: Shi-Tomasi corners, the best of every cell so that
// they spread evenly, pyramidal Lucas-Kanade there and back (Bouguet; Kalal's forward-backward
// check). Points live on while they are found; emptied cells get new ones.
class FeatureTracker {
 public:
  explicit FeatureTracker(const FeatureTrackerOptions& options);
  ~FeatureTracker();
  FeatureTracker(const FeatureTracker&) = delete;
  FeatureTracker& operator=(const FeatureTracker&) = delete;

  struct Output {
    PointTracks tracks;  // previous picture -> this one, in proxy pixels; empty for the first
    int attempted = 0;   // points that were looked for
  };

  // Pictures in order, all of one size (kInvalidArgument otherwise). `time_s` is the time of the
  // middle row.
  [[nodiscard]] Result<Output> Push(const GrayImage& image, double time_s);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rsstab::stabilizer

#endif  // RSSTAB_STABILIZER_FEATURE_TRACKS_H_
