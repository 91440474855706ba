// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_STABILIZER_PIPELINE_CALIBRATOR_H_
#define RSSTAB_STABILIZER_PIPELINE_CALIBRATOR_H_

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "igf/base/camera.h"
#include "igf/base/frame.h"
#include "igf/base/log.h"
#include "igf/base/result.h"
#include "igf/camera_profile_reader.h"
#include "stabilizer/clip_calibration.h"
#include "stabilizer/pipeline/clip_geometry.h"
#include "stabilizer/pipeline/rs_source_selection.h"
#include "stabilizer/pipeline/stabilize_options.h"

namespace rsstab::pipeline {

// A number found, and how far it can be believed.
struct CalibratedValue {
  double value = 0.0;
  double sigma = 0.0;  // one standard deviation; 0 where it was given
  bool trusted = false;
  bool given = false;  // by the user, the camera file or the telemetry
  std::string reason;  // not trusted: why, and what to do; otherwise empty

  // The interval that holds the truth 95 times of 100.
  [[nodiscard]] double low() const { return value - 1.96 * sigma; }
  [[nodiscard]] double high() const { return value + 1.96 * sigma; }
};

// How well each readout time explains what one source saw.
struct EvidenceCurve {
  std::string source;  // "tracks", "single images"
  std::vector<stabilizer::ReadoutHypothesis> points;
};

// What a clip tells about the camera that took it.
struct CalibrationReport {
  stabilizer::ShutterVerdict verdict = stabilizer::ShutterVerdict::kCannotBeTold;
  CalibratedValue readout_s;      // signed, first row to last
  CalibratedValue focal_px;       // of the clip's full size
  Camera camera;                  // full size, with the values above
  std::size_t num_stretches = 0;  // of the clip, that the tracks' word rests on
  double parallax_px = 0.0;       // see stabilizer::ClipCalibration
  std::vector<EvidenceCurve> curves;
  // What each source says of the readout by itself; empty where it was not asked or has no answer.
  std::optional<stabilizer::Estimate> tracks_readout_s;
  std::optional<PictureReadout> pictures;
  // Only with a gyro log: t_video = t_gyro + offset. Not trusted: the log does not fit, for the
  // reason given, and readout and focal length are the tracks'.
  std::optional<CalibratedValue> gyro_offset_s;
};

// Pass 1 without the path: looks at the pictures, then says what they tell about the camera. Keeps
// no pictures; bounded memory. In order, not thread safe.
class Calibrator {
 public:
  // Of `options`, those that say what is known already are heeded. Errors: kInvalidArgument.
  [[nodiscard]] static Result<std::unique_ptr<Calibrator>> Create(const StabilizeOptions& options,
                                                                  const ClipGeometry& clip,
                                                                  RsInputs inputs, Logger logger);
  ~Calibrator();
  Calibrator(const Calibrator&) = delete;
  Calibrator& operator=(const Calibrator&) = delete;

  // The next frame; `time_s` of its middle row. The view is not kept.
  [[nodiscard]] Status PushFrame(const FrameView& frame, double time_s);

  // What was seen so far. Errors: kCorruptData without a single frame.
  [[nodiscard]] Result<CalibrationReport> Finish();

 private:
  struct Impl;
  explicit Calibrator(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

// For a camera JSON.
[[nodiscard]] igf::CalibratedCamera ToCalibratedCamera(const CalibrationReport& report);

}  // namespace rsstab::pipeline

#endif  // RSSTAB_STABILIZER_PIPELINE_CALIBRATOR_H_
