// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/pipeline/rs_source_selection.h"

#include <cmath>
#include <memory>
#include <utility>

#include "igf/gyro_integrator.h"
#include "igf/gyro_motion_source.h"
#include "igf/gyro_video_sync.h"
#include "rsdiff/diffusion_motion_source.h"
#include "rsdiff/model_path.h"

namespace rsstab::pipeline {
namespace {

// Where nobody knows the focal length: 64 degrees across.
constexpr double kDefaultFocalRatio = 0.8;
// Telemetry tracks lag or lead their video by exposure, readout and packet times.
constexpr double kSharedClockSearchS = 0.25;

struct CameraKnowledge {
  Camera camera;  // of the clip's size
  bool focal_is_known = false;
  bool lens_is_known = false;
};

// The user's word goes before the camera file, that before the telemetry, that before a guess.
CameraKnowledge WhatIsKnown(const StabilizeOptions& options, const ClipGeometry& clip,
                            const RsInputs& inputs) {
  CameraKnowledge known;
  if (inputs.camera) {
    known.camera = inputs.camera->Rescaled(clip.width, clip.height);
    known.focal_is_known = true;
    known.lens_is_known = true;
  } else {
    known.camera = Camera::Pinhole(clip.width, clip.height, kDefaultFocalRatio * clip.width);
  }
  if (options.focal_px) {
    const double aspect = known.camera.fy / known.camera.fx;
    known.camera.fx = *options.focal_px;
    known.camera.fy = *options.focal_px * aspect;
    known.focal_is_known = true;
  }
  if (options.readout_s) {
    known.camera.readout_s = *options.readout_s;
  } else if (!known.camera.readout_s && inputs.readout_s) {
    known.camera.readout_s = *inputs.readout_s;
  }
  return known;
}

RsSelection WithoutSource(const CameraKnowledge& known, std::string reason) {
  RsSelection selection;
  if (known.focal_is_known) {
    selection.camera = known.camera;
  }
  selection.reason = std::move(reason);
  return selection;
}

// Brings the log into step with the picture. A given offset is kept; the fit then only finds what
// else is unknown, and may fail without harm.
Result<igf::GyroSyncResult> Synchronize(const StabilizeOptions& options,
                                        const CameraKnowledge& known, const RsInputs& inputs,
                                        std::span<const PointTracks> tracks) {
  igf::GyroSyncOptions sync;
  sync.focal_is_known = known.focal_is_known;
  if (inputs.gyro_shares_clock) {
    sync.search_s = kSharedClockSearchS;
  }
  sync.lens_is_known = known.lens_is_known;
  if (options.gyro_offset_s) {
    sync.initial_offset_s = *options.gyro_offset_s;
    sync.search_s = 0.0;
  }
  auto result = igf::SynchronizeGyro(tracks, *inputs.gyro, known.camera, sync);
  if (!options.gyro_offset_s) {
    return result;
  }
  if (!result) {
    igf::GyroSyncResult given;
    given.readout_s = known.camera.readout_s.value_or(0.0);
    given.readout_is_trusted = known.camera.readout_s.has_value();
    given.confidence = 1.0;
    result = given;
  }
  result->offset_s = *options.gyro_offset_s;
  return result;
}

// A log that tells nothing about the clip is a wrong log or a wrong offset.
Status CheckOverlap(const igf::GyroLog& log, double offset_s, std::span<const PointTracks> tracks) {
  if (tracks.empty()) {
    return {};
  }
  const double clip_begin_s = tracks.front().from_time_s;
  const double clip_end_s = tracks.back().to_time_s;
  const double log_begin_s = log.start_s() + offset_s;
  const double log_end_s = log.end_s() + offset_s;
  if (log_begin_s < clip_end_s && log_end_s > clip_begin_s) {
    return {};
  }
  return Fail(ErrorCode::kUntrustworthy,
              "with the offset of {:.3f} s the log lasts from {:.3f} to {:.3f} s and the clip from "
              "{:.3f} to {:.3f} s, which do not meet: check --gyro-offset",
              offset_s, log_begin_s, log_end_s, clip_begin_s, clip_end_s);
}

Result<RsSelection> SelectGyro(const StabilizeOptions& options, CameraKnowledge known,
                               const RsInputs& inputs, std::span<const PointTracks> tracks) {
  const auto sync = Synchronize(options, known, inputs, tracks);
  if (!sync) {
    return Propagate(sync.error(), inputs.gyro_origin);
  }
  if (Status ok = CheckOverlap(*inputs.gyro, sync->offset_s, tracks); !ok) {
    return Propagate(std::move(ok.error()), inputs.gyro_origin);
  }
  const bool readout_given = known.camera.readout_s.has_value();
  // A lens found here bends the field only, which lives in recorded pixels: nobody asked for the
  // clip to be straightened. What follows the path sees a pinhole of the same scale at its centre.
  Camera field_camera = known.camera;
  if (sync->focal_is_trusted && !(known.focal_is_known && known.lens_is_known)) {
    field_camera = sync->camera;
    known.camera.fx = field_camera.fx;
    known.camera.fy = field_camera.fy;
  }
  const double readout_s = readout_given              ? *known.camera.readout_s
                           : sync->readout_is_trusted ? sync->readout_s
                                                      : 0.0;
  auto track = igf::IntegrateGyro(*inputs.gyro, {.bias_rad_s = sync->bias_rad_s});
  if (!track) {
    return Propagate(std::move(track.error()), inputs.gyro_origin);
  }
  known.camera.readout_s = readout_s;
  auto source =
      igf::GyroMotionSource::Create(field_camera, readout_s, track->WithOffset(sync->offset_s));
  if (!source) {
    return Propagate(std::move(source.error()), inputs.gyro_origin);
  }
  RsSelection selection;
  selection.source = std::make_unique<igf::GyroMotionSource>(std::move(*source));
  selection.camera = known.camera;
  selection.readout_s = readout_s;
  selection.gyro_offset_s = sync->offset_s;
  selection.reason = fmt::format(
      "gyro log {} ({:.0f} Hz), offset {:.1f} ms, readout {:.1f} ms ({}), focal length {:.0f} px "
      "({})",
      inputs.gyro_origin, inputs.gyro->mean_rate_hz(), sync->offset_s * 1e3, readout_s * 1e3,
      readout_given              ? "given"
      : sync->readout_is_trusted ? "estimated"
                                 : "unknown: taken as a global shutter, give --readout",
      known.camera.fx,
      known.focal_is_known     ? "given"
      : sync->focal_is_trusted ? "estimated"
                               : "assumed: give --focal or --camera");
  return selection;
}

Result<RsSelection> SelectDiffusion(const StabilizeOptions& options, const CameraKnowledge& known) {
  const auto model_file = rsdiff::FindModel(options.model);
  if (!model_file) {
    return Propagate(model_file.error());
  }
  auto estimator = rsdiff::SingleImageEstimator::Load(
      *model_file, {.device = options.device, .num_threads = options.num_threads});
  if (!estimator) {
    return Propagate(std::move(estimator.error()));
  }
  const rsdiff::ModelInfo model = estimator->model();
  rsdiff::DiffusionSourceOptions source_options;
  source_options.sampling.samples = options.samples;
  source_options.sampling.steps = options.sampling_steps;
  source_options.sampling.seed = options.seed;
  source_options.strength = options.rs_strength;
  if (known.focal_is_known) {
    source_options.focal_px = known.camera.fx;
  }
  auto source = rsdiff::DiffusionMotionSource::Create(std::move(*estimator), source_options);
  if (!source) {
    return Propagate(std::move(source.error()));
  }
  RsSelection selection = WithoutSource(
      known,
      fmt::format(
          "diffusion model {} ({}), {} samples of {} steps a frame, seed {}{}", model.name,
          model_file->string(), options.samples,
          options.sampling_steps > 0 ? options.sampling_steps : model.sampling.steps, options.seed,
          options.rs_strength == 1.0 ? "" : fmt::format(", strength {}", options.rs_strength)));
  selection.source = std::make_unique<rsdiff::DiffusionMotionSource>(std::move(*source));
  return selection;
}

}  // namespace

bool NeedsTracks(const StabilizeOptions& options, const RsInputs& inputs) {
  return (options.rs == RsChoice::kAuto || options.rs == RsChoice::kGyro) &&
         inputs.gyro.has_value();
}

Result<RsSelection> SelectRsSource(const StabilizeOptions& options, const ClipGeometry& clip,
                                   const RsInputs& inputs, std::span<const PointTracks> tracks,
                                   const Logger& logger) {
  CameraKnowledge known = WhatIsKnown(options, clip, inputs);
  if (Status ok = known.camera.Validate(); !ok) {
    return Propagate(std::move(ok.error()), "camera");
  }
  if (options.rs == RsChoice::kOff) {
    return WithoutSource(known, "left alone, as asked for");
  }
  if (options.rs == RsChoice::kDiffusion) {
    return SelectDiffusion(options, known);
  }
  if (!inputs.gyro) {
    if (options.rs == RsChoice::kGyro) {
      return Fail(
          ErrorCode::kNotFound,
          "--rs gyro needs a gyro log, and the clip carries none: name one with --gyro FILE");
    }
    return WithoutSource(known, "left alone: there is no gyro log");
  }
  auto selection = SelectGyro(options, known, inputs, tracks);
  if (!selection && options.rs == RsChoice::kAuto) {
    logger->warn("the gyro log is not used: {}", selection.error().message);
    return WithoutSource(known, "left alone: the gyro log could not be trusted");
  }
  return selection;
}

}  // namespace rsstab::pipeline
