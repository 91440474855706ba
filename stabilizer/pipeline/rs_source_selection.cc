// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/pipeline/rs_source_selection.h"

#include <filesystem>
#include <memory>
#include <string_view>
#include <utility>

#include "rsdiff/diffusion_motion_source.h"
#include "rsdiff/model_path.h"
#include "stabilizer/pipeline/camera_knowledge.h"
#include "stabilizer/pipeline/fused_motion_source.h"
#include "stabilizer/pipeline/gyro_selection.h"

namespace rsstab::pipeline {
namespace {

// Less of a clip than this, and a log is worth less than the tracks. Logs that begin or end within
// the first or last frames have more.
constexpr double kMinCoveredShare = 0.95;

RsSelection WithoutSource(const CameraKnowledge& known, std::string reason) {
  RsSelection selection;
  if (known.focal_is_known) {
    selection.camera = known.camera;
  }
  selection.reason = std::move(reason);
  return selection;
}

struct LoadedModel {
  std::filesystem::path file;
  rsdiff::SingleImageEstimator estimator;
};
Result<LoadedModel> LoadModel(const StabilizeOptions& options) {
  const auto model_file = rsdiff::FindModel(options.model);
  if (!model_file) {
    return Propagate(model_file.error());
  }
  auto estimator = rsdiff::SingleImageEstimator::Load(
      *model_file, {.device = options.device, .num_threads = options.num_threads});
  if (!estimator) {
    return Propagate(std::move(estimator.error()));
  }
  return LoadedModel{*model_file, std::move(*estimator)};
}

Result<RsSelection> SelectDiffusion(const StabilizeOptions& options, const CameraKnowledge& known) {
  auto loaded = LoadModel(options);
  if (!loaded) {
    return Propagate(std::move(loaded.error()));
  }
  rsdiff::SingleImageEstimator* const estimator = &loaded->estimator;
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
          loaded->file.string(), options.samples,
          options.sampling_steps > 0 ? options.sampling_steps : model.sampling.steps, options.seed,
          options.rs_strength == 1.0 ? "" : fmt::format(", strength {}", options.rs_strength)));
  selection.source = std::make_unique<rsdiff::DiffusionMotionSource>(std::move(*source));
  return selection;
}

std::string_view SourceName(RsChoice choice) {
  return choice == RsChoice::kTracks ? "tracks" : "fused";
}

// "tracks 16.9 +- 0.7, pictures 22.5 +- 2.8"
std::string DescribeOpinions(const stabilizer::ClipCalibration& calibration) {
  std::string text;
  const auto add = [&](std::string_view who, const std::optional<stabilizer::Estimate>& opinion) {
    if (opinion) {
      text += fmt::format("{}{} {:.1f} +- {:.1f}", text.empty() ? "" : ", ", who,
                          opinion->value * 1e3, opinion->sigma * 1e3);
    }
  };
  add("tracks", calibration.tracks_readout_s);
  add("pictures", calibration.pictures_readout_s);
  return text;
}

// What the calibration says about the shutter, for people.
std::string DescribeShutter(const stabilizer::ClipCalibration& calibration) {
  const auto& readout = calibration.readout_s;
  switch (calibration.verdict) {
    case stabilizer::ShutterVerdict::kRolling:
      return fmt::format("readout {:.1f} +- {:.1f} ms ({})", readout.value * 1e3,
                         readout.sigma * 1e3, DescribeOpinions(calibration));
    case stabilizer::ShutterVerdict::kGlobal:
      return fmt::format("the clip shows no rolling shutter (readout 0 +- {:.1f} ms; {})",
                         readout.sigma * 1e3, DescribeOpinions(calibration));
    case stabilizer::ShutterVerdict::kCannotBeTold:
      return "the clip does not tell its readout time";
    case stabilizer::ShutterVerdict::kGiven:
      break;
  }
  return fmt::format("readout {:.1f} ms (given)", readout.value * 1e3);
}

// Whether the tracks show a camera that turns and nothing else.
bool OnlyTurns(const stabilizer::ClipCalibration& calibration) {
  return calibration.num_windows > 0 &&
         calibration.parallax_px < stabilizer::kMaxTurningParallax_px;
}

// One rotation spline over the clip.
Result<RsSelection> SelectFused(const StabilizeOptions& options, const ClipGeometry& clip,
                                CameraKnowledge known,
                                const stabilizer::ClipCalibration& calibration) {
  const double readout_s = calibration.readout_s.value;
  const bool focal_is_found = !known.focal_is_known && calibration.focal.trusted;
  if (focal_is_found) {
    const double aspect = known.camera.fy / known.camera.fx;
    known.camera.fx = calibration.focal.value * clip.width;
    known.camera.fy = known.camera.fx * aspect;
    known.focal_is_known = true;
  }
  known.camera.readout_s = readout_s;
  const std::string shutter = DescribeShutter(calibration);
  const bool only_turns = OnlyTurns(calibration);
  if (readout_s == 0.0 && !only_turns) {
    RsSelection selection = WithoutSource(known, "left alone: " + shutter);
    selection.calibration = calibration;
    return selection;
  }
  const stabilizer::RsMotionModel model = {.frame_interval_s = 1.0 / clip.frames_per_second,
                                           .readout_s = readout_s,
                                           .focal = known.camera.fx / known.camera.width,
                                           .jerk_weight = calibration.jerk_weight};
  auto source = FusedMotionSource::Create(std::string(SourceName(options.rs)), known.camera,
                                          known.lens_is_known, model);
  if (!source) {
    return Propagate(std::move(source.error()));
  }
  const std::string camera = fmt::format("focal length {:.0f} px ({})", known.camera.fx,
                                         focal_is_found         ? "estimated"
                                         : known.focal_is_known ? "given"
                                                                : "assumed");
  RsSelection selection = WithoutSource(
      known, readout_s == 0.0
                 ? fmt::format("left alone: {}; the camera only turns, {}", shutter, camera)
                 : fmt::format("one camera rotation from the tracks, {}, {}", shutter, camera));
  selection.camera = known.camera;
  selection.source = std::move(*source);
  selection.readout_s = readout_s;
  selection.rotation_is_known = only_turns;
  selection.only_turns = only_turns;
  selection.calibration = calibration;
  return selection;
}

}  // namespace

bool NeedsPictures(const StabilizeOptions& options, const RsInputs& inputs) {
  return (options.rs == RsChoice::kFused ||
          (options.rs == RsChoice::kAuto && !inputs.gyro.has_value())) &&
         !CalibrationOptions(options, {1, 1, 1.0}, inputs).readout_s;
}

Result<PictureReadout> AskPictures(const StabilizeOptions& options, const ReadoutPictures& pictures,
                                   double frame_interval_s) {
  auto loaded = LoadModel(options);
  if (!loaded) {
    return Propagate(std::move(loaded.error()));
  }
  return pictures.Ask(loaded->estimator, frame_interval_s);
}

bool NeedsTracks(const StabilizeOptions& options, const RsInputs& inputs) {
  switch (options.rs) {
    case RsChoice::kAuto:
    case RsChoice::kFused:
    case RsChoice::kTracks:
      return true;
    case RsChoice::kGyro:
      return inputs.gyro.has_value();
    case RsChoice::kDiffusion:
    case RsChoice::kOff:
      break;
  }
  return false;
}

Result<RsSelection> SelectRsSource(const StabilizeOptions& options, const ClipGeometry& clip,
                                   const RsInputs& inputs, const ClipEvidence& evidence,
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
  const bool may_use_gyro = options.rs == RsChoice::kAuto || options.rs == RsChoice::kGyro;
  if (may_use_gyro && inputs.gyro) {
    auto selection = SelectGyro(options, known, inputs, evidence.tracks);
    if (selection && evidence.calibration && selection->calibration->focal.trusted) {
      selection->only_turns = OnlyTurns(*evidence.calibration);
    }
    // A log with holes leaves frames as they are; tracks that tell the shutter do not.
    const bool has_better =
        selection && selection->covered_share < kMinCoveredShare && evidence.calibration &&
        evidence.calibration->verdict != stabilizer::ShutterVerdict::kCannotBeTold;
    if (options.rs == RsChoice::kGyro || (selection && !has_better)) {
      return selection;
    }
    logger->warn("the gyro log is not used: {}",
                 has_better ? fmt::format("it knows {:.0f} % of the frames only (--rs gyro uses it "
                                          "where it knows them, and leaves the others alone)",
                                          100.0 * selection->covered_share)
                            : selection.error().message);
  }
  if (options.rs == RsChoice::kGyro) {
    return Fail(ErrorCode::kNotFound,
                "--rs gyro needs a gyro log, and the clip carries none: name one with --gyro FILE");
  }
  if (!evidence.calibration) {
    return WithoutSource(known, "left alone: there is no gyro log, and the clip is not known yet");
  }
  if (evidence.calibration->verdict == stabilizer::ShutterVerdict::kCannotBeTold) {
    logger->warn(
        "the clip does not show whether its camera has a rolling shutter (its motion changes too "
        "little, or too little can be tracked), so none is taken out; if it has one, give "
        "--readout, or --camera with what `rs-stabilize calibrate` finds from a shakier clip of "
        "the same camera");
  }
  return SelectFused(options, clip, known, *evidence.calibration);
}

}  // namespace rsstab::pipeline
