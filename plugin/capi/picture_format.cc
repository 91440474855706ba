// SPDX-License-Identifier: Apache-2.0
#include "plugin/capi/picture_format.h"

#include <cstring>
#include <optional>

namespace rsstab::capi {
namespace {

constexpr int kMaxSide = 65535;
constexpr double kDefaultFrameRate = 30.0;
constexpr double kMaxFrameRate = 1e5;

PixelLayout Yuv(int bit_depth, int shift_x, int shift_y) {
  PixelLayout layout = Yuv420Layout(bit_depth);
  layout.chroma_shift_x = shift_x;
  layout.chroma_shift_y = shift_y;
  return layout;
}

PixelLayout PackedRgb(int channels) {
  PixelLayout layout = RgbaLayout();
  layout.channels[0] = channels;
  return layout;
}

PixelLayout PlanarRgb(int bit_depth) {
  PixelLayout layout = Yuv(bit_depth, 0, 0);
  layout.is_rgb = true;
  layout.full_range = true;
  return layout;
}

std::optional<PixelLayout> LayoutOf(rsstab_pixel_format format) {
  switch (format) {
    case RSSTAB_PIXEL_YUV420P:
      return Yuv(8, 1, 1);
    case RSSTAB_PIXEL_YUV422P:
      return Yuv(8, 1, 0);
    case RSSTAB_PIXEL_YUV444P:
      return Yuv(8, 0, 0);
    case RSSTAB_PIXEL_YUV420P10:
      return Yuv(10, 1, 1);
    case RSSTAB_PIXEL_YUV422P10:
      return Yuv(10, 1, 0);
    case RSSTAB_PIXEL_YUV444P10:
      return Yuv(10, 0, 0);
    case RSSTAB_PIXEL_YUV420P12:
      return Yuv(12, 1, 1);
    case RSSTAB_PIXEL_YUV422P12:
      return Yuv(12, 1, 0);
    case RSSTAB_PIXEL_YUV444P12:
      return Yuv(12, 0, 0);
    case RSSTAB_PIXEL_NV12: {
      PixelLayout layout = Yuv(8, 1, 1);
      layout.num_planes = 2;
      layout.channels[1] = 2;
      return layout;
    }
    case RSSTAB_PIXEL_GRAY8:
      return GrayLayout(8);
    case RSSTAB_PIXEL_GRAY10:
      return GrayLayout(10);
    case RSSTAB_PIXEL_GRAY12:
      return GrayLayout(12);
    case RSSTAB_PIXEL_GRAY16:
      return GrayLayout(16);
    case RSSTAB_PIXEL_RGB24:
    case RSSTAB_PIXEL_BGR24:  // the order of equal channels matters to nobody here
      return PackedRgb(3);
    case RSSTAB_PIXEL_RGBA:
    case RSSTAB_PIXEL_BGRA:
      return PackedRgb(4);
    case RSSTAB_PIXEL_GBRP:
      return PlanarRgb(8);
    case RSSTAB_PIXEL_GBRP10:
      return PlanarRgb(10);
    case RSSTAB_PIXEL_NONE:
      break;
  }
  return std::nullopt;
}

// First samples lie on the first luma sample ("left", "top left") or between it and the last.
double SitingOffset(int shift, bool centred) {
  return centred ? static_cast<double>((1 << shift) - 1) / 2.0 : 0.0;
}

template <typename Planes>
Status CheckPlanes(const Planes& planes, const VideoFormat& format) {
  for (int p = 0; p < format.layout.num_planes; ++p) {
    const auto index = static_cast<std::size_t>(p);
    if (planes.data[p] == nullptr) {
      return Fail(ErrorCode::kInvalidArgument, "plane {} of a picture is missing", p);
    }
    const std::ptrdiff_t row =
        static_cast<std::ptrdiff_t>(format.layout.PlaneWidth(p, format.width)) *
        format.layout.channels[index] * format.layout.BytesPerSample();
    const std::ptrdiff_t stride = planes.stride[p] < 0 ? -planes.stride[p] : planes.stride[p];
    if (stride < row) {
      return Fail(ErrorCode::kInvalidArgument,
                  "plane {} of a picture has a stride of {} bytes, but its rows have {}", p,
                  planes.stride[p], row);
    }
    if (format.layout.BytesPerSample() == 2 &&
        (reinterpret_cast<std::uintptr_t>(planes.data[p]) % 2 != 0 || stride % 2 != 0)) {
      return Fail(ErrorCode::kInvalidArgument,
                  "plane {} of a picture of 16-bit samples begins or continues at an odd address",
                  p);
    }
  }
  return {};
}

}  // namespace

Result<VideoFormat> ToVideoFormat(const rsstab_video& video) {
  if (video.struct_size < sizeof(rsstab_video)) {
    return Fail(ErrorCode::kInvalidArgument,
                "rsstab_video says that it is {} bytes long, not {}: begin with RSSTAB_VIDEO_INIT",
                video.struct_size, sizeof(rsstab_video));
  }
  if (video.width < 1 || video.height < 1 || video.width > kMaxSide || video.height > kMaxSide) {
    return Fail(ErrorCode::kInvalidArgument, "pictures of {}x{} are not possible", video.width,
                video.height);
  }
  const auto layout = LayoutOf(video.format);
  if (!layout) {
    return Fail(ErrorCode::kUnsupported, "there is no pixel format of number {}",
                static_cast<int>(video.format));
  }
  if (video.time_base_num < 1 || video.time_base_den < 1) {
    return Fail(ErrorCode::kInvalidArgument, "a time base of {}/{} s is not possible",
                video.time_base_num, video.time_base_den);
  }
  VideoFormat format;
  format.layout = *layout;
  format.width = video.width;
  format.height = video.height;
  format.seconds_per_tick = static_cast<double>(video.time_base_num) / video.time_base_den;
  format.frames_per_second = kDefaultFrameRate;
  if (video.frame_rate_num != 0 || video.frame_rate_den != 0) {
    const double rate = static_cast<double>(video.frame_rate_num) / video.frame_rate_den;
    if (video.frame_rate_num < 1 || video.frame_rate_den < 1 || rate > kMaxFrameRate) {
      return Fail(ErrorCode::kInvalidArgument, "{}/{} frames per second are not possible",
                  video.frame_rate_num, video.frame_rate_den);
    }
    format.frames_per_second = rate;
  }
  if (!format.layout.is_rgb) {
    format.layout.full_range = video.full_range != 0;
    if (format.layout.num_planes > 1) {
      const bool centred = video.chroma_location == RSSTAB_CHROMA_CENTER;
      const bool at_top = video.chroma_location == RSSTAB_CHROMA_TOP_LEFT;
      format.layout.chroma_offset_x = SitingOffset(format.layout.chroma_shift_x, centred);
      format.layout.chroma_offset_y = SitingOffset(format.layout.chroma_shift_y, !at_top);
    }
  }
  return format;
}

Result<FrameView> ToFrameView(const rsstab_picture& picture, const VideoFormat& format) {
  if (Status ok = CheckPlanes(picture, format); !ok) {
    return Propagate(std::move(ok.error()));
  }
  FrameView view{format.layout, format.width, format.height, {}};
  for (int p = 0; p < format.layout.num_planes; ++p) {
    view.planes[static_cast<std::size_t>(p)] = {picture.data[p], picture.stride[p],
                                                format.layout.PlaneWidth(p, format.width),
                                                format.layout.PlaneHeight(p, format.height)};
  }
  return view;
}

Result<Frame> ToFrame(const rsstab_buffer& buffer, const VideoFormat& format) {
  if (Status ok = CheckPlanes(buffer, format); !ok) {
    return Propagate(std::move(ok.error()));
  }
  Frame frame;
  frame.layout = format.layout;
  frame.width = format.width;
  frame.height = format.height;
  for (int p = 0; p < format.layout.num_planes; ++p) {
    frame.planes[static_cast<std::size_t>(p)] = {buffer.data[p], buffer.stride[p],
                                                 format.layout.PlaneWidth(p, format.width),
                                                 format.layout.PlaneHeight(p, format.height)};
  }
  return frame;
}

void CopySamples(const FrameView& source, Frame& destination) {
  for (int p = 0; p < source.layout.num_planes; ++p) {
    const auto index = static_cast<std::size_t>(p);
    const PlaneView& from = source.planes[index];
    const MutablePlaneView& to = destination.planes[index];
    const auto row =
        static_cast<std::size_t>(from.width) *
        static_cast<std::size_t>(source.layout.channels[index] * source.layout.BytesPerSample());
    for (int y = 0; y < from.height; ++y) {
      std::memcpy(to.data + y * to.stride, from.data + y * from.stride, row);
    }
  }
}

}  // namespace rsstab::capi
