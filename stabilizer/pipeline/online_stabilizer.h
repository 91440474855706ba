// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_STABILIZER_PIPELINE_ONLINE_STABILIZER_H_
#define RSSTAB_STABILIZER_PIPELINE_ONLINE_STABILIZER_H_

#include <cstdint>
#include <memory>
#include <optional>

#include "igf/base/frame.h"
#include "igf/base/log.h"
#include "igf/base/result.h"
#include "stabilizer/pipeline/motion_stage.h"
#include "stabilizer/pipeline/online_options.h"
#include "stabilizer/pipeline/rs_source_selection.h"

namespace rsstab::pipeline {

// Both passes in one, with a look-ahead window: frames in, steady frames out,
// OnlineOptions::lookahead_frames later. Memory is bounded by the window: it holds the frames that
// were pushed and not rendered yet. In order; not thread safe (uses threads of its own inside).
class OnlineStabilizer {
 public:
  // `inputs`: what is known of camera and gyro. Errors: kInvalidArgument; those of
  // SelectOnlineRsSource.
  [[nodiscard]] static Result<std::unique_ptr<OnlineStabilizer>> Create(
      const OnlineOptions& options, const ClipGeometry& clip, RsInputs inputs, Logger logger);
  ~OnlineStabilizer();
  OnlineStabilizer(const OnlineStabilizer&) = delete;
  OnlineStabilizer& operator=(const OnlineStabilizer&) = delete;

  // The next frame; shares its samples until it is rendered. All frames have one size and layout.
  // `pts` comes out with it; `time_s` is the time of the middle row (only a gyro log needs it).
  [[nodiscard]] Status Push(const Frame& frame, std::int64_t pts, double time_s);

  // No more frames will come: those inside become ready.
  [[nodiscard]] Status Flush();

  // The frame that Render() renders next; empty when none is ready. Valid until the next call.
  struct Ready {
    const Frame* frame = nullptr;
    std::int64_t pts = 0;
  };
  [[nodiscard]] Result<std::optional<Ready>> Peek();

  // Renders the frame that Peek() tells into `destination`, which has its layout and size, and lets
  // it go, also after a failure. Every pixel has a source inside the picture.
  [[nodiscard]] Status Render(Frame& destination);

  // Frames inside.
  [[nodiscard]] std::size_t num_waiting() const;
  [[nodiscard]] bool is_flushed() const;

  // Takes smoothness, tripod, crop and interpolation of `options` from the next frame on.
  [[nodiscard]] Status Update(const OnlineOptions& options);

 private:
  struct Impl;
  explicit OnlineStabilizer(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace rsstab::pipeline

#endif  // RSSTAB_STABILIZER_PIPELINE_ONLINE_STABILIZER_H_
