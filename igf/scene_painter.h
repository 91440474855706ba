// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_IGF_SCENE_PAINTER_H_
#define RSSTAB_IGF_SCENE_PAINTER_H_

#include <cstdint>

#include "igf/base/result.h"
#include "igf/texture_scene.h"

namespace rsstab::igf {

// A painted picture spans 180 degrees of a TextureScene: pass this as `picture_width_tan`.
inline constexpr double kPaintedWidthTan = 4.0;

// Paints a street seen from across the road: sky, a far skyline, houses with windows, trees, lamp
// posts, paving, and grain at several scales. Verticals and horizontals everywhere, so that rolling
// shutter is plain to the eye; corners everywhere and no two windows alike, so that a tracker finds
// hold and no false twin.
// `width` in 256..32768 pixels; `height` in 64..width / 2: the same scale, the street cut off above
// and below, eye level near the middle. Same arguments, same picture; another width is the same
// street at another resolution, but for the grain.
// Errors: kInvalidArgument for a size outside the range.
[[nodiscard]] Result<RgbPicture> PaintStreet(int width, int height, std::uint64_t seed);

}  // namespace rsstab::igf

#endif  // RSSTAB_IGF_SCENE_PAINTER_H_
