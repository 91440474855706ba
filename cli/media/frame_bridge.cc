// SPDX-License-Identifier: Apache-2.0
#include "cli/media/frame_bridge.h"

#include <array>
#include <cerrno>
#include <cstring>
#include <utility>

#include "cli/media/av_error.h"

namespace rsstab::media {
namespace {

// Side data that is as true of the steadied picture as of the decoded one. Not here: what describes
// the old bit stream (quantisers, film grain parameters, user data of the old encoder) or the old
// geometry (motion vectors, regions), and Dolby Vision, whose enhancement does not survive
// re-encoding.
constexpr std::array kKeptSideData = {
    AV_FRAME_DATA_MASTERING_DISPLAY_METADATA,
    AV_FRAME_DATA_CONTENT_LIGHT_LEVEL,
    AV_FRAME_DATA_DYNAMIC_HDR_PLUS,
    AV_FRAME_DATA_A53_CC,
    AV_FRAME_DATA_AFD,
    AV_FRAME_DATA_S12M_TIMECODE,
    AV_FRAME_DATA_STEREO3D,
};

// Frame::origin is a void pointer that any other frame maker may use for its own type, so ours
// carries a mark.
struct MarkedOrigin {
  const void* mark = nullptr;
  FrameOrigin origin;
};
constexpr char kMark = 0;

bool CopySideData(const AVFrame& source, AVFrame& target) {
  for (const AVFrameSideDataType type : kKeptSideData) {
    const AVFrameSideData* data = av_frame_get_side_data(&source, type);
    if (data == nullptr) {
      continue;
    }
    AVBufferRef* shared = av_buffer_ref(data->buf);
    if (shared == nullptr || av_frame_new_side_data_from_buf(&target, type, shared) == nullptr) {
      av_buffer_unref(&shared);
      return false;
    }
  }
  return true;
}

void ReleaseStorage(void* opaque, std::uint8_t* /*data*/) {
  delete static_cast<std::shared_ptr<void>*>(opaque);
}

}  // namespace

const FrameOrigin* OriginOf(const Frame& frame) {
  const auto* marked = static_cast<const MarkedOrigin*>(frame.origin.get());
  return marked != nullptr && marked->mark == &kMark ? &marked->origin : nullptr;
}

void SetOrigin(Frame& frame, FrameOrigin origin) {
  auto marked = std::make_shared<MarkedOrigin>();
  marked->mark = &kMark;
  marked->origin = std::move(origin);
  frame.origin = std::move(marked);
}

Frame WrapPicture(AvFramePtr picture, const PixelLayout& layout) {
  Frame frame;
  frame.layout = layout;
  frame.width = picture->width;
  frame.height = picture->height;
  for (int p = 0; p < layout.num_planes; ++p) {
    const auto index = static_cast<std::size_t>(p);
    frame.planes[index] = {picture->data[p], picture->linesize[p],
                           layout.PlaneWidth(p, frame.width), layout.PlaneHeight(p, frame.height)};
  }
  frame.storage = std::shared_ptr<AVFrame>(picture.release(), AvDeleter{});
  return frame;
}

Result<AvFramePtr> SharePicture(const Frame& frame, AVPixelFormat format) {
  AvFramePtr picture(av_frame_alloc());
  if (picture == nullptr) {
    return AvFail(AVERROR(ENOMEM), "handing a frame to the encoder");
  }
  picture->format = format;
  picture->width = frame.width;
  picture->height = frame.height;
  for (int p = 0; p < frame.layout.num_planes; ++p) {
    const auto index = static_cast<std::size_t>(p);
    const MutablePlaneView& plane = frame.planes[index];
    auto holder = std::make_unique<std::shared_ptr<void>>(frame.storage);
    const std::ptrdiff_t bytes = (plane.stride < 0 ? -plane.stride : plane.stride) * plane.height;
    picture->buf[p] = av_buffer_create(plane.data, static_cast<std::size_t>(bytes), ReleaseStorage,
                                       holder.get(), AV_BUFFER_FLAG_READONLY);
    if (picture->buf[p] == nullptr) {
      return AvFail(AVERROR(ENOMEM), "handing a frame to the encoder");
    }
    static_cast<void>(holder.release());
    picture->data[p] = plane.data;
    picture->linesize[p] = static_cast<int>(plane.stride);
  }
  const FrameOrigin* origin = OriginOf(frame);
  if (origin != nullptr && origin->properties != nullptr &&
      !CopySideData(*origin->properties, *picture)) {
    return AvFail(AVERROR(ENOMEM), "handing a frame to the encoder");
  }
  return picture;
}

AvFramePtr KeptProperties(const AVFrame& picture) {
  if (picture.nb_side_data == 0) {
    return nullptr;
  }
  AvFramePtr properties(av_frame_alloc());
  if (properties == nullptr || !CopySideData(picture, *properties) ||
      properties->nb_side_data == 0) {
    return nullptr;
  }
  return properties;
}

AvFramePtr WithContainerHdr(AvFramePtr properties, const AVStream& stream) {
  for (int i = 0; i < stream.nb_side_data; ++i) {
    const AVPacketSideData& data = stream.side_data[i];
    AVFrameSideDataType type{};
    if (data.type == AV_PKT_DATA_MASTERING_DISPLAY_METADATA) {
      type = AV_FRAME_DATA_MASTERING_DISPLAY_METADATA;
    } else if (data.type == AV_PKT_DATA_CONTENT_LIGHT_LEVEL) {
      type = AV_FRAME_DATA_CONTENT_LIGHT_LEVEL;
    } else {
      continue;
    }
    if (properties == nullptr) {
      properties.reset(av_frame_alloc());
    }
    if (properties == nullptr || av_frame_get_side_data(properties.get(), type) != nullptr) {
      continue;
    }
    if (AVFrameSideData* copy = av_frame_new_side_data(properties.get(), type, data.size)) {
      std::memcpy(copy->data, data.data, data.size);
    }
  }
  return properties;
}

}  // namespace rsstab::media
