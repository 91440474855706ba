// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_REPORT_DIFFERENCE_MAP_H_
#define RSSTAB_CLI_REPORT_DIFFERENCE_MAP_H_

#include <cstdint>
#include <optional>
#include <span>

#include "igf/base/camera.h"
#include "igf/base/frame.h"
#include "igf/base/result.h"

namespace rsstab::report {

// A difference of so many of 255 grey levels, or more, has the brightest colour.
inline constexpr int kFullDifference = 96;

// How well two pictures of one size (packed 8-bit RGB) lie on each other: black where they agree,
// over violet and orange to light yellow where brightness differs by kFullDifference. Pixels of
// `valid` (row by row, one byte a pixel; empty: all count) that are 0 become grey.
// Errors: kInvalidArgument for other layouts or sizes.
[[nodiscard]] Result<Frame> DifferenceMap(const FrameView& picture, const FrameView& truth,
                                          std::span<const std::uint8_t> valid = {});

// The same for a picture that shows the truth's scene turned and zoomed, as a steadied frame does:
// the truth is brought there first, by the best turn and zoom of `camera` (of any size), which are
// no error. What is left is skew, bending and wrong perspective. Empty when the two do not match.
[[nodiscard]] Result<std::optional<Frame>> AlignedDifferenceMap(const FrameView& picture,
                                                                const FrameView& truth,
                                                                const Camera& camera);

// The colours from agreement to kFullDifference, left to right, one pixel a level.
[[nodiscard]] Result<Frame> DifferenceKey();

}  // namespace rsstab::report

#endif  // RSSTAB_CLI_REPORT_DIFFERENCE_MAP_H_
