// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <deque>
#include <string>
#include <utility>

#include "plugin/capi/instance.h"
#include "stabilizer/pipeline/timed_renderer.h"

namespace rsstab::capi {
namespace {

constexpr std::size_t kMaxWaiting = 4;
constexpr double kMaxTicks = 9e18;  // below 2^63

class ApplyInstance final : public Instance {
 public:
  ApplyInstance(const InstanceSetup& setup, std::unique_ptr<pipeline::TimedRenderer> renderer)
      : format_(setup.format), options_(setup.options), renderer_(std::move(renderer)) {}

  Reply Push(const PushedFrame& pushed) override {
    if (flushed_) {
      return {RSSTAB_ERROR_BAD_STATE, "flushed: no frame can follow before rsstab_reset()"};
    }
    if (waiting_.size() >= kMaxWaiting) {
      return {RSSTAB_AGAIN, "steady frames wait: pull them first"};
    }
    auto frame = HostFrame::Make(pushed, format_, pool_);
    if (!frame) {
      return frame.error();
    }
    waiting_.push_back(std::move(*frame));
    waiting_.back().Accept();
    return RSSTAB_OK;
  }

  Reply Flush() override {
    flushed_ = true;
    return RSSTAB_OK;
  }

  Reply Peek(NextFrame& next) override {
    if (waiting_.empty()) {
      return flushed_ ? RSSTAB_END : RSSTAB_AGAIN;
    }
    next = {waiting_.front().pts(), FrameDataOf(waiting_.front().frame())};
    return RSSTAB_OK;
  }

  Reply Pull(const rsstab_buffer& buffer, NextFrame& next) override {
    if (Reply reply = Peek(next); reply.status != RSSTAB_OK) {
      return reply;
    }
    auto destination = ToFrame(buffer, format_);
    if (!destination) {
      return destination.error();
    }
    const HostFrame frame = std::move(waiting_.front());
    waiting_.pop_front();
    return RenderView(frame.frame().View(), frame.pts(), *destination);
  }

  Reply Render(const rsstab_picture& picture, std::int64_t pts,
               const rsstab_buffer& buffer) override {
    const auto view = ToFrameView(picture, format_);
    if (!view) {
      return view.error();
    }
    auto destination = ToFrame(buffer, format_);
    if (!destination) {
      return destination.error();
    }
    return RenderView(*view, pts, *destination);
  }

  Reply FrameTime(std::int64_t index, std::int64_t& pts) const override {
    const auto time_s = renderer_->TimeOf(index);
    const double ticks = time_s.value_or(0.0) / format_.seconds_per_tick;
    if (!time_s || !(std::abs(ticks) < kMaxTicks)) {
      return {RSSTAB_ERROR_INVALID_ARGUMENT,
              "the analysis file has no frame " + std::to_string(index)};
    }
    pts = std::llround(ticks);
    return RSSTAB_OK;
  }

  Reply Reset() override {
    waiting_.clear();
    flushed_ = false;
    renderer_->Reset();
    return RSSTAB_OK;
  }

  Reply Set(const std::string& name, const std::string& value) override {
    if (name != "interpolation") {
      return Instance::Set(name, value);
    }
    Reply reply = SetOption(options_, name, value);
    renderer_->set_interpolation(options_.stabilize.interpolation);
    return reply;
  }

 private:
  Reply RenderView(const FrameView& view, std::int64_t pts, Frame& destination) {
    const double time_s = static_cast<double>(pts) * format_.seconds_per_tick;
    Status status = renderer_->Render(view, time_s, destination);
    if (!status && status.error().code == ErrorCode::kNotFound) {
      CopySamples(view, destination);
      return {RSSTAB_UNCHANGED, std::move(status.error().message)};
    }
    return status;
  }

  VideoFormat format_;
  pipeline::OnlineOptions options_;
  FramePool pool_;
  std::unique_ptr<pipeline::TimedRenderer> renderer_;
  std::deque<HostFrame> waiting_;
  bool flushed_ = false;
};

}  // namespace

Result<std::unique_ptr<Instance>> MakeApplyInstance(const InstanceSetup& setup) {
  auto renderer = pipeline::TimedRenderer::Create(
      setup.options.stabilize, setup.path, setup.format.width, setup.format.height, setup.logger);
  if (!renderer) {
    return Propagate(std::move(renderer.error()));
  }
  return std::make_unique<ApplyInstance>(setup, std::move(*renderer));
}

}  // namespace rsstab::capi
