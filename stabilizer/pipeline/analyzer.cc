// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/pipeline/analyzer.h"

#include <optional>
#include <utility>

#include "stabilizer/feature_tracks.h"
#include "stabilizer/pipeline/clip_observer.h"
#include "stabilizer/pipeline/track_spool.h"
#include "stabilizer/pipeline/version.h"

namespace rsstab::pipeline {
namespace {

constexpr std::int64_t kCancelCheckEvery = 16;

}  // namespace

struct Analyzer::Impl {
  StabilizeOptions options;
  ClipGeometry clip;
  RsInputs inputs;
  Logger logger;
  stabilizer::FeatureTracker tracker{stabilizer::FeatureTrackerOptions{}};
  std::unique_ptr<stabilizer::AnalysisWriter> writer;
  RsSelection selection;
  std::unique_ptr<MotionStage> stage;
  std::unique_ptr<TrackSpool> spool;     // only while the source waits for the tracks
  std::optional<ClipObserver> observer;  // as long
  std::int64_t num_frames = 0;
  // The clip's clock: first and last frame in ticks and in seconds.
  std::int64_t first_pts = 0;
  std::int64_t last_pts = 0;
  double first_s = 0.0;
  double last_s = 0.0;

  [[nodiscard]] double SecondsPerTick() const {
    return last_pts > first_pts && last_s > first_s
               ? (last_s - first_s) / static_cast<double>(last_pts - first_pts)
               : 0.0;
  }

  Status StartStage(Result<RsSelection> selected) {
    if (!selected) {
      return Propagate(std::move(selected.error()));
    }
    selection = std::move(*selected);
    logger->info("rolling shutter: {}", selection.reason);
    auto created = MotionStage::Create(options, clip, &selection, logger);
    if (!created) {
      return Propagate(std::move(created.error()));
    }
    stage = std::move(*created);
    return {};
  }

  Status WriteReady() {
    for (const stabilizer::FrameAnalysis& frame : stage->TakeReady()) {
      if (Status ok = writer->Append(frame); !ok) {
        return ok;
      }
    }
    return {};
  }

  Status Advance(const FrameObservation& observation, const FrameView* image) {
    if (Status ok = stage->Push(observation, image); !ok) {
      return ok;
    }
    return WriteReady();
  }

  Status Replay(const std::function<bool()>& cancelled) {
    if (Status ok = spool->Rewind(); !ok) {
      return ok;
    }
    for (std::int64_t i = 0;; ++i) {
      auto observation = spool->Next();
      if (!observation) {
        return Propagate(std::move(observation.error()));
      }
      if (!*observation) {
        return {};
      }
      if (cancelled && i % kCancelCheckEvery == 0 && cancelled()) {
        return Fail(ErrorCode::kCancelled, "stopped");
      }
      if (Status ok = Advance(**observation, nullptr); !ok) {
        return ok;
      }
    }
  }
};

Analyzer::Analyzer(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Analyzer::~Analyzer() = default;

Result<std::unique_ptr<Analyzer>> Analyzer::Create(const StabilizeOptions& options,
                                                   const ClipGeometry& clip, RsInputs inputs,
                                                   const std::string& analysis_path,
                                                   Logger logger) {
  if (Status ok = Validate(options); !ok) {
    return Propagate(std::move(ok.error()));
  }
  auto impl = std::make_unique<Impl>();
  impl->options = options;
  impl->clip = clip;
  impl->inputs = std::move(inputs);
  impl->logger = logger ? std::move(logger) : SilentLogger();
  if (NeedsTracks(options, impl->inputs)) {
    auto spool = TrackSpool::Create();
    if (!spool) {
      return Propagate(std::move(spool.error()));
    }
    impl->spool = std::move(*spool);
    impl->observer.emplace(options, clip, impl->inputs, impl->logger);
  } else {
    Status ok = impl->StartStage(SelectRsSource(options, clip, impl->inputs, {}, impl->logger));
    if (!ok) {
      return Propagate(std::move(ok.error()));
    }
  }
  auto writer = stabilizer::AnalysisWriter::Create(analysis_path);
  if (!writer) {
    return Propagate(std::move(writer.error()));
  }
  impl->writer = std::move(*writer);
  return std::unique_ptr<Analyzer>(new Analyzer(std::move(impl)));
}

Status Analyzer::PushFrame(const FrameView& frame, std::int64_t pts, double time_s) {
  Impl& s = *impl_;
  auto observed = ObserveFrame(s.tracker, frame, pts, time_s);
  if (!observed) {
    return Propagate(std::move(observed.error()));
  }
  const FrameObservation& observation = observed->observation;
  if (s.num_frames == 0) {
    s.first_pts = pts;
    s.first_s = time_s;
  }
  s.last_pts = pts;
  s.last_s = time_s;
  ++s.num_frames;
  if (s.stage) {
    return s.Advance(observation, &frame);
  }
  s.observer->Push(observation.tracks, std::move(observed->proxy));
  return s.spool->Append(observation);
}

Result<stabilizer::ClipAnalysis> Analyzer::Finish(const std::function<bool()>& cancelled) {
  Impl& s = *impl_;
  if (s.num_frames == 0) {
    return Fail(ErrorCode::kCorruptData, "the clip has no frame that can be decoded");
  }
  if (!s.stage) {
    Status ok =
        s.StartStage(SelectRsSource(s.options, s.clip, s.inputs, s.observer->Conclude(), s.logger));
    if (ok) {
      ok = s.Replay(cancelled);
    }
    if (!ok) {
      return Propagate(std::move(ok.error()));
    }
  }
  if (Status ok = s.stage->Finish(); !ok) {
    return Propagate(std::move(ok.error()));
  }
  if (Status ok = s.WriteReady(); !ok) {
    return Propagate(std::move(ok.error()));
  }
  stabilizer::ClipAnalysis clip;
  clip.program_version = kProgramVersion;
  clip.width = s.clip.width;
  clip.height = s.clip.height;
  clip.frames_per_second = s.clip.frames_per_second;
  clip.seconds_per_tick = s.SecondsPerTick();
  clip.num_frames = s.num_frames;
  clip.fixed_zoom = s.options.zoom == ZoomMode::kFixed || s.options.tripod;
  clip.rs_source = s.selection.source ? s.selection.source->Name() : "none";
  clip.rs_reason = s.selection.reason;
  clip.readout_s = s.selection.readout_s;
  if (s.selection.calibration) {
    const stabilizer::ClipCalibration& calibration = *s.selection.calibration;
    clip.readout_sigma_s = calibration.readout_s.sigma;
    clip.shutter = stabilizer::NameOf(calibration.verdict);
    clip.focal_px = calibration.focal.value * s.clip.width;
    clip.focal_sigma_px = calibration.focal.sigma * s.clip.width;
    clip.focal_trusted = calibration.focal.trusted;
  }
  clip.rotation_is_known = s.selection.rotation_is_known;
  clip.gyro_offset_s = s.selection.gyro_offset_s;
  clip.camera = s.selection.camera;
  for (const auto& option : StabilizeOptionTable()) {
    const std::string value = option.get(s.options);
    if (!value.empty()) {
      clip.options += (clip.options.empty() ? "--" : " --") + option.name + " " + value;
    }
  }
  return s.writer->Finish(std::move(clip));
}

}  // namespace rsstab::pipeline
