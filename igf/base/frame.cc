// SPDX-License-Identifier: Apache-2.0
#include "igf/base/frame.h"

#include <new>

namespace rsstab {
namespace {

constexpr std::size_t kRowAlignment = 64;
constexpr int kMaxSide = 65535;

}  // namespace

int PixelLayout::BlackLevel(int plane, int channel) const {
  const int maximum = (1 << bit_depth) - 1;
  if (plane == 3 || channel == 3) {
    return maximum;
  }
  if (IsChroma(plane)) {
    return 1 << (bit_depth - 1);
  }
  return (is_rgb || full_range) ? 0 : 16 << (bit_depth - 8);
}

FrameView Frame::View() const {
  FrameView view{layout, width, height, {}};
  for (std::size_t p = 0; p < planes.size(); ++p) {
    view.planes[p] = {planes[p].data, planes[p].stride, planes[p].width, planes[p].height};
  }
  return view;
}

Result<Frame> AllocateFrame(const PixelLayout& layout, int width, int height) {
  if (width < 1 || height < 1 || width > kMaxSide || height > kMaxSide) {
    return Fail(ErrorCode::kInvalidArgument, "a frame of {}x{} pixels is not possible", width,
                height);
  }
  if (layout.num_planes < 1 || layout.num_planes > kMaxPlanes || layout.bit_depth < 8 ||
      layout.bit_depth > 16) {
    return Fail(ErrorCode::kInvalidArgument,
                "a pixel layout of {} planes of {} bits is not possible", layout.num_planes,
                layout.bit_depth);
  }
  Frame frame;
  frame.layout = layout;
  frame.width = width;
  frame.height = height;
  std::array<std::size_t, kMaxPlanes> offsets{};
  std::size_t total = 0;
  for (int p = 0; p < layout.num_planes; ++p) {
    const auto index = static_cast<std::size_t>(p);
    MutablePlaneView& plane = frame.planes[index];
    plane.width = layout.PlaneWidth(p, width);
    plane.height = layout.PlaneHeight(p, height);
    const auto row_bytes =
        static_cast<std::size_t>(plane.width * layout.channels[index] * layout.BytesPerSample());
    const std::size_t stride = (row_bytes + kRowAlignment - 1) / kRowAlignment * kRowAlignment;
    plane.stride = static_cast<std::ptrdiff_t>(stride);
    offsets[index] = total;
    total += stride * static_cast<std::size_t>(plane.height);
  }
  // One row of slack: vector code may load a whole register at the last sample.
  auto* memory = static_cast<std::uint8_t*>(
      ::operator new(total + kRowAlignment, std::align_val_t(kRowAlignment), std::nothrow));
  if (memory == nullptr) {
    return Fail(ErrorCode::kIo, "out of memory for a frame of {}x{} pixels", width, height);
  }
  frame.storage = std::shared_ptr<void>(
      memory, [](void* p) { ::operator delete(p, std::align_val_t(kRowAlignment)); });
  for (int p = 0; p < layout.num_planes; ++p) {
    const auto index = static_cast<std::size_t>(p);
    frame.planes[index].data = memory + offsets[index];
  }
  return frame;
}

PixelLayout Yuv420Layout(int bit_depth) {
  PixelLayout layout;
  layout.bit_depth = bit_depth;
  return layout;
}

PixelLayout GrayLayout(int bit_depth) {
  PixelLayout layout;
  layout.bit_depth = bit_depth;
  layout.num_planes = 1;
  layout.chroma_shift_x = 0;
  layout.chroma_shift_y = 0;
  layout.chroma_offset_y = 0.0;
  return layout;
}

PixelLayout RgbaLayout() {
  PixelLayout layout;
  layout.num_planes = 1;
  layout.channels = {4, 1, 1, 1};
  layout.chroma_shift_x = 0;
  layout.chroma_shift_y = 0;
  layout.chroma_offset_y = 0.0;
  layout.is_rgb = true;
  layout.full_range = true;
  return layout;
}

}  // namespace rsstab
