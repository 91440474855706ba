// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/pipeline/renderer.h"

#include <optional>
#include <utility>

#include "stabilizer/luma_proxy.h"
#include "stabilizer/pipeline/frame_renderer.h"

namespace rsstab::pipeline {
namespace {

// Looking at a picture costs a millisecond, so only some are compared with pass 1.
constexpr std::int64_t kFingerprintEvery = 30;
// The same frame decoded again differs by less than one level, re-encoded by two.
constexpr double kMaxFingerprintDistance = 4.0;

}  // namespace

struct Renderer::Impl {
  Impl(std::unique_ptr<stabilizer::AnalysisReader> analysis, const StabilizeOptions& options)
      : reader(std::move(analysis)),
        frames({reader->clip().width, reader->clip().height, reader->clip().width,
                reader->clip().height, reader->clip().camera},
               options) {}

  std::unique_ptr<stabilizer::AnalysisReader> reader;
  FrameRenderer frames;
  std::int64_t num_frames = 0;
};

Renderer::Renderer(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Renderer::~Renderer() = default;

Result<std::unique_ptr<Renderer>> Renderer::Create(const StabilizeOptions& options,
                                                   const std::string& analysis_path, int width,
                                                   int height, Logger /*logger*/) {
  auto reader = stabilizer::AnalysisReader::Open(analysis_path);
  if (!reader) {
    return Propagate(std::move(reader.error()));
  }
  const stabilizer::ClipAnalysis& clip = (*reader)->clip();
  if (clip.width != width || clip.height != height) {
    return Fail(ErrorCode::kInvalidArgument,
                "{} was made for a clip of {}x{}, this one is {}x{}: analyse this clip",
                analysis_path, clip.width, clip.height, width, height);
  }
  return std::unique_ptr<Renderer>(
      new Renderer(std::make_unique<Impl>(std::move(*reader), options)));
}

const stabilizer::ClipAnalysis& Renderer::clip() const { return impl_->reader->clip(); }

Result<Frame> Renderer::Render(const Frame& frame, std::int64_t pts) {
  Impl& s = *impl_;
  auto record = s.reader->Next();
  if (!record) {
    return Propagate(std::move(record.error()));
  }
  if (!*record) {
    return Fail(ErrorCode::kInvalidArgument,
                "the clip goes on after frame {}, where the analysed one ended: analyse this clip",
                s.num_frames);
  }
  const stabilizer::FrameAnalysis& analysis = **record;
  if (analysis.pts != pts) {
    return Fail(
        ErrorCode::kInvalidArgument,
        "frame {} is shown at tick {}, in the analysed clip at {}: it is another clip or was "
        "re-timed; analyse this clip",
        s.num_frames, pts, analysis.pts);
  }
  const FrameView view = frame.View();
  if (s.num_frames % kFingerprintEvery == 0) {
    const auto proxy = stabilizer::MakeLumaProxy(view);
    if (!proxy) {
      return Propagate(proxy.error());
    }
    if (stabilizer::FingerprintDistance(stabilizer::FingerprintOf(*proxy), analysis.fingerprint) >
        kMaxFingerprintDistance) {
      return Fail(ErrorCode::kInvalidArgument,
                  "frame {} does not look like the one that was analysed: analyse this clip",
                  s.num_frames);
    }
  }
  auto output = AllocateFrame(frame.layout, frame.width, frame.height);
  if (!output) {
    return Propagate(std::move(output.error()));
  }
  output->origin = frame.origin;
  const stabilizer::ClipAnalysis& clip = s.reader->clip();
  const double crop = clip.fixed_zoom ? clip.smallest_crop_ratio : analysis.crop_ratio;
  if (Status ok = s.frames.Render(view, analysis, crop, *output); !ok) {
    return Propagate(std::move(ok.error()));
  }
  ++s.num_frames;
  return std::move(*output);
}

Status Renderer::Finish() {
  if (impl_->num_frames < impl_->reader->clip().num_frames) {
    return Fail(ErrorCode::kInvalidArgument,
                "the clip ends after {} frames, the analysed one had {}: analyse this clip",
                impl_->num_frames, impl_->reader->clip().num_frames);
  }
  return {};
}

}  // namespace rsstab::pipeline
