// SPDX-License-Identifier: Apache-2.0
#include "plugin/capi/host_frame.h"

#include <memory>
#include <utility>

namespace rsstab::capi {
namespace {

// Lives as long as the frame does.
struct Hold {
  explicit Hold(void* data) : frame_data(data) {}
  ~Hold() {
    if (release != nullptr) {
      release(frame_data);
    }
  }
  Hold(const Hold&) = delete;
  Hold& operator=(const Hold&) = delete;

  void* frame_data;
  rsstab_release_function release = nullptr;  // set once the frame is accepted
  rsstab_release_function wanted = nullptr;
  std::shared_ptr<void> memory;  // of a copy
};

}  // namespace

Result<Frame> FramePool::Take(const VideoFormat& format) {
  for (const Frame& frame : frames_) {
    if (frame.storage.use_count() == 1) {
      return frame;
    }
  }
  auto frame = AllocateFrame(format.layout, format.width, format.height);
  if (frame) {
    frames_.push_back(*frame);
  }
  return frame;
}

Result<HostFrame> HostFrame::Make(const PushedFrame& pushed, const VideoFormat& format,
                                  FramePool& pool) {
  const auto view = ToFrameView(*pushed.picture, format);
  if (!view) {
    return Propagate(view.error());
  }
  auto hold = std::make_shared<Hold>(pushed.frame_data);
  HostFrame made;
  made.pts_ = pushed.pts;
  if (pushed.release == nullptr) {
    auto copy = pool.Take(format);
    if (!copy) {
      return Propagate(std::move(copy.error()));
    }
    CopySamples(*view, *copy);
    made.frame_ = std::move(*copy);
    hold->memory = std::move(made.frame_.storage);
  } else {
    made.frame_.layout = view->layout;
    made.frame_.width = view->width;
    made.frame_.height = view->height;
    for (std::size_t p = 0; p < view->planes.size(); ++p) {
      const PlaneView& plane = view->planes[p];
      // Frames inside are only read.
      made.frame_.planes[p] = {
          const_cast<std::uint8_t*>(plane.data),  // NOLINT(cppcoreguidelines-pro-type-const-cast)
          plane.stride, plane.width, plane.height};
    }
    hold->wanted = pushed.release;
  }
  made.frame_.origin = hold;
  made.frame_.storage = std::move(hold);
  return made;
}

void HostFrame::Accept() {
  auto* hold = static_cast<Hold*>(frame_.storage.get());
  hold->release = hold->wanted;
}

void* FrameDataOf(const Frame& frame) {
  return static_cast<const Hold*>(frame.origin.get())->frame_data;
}

}  // namespace rsstab::capi
