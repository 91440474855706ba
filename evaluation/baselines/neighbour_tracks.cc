// SPDX-License-Identifier: Apache-2.0
#include "evaluation/baselines/neighbour_tracks.h"

#include <array>
#include <utility>

#include "stabilizer/feature_tracks.h"
#include "stabilizer/luma_proxy.h"

namespace rsstab::evaluation {

Result<std::vector<PointTracks>> TrackNeighbours(const MethodInput& input, std::size_t least) {
  if (input.previous == nullptr && input.next == nullptr) {
    return Fail(ErrorCode::kUnsupported, "the picture has no frame before or after it");
  }
  stabilizer::FeatureTracker tracker{stabilizer::FeatureTrackerOptions()};
  std::vector<PointTracks> pairs;
  const std::array<std::pair<const FrameView*, double>, 3> frames = {
      {{input.previous, -1.0}, {&input.rs, 0.0}, {input.next, 1.0}}};
  for (const auto& [frame, time] : frames) {
    if (frame == nullptr) {
      continue;
    }
    const auto luma = stabilizer::MakeLumaProxy(*frame);
    if (!luma) {
      return Propagate(luma.error());
    }
    auto output = tracker.Push(*luma, time);
    if (!output) {
      return Propagate(output.error());
    }
    const bool is_first = pairs.empty() && time == (input.previous != nullptr ? -1.0 : 0.0);
    if (is_first) {
      continue;
    }
    if (output->tracks.matches.size() < least) {
      return Fail(ErrorCode::kUntrustworthy, "only {} points could be followed between frames",
                  output->tracks.matches.size());
    }
    pairs.push_back(std::move(output->tracks));
  }
  return pairs;
}

}  // namespace rsstab::evaluation
