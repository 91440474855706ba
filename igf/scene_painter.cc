// SPDX-License-Identifier: Apache-2.0
#include "igf/scene_painter.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "igf/seeded_random.h"

namespace rsstab::igf {
namespace {

// Places are in units of tangent: x from -2 to 2 (left to right), y from -1 (zenith side) to 1.
constexpr double kLeft = -kPaintedWidthTan / 2.0;
constexpr double kRight = kPaintedWidthTan / 2.0;
constexpr double kGround = 0.15;     // where houses meet the pavement
constexpr double kKerb = 0.23;       // where the pavement meets the road
constexpr double kWallCorner = 1.0;  // the room's corners: houses may not straddle them
// Sub-pixel bits of OpenCV's drawing functions.
constexpr int kShift = 4;

using Color = cv::Vec3d;  // RGB, 0..255

Color Mix(const Color& a, const Color& b, double share_of_b) {
  return a * (1.0 - share_of_b) + b * share_of_b;
}

class StreetPainter {
 public:
  StreetPainter(int width, int height, std::uint64_t seed)
      : seed_(seed), unit_(width / kPaintedWidthTan), image_(height, width, CV_8UC3) {}

  cv::Mat Paint() {
    PaintSky();
    PaintSkyline();
    PaintGround();
    PaintHouses();
    PaintTrees();
    PaintPosts();
    AddGrain();
    return image_;
  }

 private:
  [[nodiscard]] double PixelX(double x) const { return (x - kLeft) * unit_; }
  [[nodiscard]] double PixelY(double y) const { return y * unit_ + image_.rows / 2.0; }
  [[nodiscard]] cv::Point Fixed(double x, double y) const {
    return {static_cast<int>(std::lround((PixelX(x) - 0.5) * (1 << kShift))),
            static_cast<int>(std::lround((PixelY(y) - 0.5) * (1 << kShift)))};
  }
  static cv::Scalar Ink(const Color& color) { return {color[0], color[1], color[2]}; }

  void Fill(std::initializer_list<cv::Point> corners, const Color& color) {
    cv::fillConvexPoly(image_, std::vector<cv::Point>(corners), Ink(color), cv::LINE_AA, kShift);
  }
  void Box(double left, double top, double right, double bottom, const Color& color) {
    Fill({Fixed(left, top), Fixed(right, top), Fixed(right, bottom), Fixed(left, bottom)}, color);
  }
  void Disc(double x, double y, double radius, const Color& color) {
    cv::circle(image_, Fixed(x, y), static_cast<int>(std::lround(radius * unit_ * (1 << kShift))),
               Ink(color), cv::FILLED, cv::LINE_AA, kShift);
  }

  // Smooth noise in -1..1: random numbers on a lattice of `cells_per_unit`, cubic in between.
  [[nodiscard]] cv::Mat SmoothNoise(double cells_per_unit, std::uint64_t stream) const {
    const auto cells = [&](int pixels) {
      return std::max(2, static_cast<int>(std::lround(cells_per_unit * pixels / unit_)));
    };
    const int columns = cells(image_.cols);
    const int rows = cells(image_.rows);
    cv::Mat lattice(rows, columns, CV_32F);
    SeededRandom random(seed_, stream);
    for (int y = 0; y < rows; ++y) {
      for (int x = 0; x < columns; ++x) {
        lattice.at<float>(y, x) = static_cast<float>(random.Uniform(-1.0, 1.0));
      }
    }
    cv::Mat noise;
    cv::resize(lattice, noise, image_.size(), 0.0, 0.0, cv::INTER_CUBIC);
    return noise;
  }

  void PaintSky();
  void PaintSkyline();
  void PaintGround();
  void PaintHouses();
  void PaintHouse(double left, double right, SeededRandom& random);
  void PaintWindow(double left, double top, double right, double bottom, SeededRandom& random);
  void PaintShop(double left, double top, double right, SeededRandom& random);
  void PaintTrees();
  void PaintPosts();
  void AddGrain();

  std::uint64_t seed_;
  double unit_;  // pixels per unit of tangent
  cv::Mat image_;
};

void StreetPainter::PaintSky() {
  const Color zenith(78, 128, 190);
  const Color haze(205, 219, 230);
  const Color cloud(244, 244, 242);
  cv::Mat cover = SmoothNoise(3.0, 1);
  cover += 0.6 * SmoothNoise(7.0, 2) + 0.35 * SmoothNoise(17.0, 3) + 0.2 * SmoothNoise(41.0, 4);
  for (int y = 0; y < image_.rows; ++y) {
    const double height = std::clamp((kGround - ((y - image_.rows / 2.0) / unit_)) / 0.9, 0.0, 1.0);
    const Color clear = Mix(haze, zenith, std::sqrt(height));
    const auto* noise = cover.ptr<float>(y);
    auto* row = image_.ptr<cv::Vec3b>(y);
    for (int x = 0; x < image_.cols; ++x) {
      const double share = std::clamp(0.25 + 0.75 * static_cast<double>(noise[x]), 0.0, 0.9);
      row[x] = cv::Vec3b(Mix(clear, cloud, share));
    }
  }
}

void StreetPainter::PaintSkyline() {
  SeededRandom random(seed_, 10);
  const Color haze(176, 192, 206);
  for (int layer = 0; layer < 2; ++layer) {
    const Color tone = Mix(haze, Color(110, 124, 140), 0.5 * layer + 0.15);
    for (double x = kLeft; x < kRight;) {
      const double width = random.Uniform(0.05, 0.13);
      const double top = kGround - random.Uniform(0.28, layer == 0 ? 0.62 : 0.46);
      const Color wall = tone * random.Uniform(0.92, 1.06);
      Box(x, top, x + width, kGround, wall);
      if (random.Uniform() < 0.4) {  // a mast
        const double mast = x + width * random.Uniform(0.3, 0.7);
        Box(mast - 0.0025, top - random.Uniform(0.03, 0.09), mast + 0.0025, top, wall * 0.8);
      }
      const double pitch = random.Uniform(0.016, 0.024);
      for (double y = top + pitch; y < kGround; y += pitch) {
        for (double c = x + pitch * 0.6; c + pitch * 0.6 < x + width; c += pitch) {
          const double light = random.Uniform(0.72, 1.12);
          Box(c, y, c + pitch * 0.5, y + pitch * 0.55, wall * light);
        }
      }
      x += width * random.Uniform(0.8, 1.3);
    }
  }
}

void StreetPainter::PaintGround() {
  SeededRandom random(seed_, 20);
  Box(kLeft - 1.0, kGround, kRight + 1.0, 2.0, Color(112, 110, 108));
  // Paving: rows of slabs, each of its own shade, joints left open.
  const auto pave = [&](double top, double bottom, double size, const Color& stone, double spread) {
    for (double y = top; y < bottom; y += size) {
      const double low = std::min(bottom, y + size * 0.93);
      for (double x = kLeft - size * random.Uniform(); x < kRight;) {
        const double width = size * random.Uniform(0.8, 1.9);
        Box(x, y, x + width - size * 0.07, low, stone * (1.0 + random.Uniform(-spread, spread)));
        x += width;
      }
    }
  };
  pave(kGround, kKerb, 0.02, Color(170, 163, 152), 0.14);
  Box(kLeft, kKerb, kRight, kKerb + 0.012, Color(196, 192, 184));
  Box(kLeft, kKerb + 0.012, kRight, kKerb + 0.02, Color(70, 68, 66));
  pave(kKerb + 0.02, 1.02, 0.032, Color(120, 116, 112), 0.22);
  for (int i = 0; i < 60; ++i) {  // drain covers and patches
    const double x = random.Uniform(kLeft, kRight);
    const double y = random.Uniform(kKerb + 0.05, 0.95);
    const double w = random.Uniform(0.015, 0.05);
    Box(x, y, x + w, y + w * random.Uniform(0.4, 0.9),
        Color(84, 82, 82) * random.Uniform(0.7, 1.6));
  }
}

void StreetPainter::PaintWindow(double left, double top, double right, double bottom,
                                SeededRandom& random) {
  const double w = right - left;
  const double h = bottom - top;
  const double bar = w * 0.08;
  const Color frame = Mix(Color(236, 234, 228), Color(72, 60, 52), random.Uniform() < 0.3 ? 1 : 0);
  Box(left - bar, top - bar, right + bar, bottom + bar, frame);
  const Color glass = Mix(Color(38, 48, 62), Color(120, 146, 168), random.Uniform(0.0, 0.8));
  Box(left, top, right, bottom, glass);
  // The reflection of the sky, cut off at an angle of its own.
  const double cut = random.Uniform(0.1, 0.9);
  Fill({Fixed(left, top), Fixed(left + w * cut, top),
        Fixed(left, top + h * random.Uniform(0.3, 0.9))},
       Mix(glass, Color(214, 226, 236), random.Uniform(0.2, 0.7)));
  const double kind = random.Uniform();
  if (kind < 0.3) {  // a blind, pulled down so far
    Box(left, top, right, top + h * random.Uniform(0.15, 0.85),
        Color(222, 214, 196) * random.Uniform(0.7, 1.1));
  } else if (kind < 0.6) {  // curtains
    const Color cloth(random.Uniform(150, 240), random.Uniform(140, 220), random.Uniform(130, 210));
    Box(left, top, left + w * random.Uniform(0.1, 0.4), bottom, cloth);
    Box(right - w * random.Uniform(0.1, 0.4), top, right, bottom, cloth);
  } else if (kind < 0.68) {  // a lamp is on
    Box(left, top, right, bottom, Color(250, 222, 150));
  }
  Box((left + right - bar) / 2.0, top, (left + right + bar) / 2.0, bottom, frame);
  if (random.Uniform() < 0.6) {
    const double y = top + h * 0.36;
    Box(left, y - bar / 2.0, right, y + bar / 2.0, frame);
  }
  // Sill, its shadow, and sometimes a flower box.
  Box(left - 2.2 * bar, bottom + bar, right + 2.2 * bar, bottom + 2.2 * bar, Color(214, 208, 196));
  Box(left - 2.0 * bar, bottom + 2.2 * bar, right + 2.0 * bar, bottom + 3.0 * bar,
      Color(84, 76, 70));
  if (random.Uniform() < 0.22) {
    for (int i = 0; i < 9; ++i) {
      const Color bloom = i % 3 == 0 ? Color(206, 60, 72) : Color(74, 128, 58);
      Disc(random.Uniform(left, right), bottom + bar * random.Uniform(-1.2, 1.0), bar * 0.9,
           bloom * random.Uniform(0.8, 1.15));
    }
  }
}

void StreetPainter::PaintShop(double left, double top, double right, SeededRandom& random) {
  const Color board(random.Uniform(40, 150), random.Uniform(40, 130), random.Uniform(40, 130));
  Box(left, top, right, kGround, Color(58, 54, 52));
  Box(left, top, right, top + 0.024, board);
  // Lettering: strokes of random height, not words.
  for (double x = left + 0.02; x < right - 0.03; x += random.Uniform(0.009, 0.014)) {
    const double y = top + random.Uniform(0.004, 0.009);
    Box(x, y, x + random.Uniform(0.003, 0.007), top + 0.0195, Color(240, 232, 208));
  }
  for (double x = left + 0.008; x + 0.03 < right;) {
    const double width = std::min(random.Uniform(0.04, 0.08), right - 0.008 - x);
    if (random.Uniform() < 0.3) {  // a door
      Box(x, top + 0.032, x + width * 0.7, kGround, board * 1.25);
      Box(x + width * 0.1, top + 0.04, x + width * 0.6, kGround - 0.03, Color(96, 116, 130));
      Disc(x + width * 0.62, kGround - 0.04, 0.003, Color(220, 200, 120));
    } else {  // a window with goods
      Box(x, top + 0.032, x + width, kGround - 0.018,
          Color(140, 156, 164) * random.Uniform(0.6, 1.1));
      for (int i = 0; i < 6; ++i) {
        const double gx = x + random.Uniform(0.0, width * 0.8);
        const double gy = kGround - random.Uniform(0.025, 0.055);
        Box(gx, gy, gx + random.Uniform(0.005, 0.012), kGround - 0.018,
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
      Fill({Fixed(x, top + 0.022), Fixed(end, top + 0.022), Fixed(end, top + 0.046),
            Fixed(x, top + 0.046)},
           light ? Color(238, 232, 220) : stripe);
    }
  }
}

void StreetPainter::PaintHouse(double left, double right, SeededRandom& random) {
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
  const double base = kGround - (has_shop ? 0.115 : 0.02);
  const double top = base - storeys * storey - 0.02;

  if (random.Uniform() < 0.5) {  // pitched roof with a chimney
    const Color tiles(random.Uniform(96, 150), random.Uniform(60, 84), random.Uniform(54, 76));
    const double ridge = top - random.Uniform(0.05, 0.1);
    const double inset = (right - left) * random.Uniform(0.08, 0.3);
    const double chimney = left + (right - left) * random.Uniform(0.25, 0.7);
    Box(chimney, ridge - 0.03, chimney + 0.026, top, wall * 0.72);
    Box(chimney - 0.004, ridge - 0.036, chimney + 0.03, ridge - 0.028, wall * 0.5);
    Fill({Fixed(left - 0.006, top), Fixed(left + inset, ridge), Fixed(right - inset, ridge),
          Fixed(right + 0.006, top)},
         tiles);
    for (double y = ridge + 0.011; y < top; y += 0.011) {
      const double share = (top - y) / (top - ridge);
      Box(left + inset * share, y, right - inset * share, y + 0.0028,
          tiles * random.Uniform(0.66, 0.86));
    }
  }
  Box(left, top, right, kGround, wall);
  // Courses of brick or render, each stone a little different.
  const double course = random.Uniform(0.009, 0.014);
  for (double y = top; y < kGround; y += course) {
    for (double x = left; x < right;) {
      const double end = std::min(right, x + course * random.Uniform(1.6, 2.6));
      Box(x, y, end - course * 0.14, std::min(kGround, y + course * 0.86),
          wall * (1.0 + random.Uniform(-0.09, 0.09)));
      x = end;
    }
  }
  Box(left, top, right, top + 0.008, wall * 1.25);         // cornice
  Box(left, top + 0.008, right, top + 0.012, wall * 0.6);  // and its shadow
  Box(left, top, left + 0.0035, kGround, wall * 0.62);     // joint to the next house

  const double wanted = random.Uniform(0.062, 0.085);
  const int columns = std::max(2, static_cast<int>((right - left) / wanted));
  const double pitch = (right - left) / columns;
  const double w = pitch * random.Uniform(0.42, 0.55);
  const double h = storey * random.Uniform(0.52, 0.64);
  for (int s = 0; s < storeys; ++s) {
    const double y = base - (s + 1) * storey + (storey - h) * 0.45;
    if (random.Uniform() < 0.5) {
      Box(left, base - s * storey - 0.005, right, base - s * storey,
          wall * random.Uniform(1.12, 1.3));
    }
    for (int c = 0; c < columns; ++c) {
      const double x = left + (c + 0.5) * pitch - w / 2.0;
      if (random.Uniform() < 0.95) {
        PaintWindow(x, y, x + w, y + h, random);
      }
    }
  }
  if (has_shop) {
    PaintShop(left + 0.006, base, right - 0.004, random);
  } else {
    const double door = left + (right - left) * random.Uniform(0.2, 0.7);
    Box(door - 0.004, kGround - 0.098, door + 0.046, kGround, wall * 1.3);
    Box(door, kGround - 0.09, door + 0.042, kGround,
        Color(random.Uniform(30, 130), random.Uniform(40, 90), random.Uniform(40, 100)));
  }
  if (random.Uniform() < 0.6) {  // drain pipe
    const double pipe = right - 0.012;
    Box(pipe, top + 0.012, pipe + 0.005, kGround, wall * 0.5);
  }
}

void StreetPainter::PaintHouses() {
  SeededRandom random(seed_, 30);
  for (double x = kLeft - 0.1; x < kRight;) {
    double right = x + random.Uniform(0.2, 0.42);
    for (const double corner : {-kWallCorner, kWallCorner}) {
      if (x < corner && right > corner - 0.1) {
        right = corner;
      }
    }
    PaintHouse(x, right, random);
    x = right;
    if (random.Uniform() < 0.16) {
      x += random.Uniform(0.03, 0.08);  // a lane: the skyline shows
    }
  }
}

void StreetPainter::PaintTrees() {
  SeededRandom random(seed_, 40);
  for (double x = kLeft + random.Uniform(0.1, 0.4); x < kRight; x += random.Uniform(0.35, 0.8)) {
    const double crown = random.Uniform(0.05, 0.085);
    const double centre = kGround - random.Uniform(0.14, 0.2);
    const Color bark(88, 70, 54);
    Box(x - 0.008, centre, x + 0.008, kGround + 0.035, bark);
    Box(x + 0.003, centre, x + 0.008, kGround + 0.035, bark * 0.7);
    const Color leaf = Color(72, 104, 48) * random.Uniform(0.8, 1.15);
    for (int i = 0; i < 420; ++i) {
      const double angle = random.Uniform(0.0, 6.283185);
      const double reach = std::sqrt(random.Uniform());
      const double dx = crown * reach * std::cos(angle);
      const double dy = crown * 1.15 * reach * std::sin(angle);
      // Light comes from the upper left.
      const double light = 1.0 - 0.45 * (dx + 1.4 * dy) / crown + random.Uniform(-0.25, 0.25);
      Disc(x + dx, centre + dy, crown * random.Uniform(0.06, 0.13), leaf * std::max(0.3, light));
    }
  }
}

void StreetPainter::PaintPosts() {
  SeededRandom random(seed_, 50);
  for (double x = kLeft + random.Uniform(0.05, 0.3); x < kRight; x += random.Uniform(0.3, 0.55)) {
    const Color iron = Color(52, 58, 60) * random.Uniform(0.8, 1.5);
    const double foot = kKerb - random.Uniform(0.0, 0.03);
    const double top = kGround - random.Uniform(0.3, 0.42);
    Box(x - 0.005, top, x + 0.005, foot, iron);
    Box(x - 0.005, top, x - 0.002, foot, iron * 1.7);
    Box(x - 0.011, foot - 0.03, x + 0.011, foot, iron * 0.9);
    const double kind = random.Uniform();
    if (kind < 0.5) {  // lamp on an arm
      const double side = random.Uniform() < 0.5 ? -1.0 : 1.0;
      const double reach = x + side * 0.06;
      Box(std::min(x, reach), top, std::max(x, reach), top + 0.006, iron);
      Box(reach - 0.017, top + 0.006, reach + 0.017, top + 0.016, Color(244, 236, 206));
    } else if (kind < 0.8) {  // traffic sign
      const double radius = random.Uniform(0.022, 0.03);
      Disc(x, top + radius, radius, Color(238, 238, 236));
      Disc(x, top + radius, radius * 0.88,
           random.Uniform() < 0.5 ? Color(190, 36, 40) : Color(36, 84, 170));
      Box(x - radius * 0.55, top + radius * 0.82, x + radius * 0.55, top + radius * 1.18,
          Color(240, 240, 240));
    } else {  // lantern
      Disc(x, top - 0.008, 0.017, Color(248, 240, 214));
      Box(x - 0.018, top + 0.008, x + 0.018, top + 0.013, iron);
    }
  }
}

void StreetPainter::AddGrain() {
  // Uneven light, dirt and grain: relative, so that dark parts stay dark. The two finest follow the
  // pixels, not the street.
  cv::Mat shade = 0.05 * SmoothNoise(5.0, 60);
  shade += 0.04 * SmoothNoise(23.0, 61) + 0.04 * SmoothNoise(90.0, 62);
  shade += 0.045 * SmoothNoise(std::min(unit_ / 3.0, 300.0), 63);
  shade += 0.05 * SmoothNoise(unit_ / 1.6, 64);
  for (int y = 0; y < image_.rows; ++y) {
    const auto* noise = shade.ptr<float>(y);
    auto* row = image_.ptr<cv::Vec3b>(y);
    for (int x = 0; x < image_.cols; ++x) {
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
  const cv::Mat image = StreetPainter(width, height, seed).Paint();
  RgbPicture picture;
  picture.width = image.cols;
  picture.height = image.rows;
  picture.pixels.assign(image.datastart, image.dataend);
  return picture;
}

}  // namespace rsstab::igf
