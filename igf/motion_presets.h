// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_IGF_MOTION_PRESETS_H_
#define RSSTAB_IGF_MOTION_PRESETS_H_

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "igf/base/result.h"
#include "igf/orientation_track.h"

namespace rsstab::igf {

// Ways to hold a camera. Calibrated for a view 60 degrees wide and 16:9 at 30 frames/s; figures in
// px at 640 px width, with the preset's usual readout (jitter: RMS second difference of the image
// motion; camera residual: RMS of what rolling shutter does beyond a rotation and a zoom).
enum class MotionPreset {
  kHandheld,   // standing still: jitter 2.5, residual 0.5 at 20 ms
  kWalking,    // steps at 1.9 Hz: jitter 4.8, residual 1.2 at 25 ms
  kVibration,  // a drone with 15-60 Hz from its motors: jitter 7, residual 1.9 at 28 ms
  kFastPan,    // hand-held with two whip pans of 55 degrees: jitter 2.3, residual 2.2 at 25 ms
};

inline constexpr std::array<MotionPreset, 4> kMotionPresets = {
    MotionPreset::kHandheld, MotionPreset::kWalking, MotionPreset::kVibration,
    MotionPreset::kFastPan};

// "handheld", "walking", "vibration", "fast-pan".
[[nodiscard]] std::string_view MotionPresetName(MotionPreset preset);

// The readout time that goes with the preset's figures, s.
[[nodiscard]] double UsualReadout(MotionPreset preset);

// A camera that turns along a smooth function of time (infinitely differentiable, band-limited but
// for the pans). Same seed, same motion; seeds differ in phases and frequencies, not in strength.
class PresetMotion {
 public:
  // `duration_s` places the whip pans of kFastPan: at a quarter and at two thirds of it.
  PresetMotion(MotionPreset preset, std::uint64_t seed, double duration_s);

  // world_from_camera = Ry(yaw) Rx(pitch) Rz(roll); any time, also outside [0, duration).
  [[nodiscard]] Eigen::Quaterniond WorldFromCamera(double time_s) const;

  // (pitch, yaw, roll): rotations about the camera's x, y and z axes, rad.
  [[nodiscard]] Eigen::Vector3d Angles(double time_s) const;

 private:
  // amplitude * sin(2 pi frequency t + phase)
  struct Tone {
    double amplitude_rad = 0.0;
    double frequency_hz = 0.0;
    double phase_rad = 0.0;
  };
  // A yaw by angle_rad in duration_s, begun and ended at rest.
  struct Pan {
    double start_s = 0.0;
    double duration_s = 0.0;
    double angle_rad = 0.0;
  };
  struct Band;

  void AddBands(std::span<const Band> bands, std::uint64_t seed);

  std::array<std::vector<Tone>, 3> tones_;  // about x, y, z
  std::vector<Pan> pans_;
};

// Instants per second at which MakePresetOrientation samples a motion. SLERP between them is within
// 5e-6 rad (0.003 px at 640 px width) of the smooth motion, even for a 60 Hz vibration.
inline constexpr double kPresetSamplingHz = 4000.0;
// How far before 0 and beyond the duration it reaches, s: readout of the first and last frame, and
// the ends of a gyro log that begins early and stops late.
inline constexpr double kPresetMarginS = 0.5;

// The motion of a clip that begins at 0 and lasts duration_s, sampled uniformly over
// [-kPresetMarginS, duration_s + kPresetMarginS]. The samples define the truth: simulator, gyro log
// and truth file all use them.
// Errors: kInvalidArgument unless 0 < duration_s <= 3600.
[[nodiscard]] Result<OrientationTrack> MakePresetOrientation(MotionPreset preset,
                                                             std::uint64_t seed, double duration_s);

}  // namespace rsstab::igf

#endif  // RSSTAB_IGF_MOTION_PRESETS_H_
