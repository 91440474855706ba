// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/pipeline/frame_observation.h"

#include <utility>

namespace rsstab::pipeline {

Result<ObservedFrame> ObserveFrame(stabilizer::FeatureTracker& tracker, const FrameView& frame,
                                   std::int64_t pts, double time_s) {
  auto proxy = stabilizer::MakeLumaProxy(frame);
  if (!proxy) {
    return Propagate(std::move(proxy.error()));
  }
  auto tracked = tracker.Push(*proxy, time_s);
  if (!tracked) {
    return Propagate(std::move(tracked.error()));
  }
  FrameObservation observation;
  observation.pts = pts;
  observation.time_s = time_s;
  observation.fingerprint = stabilizer::FingerprintOf(*proxy);
  observation.attempted_points = tracked->attempted;
  observation.tracks = std::move(tracked->tracks);
  return ObservedFrame{std::move(observation), std::move(*proxy)};
}

}  // namespace rsstab::pipeline
