// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_STABILIZER_METRICS_METRIC_TRACKS_DETAIL_H_
#define RSSTAB_STABILIZER_METRICS_METRIC_TRACKS_DETAIL_H_

#include <opencv2/core.hpp>
#include <vector>

#include "igf/base/point_tracks.h"

namespace rsstab::stabilizer::detail {

// Tracks for metrics: the best corner of every 20x20 px cell of `from` that is at least 10 px from
// the border and has 2% of the picture's best corner strength, followed to `to` by pyramidal
// Lucas-Kanade (15x15, 4 levels) and back, the way back ending within 0.3 px. All lengths at
// reference width. Both pictures 8 bit, one channel, equal size; matches in their pixels, cell by
// cell in reading order. Own code on purpose: the stabilizer's tracker must not judge itself.
[[nodiscard]] std::vector<PointMatch> MetricTracks(const cv::Mat& from, const cv::Mat& to);

}  // namespace rsstab::stabilizer::detail

#endif  // RSSTAB_STABILIZER_METRICS_METRIC_TRACKS_DETAIL_H_
