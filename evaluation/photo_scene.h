// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_EVALUATION_PHOTO_SCENE_H_
#define RSSTAB_EVALUATION_PHOTO_SCENE_H_

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <functional>
#include <span>

#include "igf/base/camera.h"
#include "igf/base/frame.h"
#include "igf/base/result.h"

namespace rsstab::evaluation {

struct ExposureOptions {
  double noise_sigma = 2.0;  // of every sample, in 8-bit levels, >= 0
  std::uint64_t noise_seed = 1;
};

// camera_from_scene at the instant of each row.
using RowOrientation = std::function<Eigen::Quaterniond(int row)>;

// A photograph at infinity in front of a camera that only turns, so large that every picture of it
// that is to be taken lies inside: nothing has to be invented at a border. A sampler of its own: it
// shares no code with the correctors it is to judge. Const methods from any thread.
class PhotoScene {
 public:
  // The photograph is placed in the middle of what `exposures` see, at the largest scale at which
  // they stay inside it. Packed 8-bit RGB; the camera is a pinhole and says the pictures' size. A
  // photograph with finer pixels than theirs is shrunk by area averages.
  // Errors: kInvalidArgument for another layout, an invalid camera, a photo of less than 16 pixels
  // a side, or an exposure that shows what lies behind the scene.
  [[nodiscard]] static Result<PhotoScene> Create(const FrameView& photo, const Camera& camera,
                                                 std::span<const RowOrientation> exposures);

  // One picture, each row as its own orientation sees the scene; the photograph is sampled once, by
  // cubic convolution. `exposure` must be one of those that Create was told of.
  [[nodiscard]] Result<Frame> Record(const RowOrientation& exposure,
                                     const ExposureOptions& options) const;

  // Photograph pixels per picture pixel: below 1 the photograph was enlarged.
  [[nodiscard]] double photo_per_pixel() const { return photo_per_pixel_; }

 private:
  PhotoScene() = default;

  Camera camera_;
  Frame photo_;
  Eigen::Matrix3d photo_from_scene_;  // from pixels of a camera that looks as the scene does
  double photo_per_pixel_ = 0.0;
};

}  // namespace rsstab::evaluation

#endif  // RSSTAB_EVALUATION_PHOTO_SCENE_H_
