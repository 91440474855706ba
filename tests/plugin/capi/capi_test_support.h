// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_TESTS_PLUGIN_CAPI_CAPI_TEST_SUPPORT_H_
#define RSSTAB_TESTS_PLUGIN_CAPI_CAPI_TEST_SUPPORT_H_

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "igf/base/frame.h"
#include "plugin/capi/rsstab.h"
#include "tests/support/random_scene.h"

namespace rsstab::testing {

struct OptionsDeleter {
  void operator()(rsstab_options* options) const { rsstab_options_destroy(options); }
};
struct InstanceDeleter {
  void operator()(rsstab_instance* instance) const { rsstab_destroy(instance); }
};
using OptionsHandle = std::unique_ptr<rsstab_options, OptionsDeleter>;
using InstanceHandle = std::unique_ptr<rsstab_instance, InstanceDeleter>;

using OptionList = std::vector<std::pair<std::string, std::string>>;

inline OptionsHandle MakeOptions(const OptionList& values) {
  OptionsHandle options(rsstab_options_create());
  for (const auto& [name, value] : values) {
    EXPECT_EQ(rsstab_options_set(options.get(), name.c_str(), value.c_str()), RSSTAB_OK)
        << rsstab_options_error(options.get());
  }
  return options;
}

// Ticks of 1/25 s.
inline rsstab_video MakeVideo(int width, int height, rsstab_pixel_format format) {
  rsstab_video video = RSSTAB_VIDEO_INIT;
  video.width = width;
  video.height = height;
  video.format = format;
  video.time_base_num = 1;
  video.time_base_den = 25;
  video.frame_rate_num = 25;
  video.frame_rate_den = 1;
  return video;
}

// Content position in frame t: shake of some 4 px on a slow drift.
inline Eigen::Vector2d Shift(int t) {
  return {4.0 * std::sin(1.9 * t) + 0.2 * t, 3.0 * std::sin(2.3 * t + 1.0)};
}

// Frame t of a shaky clip, painted into every plane (chroma follows the picture, too).
inline Frame PaintShaky(const PixelLayout& layout, int width, int height, int t) {
  static const WaveScene scene(11);
  Frame frame = *AllocateFrame(layout, width, height);
  const double scale = 1 << (layout.bit_depth - 8);
  for (int p = 0; p < layout.num_planes; ++p) {
    const auto plane = static_cast<std::size_t>(p);
    const MutablePlaneView& view = frame.planes[plane];
    const double step = layout.IsChroma(p) ? 1 << layout.chroma_shift_x : 1;
    const double step_y = layout.IsChroma(p) ? 1 << layout.chroma_shift_y : 1;
    const int channels = layout.channels[plane];
    for (int y = 0; y < view.height; ++y) {
      std::uint8_t* row = view.data + y * view.stride;
      for (int x = 0; x < view.width * channels; ++x) {
        const Eigen::Vector2d at(x / channels * step, y * step_y);
        const double value = std::clamp(scene.At(at - Shift(t)), 40.0, 250.0) * scale;
        if (layout.BytesPerSample() == 2) {
          reinterpret_cast<std::uint16_t*>(row)[x] = static_cast<std::uint16_t>(value);
        } else {
          row[x] = static_cast<std::uint8_t>(value);
        }
      }
    }
  }
  return frame;
}

inline rsstab_picture ToPicture(const Frame& frame) {
  rsstab_picture picture{};
  for (std::size_t p = 0; p < RSSTAB_MAX_PLANES; ++p) {
    picture.data[p] = frame.planes[p].data;
    picture.stride[p] = frame.planes[p].stride;
  }
  return picture;
}

inline rsstab_buffer ToBuffer(const Frame& frame) {
  rsstab_buffer buffer{};
  for (std::size_t p = 0; p < RSSTAB_MAX_PLANES; ++p) {
    buffer.data[p] = frame.planes[p].data;
    buffer.stride[p] = frame.planes[p].stride;
  }
  return buffer;
}

// The samples of all planes, without padding.
inline std::string Bytes(const Frame& frame) {
  std::string bytes;
  for (int p = 0; p < frame.layout.num_planes; ++p) {
    const auto plane = static_cast<std::size_t>(p);
    const MutablePlaneView& view = frame.planes[plane];
    const int row = view.width * frame.layout.channels[plane] * frame.layout.BytesPerSample();
    for (int y = 0; y < view.height; ++y) {
      bytes.append(reinterpret_cast<const char*>(view.data + y * view.stride),
                   static_cast<std::size_t>(row));
    }
  }
  return bytes;
}

// Writes an analysis file of a shaky clip of `frames` frames with times 0, 1, 2, ...
inline void Analyze(const rsstab_video& video, const PixelLayout& layout, int frames,
                    const std::string& path) {
  const OptionsHandle options = MakeOptions({{"rs", "off"}, {"threads", "1"}});
  rsstab_instance* made = nullptr;
  ASSERT_EQ(rsstab_create_analyze(options.get(), &video, path.c_str(), &made), RSSTAB_OK)
      << rsstab_options_error(options.get());
  const InstanceHandle instance(made);
  for (int t = 0; t < frames; ++t) {
    const Frame frame = PaintShaky(layout, video.width, video.height, t);
    const rsstab_picture picture = ToPicture(frame);
    ASSERT_EQ(rsstab_push(made, &picture, t, nullptr, nullptr), RSSTAB_OK) << rsstab_error(made);
  }
  ASSERT_EQ(rsstab_flush(made), RSSTAB_OK) << rsstab_error(made);
}

}  // namespace rsstab::testing

#endif  // RSSTAB_TESTS_PLUGIN_CAPI_CAPI_TEST_SUPPORT_H_
