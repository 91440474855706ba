// SPDX-License-Identifier: Apache-2.0
#include "cli/images/flow_colors.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

namespace rsstab::images {
namespace {

constexpr int kRowsPerBlock = 32;

// An arc of the wheel: from one colour towards the next in so many steps. The eye tells some hues
// apart better than others, so arcs differ in length.
struct Arc {
  int steps;
  std::array<float, 3> from;  // red, green, blue, 0 to 1
};
constexpr std::array<Arc, 6> kArcs = {{{15, {1, 0, 0}},
                                       {6, {1, 1, 0}},
                                       {4, {0, 1, 0}},
                                       {11, {0, 1, 1}},
                                       {13, {0, 0, 1}},
                                       {6, {1, 0, 1}}}};

using Color = Eigen::Vector3f;

std::vector<Color> MakeWheel() {
  std::vector<Color> wheel;
  for (std::size_t i = 0; i < kArcs.size(); ++i) {
    const Color from(kArcs[i].from.data());
    const Color to(kArcs[(i + 1) % kArcs.size()].from.data());
    for (int step = 0; step < kArcs[i].steps; ++step) {
      const float share = static_cast<float>(step) / static_cast<float>(kArcs[i].steps);
      wheel.push_back(from + share * (to - from));
    }
  }
  return wheel;
}

// `displacement` in units of the longest one.
Color ColorOf(const std::vector<Color>& wheel, const Eigen::Vector2d& displacement) {
  const double turn = std::atan2(-displacement.y(), -displacement.x()) / std::numbers::pi;
  const double place = 0.5 * (turn + 1.0) * static_cast<double>(wheel.size());
  const std::size_t index = static_cast<std::size_t>(place) % wheel.size();
  const auto share = static_cast<float>(place - std::floor(place));
  const Color hue = wheel[index] + share * (wheel[(index + 1) % wheel.size()] - wheel[index]);
  const auto length = static_cast<float>(std::min(displacement.norm(), 1.0));
  return Color::Ones() - length * (Color::Ones() - hue);
}

}  // namespace

Result<Frame> FlowColors(const MotionField& field, WorkerPool& workers, double full_px) {
  PixelLayout layout;
  layout.num_planes = 1;
  layout.channels[0] = 3;
  layout.is_rgb = true;
  auto picture = AllocateFrame(layout, field.width(), field.height());
  if (!picture) {
    return picture;
  }
  const std::vector<Color> wheel = MakeWheel();
  const double longest = full_px > 0.0 ? full_px : field.MaxLength();
  const double scale = longest > 0.0 ? 1.0 / longest : 0.0;
  const MutablePlaneView& plane = picture->planes[0];
  workers.ForBlocks(field.height(), kRowsPerBlock, [&](int begin, int end) {
    for (int y = begin; y < end; ++y) {
      std::uint8_t* out = plane.data + y * plane.stride;
      for (int x = 0; x < field.width(); ++x) {
        const Color color = ColorOf(wheel, scale * field.Sample({x, y}));
        for (const float channel : color) {
          *out++ = static_cast<std::uint8_t>(std::lround(255.0F * channel));
        }
      }
    }
  });
  return picture;
}

}  // namespace rsstab::images
