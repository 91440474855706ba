// SPDX-License-Identifier: Apache-2.0
#include "igf/motion_presets.h"

#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>

#include "igf/base/rotation.h"
#include "igf/base/seeded_random.h"

namespace rsstab::igf {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

struct PresetFacts {
  MotionPreset preset;
  std::string_view name;
  double readout_s;
};
constexpr std::array<PresetFacts, 4> kFacts = {{
    {MotionPreset::kHandheld, "handheld", 0.020},
    {MotionPreset::kWalking, "walking", 0.025},
    {MotionPreset::kVibration, "vibration", 0.028},
    {MotionPreset::kFastPan, "fast-pan", 0.025},
}};

const PresetFacts& FactsOf(MotionPreset preset) {
  for (const PresetFacts& facts : kFacts) {
    if (facts.preset == preset) {
      return facts;
    }
  }
  return kFacts.front();
}

// Share of a pan done at u in [0, 1]: raised-cosine speed.
double PanProgress(double u) {
  if (u <= 0.0) {
    return 0.0;
  }
  return u >= 1.0 ? 1.0 : u - std::sin(kTurn * u) / kTurn;
}

}  // namespace

// Noise of one frequency band about each axis, as a sum of tones at random places on a logarithmic
// scale.
struct PresetMotion::Band {
  double low_hz = 0.0;
  double high_hz = 0.0;
  int tones = 1;
  double slope = 0.0;                                  // amplitude falls as frequency^-slope
  Eigen::Vector3d rms_mrad = Eigen::Vector3d::Zero();  // of pitch, yaw, roll
};

std::string_view MotionPresetName(MotionPreset preset) { return FactsOf(preset).name; }

double UsualReadout(MotionPreset preset) { return FactsOf(preset).readout_s; }

PresetMotion::PresetMotion(MotionPreset preset, std::uint64_t seed, double duration_s) {
  // Strengths: found by scaling each band until the figures in the header came out (the test of
  // this file measures them). One mrad is 0.55 px at 640 px width and 60 degrees.
  switch (preset) {
    case MotionPreset::kHandheld: {
      const std::array<Band, 3> bands = {{
          {0.12, 1.0, 8, 1.0, {28.0, 38.0, 16.0}},  // sway
          {1.0, 5.0, 10, 1.3, {7.6, 8.6, 4.2}},     // correction by the arms
          {6.0, 12.0, 8, 1.0, {1.1, 1.1, 0.6}},     // tremor
      }};
      AddBands(bands, seed);
      break;
    }
    case MotionPreset::kWalking: {
      const std::array<Band, 6> bands = {{
          {0.1, 0.8, 8, 1.0, {20.0, 34.0, 12.0}},   // drift of the gaze
          {0.94, 0.96, 1, 0.0, {3.0, 18.0, 15.0}},  // one stride: left, right
          {1.88, 1.92, 1, 0.0, {14.0, 5.0, 3.5}},   // one step: up, down
          {3.6, 4.0, 2, 0.0, {5.5, 2.8, 2.0}},      // heel strikes, and their harmonics
          {5.0, 8.5, 8, 1.0, {2.8, 2.3, 1.2}},
          {8.5, 13.0, 8, 1.0, {1.0, 1.0, 0.6}},
      }};
      AddBands(bands, seed);
      break;
    }
    case MotionPreset::kVibration: {
      const std::array<Band, 3> bands = {{
          {0.08, 0.6, 8, 1.0, {20.0, 30.0, 12.0}},  // drift in the wind
          {15.0, 26.0, 6, 0.5, {2.35, 2.35, 0.9}},  // frame and motors
          {30.0, 60.0, 6, 0.5, {1.4, 1.4, 0.6}},
      }};
      AddBands(bands, seed);
      break;
    }
    case MotionPreset::kFastPan: {
      const std::array<Band, 3> bands = {{
          {0.12, 1.0, 8, 1.0, {12.0, 12.0, 6.0}},
          {1.0, 5.0, 10, 1.3, {4.6, 5.3, 2.6}},
          {6.0, 12.0, 8, 1.0, {0.78, 0.78, 0.42}},
      }};
      AddBands(bands, seed);
      constexpr double kPanDurationS = 0.9;
      constexpr double kPanAngleRad = 55.0 * std::numbers::pi / 180.0;
      pans_ = {{duration_s / 4.0 - kPanDurationS / 2.0, kPanDurationS, kPanAngleRad},
               {duration_s * 2.0 / 3.0 - kPanDurationS / 2.0, kPanDurationS, -kPanAngleRad}};
      break;
    }
  }
}

void PresetMotion::AddBands(std::span<const Band> bands, std::uint64_t seed) {
  for (std::size_t b = 0; b < bands.size(); ++b) {
    const Band& band = bands[b];
    for (std::size_t axis = 0; axis < 3; ++axis) {
      SeededRandom random(seed, 3 * b + axis);
      std::vector<Tone> tones(static_cast<std::size_t>(band.tones));
      double power = 0.0;
      for (std::size_t i = 0; i < tones.size(); ++i) {
        const double place = (static_cast<double>(i) + random.Uniform()) / band.tones;
        tones[i].frequency_hz = band.low_hz * std::pow(band.high_hz / band.low_hz, place);
        tones[i].phase_rad = kTurn * random.Uniform();
        tones[i].amplitude_rad = std::pow(tones[i].frequency_hz, -band.slope);
        power += tones[i].amplitude_rad * tones[i].amplitude_rad / 2.0;
      }
      const double rms_rad = 1e-3 * band.rms_mrad(static_cast<Eigen::Index>(axis));
      for (Tone& tone : tones) {
        tone.amplitude_rad *= rms_rad / std::sqrt(power);
        tones_[axis].push_back(tone);
      }
    }
  }
}

Eigen::Vector3d PresetMotion::Angles(double time_s) const {
  Eigen::Vector3d angles = Eigen::Vector3d::Zero();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    double& angle = angles(static_cast<Eigen::Index>(axis));
    for (const Tone& tone : tones_[axis]) {
      angle += tone.amplitude_rad * std::sin(kTurn * tone.frequency_hz * time_s + tone.phase_rad);
    }
  }
  for (const Pan& pan : pans_) {
    angles.y() += pan.angle_rad * PanProgress((time_s - pan.start_s) / pan.duration_s);
  }
  return angles;
}

Eigen::Quaterniond PresetMotion::WorldFromCamera(double time_s) const {
  const Eigen::Vector3d angles = Angles(time_s);
  return ExpSo3(Eigen::Vector3d(0.0, angles.y(), 0.0)) *
         ExpSo3(Eigen::Vector3d(angles.x(), 0.0, 0.0)) *
         ExpSo3(Eigen::Vector3d(0.0, 0.0, angles.z()));
}

Result<OrientationTrack> MakePresetOrientation(MotionPreset preset, std::uint64_t seed,
                                               double duration_s) {
  constexpr double kLongestS = 3600.0;
  if (!(duration_s > 0.0 && duration_s <= kLongestS)) {
    return Fail(ErrorCode::kInvalidArgument, "A motion lasts between 0 and {} s, not {} s.",
                kLongestS, duration_s);
  }
  const PresetMotion motion(preset, seed, duration_s);
  const auto count = static_cast<std::size_t>(
      std::ceil((duration_s + 2.0 * kPresetMarginS) * kPresetSamplingHz) + 1.0);
  std::vector<double> times_s(count);
  std::vector<Eigen::Quaterniond> orientations(count);
  for (std::size_t i = 0; i < count; ++i) {
    times_s[i] = static_cast<double>(i) / kPresetSamplingHz - kPresetMarginS;
    orientations[i] = motion.WorldFromCamera(times_s[i]);
  }
  return OrientationTrack::Create(std::move(times_s), std::move(orientations));
}

}  // namespace rsstab::igf
