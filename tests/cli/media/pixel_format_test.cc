// SPDX-License-Identifier: Apache-2.0
#include "cli/media/pixel_format.h"

#include <gtest/gtest.h>

#include <utility>
#include <vector>

namespace rsstab::media {
namespace {

std::optional<PixelLayout> Layout(AVPixelFormat format) {
  return LayoutOf(format, AVCOL_RANGE_UNSPECIFIED, AVCHROMA_LOC_UNSPECIFIED);
}

TEST(PixelFormat, KnownLayouts) {
  EXPECT_EQ(Layout(AV_PIX_FMT_YUV420P), Yuv420Layout(8));
  EXPECT_EQ(Layout(AV_PIX_FMT_YUV420P10), Yuv420Layout(10));
  EXPECT_EQ(Layout(AV_PIX_FMT_GRAY8), GrayLayout(8));
  EXPECT_EQ(Layout(AV_PIX_FMT_RGBA)->channels, RgbaLayout().channels);
  EXPECT_TRUE(Layout(AV_PIX_FMT_RGBA)->full_range);
  EXPECT_EQ(Layout(AV_PIX_FMT_NV12)->num_planes, 2);
  EXPECT_EQ(Layout(AV_PIX_FMT_NV12)->channels[1], 2);
  EXPECT_EQ(Layout(AV_PIX_FMT_YUVA420P)->num_planes, 4);
  EXPECT_TRUE(Layout(AV_PIX_FMT_GBRP16)->is_rgb);
  EXPECT_TRUE(Layout(AV_PIX_FMT_YUVJ422P)->full_range);
}

TEST(PixelFormat, NoLayoutForWhatItCannotSay) {
  for (const AVPixelFormat format :
       {AV_PIX_FMT_YUYV422, AV_PIX_FMT_PAL8, AV_PIX_FMT_YUV420P10BE, AV_PIX_FMT_NV21,
        AV_PIX_FMT_P010LE, AV_PIX_FMT_GBRPF32LE, AV_PIX_FMT_MONOWHITE, AV_PIX_FMT_RGB565LE,
        AV_PIX_FMT_ARGB, AV_PIX_FMT_YA8, AV_PIX_FMT_VAAPI, AV_PIX_FMT_BAYER_BGGR8,
        AV_PIX_FMT_NONE}) {
    EXPECT_FALSE(Layout(format)) << FormatName(format);
  }
}

TEST(PixelFormat, DeliveredFormatKeepsDepthAndSubsampling) {
  using Pair = std::pair<AVPixelFormat, AVPixelFormat>;
  for (const auto& [stored, delivered] :
       {Pair{AV_PIX_FMT_YUYV422, AV_PIX_FMT_YUV422P}, Pair{AV_PIX_FMT_UYVY422, AV_PIX_FMT_YUV422P},
        Pair{AV_PIX_FMT_YUV422P10BE, AV_PIX_FMT_YUV422P10LE},
        Pair{AV_PIX_FMT_P010LE, AV_PIX_FMT_YUV420P10LE}, Pair{AV_PIX_FMT_NV12, AV_PIX_FMT_NV12},
        Pair{AV_PIX_FMT_NV21, AV_PIX_FMT_YUV420P}, Pair{AV_PIX_FMT_YUVJ420P, AV_PIX_FMT_YUV420P},
        Pair{AV_PIX_FMT_GRAY16BE, AV_PIX_FMT_GRAY16LE}, Pair{AV_PIX_FMT_BGR24, AV_PIX_FMT_GBRP},
        Pair{AV_PIX_FMT_MONOWHITE, AV_PIX_FMT_GRAY8}, Pair{AV_PIX_FMT_PAL8, AV_PIX_FMT_GBRAP},
        Pair{AV_PIX_FMT_RGB565LE, AV_PIX_FMT_GBRP}, Pair{AV_PIX_FMT_X2RGB10LE, AV_PIX_FMT_GBRP10},
        Pair{AV_PIX_FMT_YA8, AV_PIX_FMT_YUVA420P}}) {
    EXPECT_EQ(FormatName(DeliveredFormat(stored)), FormatName(delivered)) << FormatName(stored);
  }
}

TEST(PixelFormat, NearestFormatLosesLeast) {
  const std::vector<AVPixelFormat> x264 = {
      AV_PIX_FMT_YUV420P, AV_PIX_FMT_YUVJ420P,  AV_PIX_FMT_YUV422P,   AV_PIX_FMT_YUV444P,
      AV_PIX_FMT_NV12,    AV_PIX_FMT_YUV420P10, AV_PIX_FMT_YUV422P10, AV_PIX_FMT_YUV444P10,
      AV_PIX_FMT_GRAY8,   AV_PIX_FMT_GRAY10};
  using Pair = std::pair<AVPixelFormat, AVPixelFormat>;
  for (const auto& [wanted, nearest] :
       {Pair{AV_PIX_FMT_YUV420P, AV_PIX_FMT_YUV420P}, Pair{AV_PIX_FMT_NV12, AV_PIX_FMT_NV12},
        Pair{AV_PIX_FMT_YUV422P12, AV_PIX_FMT_YUV422P10},
        Pair{AV_PIX_FMT_YUV440P, AV_PIX_FMT_YUV444P}, Pair{AV_PIX_FMT_GBRP, AV_PIX_FMT_YUV444P},
        Pair{AV_PIX_FMT_RGBA, AV_PIX_FMT_YUV444P}, Pair{AV_PIX_FMT_GRAY16, AV_PIX_FMT_GRAY10},
        Pair{AV_PIX_FMT_YUVA420P, AV_PIX_FMT_YUV420P}}) {
    EXPECT_EQ(FormatName(NearestFormat(wanted, x264)), FormatName(nearest)) << FormatName(wanted);
  }
  EXPECT_EQ(FormatName(NearestFormat(AV_PIX_FMT_GRAY8, {AV_PIX_FMT_YUV420P})), "yuv420p");
  EXPECT_EQ(
      FormatName(NearestFormat(AV_PIX_FMT_YUV420P, {AV_PIX_FMT_YUVJ444P, AV_PIX_FMT_YUVJ420P})),
      "yuvj420p");
  EXPECT_EQ(NearestFormat(AV_PIX_FMT_YUV420P, {}), AV_PIX_FMT_NONE);
}

TEST(PixelFormat, EveryFormatIsDeliveredSomehow) {
  for (int i = 0; i < AV_PIX_FMT_NB; ++i) {
    const auto format = static_cast<AVPixelFormat>(i);
    if (sws_isSupportedInput(format) == 0) {
      continue;
    }
    const AVPixelFormat delivered = DeliveredFormat(format);
    ASSERT_NE(delivered, AV_PIX_FMT_NONE) << FormatName(format);
    EXPECT_TRUE(Layout(delivered)) << FormatName(format);
  }
}

TEST(PixelFormat, FormatOfInvertsLayoutOf) {
  for (const AVPixelFormat format :
       {AV_PIX_FMT_YUV420P, AV_PIX_FMT_YUV422P, AV_PIX_FMT_YUV444P, AV_PIX_FMT_YUV440P,
        AV_PIX_FMT_YUV411P, AV_PIX_FMT_YUV410P, AV_PIX_FMT_YUV420P9LE, AV_PIX_FMT_YUV422P12LE,
        AV_PIX_FMT_YUV444P16LE, AV_PIX_FMT_YUVA444P10LE, AV_PIX_FMT_GRAY8, AV_PIX_FMT_GRAY12LE,
        AV_PIX_FMT_GBRP, AV_PIX_FMT_GBRP10LE, AV_PIX_FMT_GBRAP, AV_PIX_FMT_NV12, AV_PIX_FMT_NV16,
        AV_PIX_FMT_RGB24, AV_PIX_FMT_RGBA}) {
    EXPECT_EQ(FormatName(FormatOf(Layout(format).value())), FormatName(format));
  }
  PixelLayout impossible = Yuv420Layout();
  impossible.bit_depth = 11;
  EXPECT_EQ(FormatOf(impossible), AV_PIX_FMT_NONE);
}

TEST(PixelFormat, Siting) {
  const auto offsets = [](AVPixelFormat format, AVChromaLocation location) {
    const PixelLayout layout = LayoutOf(format, AVCOL_RANGE_MPEG, location).value();
    return std::pair(layout.chroma_offset_x, layout.chroma_offset_y);
  };
  EXPECT_EQ(offsets(AV_PIX_FMT_YUV420P, AVCHROMA_LOC_LEFT), std::pair(0.0, 0.5));
  EXPECT_EQ(offsets(AV_PIX_FMT_YUV420P, AVCHROMA_LOC_CENTER), std::pair(0.5, 0.5));
  EXPECT_EQ(offsets(AV_PIX_FMT_YUV420P, AVCHROMA_LOC_TOPLEFT), std::pair(0.0, 0.0));
  EXPECT_EQ(offsets(AV_PIX_FMT_YUV420P, AVCHROMA_LOC_BOTTOM), std::pair(0.5, 1.0));
  EXPECT_EQ(offsets(AV_PIX_FMT_YUV422P, AVCHROMA_LOC_LEFT), std::pair(0.0, 0.0));
  EXPECT_EQ(offsets(AV_PIX_FMT_YUV422P, AVCHROMA_LOC_CENTER), std::pair(0.5, 0.0));
  EXPECT_EQ(offsets(AV_PIX_FMT_YUV444P, AVCHROMA_LOC_CENTER), std::pair(0.0, 0.0));
  EXPECT_EQ(offsets(AV_PIX_FMT_YUV411P, AVCHROMA_LOC_CENTER), std::pair(1.5, 0.0));
  for (const AVChromaLocation location :
       {AVCHROMA_LOC_LEFT, AVCHROMA_LOC_CENTER, AVCHROMA_LOC_TOPLEFT, AVCHROMA_LOC_BOTTOMLEFT}) {
    EXPECT_EQ(SitingOf(LayoutOf(AV_PIX_FMT_YUV420P, AVCOL_RANGE_MPEG, location).value()), location);
  }
}

TEST(PixelFormat, ColorNamesRoundTrip) {
  const ColorTags tags{"tv", "bt2020", "smpte2084", "bt2020nc", "topleft"};
  EXPECT_EQ(NamesOf(ColorOf(tags)), tags);
  EXPECT_EQ(NamesOf(ColorOf({})), ColorTags());
  EXPECT_EQ(NamesOf(ColorOf({"loud", "blue", "slow", "big", "here"})), ColorTags());
}

}  // namespace
}  // namespace rsstab::media
