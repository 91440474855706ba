// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_STABILIZER_PIPELINE_FRAME_LOOKUP_H_
#define RSSTAB_STABILIZER_PIPELINE_FRAME_LOOKUP_H_

#include <cstddef>
#include <optional>
#include <vector>

#include "stabilizer/analysis_file.h"

namespace rsstab::pipeline {

// Finds the record of a frame in an analysis file: by when it is shown, or by what it looks like.
// Const methods are safe from any thread.
class FrameLookup {
 public:
  // `keys` of all records in the file's order, at least one. `clip`: of the same file.
  FrameLookup(std::vector<stabilizer::RecordKey> keys, const stabilizer::ClipAnalysis& clip);

  struct Match {
    std::size_t record = 0;
    bool is_exact = false;  // the same instant, but for the rounding of another time base
  };
  // The record whose frame is on show at `time_s` (seconds of the analysed clip's clock): the last
  // one that begins there or earlier, or up to a quarter of a frame later. Empty before the first
  // frame and after the last.
  [[nodiscard]] std::optional<Match> AtTime(double time_s) const;

  // The record that looks most like `fingerprint`, if within `max_distance` (PictureDistance); of
  // those that look alike, the one nearest to `time_s`.
  [[nodiscard]] std::optional<std::size_t> ByPicture(const stabilizer::LumaFingerprint& fingerprint,
                                                     double max_distance, double time_s) const;

  [[nodiscard]] double TimeOf(std::size_t record) const;
  [[nodiscard]] double frame_s() const { return frame_s_; }  // usual time between frames
  [[nodiscard]] const std::vector<stabilizer::RecordKey>& keys() const { return keys_; }

 private:
  std::vector<stabilizer::RecordKey> keys_;
  std::vector<std::size_t> by_time_;  // records in order of their time
  double seconds_per_tick_ = 0.0;
  double frame_s_ = 0.0;
};

// Mean absolute difference of two fingerprints, 8-bit levels, after the brightness and contrast
// that bring `seen` closest to `stored`: a picture in another range or colour model still is the
// same.
[[nodiscard]] double PictureDistance(const stabilizer::LumaFingerprint& seen,
                                     const stabilizer::LumaFingerprint& stored);

}  // namespace rsstab::pipeline

#endif  // RSSTAB_STABILIZER_PIPELINE_FRAME_LOOKUP_H_
