// SPDX-License-Identifier: Apache-2.0
#include "igf/street/street_houses.h"

#include <algorithm>
#include <array>

#include "igf/base/seeded_random.h"

namespace rsstab::igf {
namespace {

using Color = StreetColor;

constexpr double kWallCorner = 1.0;  // the scene's corners: no house stands across them

void PaintWindow(StreetCanvas& canvas, double left, double top, double right, double bottom,
                 SeededRandom& random) {
  const double w = right - left;
  const double h = bottom - top;
  const double bar = w * 0.08;
  const Color frame = Mix(Color(236, 234, 228), Color(72, 60, 52), random.Uniform() < 0.3 ? 1 : 0);
  canvas.Box(left - bar, top - bar, right + bar, bottom + bar, frame);
  const Color glass = Mix(Color(38, 48, 62), Color(120, 146, 168), random.Uniform(0.0, 0.8));
  canvas.Box(left, top, right, bottom, glass);
  // The reflection of the sky, cut off at an angle of its own.
  const double cut = random.Uniform(0.1, 0.9);
  canvas.Fill({canvas.Fixed(left, top), canvas.Fixed(left + w * cut, top),
               canvas.Fixed(left, top + h * random.Uniform(0.3, 0.9))},
              Mix(glass, Color(214, 226, 236), random.Uniform(0.2, 0.7)));
  const double kind = random.Uniform();
  if (kind < 0.3) {  // a blind, pulled down so far
    canvas.Box(left, top, right, top + h * random.Uniform(0.15, 0.85),
               Color(222, 214, 196) * random.Uniform(0.7, 1.1));
  } else if (kind < 0.6) {  // curtains
    const Color cloth(random.Uniform(150, 240), random.Uniform(140, 220), random.Uniform(130, 210));
    canvas.Box(left, top, left + w * random.Uniform(0.1, 0.4), bottom, cloth);
    canvas.Box(right - w * random.Uniform(0.1, 0.4), top, right, bottom, cloth);
  } else if (kind < 0.68) {  // a lamp is on
    canvas.Box(left, top, right, bottom, Color(250, 222, 150));
  }
  canvas.Box((left + right - bar) / 2.0, top, (left + right + bar) / 2.0, bottom, frame);
  if (random.Uniform() < 0.6) {
    const double y = top + h * 0.36;
    canvas.Box(left, y - bar / 2.0, right, y + bar / 2.0, frame);
  }
  // Sill, its shadow, and sometimes a flower box.
  canvas.Box(left - 2.2 * bar, bottom + bar, right + 2.2 * bar, bottom + 2.2 * bar,
             Color(214, 208, 196));
  canvas.Box(left - 2.0 * bar, bottom + 2.2 * bar, right + 2.0 * bar, bottom + 3.0 * bar,
             Color(84, 76, 70));
  if (random.Uniform() < 0.22) {
    for (int i = 0; i < 9; ++i) {
      const Color bloom = i % 3 == 0 ? Color(206, 60, 72) : Color(74, 128, 58);
      canvas.Disc(random.Uniform(left, right), bottom + bar * random.Uniform(-1.2, 1.0), bar * 0.9,
                  bloom * random.Uniform(0.8, 1.15));
    }
  }
}

void PaintShop(StreetCanvas& canvas, double left, double top, double right, SeededRandom& random) {
  const Color board(random.Uniform(40, 150), random.Uniform(40, 130), random.Uniform(40, 130));
  canvas.Box(left, top, right, kHouseFoot, Color(58, 54, 52));
  canvas.Box(left, top, right, top + 0.024, board);
  // Lettering: strokes of random height, not words.
  for (double x = left + 0.02; x < right - 0.03; x += random.Uniform(0.009, 0.014)) {
    const double y = top + random.Uniform(0.004, 0.009);
    canvas.Box(x, y, x + random.Uniform(0.003, 0.007), top + 0.0195, Color(240, 232, 208));
  }
  for (double x = left + 0.008; x + 0.03 < right;) {
    const double width = std::min(random.Uniform(0.04, 0.08), right - 0.008 - x);
    if (random.Uniform() < 0.3) {  // a door
      canvas.Box(x, top + 0.032, x + width * 0.7, kHouseFoot, board * 1.25);
      canvas.Box(x + width * 0.1, top + 0.04, x + width * 0.6, kHouseFoot - 0.03,
                 Color(96, 116, 130));
      canvas.Disc(x + width * 0.62, kHouseFoot - 0.04, 0.003, Color(220, 200, 120));
    } else {  // a window with goods
      canvas.Box(x, top + 0.032, x + width, kHouseFoot - 0.018,
                 Color(140, 156, 164) * random.Uniform(0.6, 1.1));
      for (int i = 0; i < 6; ++i) {
        const double gx = x + random.Uniform(0.0, width * 0.8);
        const double gy = kHouseFoot - random.Uniform(0.025, 0.055);
        canvas.Box(
            gx, gy, gx + random.Uniform(0.005, 0.012), kHouseFoot - 0.018,
            Color(random.Uniform(60, 240), random.Uniform(60, 230), random.Uniform(50, 220)));
      }
    }
    x += width + 0.007;
  }
  if (random.Uniform() < 0.6) {  // striped awning
    const Color stripe(random.Uniform(120, 210), random.Uniform(40, 120), random.Uniform(40, 110));
    bool light = false;
    for (double x = left + 0.006; x < right - 0.006; x += 0.014, light = !light) {
      const double end = std::min(x + 0.014, right - 0.006);
      canvas.Fill({canvas.Fixed(x, top + 0.022), canvas.Fixed(end, top + 0.022),
                   canvas.Fixed(end, top + 0.046), canvas.Fixed(x, top + 0.046)},
                  light ? Color(238, 232, 220) : stripe);
    }
  }
}

void PaintHouse(StreetCanvas& canvas, double left, double right, SeededRandom& random) {
  constexpr std::array<std::array<double, 3>, 8> kWalls = {{{178, 96, 74},
                                                            {208, 180, 140},
                                                            {226, 214, 188},
                                                            {150, 156, 160},
                                                            {196, 146, 98},
                                                            {140, 82, 66},
                                                            {176, 188, 172},
                                                            {214, 166, 150}}};
  const auto& chosen = kWalls[static_cast<std::size_t>(random.Integer(0, 7))];
  const Color wall = Color(chosen[0], chosen[1], chosen[2]) * random.Uniform(0.86, 1.08);
  const bool has_shop = random.Uniform() < 0.55;
  const double storey = random.Uniform(0.085, 0.105);
  const int storeys = random.Integer(3, 5);
  const double base = kHouseFoot - (has_shop ? 0.115 : 0.02);
  const double top = base - storeys * storey - 0.02;

  if (random.Uniform() < 0.5) {  // pitched roof with a chimney
    const Color tiles(random.Uniform(96, 150), random.Uniform(60, 84), random.Uniform(54, 76));
    const double ridge = top - random.Uniform(0.05, 0.1);
    const double inset = (right - left) * random.Uniform(0.08, 0.3);
    const double chimney = left + (right - left) * random.Uniform(0.25, 0.7);
    canvas.Box(chimney, ridge - 0.03, chimney + 0.026, top, wall * 0.72);
    canvas.Box(chimney - 0.004, ridge - 0.036, chimney + 0.03, ridge - 0.028, wall * 0.5);
    canvas.Fill({canvas.Fixed(left - 0.006, top), canvas.Fixed(left + inset, ridge),
                 canvas.Fixed(right - inset, ridge), canvas.Fixed(right + 0.006, top)},
                tiles);
    for (double y = ridge + 0.011; y < top; y += 0.011) {
      const double share = (top - y) / (top - ridge);
      canvas.Box(left + inset * share, y, right - inset * share, y + 0.0028,
                 tiles * random.Uniform(0.66, 0.86));
    }
  }
  canvas.Box(left, top, right, kHouseFoot, wall);
  // Courses of brick or render, each stone a little different.
  const double course = random.Uniform(0.009, 0.014);
  for (double y = top; y < kHouseFoot; y += course) {
    for (double x = left; x < right;) {
      const double end = std::min(right, x + course * random.Uniform(1.6, 2.6));
      canvas.Box(x, y, end - course * 0.14, std::min(kHouseFoot, y + course * 0.86),
                 wall * (1.0 + random.Uniform(-0.09, 0.09)));
      x = end;
    }
  }
  canvas.Box(left, top, right, top + 0.008, wall * 1.25);         // cornice
  canvas.Box(left, top + 0.008, right, top + 0.012, wall * 0.6);  // and its shadow
  canvas.Box(left, top, left + 0.0035, kHouseFoot, wall * 0.62);  // joint to the next house

  const double wanted = random.Uniform(0.062, 0.085);
  const int columns = std::max(2, static_cast<int>((right - left) / wanted));
  const double pitch = (right - left) / columns;
  const double w = pitch * random.Uniform(0.42, 0.55);
  const double h = storey * random.Uniform(0.52, 0.64);
  for (int s = 0; s < storeys; ++s) {
    const double y = base - (s + 1) * storey + (storey - h) * 0.45;
    if (random.Uniform() < 0.5) {
      canvas.Box(left, base - s * storey - 0.005, right, base - s * storey,
                 wall * random.Uniform(1.12, 1.3));
    }
    for (int c = 0; c < columns; ++c) {
      const double x = left + (c + 0.5) * pitch - w / 2.0;
      if (random.Uniform() < 0.95) {
        PaintWindow(canvas, x, y, x + w, y + h, random);
      }
    }
  }
  if (has_shop) {
    PaintShop(canvas, left + 0.006, base, right - 0.004, random);
  } else {
    const double door = left + (right - left) * random.Uniform(0.2, 0.7);
    canvas.Box(door - 0.004, kHouseFoot - 0.098, door + 0.046, kHouseFoot, wall * 1.3);
    canvas.Box(door, kHouseFoot - 0.09, door + 0.042, kHouseFoot,
               Color(random.Uniform(30, 130), random.Uniform(40, 90), random.Uniform(40, 100)));
  }
  if (random.Uniform() < 0.6) {  // drain pipe
    const double pipe = right - 0.012;
    canvas.Box(pipe, top + 0.012, pipe + 0.005, kHouseFoot, wall * 0.5);
  }
}

}  // namespace

void PaintHouses(StreetCanvas& canvas) {
  SeededRandom random(canvas.seed(), 30);
  for (double x = kStreetLeft - 0.1; x < kStreetRight;) {
    double right = x + random.Uniform(0.2, 0.42);
    for (const double corner : {-kWallCorner, kWallCorner}) {
      if (x < corner && right > corner - 0.1) {
        right = corner;
      }
    }
    PaintHouse(canvas, x, right, random);
    x = right;
    if (random.Uniform() < 0.16) {
      x += random.Uniform(0.03, 0.08);  // a lane: the skyline shows
    }
  }
}

}  // namespace rsstab::igf
