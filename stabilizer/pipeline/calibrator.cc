// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/pipeline/calibrator.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "stabilizer/feature_tracks.h"
#include "stabilizer/pipeline/camera_knowledge.h"
#include "stabilizer/pipeline/clip_observer.h"
#include "stabilizer/pipeline/frame_observation.h"
#include "stabilizer/pipeline/gyro_selection.h"

namespace rsstab::pipeline {
namespace {

using stabilizer::ClipCalibration;

CalibratedValue Given(double value) { return {value, 0.0, true, true, ""}; }

CalibratedValue ReadoutFromTracks(const ClipCalibration& calibration) {
  CalibratedValue readout;
  readout.value = calibration.readout_s.value;
  readout.sigma = calibration.readout_s.sigma;
  readout.trusted = calibration.readout_s.trusted;
  if (readout.trusted) {
    return readout;
  }
  if (calibration.vibrates) {
    readout.reason = fmt::format(
        "the camera vibrates so fast that other readout times within {:.0f} ms explain the clip as "
        "well, which hardly matters for this clip; film a few seconds of turning by hand",
        1.96e3 * readout.sigma);
    return readout;
  }
  readout.reason =
      calibration.num_windows == 0
          ? "the camera's speed hardly changes anywhere in the clip, or too little can be tracked; "
            "film a few seconds of shaky turning before a textured scene, or give --readout"
          : fmt::format(
                "the clip's motion leaves +- {:.1f} ms open; film a few seconds of quick, "
                "shaky turning, or give --readout",
                1.96e3 * readout.sigma);
  return readout;
}

CalibratedValue FocalFromTracks(const ClipCalibration& calibration, int width) {
  CalibratedValue focal;
  focal.value = calibration.focal.value * width;
  focal.sigma = calibration.focal.sigma * width;
  focal.trusted = calibration.focal.trusted;
  if (focal.trusted) {
    return focal;
  }
  if (calibration.num_windows == 0) {
    focal.reason = "the camera hardly turns, or too little can be tracked; the value is a guess";
  } else if (calibration.parallax_px >= stabilizer::kMaxTurningParallax_px) {
    focal.reason = fmt::format(
        "the camera moves past near things ({:.2f} px a frame at the picture's edge that no turn "
        "explains), which feigns another lens; turn on the spot; the value is a guess",
        calibration.parallax_px);
  } else {
    focal.reason =
        "the camera turns too little to tell, above all about its axis of view; the value is a "
        "guess";
  }
  return focal;
}

// With Gaussian errors, how likely it is that no skew remains after correcting with each candidate.
EvidenceCurve CurveOf(const PictureReadout& pictures) {
  EvidenceCurve curve{"single images", {}};
  double best = -std::numeric_limits<double>::infinity();
  for (const PictureReadout::Remainder& r : pictures.curve) {
    if (r.sigma > 0.0) {
      curve.points.push_back({r.readout_s, -0.5 * std::pow(r.skew / r.sigma, 2)});
      best = std::max(best, curve.points.back().log_evidence);
    }
  }
  for (stabilizer::ReadoutHypothesis& h : curve.points) {
    h.log_evidence -= best;
  }
  return curve;
}

// What the log adds: it sees the turn of the camera itself, so its word goes before the tracks'.
void AddGyro(const Result<igf::GyroSyncResult>& sync, const CameraKnowledge& known,
             CalibrationReport& report) {
  CalibratedValue& offset = report.gyro_offset_s.emplace();
  if (!sync) {
    offset.reason = sync.error().message;
    return;
  }
  offset = {sync->offset_s, sync->offset_sigma_s, true, sync->offset_sigma_s == 0.0, ""};
  const ClipCalibration log = CalibrationOf(*sync, known);
  if (!report.focal_px.given && log.focal.trusted) {
    const int width = known.camera.width;
    report.focal_px = {log.focal.value * width, log.focal.sigma * width, true, false, ""};
    report.camera = sync->camera;
  }
  if (!report.readout_s.given && log.readout_s.trusted) {
    report.readout_s = {log.readout_s.value, log.readout_s.sigma, true, false, ""};
    report.verdict = log.verdict;
  }
}

}  // namespace

struct Calibrator::Impl {
  Impl(const StabilizeOptions& stabilize_options, const ClipGeometry& geometry,
       RsInputs known_inputs, Logger logger)
      : options(stabilize_options),
        clip(geometry),
        inputs(std::move(known_inputs)),
        observer(options, clip, inputs, std::move(logger)) {}

  StabilizeOptions options;
  ClipGeometry clip;
  RsInputs inputs;
  ClipObserver observer;
  stabilizer::FeatureTracker tracker{stabilizer::FeatureTrackerOptions{}};
  std::int64_t num_frames = 0;
};

Calibrator::Calibrator(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Calibrator::~Calibrator() = default;

Result<std::unique_ptr<Calibrator>> Calibrator::Create(const StabilizeOptions& options,
                                                       const ClipGeometry& clip, RsInputs inputs,
                                                       Logger logger) {
  if (Status ok = Validate(options); !ok) {
    return Propagate(std::move(ok.error()));
  }
  if (Status ok = WhatIsKnown(options, clip, inputs).camera.Validate(); !ok) {
    return Propagate(std::move(ok.error()), "camera");
  }
  return std::unique_ptr<Calibrator>(new Calibrator(std::make_unique<Impl>(
      options, clip, std::move(inputs), logger ? std::move(logger) : SilentLogger())));
}

Status Calibrator::PushFrame(const FrameView& frame, double time_s) {
  Impl& s = *impl_;
  auto observed = ObserveFrame(s.tracker, frame, s.num_frames, time_s);
  if (!observed) {
    return Propagate(std::move(observed.error()));
  }
  s.observer.Push(observed->observation.tracks, std::move(observed->proxy));
  ++s.num_frames;
  return {};
}

Result<CalibrationReport> Calibrator::Finish() {
  Impl& s = *impl_;
  if (s.num_frames == 0) {
    return Fail(ErrorCode::kCorruptData, "the clip has no frame that can be decoded");
  }
  const ClipEvidence evidence = s.observer.Conclude();
  const ClipCalibration& calibration = *evidence.calibration;
  const CameraKnowledge known = WhatIsKnown(s.options, s.clip, s.inputs);

  CalibrationReport report;
  report.verdict = calibration.verdict;
  report.num_stretches = calibration.num_windows;
  report.parallax_px = calibration.parallax_px;
  report.camera = known.camera;
  if (!calibration.curve.empty()) {
    report.curves.push_back({"tracks", calibration.curve});
  }
  report.tracks_readout_s = calibration.tracks_readout_s;
  report.pictures = evidence.pictures;
  if (evidence.pictures) {
    report.curves.push_back(CurveOf(*evidence.pictures));
  }
  report.readout_s =
      known.camera.readout_s ? Given(*known.camera.readout_s) : ReadoutFromTracks(calibration);
  report.focal_px =
      known.focal_is_known ? Given(known.camera.fx) : FocalFromTracks(calibration, s.clip.width);
  if (s.inputs.gyro) {
    AddGyro(BringIntoStep(s.options, known, s.inputs, evidence.tracks), known, report);
  }
  report.camera.fy *= report.focal_px.value / report.camera.fx;
  report.camera.fx = report.focal_px.value;
  report.camera.readout_s = report.readout_s.value;
  return report;
}

igf::CalibratedCamera ToCalibratedCamera(const CalibrationReport& report) {
  return {report.camera, report.focal_px.sigma, report.readout_s.sigma, report.focal_px.trusted,
          report.readout_s.trusted};
}

}  // namespace rsstab::pipeline
