// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_PLUGIN_CAPI_HOST_FRAME_H_
#define RSSTAB_PLUGIN_CAPI_HOST_FRAME_H_

#include <cstdint>
#include <vector>

#include "igf/base/frame.h"
#include "igf/base/result.h"
#include "plugin/capi/picture_format.h"
#include "plugin/capi/rsstab.h"

namespace rsstab::capi {

// Frames of one size whose memory is used again: as many as were ever alive at once.
class FramePool {
 public:
  // Errors: those of AllocateFrame.
  [[nodiscard]] Result<Frame> Take(const VideoFormat& format);

 private:
  std::vector<Frame> frames_;
};

// What rsstab_push() was given.
struct PushedFrame {
  const rsstab_picture* picture = nullptr;
  std::int64_t pts = 0;
  void* frame_data = nullptr;
  rsstab_release_function release = nullptr;  // null: copy
};

// A frame inside an instance: the host's memory, or a copy from `pool`.
class HostFrame {
 public:
  [[nodiscard]] static Result<HostFrame> Make(const PushedFrame& pushed, const VideoFormat& format,
                                              FramePool& pool);

  // `storage` of the frame releases the host's frame when its last copy goes, once Accept() was
  // called; before that it goes without a word.
  [[nodiscard]] const Frame& frame() const { return frame_; }
  [[nodiscard]] std::int64_t pts() const { return pts_; }
  void Accept();

 private:
  Frame frame_;
  std::int64_t pts_ = 0;
};

// The host's `frame_data` of a frame made here.
[[nodiscard]] void* FrameDataOf(const Frame& frame);

}  // namespace rsstab::capi

#endif  // RSSTAB_PLUGIN_CAPI_HOST_FRAME_H_
