// SPDX-License-Identifier: Apache-2.0
#include "tests/support/test_clip.h"

#include <cmath>
#include <cstdint>
#include <stdexcept>

#include "cli/media/video_writer.h"

namespace rsstab::testing {
namespace {

// A number in [0, 1) that belongs to a lattice point.
double LatticeValue(int x, int y) {
  auto h =
      static_cast<std::uint32_t>(x) * 0x9E3779B1U ^ static_cast<std::uint32_t>(y) * 0x85EBCA77U;
  h ^= h >> 15U;
  h *= 0x2C1B3C6DU;
  h ^= h >> 13U;
  return static_cast<double>(h) / 4294967296.0;
}

// Smooth noise with blobs of `size` pixels.
double SmoothNoise(double x, double y, double size) {
  const double u = x / size;
  const double v = y / size;
  const int i = static_cast<int>(std::floor(u));
  const int j = static_cast<int>(std::floor(v));
  const double a = u - i;
  const double b = v - j;
  return (LatticeValue(i, j) * (1 - a) + LatticeValue(i + 1, j) * a) * (1 - b) +
         (LatticeValue(i, j + 1) * (1 - a) + LatticeValue(i + 1, j + 1) * a) * b;
}

void PaintPlane(Frame& frame, int plane, double shift_x, double shift_y) {
  const PixelLayout& layout = frame.layout;
  const MutablePlaneView& view = frame.planes[static_cast<std::size_t>(plane)];
  const bool chroma = layout.IsChroma(plane);
  const double step_x = chroma ? 1 << layout.chroma_shift_x : 1;
  const double step_y = chroma ? 1 << layout.chroma_shift_y : 1;
  const int channels = layout.channels[static_cast<std::size_t>(plane)];
  const double scale = 1 << (layout.bit_depth - 8);
  for (int y = 0; y < view.height; ++y) {
    std::uint8_t* row = view.data + y * view.stride;
    for (int x = 0; x < view.width; ++x) {
      const double px = x * step_x + shift_x;
      const double py = y * step_y + shift_y;
      const double luma =
          40.0 + 100.0 * SmoothNoise(px, py, 7.0) + 60.0 * SmoothNoise(px + 91.0, py, 23.0);
      for (int c = 0; c < channels; ++c) {
        const double value =
            chroma ? 108.0 + 40.0 * SmoothNoise(px + 37.0 * (plane + c), py, 31.0) : luma;
        const auto sample = static_cast<std::uint16_t>(value * scale);
        const std::ptrdiff_t at = static_cast<std::ptrdiff_t>(x) * channels + c;
        if (layout.BytesPerSample() == 2) {
          reinterpret_cast<std::uint16_t*>(row)[at] = sample;
        } else {
          row[at] = static_cast<std::uint8_t>(sample);
        }
      }
    }
  }
}

template <typename T>
T Value(Result<T> result) {
  if (!result) {
    throw std::runtime_error(result.error().message);
  }
  return std::move(*result);
}

void Check(const Status& status) {
  if (!status) {
    throw std::runtime_error(status.error().message);
  }
}

}  // namespace

Frame MakeTestFrame(const TestClip& clip, int index) {
  Frame frame = Value(AllocateFrame(clip.layout, clip.width, clip.height));
  const double shift_x = clip.shake_px * std::sin(2.4 * index);
  const double shift_y = clip.shake_px * std::cos(1.7 * index);
  for (int plane = 0; plane < clip.layout.num_planes; ++plane) {
    PaintPlane(frame, plane, shift_x, shift_y);
  }
  return frame;
}

void WriteTestClip(const std::filesystem::path& path, const TestClip& clip) {
  media::VideoDescription description;
  description.width = clip.width;
  description.height = clip.height;
  description.layout = clip.layout;
  media::WriterOptions options;
  options.codec = clip.codec;
  options.num_threads = 1;
  options.overwrite = true;
  auto writer = Value(media::VideoWriter::Create(path.string(), description, options));
  for (int i = 0; i < clip.frames; ++i) {
    media::VideoFrame frame;
    frame.frame = MakeTestFrame(clip, i);
    frame.index = i;
    frame.pts = i;
    Check(writer->Write(frame));
  }
  Check(writer->Finish());
}

}  // namespace rsstab::testing
