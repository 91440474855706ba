// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_MEDIA_PIXEL_FORMAT_H_
#define RSSTAB_CLI_MEDIA_PIXEL_FORMAT_H_

// AVPixelFormat <-> PixelLayout (includes libav). Both ways follow from libav's format
// descriptions, not from a table, so that every format that fits is found.

#include <optional>
#include <string>
#include <vector>

#include "cli/media/av_handles.h"
#include "cli/media/video_info.h"
#include "igf/base/frame.h"

namespace rsstab::media {

// How frames of `format` lie in memory. std::nullopt for what PixelLayout cannot say: other byte
// order, packed YUV, swapped chroma, palettes, bit streams, floating point, samples in the high
// bits, hardware surfaces.
// `range` unspecified means limited, except for RGB and the "yuvj" formats. `siting` unspecified
// means what MPEG-2, H.264 and later assume, "left".
[[nodiscard]] std::optional<PixelLayout> LayoutOf(AVPixelFormat format, AVColorRange range,
                                                  AVChromaLocation siting);

// The format whose frames lie like `layout`, range and siting aside; AV_PIX_FMT_NONE if there is
// none.
[[nodiscard]] AVPixelFormat FormatOf(const PixelLayout& layout);

// The format that frames of `format` are delivered in: itself where LayoutOf() can tell it,
// otherwise the one with a layout that loses least (depth, subsampling, colour, alpha).
[[nodiscard]] AVPixelFormat DeliveredFormat(AVPixelFormat format);

// The "yuvj" formats are the plain ones with full range said in the name. Returns the plain one.
[[nodiscard]] AVPixelFormat WithoutRange(AVPixelFormat format);
[[nodiscard]] bool NameSaysFullRange(AVPixelFormat format);

// Whichever of `candidates` loses least of `format`; a format equal but for a range in its name
// counts as the same. AV_PIX_FMT_NONE for no candidates.
[[nodiscard]] AVPixelFormat NearestFormat(AVPixelFormat format,
                                          const std::vector<AVPixelFormat>& candidates);

[[nodiscard]] std::string FormatName(AVPixelFormat format);

// ColorTags <-> libav's enumerations. Unspecified <-> empty; unknown names become unspecified.
struct AvColor {
  AVColorRange range = AVCOL_RANGE_UNSPECIFIED;
  AVColorPrimaries primaries = AVCOL_PRI_UNSPECIFIED;
  AVColorTransferCharacteristic transfer = AVCOL_TRC_UNSPECIFIED;
  AVColorSpace matrix = AVCOL_SPC_UNSPECIFIED;
  AVChromaLocation chroma_location = AVCHROMA_LOC_UNSPECIFIED;
};
[[nodiscard]] ColorTags NamesOf(const AvColor& color);
[[nodiscard]] AvColor ColorOf(const ColorTags& tags);

// The siting that `layout` describes, unspecified where it has no name.
[[nodiscard]] AVChromaLocation SitingOf(const PixelLayout& layout);

}  // namespace rsstab::media

#endif  // RSSTAB_CLI_MEDIA_PIXEL_FORMAT_H_
