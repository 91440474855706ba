// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_STABILIZER_PIPELINE_TRACK_SPOOL_H_
#define RSSTAB_STABILIZER_PIPELINE_TRACK_SPOOL_H_

#include <memory>
#include <optional>

#include "igf/base/result.h"
#include "stabilizer/pipeline/frame_observation.h"

namespace rsstab::pipeline {

// Observations of a whole clip in an anonymous temporary file, so that a source that must see the
// clip before it can speak (gyro synchronisation) costs no memory per frame: about 4 KB of disk a
// frame instead. Write all, then read in order, as often as needed.
class TrackSpool {
 public:
  // Errors: kIo when the folder for temporary files ($TMPDIR or /tmp) cannot be written.
  [[nodiscard]] static Result<std::unique_ptr<TrackSpool>> Create();
  ~TrackSpool();
  TrackSpool(const TrackSpool&) = delete;
  TrackSpool& operator=(const TrackSpool&) = delete;

  [[nodiscard]] Status Append(const FrameObservation& observation);
  // Back to the first observation.
  [[nodiscard]] Status Rewind();
  // The next one; empty at the end.
  [[nodiscard]] Result<std::optional<FrameObservation>> Next();
  [[nodiscard]] std::int64_t count() const;

 private:
  struct Impl;
  explicit TrackSpool(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace rsstab::pipeline

#endif  // RSSTAB_STABILIZER_PIPELINE_TRACK_SPOOL_H_
