// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_EVALUATION_HAND_MOTION_H_
#define RSSTAB_EVALUATION_HAND_MOTION_H_

#include <array>
#include <cstdint>
#include <string>

#include "igf/base/camera.h"
#include "igf/base/result.h"
#include "igf/orientation_track.h"

namespace rsstab::evaluation {

// How far rolling shutter displaces the pixels of a picture against its first row's view: mean
// length of the field over the pixels with a source, px at 800 px width.
struct MotionStrength {
  const char* name;
  double least_px;
  double most_px;
};
inline constexpr std::array<MotionStrength, 3> kMotionStrengths = {
    {{"weak", 1.0, 3.0}, {"medium", 3.0, 8.0}, {"strong", 8.0, 20.0}}};

// The motion of a few consecutive frames.
struct HandMotion {
  std::string preset;           // whose kind of motion it is
  igf::OrientationTrack track;  // time 0 is the first frame's middle row
  double frame_interval_s = 0.0;
};

// The kinds of motion of igf/motion_presets.h (hand, walk, vibration, pan), at an instant at which
// the camera moves much, made larger or smaller until the middle frame of `frames` is displaced by
// a length drawn from `strength`. `camera` states its readout time. Covers all frames and
// `margin_s` more on both sides. Same arguments, same motion.
// Errors: kInvalidArgument for a camera without readout time or an invalid one.
[[nodiscard]] Result<HandMotion> MakeHandMotion(const MotionStrength& strength,
                                                const Camera& camera, int frames,
                                                double frame_interval_s, double margin_s,
                                                std::uint64_t seed);

}  // namespace rsstab::evaluation

#endif  // RSSTAB_EVALUATION_HAND_MOTION_H_
