// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_EVALUATION_SYNTHETIC_SAMPLE_H_
#define RSSTAB_EVALUATION_SYNTHETIC_SAMPLE_H_

#include <Eigen/Core>
#include <cstdint>
#include <string_view>
#include <vector>

#include "evaluation/readout_curve.h"
#include "igf/base/camera.h"
#include "igf/base/frame.h"
#include "igf/base/motion_field.h"
#include "igf/base/result.h"

namespace rsstab::evaluation {

// The numbers of the protocol synthetic-val (docs/evaluation.md).
inline constexpr int kSyntheticWidth = 800;
inline constexpr int kSyntheticHeight = 600;
inline constexpr double kLeastUncorrectedPx = 6.0;
inline constexpr double kMostUncorrectedPx = 10.0;
inline constexpr double kLeastFocalWidths = 0.5;
inline constexpr double kMostFocalWidths = 2.0;

// One rolling-shutter picture of which everything is known. Reference row the middle.
struct SyntheticSample {
  MotionClass motion_class = MotionClass::kStill;
  Camera camera;
  ReadoutCurve curve;
  Frame rs;
  Frame gs;
  double photo_per_pixel = 0.0;  // below 1 the photograph was enlarged
  std::uint64_t seed = 0;        // for whoever draws numbers while looking at the picture
  MotionField truth;
  // The truth at every pixel, row by row, and whether its source lies inside the recorded frame.
  std::vector<Eigen::Vector2f> displacement;
  std::vector<std::uint8_t> valid;
};

// A field at every pixel, row by row.
[[nodiscard]] std::vector<Eigen::Vector2f> PixelDisplacements(const MotionField& field);

// Sources this far outside the outermost pixel centres still count as inside: rounding must not
// cost a still frame its border.
inline constexpr double kEdgeTolerancePx = 1e-3;

// 1 where pixel + displacement lies in [0, width - 1] x [0, height - 1], else 0.
[[nodiscard]] std::vector<std::uint8_t> SourcesInside(
    const std::vector<Eigen::Vector2f>& displacement, int width, int height);

// A number for a name: always the same one (FNV-1a).
[[nodiscard]] std::uint64_t HashOfName(std::string_view name);

// The seed of a photo's samples: it depends on the run's seed and the photo's file name, not on
// what other photos there are.
[[nodiscard]] std::uint64_t SampleSeed(std::uint64_t seed, std::string_view photo_name,
                                       MotionClass motion_class);

// Draws camera and motion of a class, and records the photograph (packed 8-bit RGB) with them. Same
// arguments, same sample. Any thread. Errors: those of Expose and ScaleToMeanLength.
[[nodiscard]] Result<SyntheticSample> MakeSyntheticSample(const FrameView& photo,
                                                          MotionClass motion_class,
                                                          std::uint64_t sample_seed);

}  // namespace rsstab::evaluation

#endif  // RSSTAB_EVALUATION_SYNTHETIC_SAMPLE_H_
