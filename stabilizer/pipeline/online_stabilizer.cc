// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/pipeline/online_stabilizer.h"

#include <algorithm>
#include <deque>
#include <utility>

#include "stabilizer/feature_tracks.h"
#include "stabilizer/pipeline/frame_renderer.h"
#include "stabilizer/pipeline/online_rs_source.h"

namespace rsstab::pipeline {

struct OnlineStabilizer::Impl {
  Impl(const OnlineOptions& online_options, const ClipGeometry& geometry, Logger log)
      : options(online_options),
        delay(static_cast<std::size_t>(online_options.lookahead_frames)),
        clip(geometry),
        logger(std::move(log)) {}

  struct Waiting {
    Frame frame;
    std::int64_t pts = 0;
  };

  OnlineOptions options;
  std::size_t delay;
  ClipGeometry clip;
  Logger logger;
  RsSelection rs;
  std::unique_ptr<MotionStage> stage;
  std::unique_ptr<FrameRenderer> renderer;
  stabilizer::FeatureTracker tracker{stabilizer::FeatureTrackerOptions{}};
  std::deque<Waiting> frames;                      // pushed and not rendered
  std::deque<stabilizer::FrameAnalysis> analyses;  // of frames.front() and those after it
  bool flushed = false;

  void TakeAnalyses() {
    for (stabilizer::FrameAnalysis& analysis : stage->TakeReady()) {
      analyses.push_back(std::move(analysis));
    }
  }

  // The share of a side that a frame keeps. One zoom for a clip that is not known yet is the given
  // one, or the smallest that was allowed.
  [[nodiscard]] double CropRatio(const stabilizer::FrameAnalysis& analysis) const {
    const StabilizeOptions& wanted = options.stabilize;
    if (wanted.zoom == ZoomMode::kAdaptive && !wanted.tripod) {
      return analysis.crop_ratio;
    }
    const double fixed = wanted.fixed_zoom ? 1.0 / *wanted.fixed_zoom : wanted.min_crop_ratio;
    return std::min(fixed, analysis.crop_ratio);
  }
};

OnlineStabilizer::OnlineStabilizer(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
OnlineStabilizer::~OnlineStabilizer() = default;

Result<std::unique_ptr<OnlineStabilizer>> OnlineStabilizer::Create(const OnlineOptions& options,
                                                                   const ClipGeometry& clip,
                                                                   RsInputs inputs, Logger logger) {
  if (Status ok = Validate(options); !ok) {
    return Propagate(std::move(ok.error()));
  }
  auto impl = std::make_unique<Impl>(options, clip, logger ? std::move(logger) : SilentLogger());
  auto rs = SelectOnlineRsSource(options, clip, std::move(inputs), impl->logger);
  if (!rs) {
    return Propagate(std::move(rs.error()));
  }
  impl->rs = std::move(*rs);
  impl->logger->info("rolling shutter: {}", impl->rs.reason);
  auto stage = MotionStage::Create(options.stabilize, clip, &impl->rs, impl->logger,
                                   options.lookahead_frames);
  if (!stage) {
    return Propagate(std::move(stage.error()));
  }
  impl->stage = std::move(*stage);
  impl->renderer = std::make_unique<FrameRenderer>(
      RenderGeometry{clip.width, clip.height, clip.width, clip.height, impl->rs.camera},
      options.stabilize);
  return std::unique_ptr<OnlineStabilizer>(new OnlineStabilizer(std::move(impl)));
}

Status OnlineStabilizer::Push(const Frame& frame, std::int64_t pts, double time_s) {
  Impl& s = *impl_;
  const FrameView picture = frame.View();
  auto observed = ObserveFrame(s.tracker, picture, pts, time_s);
  if (!observed) {
    return Propagate(std::move(observed.error()));
  }
  if (Status ok = s.stage->Push(observed->observation, &picture); !ok) {
    return ok;
  }
  s.TakeAnalyses();
  s.frames.push_back({frame, pts});
  return {};
}

Status OnlineStabilizer::Flush() {
  Impl& s = *impl_;
  s.flushed = true;
  if (Status ok = s.stage->Finish(); !ok) {
    return ok;
  }
  s.TakeAnalyses();
  return {};
}

Result<std::optional<OnlineStabilizer::Ready>> OnlineStabilizer::Peek() {
  Impl& s = *impl_;
  if (s.frames.empty() || !(s.flushed || s.frames.size() > s.delay)) {
    return std::nullopt;
  }
  if (s.analyses.empty()) {
    return Fail(ErrorCode::kInternal, "a frame is due, but its motion is not decided");
  }
  return Ready{&s.frames.front().frame, s.frames.front().pts};
}

Status OnlineStabilizer::Render(Frame& destination) {
  Impl& s = *impl_;
  const auto ready = Peek();
  if (!ready || !*ready) {
    return Fail(ErrorCode::kInvalidArgument, "no frame is ready to be rendered");
  }
  const Impl::Waiting waiting = std::move(s.frames.front());
  s.frames.pop_front();
  const stabilizer::FrameAnalysis analysis = std::move(s.analyses.front());
  s.analyses.pop_front();
  return s.renderer->Render(waiting.frame.View(), analysis, s.CropRatio(analysis), destination);
}

std::size_t OnlineStabilizer::num_waiting() const { return impl_->frames.size(); }
bool OnlineStabilizer::is_flushed() const { return impl_->flushed; }

Status OnlineStabilizer::Update(const OnlineOptions& options) {
  Impl& s = *impl_;
  s.options = options;
  s.renderer->set_interpolation(options.stabilize.interpolation);
  return s.stage->Update(options.stabilize);
}

}  // namespace rsstab::pipeline
