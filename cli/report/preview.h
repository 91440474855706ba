// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_REPORT_PREVIEW_H_
#define RSSTAB_CLI_REPORT_PREVIEW_H_

#include <string>
#include <string_view>

#include "igf/base/frame.h"
#include "igf/base/result.h"

namespace rsstab::report {

// How Y, Cb and Cr become red, green and blue.
enum class ColorMatrix { kBt601, kBt709, kBt2020 };

// From the name that libav gives it ("bt709", "smpte170m", "bt2020nc"); where a clip does not say,
// what players assume by the picture's height.
[[nodiscard]] ColorMatrix ColorMatrixOf(std::string_view name, int height);

// A frame made small enough to look at: at most `max_width` wide, packed RGB, 8 bits, its samples
// its own. Transfer curves are left as they are, so HDR looks flat.
// Errors: kInvalidArgument for a frame without samples or `max_width` below 1.
[[nodiscard]] Result<Frame> MakePreview(const FrameView& frame, int max_width,
                                        ColorMatrix matrix = ColorMatrix::kBt709);

enum class PictureFormat {
  kWebp,  // photographs
  kPng,   // colours that have to stay exact
};

// A packed 8-bit RGB picture as a "data:" address for a page. `quarter_turns` counter-clockwise.
// Errors: kInvalidArgument for another layout; kInternal when the encoder fails.
[[nodiscard]] Result<std::string> DataUri(const FrameView& rgb, PictureFormat format,
                                          int quarter_turns = 0);

}  // namespace rsstab::report

#endif  // RSSTAB_CLI_REPORT_PREVIEW_H_
