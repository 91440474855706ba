// SPDX-License-Identifier: Apache-2.0
#include "igf/scene_painter.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "igf/base/seeded_random.h"
#include "igf/street/street_canvas.h"
#include "igf/street/street_houses.h"

namespace rsstab::igf {
namespace {

using Color = StreetColor;

void PaintSky(StreetCanvas& canvas) {
  const Color zenith(78, 128, 190);
  const Color haze(205, 219, 230);
  const Color cloud(244, 244, 242);
  cv::Mat cover = canvas.SmoothNoise(3.0, 1);
  cover += 0.6 * canvas.SmoothNoise(7.0, 2) + 0.35 * canvas.SmoothNoise(17.0, 3) +
           0.2 * canvas.SmoothNoise(41.0, 4);
  for (int y = 0; y < canvas.image().rows; ++y) {
    const double height = std::clamp((kHouseFoot - canvas.RowPlace(y)) / 0.9, 0.0, 1.0);
    const Color clear = Mix(haze, zenith, std::sqrt(height));
    const auto* noise = cover.ptr<float>(y);
    auto* row = canvas.image().ptr<cv::Vec3b>(y);
    for (int x = 0; x < canvas.image().cols; ++x) {
      const double share = std::clamp(0.25 + 0.75 * static_cast<double>(noise[x]), 0.0, 0.9);
      row[x] = cv::Vec3b(Mix(clear, cloud, share));
    }
  }
}

void PaintSkyline(StreetCanvas& canvas) {
  SeededRandom random(canvas.seed(), 10);
  const Color haze(176, 192, 206);
  for (int layer = 0; layer < 2; ++layer) {
    const Color tone = Mix(haze, Color(110, 124, 140), 0.5 * layer + 0.15);
    for (double x = kStreetLeft; x < kStreetRight;) {
      const double width = random.Uniform(0.05, 0.13);
      const double top = kHouseFoot - random.Uniform(0.28, layer == 0 ? 0.62 : 0.46);
      const Color wall = tone * random.Uniform(0.92, 1.06);
      canvas.Box(x, top, x + width, kHouseFoot, wall);
      if (random.Uniform() < 0.4) {  // a mast
        const double mast = x + width * random.Uniform(0.3, 0.7);
        canvas.Box(mast - 0.0025, top - random.Uniform(0.03, 0.09), mast + 0.0025, top, wall * 0.8);
      }
      const double pitch = random.Uniform(0.016, 0.024);
      for (double y = top + pitch; y < kHouseFoot; y += pitch) {
        for (double c = x + pitch * 0.6; c + pitch * 0.6 < x + width; c += pitch) {
          const double light = random.Uniform(0.72, 1.12);
          canvas.Box(c, y, c + pitch * 0.5, y + pitch * 0.55, wall * light);
        }
      }
      x += width * random.Uniform(0.8, 1.3);
    }
  }
}

void PaintGround(StreetCanvas& canvas) {
  SeededRandom random(canvas.seed(), 20);
  canvas.Box(kStreetLeft - 1.0, kHouseFoot, kStreetRight + 1.0, 2.0, Color(112, 110, 108));
  // Paving: rows of slabs, each of its own shade, joints left open.
  const auto pave = [&](double top, double bottom, double size, const Color& stone, double spread) {
    for (double y = top; y < bottom; y += size) {
      const double low = std::min(bottom, y + size * 0.93);
      for (double x = kStreetLeft - size * random.Uniform(); x < kStreetRight;) {
        const double width = size * random.Uniform(0.8, 1.9);
        canvas.Box(x, y, x + width - size * 0.07, low,
                   stone * (1.0 + random.Uniform(-spread, spread)));
        x += width;
      }
    }
  };
  pave(kHouseFoot, kKerb, 0.02, Color(170, 163, 152), 0.14);
  canvas.Box(kStreetLeft, kKerb, kStreetRight, kKerb + 0.012, Color(196, 192, 184));
  canvas.Box(kStreetLeft, kKerb + 0.012, kStreetRight, kKerb + 0.02, Color(70, 68, 66));
  pave(kKerb + 0.02, 1.02, 0.032, Color(120, 116, 112), 0.22);
  for (int i = 0; i < 60; ++i) {  // drain covers and patches
    const double x = random.Uniform(kStreetLeft, kStreetRight);
    const double y = random.Uniform(kKerb + 0.05, 0.95);
    const double w = random.Uniform(0.015, 0.05);
    canvas.Box(x, y, x + w, y + w * random.Uniform(0.4, 0.9),
               Color(84, 82, 82) * random.Uniform(0.7, 1.6));
  }
}

void PaintTrees(StreetCanvas& canvas) {
  SeededRandom random(canvas.seed(), 40);
  for (double x = kStreetLeft + random.Uniform(0.1, 0.4); x < kStreetRight;
       x += random.Uniform(0.35, 0.8)) {
    const double crown = random.Uniform(0.05, 0.085);
    const double centre = kHouseFoot - random.Uniform(0.14, 0.2);
    const Color bark(88, 70, 54);
    canvas.Box(x - 0.008, centre, x + 0.008, kHouseFoot + 0.035, bark);
    canvas.Box(x + 0.003, centre, x + 0.008, kHouseFoot + 0.035, bark * 0.7);
    const Color leaf = Color(72, 104, 48) * random.Uniform(0.8, 1.15);
    for (int i = 0; i < 420; ++i) {
      const double angle = random.Uniform(0.0, 2.0 * std::numbers::pi);
      const double reach = std::sqrt(random.Uniform());
      const double dx = crown * reach * std::cos(angle);
      const double dy = crown * 1.15 * reach * std::sin(angle);
      // Light comes from the upper left.
      const double light = 1.0 - 0.45 * (dx + 1.4 * dy) / crown + random.Uniform(-0.25, 0.25);
      canvas.Disc(x + dx, centre + dy, crown * random.Uniform(0.06, 0.13),
                  leaf * std::max(0.3, light));
    }
  }
}

void PaintPosts(StreetCanvas& canvas) {
  SeededRandom random(canvas.seed(), 50);
  for (double x = kStreetLeft + random.Uniform(0.05, 0.3); x < kStreetRight;
       x += random.Uniform(0.3, 0.55)) {
    const Color iron = Color(52, 58, 60) * random.Uniform(0.8, 1.5);
    const double foot = kKerb - random.Uniform(0.0, 0.03);
    const double top = kHouseFoot - random.Uniform(0.3, 0.42);
    canvas.Box(x - 0.005, top, x + 0.005, foot, iron);
    canvas.Box(x - 0.005, top, x - 0.002, foot, iron * 1.7);
    canvas.Box(x - 0.011, foot - 0.03, x + 0.011, foot, iron * 0.9);
    const double kind = random.Uniform();
    if (kind < 0.5) {  // lamp on an arm
      const double side = random.Uniform() < 0.5 ? -1.0 : 1.0;
      const double reach = x + side * 0.06;
      canvas.Box(std::min(x, reach), top, std::max(x, reach), top + 0.006, iron);
      canvas.Box(reach - 0.017, top + 0.006, reach + 0.017, top + 0.016, Color(244, 236, 206));
    } else if (kind < 0.8) {  // traffic sign
      const double radius = random.Uniform(0.022, 0.03);
      canvas.Disc(x, top + radius, radius, Color(238, 238, 236));
      canvas.Disc(x, top + radius, radius * 0.88,
                  random.Uniform() < 0.5 ? Color(190, 36, 40) : Color(36, 84, 170));
      canvas.Box(x - radius * 0.55, top + radius * 0.82, x + radius * 0.55, top + radius * 1.18,
                 Color(240, 240, 240));
    } else {  // lantern
      canvas.Disc(x, top - 0.008, 0.017, Color(248, 240, 214));
      canvas.Box(x - 0.018, top + 0.008, x + 0.018, top + 0.013, iron);
    }
  }
}

void AddGrain(StreetCanvas& canvas) {
  // Uneven light, dirt and grain: relative, so that dark parts stay dark. The two finest follow the
  // pixels, not the street.
  cv::Mat shade = 0.05 * canvas.SmoothNoise(5.0, 60);
  shade += 0.04 * canvas.SmoothNoise(23.0, 61) + 0.04 * canvas.SmoothNoise(90.0, 62);
  shade += 0.045 * canvas.SmoothNoise(std::min(canvas.unit() / 3.0, 300.0), 63);
  shade += 0.05 * canvas.SmoothNoise(canvas.unit() / 1.6, 64);
  for (int y = 0; y < canvas.image().rows; ++y) {
    const auto* noise = shade.ptr<float>(y);
    auto* row = canvas.image().ptr<cv::Vec3b>(y);
    for (int x = 0; x < canvas.image().cols; ++x) {
      for (int c = 0; c < 3; ++c) {
        row[x][c] =
            cv::saturate_cast<std::uint8_t>(static_cast<float>(row[x][c]) * (1.0F + noise[x]));
      }
    }
  }
}

}  // namespace

Result<RgbPicture> PaintStreet(int width, int height, std::uint64_t seed) {
  constexpr int kNarrowest = 256;
  constexpr int kWidest = 32768;
  constexpr int kLowest = 64;
  if (width < kNarrowest || width > kWidest || height < kLowest || height > width / 2) {
    return Fail(ErrorCode::kInvalidArgument,
                "A painted scene is {} to {} pixels wide and {} to half its width high, not {} x "
                "{}.",
                kNarrowest, kWidest, kLowest, width, height);
  }
  StreetCanvas canvas(width, height, seed);
  PaintSky(canvas);
  PaintSkyline(canvas);
  PaintGround(canvas);
  PaintHouses(canvas);
  PaintTrees(canvas);
  PaintPosts(canvas);
  AddGrain(canvas);
  const cv::Mat& image = canvas.image();
  RgbPicture picture;
  picture.width = image.cols;
  picture.height = image.rows;
  picture.pixels.assign(image.datastart, image.dataend);
  return picture;
}

}  // namespace rsstab::igf
