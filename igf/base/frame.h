// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_IGF_BASE_FRAME_H_
#define RSSTAB_IGF_BASE_FRAME_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>

#include "igf/base/result.h"

namespace rsstab {

inline constexpr int kMaxPlanes = 4;

// How the samples of a frame lie in memory. Planar and semi-planar YUV, gray, planar and packed
// RGB. Samples deeper than 8 bits are host-endian uint16, value in the low bits.
struct PixelLayout {
  int bit_depth = 8;   // 8..16
  int num_planes = 3;  // 1..kMaxPlanes
  // Interleaved samples per pixel of each plane: 1 for planar data, 2 for the chroma of NV12, 4 for
  // packed RGBA.
  std::array<int, kMaxPlanes> channels = {1, 1, 1, 1};
  // YUV only: log2 of the luma-to-chroma size ratio of the chroma planes.
  int chroma_shift_x = 1;
  int chroma_shift_y = 1;
  // YUV only: where chroma sample 0 sits, in luma pixels from the centre of luma pixel 0. MPEG-2
  // ("left") siting of 4:2:0 is (0, 0.5), MPEG-1/JPEG ("center") (0.5, 0.5), 4:4:4 (0, 0).
  double chroma_offset_x = 0.0;
  double chroma_offset_y = 0.5;
  bool is_rgb = false;      // false: plane 0 is luma (or gray), the next one or two are chroma
  bool full_range = false;  // luma black is 0 (true) or 16 << (bit_depth - 8) (false)

  // True for the subsampled planes: 1 and 2 of planar YUV, 1 of semi-planar YUV (never plane 3,
  // alpha).
  [[nodiscard]] bool IsChroma(int plane) const {
    if (is_rgb || num_planes == 1) {
      return false;
    }
    return plane == 1 || (plane == 2 && channels[1] == 1);
  }
  [[nodiscard]] int BytesPerSample() const { return bit_depth > 8 ? 2 : 1; }
  // Size in pixels of `plane` in an image of width x height; chroma rounds up, as libav does.
  [[nodiscard]] int PlaneWidth(int plane, int width) const {
    return IsChroma(plane) ? -((-width) >> chroma_shift_x) : width;
  }
  [[nodiscard]] int PlaneHeight(int plane, int height) const {
    return IsChroma(plane) ? -((-height) >> chroma_shift_y) : height;
  }
  // Value of black in channel `channel` of `plane` (alpha is opaque).
  [[nodiscard]] int BlackLevel(int plane, int channel) const;

  friend bool operator==(const PixelLayout&, const PixelLayout&) = default;
};

// One plane, not owned. `stride` in bytes, may be larger than the row; rows run top to bottom.
struct PlaneView {
  const std::uint8_t* data = nullptr;
  std::ptrdiff_t stride = 0;
  int width = 0;   // pixels, not samples
  int height = 0;  // rows
};
struct MutablePlaneView {
  std::uint8_t* data = nullptr;
  std::ptrdiff_t stride = 0;
  int width = 0;
  int height = 0;
};

// A picture owned by somebody else; never outlives the call it is passed to.
struct FrameView {
  PixelLayout layout;
  int width = 0;
  int height = 0;
  std::array<PlaneView, kMaxPlanes> planes;
};

// A picture with shared ownership of its samples. Copying shares them; treat the samples of a
// copied frame as const.
struct Frame {
  PixelLayout layout;
  int width = 0;
  int height = 0;
  std::array<MutablePlaneView, kMaxPlanes> planes;
  std::shared_ptr<void> storage;  // keeps `planes` alive
  // Opaque per-frame data of whoever made the frame (timestamps, side data); travels unchanged from
  // a decoded frame to the frame rendered from it.
  std::shared_ptr<const void> origin;

  [[nodiscard]] FrameView View() const;
};

// Allocates a frame; rows are aligned to 64 bytes, samples uninitialised.
// Errors: kInvalidArgument for sizes outside 1..65535 or a layout outside the limits above.
[[nodiscard]] Result<Frame> AllocateFrame(const PixelLayout& layout, int width, int height);

// Layouts in common use. Chroma siting "left" where it applies.
[[nodiscard]] PixelLayout Yuv420Layout(int bit_depth = 8);
[[nodiscard]] PixelLayout GrayLayout(int bit_depth = 8);
[[nodiscard]] PixelLayout RgbaLayout();  // packed, 8 bit

}  // namespace rsstab

#endif  // RSSTAB_IGF_BASE_FRAME_H_
