// SPDX-License-Identifier: Apache-2.0
#include "cli/media/pixel_format.h"

extern "C" {
#include <libavutil/pixdesc.h>
}

#include <bit>
#include <cstdint>

namespace rsstab::media {
namespace {

// Where chroma sample 0 sits, in luma pixels, along one axis that is subsampled by 2^shift.
enum class Siting { kFirst, kMiddle, kLast };

double OffsetOf(Siting siting, int shift) {
  const double last = static_cast<double>((1 << shift) - 1);
  return siting == Siting::kFirst ? 0.0 : siting == Siting::kMiddle ? last / 2.0 : last;
}

void SetSiting(PixelLayout& layout, AVChromaLocation location) {
  Siting x = Siting::kFirst;
  Siting y = Siting::kMiddle;
  switch (location) {
    case AVCHROMA_LOC_CENTER:
      x = Siting::kMiddle;
      break;
    case AVCHROMA_LOC_TOPLEFT:
      y = Siting::kFirst;
      break;
    case AVCHROMA_LOC_TOP:
      x = Siting::kMiddle;
      y = Siting::kFirst;
      break;
    case AVCHROMA_LOC_BOTTOMLEFT:
      y = Siting::kLast;
      break;
    case AVCHROMA_LOC_BOTTOM:
      x = Siting::kMiddle;
      y = Siting::kLast;
      break;
    default:
      break;
  }
  layout.chroma_offset_x = OffsetOf(x, layout.chroma_shift_x);
  layout.chroma_offset_y = OffsetOf(y, layout.chroma_shift_y);
}

bool SameMemory(const PixelLayout& a, const PixelLayout& b) {
  return a.bit_depth == b.bit_depth && a.num_planes == b.num_planes && a.channels == b.channels &&
         a.is_rgb == b.is_rgb &&
         (a.is_rgb || a.num_planes == 1 ||
          (a.chroma_shift_x == b.chroma_shift_x && a.chroma_shift_y == b.chroma_shift_y));
}

// The components of a plane must be its channels in their own order: R, G, B, A or U, V.
bool ReadPlanes(const AVPixFmtDescriptor& format, int bytes_per_sample, PixelLayout& layout) {
  layout.channels = {0, 0, 0, 0};
  const bool packed = layout.num_planes == 1 && format.nb_components > 1;
  for (int c = 0; c < format.nb_components; ++c) {
    const AVComponentDescriptor& component = format.comp[c];
    if (component.plane >= layout.num_planes) {
      return false;
    }
    int& channels = layout.channels[static_cast<std::size_t>(component.plane)];
    if (component.offset != channels * bytes_per_sample) {
      return false;
    }
    ++channels;
  }
  for (int c = 0; c < format.nb_components; ++c) {
    const AVComponentDescriptor& component = format.comp[c];
    const int channels = layout.channels[static_cast<std::size_t>(component.plane)];
    // RGB0 and the like have a fourth byte that no component owns: treated as alpha.
    const bool has_padding = packed && channels == 3 && component.step == 4 * bytes_per_sample;
    if (component.step != channels * bytes_per_sample && !has_padding) {
      return false;
    }
    if (has_padding && c == format.nb_components - 1) {
      layout.channels[static_cast<std::size_t>(component.plane)] = 4;
      break;
    }
  }
  for (std::size_t p = 0; p < layout.channels.size(); ++p) {
    if (static_cast<int>(p) >= layout.num_planes) {
      layout.channels[p] = 1;
    } else if (layout.channels[p] == 0) {
      return false;
    }
  }
  if (packed) {
    return layout.is_rgb && layout.channels[0] >= 3;  // no packed YUV, no gray with alpha
  }
  return layout.channels[0] == 1;
}

struct FormatTraits {
  bool is_gray = false;
  bool is_rgb = false;
  bool has_alpha = false;
  bool is_planar = false;
  int depth = 0;
};

FormatTraits TraitsOf(const AVPixFmtDescriptor& format) {
  FormatTraits traits;
  const bool is_palette = (format.flags & AV_PIX_FMT_FLAG_PAL) != 0;
  traits.is_rgb = (format.flags & AV_PIX_FMT_FLAG_RGB) != 0 || is_palette;
  traits.is_gray = !traits.is_rgb && format.nb_components <= 2;
  traits.has_alpha = (format.flags & AV_PIX_FMT_FLAG_ALPHA) != 0;
  traits.is_planar = (format.flags & AV_PIX_FMT_FLAG_PLANAR) != 0 && format.comp[1].step <= 2;
  traits.depth = format.comp[0].depth;
  return traits;
}

// What a change of format costs: losses first, in the order in which an eye would miss them, then
// what it inflates. (libav's own choice prefers 16 bits for 10-bit pictures in another byte order.)
int ConversionCost(const AVPixFmtDescriptor& source, const AVPixFmtDescriptor& target) {
  const FormatTraits from = TraitsOf(source);
  const FormatTraits to = TraitsOf(target);
  int cost = 1;  // an equal format costs nothing
  const auto add = [&cost](bool applies, int amount) { cost += applies ? amount : 0; };
  add(to.is_gray && !from.is_gray, 1000);
  add(from.has_alpha && !to.has_alpha, 300);
  add(!from.is_gray && !to.is_gray && from.is_rgb != to.is_rgb, 50);
  add(from.is_gray && !to.is_gray, to.is_rgb ? 60 : 10);
  add(to.has_alpha && !from.has_alpha, 5);
  add(!to.is_planar, 1);
  const int deeper = to.depth - from.depth;
  cost += deeper < 0 ? -20 * deeper : 2 * deeper;
  if (!from.is_gray && !to.is_gray) {
    const int coarser = (target.log2_chroma_w - source.log2_chroma_w);
    const int lower = (target.log2_chroma_h - source.log2_chroma_h);
    cost += coarser > 0 ? 100 * coarser : -3 * coarser;
    cost += lower > 0 ? 100 * lower : -3 * lower;
  }
  return cost;
}

}  // namespace

std::optional<PixelLayout> LayoutOf(AVPixelFormat format, AVColorRange range,
                                    AVChromaLocation siting) {
  const AVPixFmtDescriptor* description = av_pix_fmt_desc_get(format);
  constexpr std::uint64_t kForeign = AV_PIX_FMT_FLAG_HWACCEL | AV_PIX_FMT_FLAG_PAL |
                                     AV_PIX_FMT_FLAG_BITSTREAM | AV_PIX_FMT_FLAG_FLOAT |
                                     AV_PIX_FMT_FLAG_BAYER;
  if (description == nullptr || (description->flags & kForeign) != 0 ||
      description->nb_components < 1) {
    return std::nullopt;
  }
  PixelLayout layout;
  layout.bit_depth = description->comp[0].depth;
  layout.num_planes = av_pix_fmt_count_planes(format);
  layout.is_rgb = (description->flags & AV_PIX_FMT_FLAG_RGB) != 0;
  if (layout.bit_depth < 8 || layout.bit_depth > 16 || layout.num_planes < 1 ||
      layout.num_planes > kMaxPlanes) {
    return std::nullopt;
  }
  const bool is_big_endian = (description->flags & AV_PIX_FMT_FLAG_BE) != 0;
  if (layout.bit_depth > 8 && is_big_endian != (std::endian::native == std::endian::big)) {
    return std::nullopt;
  }
  for (int c = 0; c < description->nb_components; ++c) {
    if (description->comp[c].depth != layout.bit_depth || description->comp[c].shift != 0) {
      return std::nullopt;
    }
  }
  if (!ReadPlanes(*description, layout.BytesPerSample(), layout)) {
    return std::nullopt;
  }
  layout.chroma_shift_x = description->log2_chroma_w;
  layout.chroma_shift_y = description->log2_chroma_h;
  layout.full_range = layout.is_rgb || NameSaysFullRange(format) || range == AVCOL_RANGE_JPEG;
  SetSiting(layout, siting);
  return layout;
}

AVPixelFormat FormatOf(const PixelLayout& layout) {
  for (const AVPixFmtDescriptor* description = av_pix_fmt_desc_next(nullptr);
       description != nullptr; description = av_pix_fmt_desc_next(description)) {
    const AVPixelFormat format = av_pix_fmt_desc_get_id(description);
    const std::optional<PixelLayout> candidate =
        LayoutOf(format, AVCOL_RANGE_UNSPECIFIED, AVCHROMA_LOC_UNSPECIFIED);
    if (candidate && !NameSaysFullRange(format) && SameMemory(*candidate, layout)) {
      return format;
    }
  }
  return AV_PIX_FMT_NONE;
}

AVPixelFormat DeliveredFormat(AVPixelFormat format) {
  const AVPixelFormat plain = WithoutRange(format);
  if (LayoutOf(plain, AVCOL_RANGE_UNSPECIFIED, AVCHROMA_LOC_UNSPECIFIED)) {
    return plain;
  }
  std::vector<AVPixelFormat> candidates;
  for (const AVPixFmtDescriptor* description = av_pix_fmt_desc_next(nullptr);
       description != nullptr; description = av_pix_fmt_desc_next(description)) {
    const AVPixelFormat candidate = av_pix_fmt_desc_get_id(description);
    const bool planar =
        (description->flags & AV_PIX_FMT_FLAG_PLANAR) != 0 || description->nb_components == 1;
    if (planar && !NameSaysFullRange(candidate) && sws_isSupportedOutput(candidate) != 0 &&
        LayoutOf(candidate, AVCOL_RANGE_UNSPECIFIED, AVCHROMA_LOC_UNSPECIFIED)) {
      candidates.push_back(candidate);
    }
  }
  return NearestFormat(format, candidates);
}

AVPixelFormat WithoutRange(AVPixelFormat format) {
  switch (format) {
    case AV_PIX_FMT_YUVJ420P:
      return AV_PIX_FMT_YUV420P;
    case AV_PIX_FMT_YUVJ422P:
      return AV_PIX_FMT_YUV422P;
    case AV_PIX_FMT_YUVJ444P:
      return AV_PIX_FMT_YUV444P;
    case AV_PIX_FMT_YUVJ440P:
      return AV_PIX_FMT_YUV440P;
    case AV_PIX_FMT_YUVJ411P:
      return AV_PIX_FMT_YUV411P;
    default:
      return format;
  }
}

bool NameSaysFullRange(AVPixelFormat format) { return WithoutRange(format) != format; }

AVPixelFormat NearestFormat(AVPixelFormat format, const std::vector<AVPixelFormat>& candidates) {
  const AVPixFmtDescriptor* source = av_pix_fmt_desc_get(WithoutRange(format));
  AVPixelFormat best = AV_PIX_FMT_NONE;
  int best_cost = 0;
  for (const AVPixelFormat candidate : candidates) {
    const AVPixFmtDescriptor* target = av_pix_fmt_desc_get(WithoutRange(candidate));
    if (source == nullptr || target == nullptr) {
      continue;
    }
    const int cost = source == target ? 0 : ConversionCost(*source, *target);
    if (best == AV_PIX_FMT_NONE || cost < best_cost) {
      best = candidate;
      best_cost = cost;
    }
  }
  return best;
}

std::string FormatName(AVPixelFormat format) {
  const char* name = av_get_pix_fmt_name(format);
  return name != nullptr ? name : "unknown";
}

ColorTags NamesOf(const AvColor& color) {
  const auto name = [](bool specified, const char* text) {
    return std::string(specified && text != nullptr ? text : "");
  };
  ColorTags tags;
  tags.range = name(color.range != AVCOL_RANGE_UNSPECIFIED, av_color_range_name(color.range));
  tags.primaries =
      name(color.primaries != AVCOL_PRI_UNSPECIFIED, av_color_primaries_name(color.primaries));
  tags.transfer =
      name(color.transfer != AVCOL_TRC_UNSPECIFIED, av_color_transfer_name(color.transfer));
  tags.matrix = name(color.matrix != AVCOL_SPC_UNSPECIFIED, av_color_space_name(color.matrix));
  tags.chroma_location = name(color.chroma_location != AVCHROMA_LOC_UNSPECIFIED,
                              av_chroma_location_name(color.chroma_location));
  return tags;
}

AvColor ColorOf(const ColorTags& tags) {
  // Each lookup gives a negative number for an unknown or empty name.
  AvColor color;
  if (const int value = av_color_range_from_name(tags.range.c_str()); value > 0) {
    color.range = static_cast<AVColorRange>(value);
  }
  if (const int value = av_color_primaries_from_name(tags.primaries.c_str()); value > 0) {
    color.primaries = static_cast<AVColorPrimaries>(value);
  }
  if (const int value = av_color_transfer_from_name(tags.transfer.c_str()); value > 0) {
    color.transfer = static_cast<AVColorTransferCharacteristic>(value);
  }
  if (const int value = av_color_space_from_name(tags.matrix.c_str()); value >= 0) {
    color.matrix = static_cast<AVColorSpace>(value);
  }
  if (const int value = av_chroma_location_from_name(tags.chroma_location.c_str()); value > 0) {
    color.chroma_location = static_cast<AVChromaLocation>(value);
  }
  return color;
}

AVChromaLocation SitingOf(const PixelLayout& layout) {
  if (layout.is_rgb || layout.num_planes == 1 || layout.chroma_shift_y == 0) {
    return AVCHROMA_LOC_UNSPECIFIED;
  }
  for (const AVChromaLocation location :
       {AVCHROMA_LOC_LEFT, AVCHROMA_LOC_CENTER, AVCHROMA_LOC_TOPLEFT, AVCHROMA_LOC_TOP,
        AVCHROMA_LOC_BOTTOMLEFT, AVCHROMA_LOC_BOTTOM}) {
    PixelLayout candidate = layout;
    SetSiting(candidate, location);
    if (candidate == layout) {
      return location;
    }
  }
  return AVCHROMA_LOC_UNSPECIFIED;
}

}  // namespace rsstab::media
