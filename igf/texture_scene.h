// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_IGF_TEXTURE_SCENE_H_
#define RSSTAB_IGF_TEXTURE_SCENE_H_

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "igf/base/result.h"

namespace rsstab::igf {

// Packed 8-bit RGB, row by row, no padding: pixels.size() == 3 * width * height.
struct RgbPicture {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> pixels;
};

// Which sample of a scene is asked for; BT.709 luma and chroma.
enum class ScenePlane { kLuma = 0, kCb = 1, kCr = 2 };

// A picture of the world at infinity, seen from the inside: it covers every direction, so no view
// has a black border, and it is a smooth function of the direction, so it can be sampled exactly.
//
// Geometry. World axes: x right, y down, z forward. The picture hangs on the four walls of an
// endlessly tall square room around the camera, its centre straight ahead, and is continued by
// reflection in all directions. A wall is a plane, so what is straight in the picture is straight
// in a view of less than 90 degrees, and a view is related to a wall by the homography
// K_scene R^T K^-1.
//
// Sampling. Values are the control points of a uniform cubic B-spline, at 1.25 texels a view pixel:
// a twice differentiable surface, without overshoot, which a view's pixel grid resolves (it is as
// sharp as a Gaussian of 0.46 view pixels). Towards the corners of the room, where a view sees more
// texels a pixel, the texture is blurred beforehand to the same sharpness.
//
// Immutable; const methods from any thread.
class TextureScene {
 public:
  // `picture_width_tan`: width of the picture on its wall in units of the wall's distance, in
  // (0, 8]; a view of horizontal angle a sees 2 tan(a / 2) of it. Rounded such that an even number
  // of pictures goes round the room (8, 2, 4/3 or 1 for example: 8 / width is 2, 4, 6, 8, ..; a
  // width above 4 becomes 4). `view_focal_px`: focal length of the camera that will look at it.
  // Errors: kInvalidArgument for an empty picture, or numbers outside the ranges above, or a scene
  // of more than 2^28 texels.
  [[nodiscard]] static Result<TextureScene> FromPicture(const RgbPicture& picture,
                                                        double picture_width_tan,
                                                        double view_focal_px);

  // Texels per unit of tangent on a wall: the K_scene focal length of the luma plane.
  [[nodiscard]] double focal_texels() const { return planes_[0].focal; }
  // Picture size in texels of the luma plane.
  [[nodiscard]] int width_texels() const { return planes_[0].width; }
  [[nodiscard]] int height_texels() const { return planes_[0].height; }

  // Samples the directions d_i = first + i * step (world axes, any length; not straight up or down)
  // for i = 0 .. out.size() - 1 into out. Values are full-range and of unit scale: luma 0..1,
  // chroma -0.5..0.5.
  void SampleLine(ScenePlane plane, const Eigen::Vector3d& first, const Eigen::Vector3d& step,
                  std::span<float> out) const;

  // The same for any list of directions.
  void SampleDirections(ScenePlane plane, std::span<const Eigen::Vector3d> directions,
                        std::span<float> out) const;

 private:
  // Control points with a reflected margin, so that a 4x4 neighbourhood never leaves the array.
  struct Plane {
    int width = 0;
    int height = 0;
    int stride = 0;
    double focal = 0.0;
    std::vector<float> values;
  };

  [[nodiscard]] const Plane& plane(ScenePlane p) const {
    return planes_[static_cast<std::size_t>(p)];
  }

  std::array<Plane, 3> planes_;
};

}  // namespace rsstab::igf

#endif  // RSSTAB_IGF_TEXTURE_SCENE_H_
