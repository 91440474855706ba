// SPDX-License-Identifier: Apache-2.0
#include "plugin/frei0r/session.h"

#include <cmath>
#include <cstring>

namespace rsstab::frei0r {

rsstab_video DescribeVideo(const PictureShape& shape) {
  rsstab_video video = RSSTAB_VIDEO_INIT;
  video.width = static_cast<std::int32_t>(shape.width);
  video.height = static_cast<std::int32_t>(shape.height);
  video.format = RSSTAB_PIXEL_RGBA;
  video.time_base_num = 1;
  video.time_base_den = kTicksPerSecond;
  return video;
}

rsstab_picture PictureAt(const std::uint8_t* data, const PictureShape& shape) {
  return {{data, nullptr, nullptr, nullptr}, {shape.row_bytes, 0, 0, 0}};
}

rsstab_buffer BufferAt(std::uint8_t* data, const PictureShape& shape) {
  return {{data, nullptr, nullptr, nullptr}, {shape.row_bytes, 0, 0, 0}};
}

void CopyPicture(const std::uint8_t* in, std::uint8_t* out, const PictureShape& shape) {
  const std::size_t used = std::size_t{4} * shape.width;
  for (unsigned row = 0; row < shape.height; ++row) {
    const std::ptrdiff_t offset = shape.row_bytes * static_cast<std::ptrdiff_t>(row);
    std::memcpy(out + offset, in + offset, used);
  }
}

std::int64_t Ticks(double time_s) {
  return static_cast<std::int64_t>(std::llround(time_s * kTicksPerSecond));
}

}  // namespace rsstab::frei0r
