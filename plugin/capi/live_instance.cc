// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include "plugin/capi/instance.h"
#include "stabilizer/pipeline/online_stabilizer.h"
#include "stabilizer/pipeline/rs_input_files.h"

namespace rsstab::capi {
namespace {

using pipeline::OnlineStabilizer;

// Steady frames that may wait before the host has to pull.
constexpr std::size_t kMaxWaiting = 4;
constexpr std::array<std::string_view, 4> kChangeable = {"smoothness", "tripod", "crop",
                                                         "interpolation"};

class LiveInstance final : public Instance {
 public:
  explicit LiveInstance(const InstanceSetup& setup) : setup_(setup) {}

  Status Start() {
    const VideoFormat& format = setup_.format;
    auto inputs = pipeline::ReadRsInputFiles(setup_.options.stabilize, format.width, format.height,
                                             setup_.logger);
    if (!inputs) {
      return Propagate(std::move(inputs.error()));
    }
    auto stabilizer = OnlineStabilizer::Create(
        setup_.options, {format.width, format.height, format.frames_per_second}, std::move(*inputs),
        setup_.logger);
    if (!stabilizer) {
      return Propagate(std::move(stabilizer.error()));
    }
    stabilizer_ = std::move(*stabilizer);
    return {};
  }

  Reply Push(const PushedFrame& pushed) override {
    if (stabilizer_->is_flushed()) {
      return {RSSTAB_ERROR_BAD_STATE, "flushed: no frame can follow before rsstab_reset()"};
    }
    const auto delay = static_cast<std::size_t>(setup_.options.lookahead_frames);
    if (stabilizer_->num_waiting() >= delay + kMaxWaiting) {
      return {RSSTAB_AGAIN, "steady frames wait: pull them first"};
    }
    auto frame = HostFrame::Make(pushed, setup_.format, pool_);
    if (!frame) {
      return frame.error();
    }
    const double time_s = static_cast<double>(pushed.pts) * setup_.format.seconds_per_tick;
    Reply reply = stabilizer_->Push(frame->frame(), pushed.pts, time_s);
    if (reply.status == RSSTAB_OK) {
      frame->Accept();
    }
    return reply;
  }

  Reply Flush() override {
    if (stabilizer_->is_flushed()) {
      return {RSSTAB_ERROR_BAD_STATE, "flushed already"};
    }
    return stabilizer_->Flush();
  }

  Reply Peek(NextFrame& next) override {
    const auto ready = stabilizer_->Peek();
    if (!ready) {
      return ready.error();
    }
    if (!*ready) {
      return stabilizer_->is_flushed() ? RSSTAB_END : RSSTAB_AGAIN;
    }
    next = {(*ready)->pts, FrameDataOf(*(*ready)->frame)};
    return RSSTAB_OK;
  }

  Reply Pull(const rsstab_buffer& buffer, NextFrame& next) override {
    if (Reply reply = Peek(next); reply.status != RSSTAB_OK) {
      return reply;
    }
    auto destination = ToFrame(buffer, setup_.format);
    if (!destination) {
      return destination.error();
    }
    return stabilizer_->Render(*destination);
  }

  Reply Reset() override { return Start(); }

  Reply Set(const std::string& name, const std::string& value) override {
    if (std::find(kChangeable.begin(), kChangeable.end(), name) == kChangeable.end()) {
      return Instance::Set(name, value);
    }
    pipeline::OnlineOptions options = setup_.options;
    if (Status ok = SetOption(options, name, value); !ok) {
      return ok;
    }
    if (Status ok = stabilizer_->Update(options); !ok) {
      return ok;
    }
    setup_.options = options;
    return RSSTAB_OK;
  }

  int Delay() const override { return setup_.options.lookahead_frames; }

 private:
  InstanceSetup setup_;
  FramePool pool_;
  std::unique_ptr<OnlineStabilizer> stabilizer_;
};

}  // namespace

Result<std::unique_ptr<Instance>> MakeLiveInstance(const InstanceSetup& setup) {
  auto instance = std::make_unique<LiveInstance>(setup);
  if (Status ok = instance->Start(); !ok) {
    return Propagate(std::move(ok.error()));
  }
  return instance;
}

}  // namespace rsstab::capi
