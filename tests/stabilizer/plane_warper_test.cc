// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/plane_warper.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <optional>
#include <ostream>
#include <random>
#include <string>
#include <vector>

namespace rsstab::stabilizer {
namespace {

constexpr std::array kAllInterpolations = {Interpolation::kBilinear, Interpolation::kBicubic,
                                           Interpolation::kLanczos};

// --- Layouts ------------------------------------------------------------------------------------

struct NamedLayout {
  std::string name;
  PixelLayout layout;
};

PixelLayout Yuv(int shift_x, int shift_y, double offset_x, double offset_y, int bit_depth = 8) {
  PixelLayout layout = Yuv420Layout(bit_depth);
  layout.chroma_shift_x = shift_x;
  layout.chroma_shift_y = shift_y;
  layout.chroma_offset_x = offset_x;
  layout.chroma_offset_y = offset_y;
  return layout;
}

PixelLayout SemiPlanar(int bit_depth) {
  PixelLayout layout = Yuv420Layout(bit_depth);
  layout.num_planes = 2;
  layout.channels = {1, 2, 1, 1};
  return layout;
}

PixelLayout Yuva() {
  PixelLayout layout = Yuv420Layout();
  layout.num_planes = 4;
  return layout;
}

PixelLayout PlanarRgb(int bit_depth) {
  PixelLayout layout = Yuv(0, 0, 0.0, 0.0, bit_depth);
  layout.is_rgb = true;
  return layout;
}

PixelLayout PackedRgb(int channels, int bit_depth) {
  PixelLayout layout = RgbaLayout();
  layout.channels[0] = channels;
  layout.bit_depth = bit_depth;
  return layout;
}

std::vector<NamedLayout> AllLayouts() {
  return {{"420 left", Yuv(1, 1, 0.0, 0.5)},
          {"420 centre", Yuv(1, 1, 0.5, 0.5)},
          {"420 top left", Yuv(1, 1, 0.0, 0.0)},
          {"420 10 bit", Yuv(1, 1, 0.0, 0.5, 10)},
          {"420 16 bit", Yuv(1, 1, 0.0, 0.5, 16)},
          {"422 left", Yuv(1, 0, 0.0, 0.0)},
          {"422 12 bit", Yuv(1, 0, 0.0, 0.0, 12)},
          {"444", Yuv(0, 0, 0.0, 0.0)},
          {"411", Yuv(2, 0, 1.5, 0.0)},
          {"410", Yuv(2, 2, 1.5, 1.5)},
          {"nv12", SemiPlanar(8)},
          {"p010-like", SemiPlanar(10)},
          {"yuva", Yuva()},
          {"gray", GrayLayout()},
          {"gray 9 bit", GrayLayout(9)},
          {"gray 14 bit", GrayLayout(14)},
          {"gray 16 bit", GrayLayout(16)},
          {"planar rgb", PlanarRgb(8)},
          {"rgba", PackedRgb(4, 8)},
          {"rgba 16 bit", PackedRgb(4, 16)},
          {"rgb", PackedRgb(3, 8)}};
}

// --- Frames -------------------------------------------------------------------------------------

int GetSample(const Frame& frame, int plane, int x, int y, int channel) {
  const auto index = static_cast<std::size_t>(plane);
  const MutablePlaneView& view = frame.planes[index];
  const int sample = x * frame.layout.channels[index] + channel;
  const std::uint8_t* row = view.data + y * view.stride;
  return frame.layout.bit_depth == 8 ? row[sample]
                                     : reinterpret_cast<const std::uint16_t*>(row)[sample];
}

void SetSample(Frame& frame, int plane, int x, int y, int channel, int value) {
  const auto index = static_cast<std::size_t>(plane);
  const MutablePlaneView& view = frame.planes[index];
  const int sample = x * frame.layout.channels[index] + channel;
  std::uint8_t* row = view.data + y * view.stride;
  if (frame.layout.bit_depth == 8) {
    row[sample] = static_cast<std::uint8_t>(value);
  } else {
    reinterpret_cast<std::uint16_t*>(row)[sample] = static_cast<std::uint16_t>(value);
  }
}

struct SampleId {
  int plane;
  int channel;
  int x;
  int y;
};
std::ostream& operator<<(std::ostream& out, const SampleId& id) {
  return out << "plane " << id.plane << " channel " << id.channel << " at " << id.x << ", " << id.y;
}

void ForEachSample(const Frame& frame, const std::function<void(const SampleId&)>& body) {
  for (int p = 0; p < frame.layout.num_planes; ++p) {
    const auto index = static_cast<std::size_t>(p);
    for (int y = 0; y < frame.planes[index].height; ++y) {
      for (int x = 0; x < frame.planes[index].width; ++x) {
        for (int c = 0; c < frame.layout.channels[index]; ++c) {
          body({p, c, x, y});
        }
      }
    }
  }
}

int Get(const Frame& frame, const SampleId& id) {
  return GetSample(frame, id.plane, id.x, id.y, id.channel);
}
void Set(Frame& frame, const SampleId& id, int value) {
  SetSample(frame, id.plane, id.x, id.y, id.channel, value);
}

// Where a sample sits, in luma pixels.
Eigen::Vector2d LumaPosition(const PixelLayout& layout, const SampleId& id) {
  if (!layout.IsChroma(id.plane)) {
    return {id.x, id.y};
  }
  return {id.x * (1 << layout.chroma_shift_x) + layout.chroma_offset_x,
          id.y * (1 << layout.chroma_shift_y) + layout.chroma_offset_y};
}

Frame MakeFrame(const PixelLayout& layout, int width, int height) {
  Result<Frame> frame = AllocateFrame(layout, width, height);
  EXPECT_TRUE(frame.has_value());
  return *frame;
}

Frame RandomFrame(const PixelLayout& layout, int width, int height, unsigned seed) {
  Frame frame = MakeFrame(layout, width, height);
  std::mt19937 random(seed);
  std::uniform_int_distribution<int> level(0, (1 << layout.bit_depth) - 1);
  ForEachSample(frame, [&](const SampleId& id) { Set(frame, id, level(random)); });
  return frame;
}

constexpr double kSceneFrequency = 2.0 * std::numbers::pi / 40.0;  // rad per luma pixel
constexpr double kSceneAmplitude = 0.22;

// A smooth scene, another one in every plane and channel; in [0, 1].
double Scene(int plane, int channel, const Eigen::Vector2d& luma_pixel) {
  const double phase = 0.9 * plane + 0.4 * channel;
  return 0.5 + kSceneAmplitude * std::sin(kSceneFrequency * luma_pixel.x() + phase) +
         kSceneAmplitude * std::cos(kSceneFrequency * luma_pixel.y() - phase);
}

Frame SceneFrame(const PixelLayout& layout, int width, int height) {
  Frame frame = MakeFrame(layout, width, height);
  const int maximum = (1 << layout.bit_depth) - 1;
  ForEachSample(frame, [&](const SampleId& id) {
    const double value = Scene(id.plane, id.channel, LumaPosition(layout, id));
    Set(frame, id, static_cast<int>(std::lround(value * maximum)));
  });
  return frame;
}

// --- Maps ---------------------------------------------------------------------------------------

BackwardMap MapOf(int width, int height,
                  const std::function<Eigen::Vector2d(const Eigen::Vector2d&)>& source_of) {
  const MapGrid grid = DefaultMapGrid(width, height);
  BackwardMap map(width, height, grid.columns, grid.rows);
  for (int r = 0; r < grid.rows; ++r) {
    for (int c = 0; c < grid.columns; ++c) {
      map.At(c, r) = source_of(map.VertexPosition(c, r)).cast<float>();
    }
  }
  return map;
}

BackwardMap ShiftMap(int width, int height, const Eigen::Vector2d& shift) {
  return MapOf(width, height,
               [&](const Eigen::Vector2d& q) -> Eigen::Vector2d { return q + shift; });
}

BackwardMap SimilarityMap(int width, int height, double angle_rad, double scale) {
  const Eigen::Vector2d centre((width - 1) / 2.0, (height - 1) / 2.0);
  const Eigen::Matrix2d turn = scale * Eigen::Rotation2Dd(angle_rad).toRotationMatrix();
  return MapOf(width, height, [&](const Eigen::Vector2d& q) -> Eigen::Vector2d {
    return centre + turn * (q - centre);
  });
}

Frame Warped(const Frame& source, const BackwardMap& map, Interpolation interpolation,
             KernelSet kernels = BestKernelSet(), int threads = 1) {
  Frame output = MakeFrame(source.layout, source.width, source.height);
  WorkerPool workers(threads);
  const Status status =
      PlaneWarper(kernels).Warp(source.View(), map, interpolation, output, workers);
  EXPECT_TRUE(status.has_value()) << status.error().message;
  return output;
}

void ExpectSameSamples(const Frame& actual, const Frame& expected, const std::string& what) {
  int different = 0;
  ForEachSample(actual, [&](const SampleId& id) {
    if (Get(actual, id) != Get(expected, id) && different++ == 0) {
      ADD_FAILURE() << what << ": " << id << ": " << Get(actual, id) << " instead of "
                    << Get(expected, id);
    }
  });
  EXPECT_EQ(different, 0) << what;
}

// --- Tests --------------------------------------------------------------------------------------

TEST(PlaneWarper, IdentityCopiesEveryLayout) {
  for (const auto& [name, layout] : AllLayouts()) {
    const Frame source = RandomFrame(layout, 131, 37, 1);
    for (const Interpolation interpolation : kAllInterpolations) {
      for (const KernelSet kernels : {KernelSet::kPortable, BestKernelSet()}) {
        ExpectSameSamples(Warped(source, ShiftMap(131, 37, {0.0, 0.0}), interpolation, kernels),
                          source, name);
      }
    }
  }
}

TEST(PlaneWarper, IdentityCopiesEverySmallSize) {
  for (const PixelLayout& layout : {Yuv(1, 1, 0.5, 0.5), Yuv(1, 1, 0.0, 0.5, 10),
                                    Yuv(2, 2, 1.5, 1.5), SemiPlanar(8), RgbaLayout()}) {
    for (int height = 1; height <= 13; ++height) {
      for (int width = 1; width <= 17; ++width) {
        const Frame source = RandomFrame(layout, width, height, 2);
        for (const Interpolation interpolation : kAllInterpolations) {
          ExpectSameSamples(Warped(source, ShiftMap(width, height, {0.0, 0.0}), interpolation),
                            source, std::to_string(width) + "x" + std::to_string(height));
        }
      }
    }
  }
}

TEST(PlaneWarper, IdentityCopiesWideFrames) {
  // Float positions are coarsest at the far end of an 8K row.
  const Frame source = RandomFrame(GrayLayout(), 8192, 8, 3);
  ExpectSameSamples(Warped(source, ShiftMap(8192, 8, {0.0, 0.0}), Interpolation::kBicubic), source,
                    "8192 wide");
}

TEST(PlaneWarper, WholePixelShiftsMoveSamplesExactly) {
  // Chroma samples of 4:2:0 lie on multiples of 2, those of 4:1:0 on multiples of 4.
  const int shift_x = 8;
  const int shift_y = -4;
  for (const auto& [name, layout] : AllLayouts()) {
    const Frame source = RandomFrame(layout, 133, 41, 4);
    for (const Interpolation interpolation : kAllInterpolations) {
      const Frame output =
          Warped(source, ShiftMap(133, 41, Eigen::Vector2d(shift_x, shift_y)), interpolation);
      ForEachSample(output, [&, &layout = layout, &name = name](const SampleId& id) {
        const bool chroma = layout.IsChroma(id.plane);
        SampleId from = id;
        from.x += shift_x >> (chroma ? layout.chroma_shift_x : 0);
        from.y += -(-shift_y >> (chroma ? layout.chroma_shift_y : 0));
        const MutablePlaneView& plane = source.planes[static_cast<std::size_t>(id.plane)];
        const bool inside = from.x < plane.width && from.y >= 0;
        const int expected = inside ? Get(source, from) : layout.BlackLevel(id.plane, id.channel);
        ASSERT_EQ(Get(output, id), expected) << name << ": " << id;
      });
    }
  }
}

TEST(PlaneWarper, FollowsASmoothSceneThroughAnyLayout) {
  // A shift alone would not see where chroma is sited; a zoom does. 160 x 120 luma pixels are
  // seen twice as large.
  const int width = 160;
  const int height = 120;
  const Eigen::Vector2d anchor(37.3, 21.9);
  const auto source_of = [&](const Eigen::Vector2d& q) -> Eigen::Vector2d {
    return anchor + 0.5 * q;
  };
  const BackwardMap map = MapOf(width, height, source_of);
  for (const auto& [name, layout] : AllLayouts()) {
    const Frame source = SceneFrame(layout, width, height);
    const double maximum = (1 << layout.bit_depth) - 1;
    for (const Interpolation interpolation : kAllInterpolations) {
      // Linear interpolation misses a sine of amplitude A by A (w h)^2 / 8 on each axis; at the
      // coarsest chroma step of 4 luma pixels w h = 0.63. Bicubic misses less than a tenth of that;
      // so does Lanczos, which besides moves slopes by up to 0.02 px. Rounding (source, output,
      // position) adds 1.5 levels and 1/512 px.
      const double step = layout.IsChroma(1) ? 1 << layout.chroma_shift_x : 1;
      const double wh = kSceneFrequency * step;
      const double linear_error = 2.0 * kSceneAmplitude * wh * wh / 8.0;
      const double error =
          interpolation == Interpolation::kBilinear ? linear_error : 0.1 * linear_error;
      const double position_error_px =
          1.0 / 512.0 + (interpolation == Interpolation::kLanczos ? 0.02 : 0.0);
      const double tolerance =
          (error + 2.0 * kSceneAmplitude * wh * position_error_px) * maximum + 1.5;
      const Frame output = Warped(source, map, interpolation);
      ForEachSample(output, [&, &layout = layout, &name = name](const SampleId& id) {
        const Eigen::Vector2d from = source_of(LumaPosition(layout, id));
        ASSERT_NEAR(Get(output, id), Scene(id.plane, id.channel, from) * maximum, tolerance)
            << name << ": " << id;
      });
    }
  }
}

// RMS error of a shifted 16-bit sine, in shares of its amplitude.
double ShiftError(double wavelength_px, Interpolation interpolation) {
  const int width = 160;
  const int height = 120;
  const Eigen::Vector2d shift(0.37, -0.61);
  const auto sine = [&](const Eigen::Vector2d& q) {
    return std::sin(2.0 * std::numbers::pi * (0.8 * q.x() + 0.6 * q.y()) / wavelength_px);
  };
  constexpr double kAmplitude = 20000.0;
  Frame source = MakeFrame(GrayLayout(16), width, height);
  ForEachSample(source, [&](const SampleId& id) {
    Set(source, id, static_cast<int>(std::lround(32768.0 + kAmplitude * sine({id.x, id.y}))));
  });
  const Frame output = Warped(source, ShiftMap(width, height, shift), interpolation);
  double sum = 0.0;
  constexpr int kBorder = 8;
  for (int y = kBorder; y < height - kBorder; ++y) {
    for (int x = kBorder; x < width - kBorder; ++x) {
      const double truth = sine(Eigen::Vector2d(x, y) + shift);
      sum += std::pow((GetSample(output, 0, x, y, 0) - 32768.0) / kAmplitude - truth, 2.0);
    }
  }
  return std::sqrt(sum / ((width - 2 * kBorder) * (height - 2 * kBorder)));
}

TEST(PlaneWarper, HigherOrdersAreMoreExact) {
  EXPECT_LT(ShiftError(20.0, Interpolation::kBicubic),
            0.1 * ShiftError(20.0, Interpolation::kBilinear));
  EXPECT_LT(ShiftError(4.0, Interpolation::kBicubic),
            0.6 * ShiftError(4.0, Interpolation::kBilinear));
  EXPECT_LT(ShiftError(4.0, Interpolation::kLanczos),
            0.6 * ShiftError(4.0, Interpolation::kBicubic));
}

TEST(PlaneWarper, KeepsFlatAreasFlatAndTheMeanLevel) {
  // Rounding that leaned to one side would move the mean by up to half a level.
  // Seven sigma of the mean of 17,000 rounding errors, each uniform within half a level.
  constexpr double kBiasTolerance = 0.015;
  const int width = 160;
  const int height = 120;
  Frame flat = MakeFrame(GrayLayout(), width, height);
  Frame noise = MakeFrame(GrayLayout(), width, height);
  std::mt19937 random(5);
  std::uniform_int_distribution<int> level(96, 160);
  ForEachSample(flat, [&](const SampleId& id) {
    Set(flat, id, 77);
    Set(noise, id, level(random));
  });
  for (const Interpolation interpolation : kAllInterpolations) {
    const BackwardMap map = SimilarityMap(width, height, 0.05, 0.9);
    ExpectSameSamples(Warped(flat, map, interpolation), flat, "flat");

    const Frame output = Warped(noise, map, interpolation);
    const FilterBank filter(interpolation);
    double bias = 0.0;
    int count = 0;
    for (int y = 4; y < height - 4; ++y) {
      for (int x = 4; x < width - 4; ++x) {
        const Eigen::Vector2d from = map.Sample({x, y});
        const int left = static_cast<int>(std::floor(from.x()));
        const int top = static_cast<int>(std::floor(from.y()));
        const auto phase_x = static_cast<unsigned>(std::lround((from.x() - left) * kPhases));
        const auto phase_y = static_cast<unsigned>(std::lround((from.y() - top) * kPhases));
        if (phase_x == kPhases || phase_y == kPhases) {
          continue;
        }
        double exact = 0.0;
        for (int r = 0; r < filter.taps(); ++r) {
          for (int k = 0; k < filter.taps(); ++k) {
            exact += static_cast<double>(filter.Weights(phase_x)[k]) * filter.Weights(phase_y)[r] *
                     GetSample(noise, 0, left + k - filter.taps() / 2 + 1,
                               top + r - filter.taps() / 2 + 1, 0);
          }
        }
        bias += GetSample(output, 0, x, y, 0) - exact / (1 << (2 * kWeightBits));
        ++count;
      }
    }
    EXPECT_NEAR(bias / count, 0.0, kBiasTolerance);
  }
}

TEST(PlaneWarper, AllKernelsGiveTheSameBytes) {
  if (BestKernelSet() == KernelSet::kPortable) {
    GTEST_SKIP() << "this machine has the portable kernels only";
  }
  const int width = 203;
  const int height = 61;
  std::vector<BackwardMap> maps = {
      ShiftMap(width, height, {0.37, -0.21}),   SimilarityMap(width, height, 0.02, 0.9),
      SimilarityMap(width, height, -0.17, 0.8), SimilarityMap(width, height, 0.8, 0.5),
      SimilarityMap(width, height, 3.0, 1.0),   SimilarityMap(width, height, 0.1, 3.0),
      SimilarityMap(width, height, -0.1, 0.2)};
  std::mt19937 random(6);
  std::uniform_real_distribution<double> anywhere(-12.0, 12.0);
  maps.push_back(MapOf(width, height, [&](const Eigen::Vector2d& q) -> Eigen::Vector2d {
    return q + Eigen::Vector2d(anywhere(random), anywhere(random));
  }));
  for (const auto& [name, layout] : AllLayouts()) {
    const Frame source = RandomFrame(layout, width, height, 7);
    for (const BackwardMap& map : maps) {
      for (const Interpolation interpolation : kAllInterpolations) {
        ExpectSameSamples(Warped(source, map, interpolation, BestKernelSet()),
                          Warped(source, map, interpolation, KernelSet::kPortable), name);
      }
    }
  }
}

TEST(PlaneWarper, ThreadsDoNotChangeTheResult) {
  const Frame source = RandomFrame(Yuv420Layout(), 203, 161, 8);
  const BackwardMap map = SimilarityMap(203, 161, 0.1, 0.95);
  const Frame expected = Warped(source, map, Interpolation::kBicubic, BestKernelSet(), 1);
  for (const int threads : {2, 3, 8}) {
    ExpectSameSamples(Warped(source, map, Interpolation::kBicubic, BestKernelSet(), threads),
                      expected, std::to_string(threads) + " threads");
  }
}

TEST(PlaneWarper, EdgesRepeatForHalfAPixelAndThenTurnBlack) {
  Frame source = MakeFrame(Yuv(0, 0, 0.0, 0.0), 32, 16);
  ForEachSample(source, [&](const SampleId& id) { Set(source, id, 100 + 10 * id.plane); });
  struct Case {
    Eigen::Vector2d shift;
    bool first_column_black;
    bool last_column_black;
  };
  for (const Case& c : {Case{{-0.49, 0.0}, false, false}, Case{{-0.52, 0.0}, true, false},
                        Case{{0.49, 0.0}, false, false}, Case{{0.52, 0.0}, false, true}}) {
    for (const KernelSet kernels : {KernelSet::kPortable, BestKernelSet()}) {
      const Frame output =
          Warped(source, ShiftMap(32, 16, c.shift), Interpolation::kLanczos, kernels);
      EXPECT_EQ(GetSample(output, 0, 0, 5, 0), c.first_column_black ? 16 : 100);
      EXPECT_EQ(GetSample(output, 0, 31, 5, 0), c.last_column_black ? 16 : 100);
      EXPECT_EQ(GetSample(output, 1, 0, 5, 0), c.first_column_black ? 128 : 110);
      EXPECT_EQ(GetSample(output, 2, 31, 5, 0), c.last_column_black ? 128 : 120);
      EXPECT_EQ(GetSample(output, 0, 15, 5, 0), 100);
    }
  }
}

TEST(PlaneWarper, PositionsThatAreNotNumbersOrFarAwayTurnBlack) {
  const Frame source = RandomFrame(RgbaLayout(), 48, 40, 9);
  for (const float bad :
       {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
        -std::numeric_limits<float>::infinity(), 1e30F, -1e6F}) {
    for (const Eigen::Vector2f& position :
         {Eigen::Vector2f(bad, bad), Eigen::Vector2f(bad, 5.0F), Eigen::Vector2f(5.0F, bad)}) {
      BackwardMap map(48, 40, 4, 4);
      for (int r = 0; r < 4; ++r) {
        for (int c = 0; c < 4; ++c) {
          map.At(c, r) = position;
        }
      }
      const Frame output = Warped(source, map, Interpolation::kBicubic);
      ForEachSample(output, [&](const SampleId& id) {
        ASSERT_EQ(Get(output, id), id.channel == 3 ? 255 : 0) << id;
      });
    }
    // One bad vertex spoils its own cells only.
    BackwardMap map(48, 40, 4, 4);
    map.At(0, 0).x() = bad;
    const Frame output = Warped(source, map, Interpolation::kBicubic);
    EXPECT_EQ(GetSample(output, 0, 40, 30, 0), GetSample(source, 0, 40, 30, 0));
  }
}

TEST(PlaneWarper, WorksOnPaddedAndUnalignedRows) {
  const int width = 67;
  const int height = 23;
  const PixelLayout layout = Yuv420Layout(10);
  const Frame source = RandomFrame(layout, width, height, 10);
  const BackwardMap map = SimilarityMap(width, height, 0.05, 0.9);
  const Frame expected = Warped(source, map, Interpolation::kBicubic);

  // The same picture with rows that end where their samples end, in memory of exactly that size,
  // and an output with wide, guarded rows.
  constexpr std::uint8_t kGuard = 0x5A;
  FrameView tight = source.View();
  Frame wide = expected;
  std::array<std::vector<std::uint8_t>, 3> tight_memory;
  std::array<std::vector<std::uint8_t>, 3> wide_memory;
  for (std::size_t p = 0; p < 3; ++p) {
    const PlaneView plane = source.View().planes[p];
    const std::ptrdiff_t row_bytes = plane.width * 2;
    for (int y = 0; y < plane.height; ++y) {
      const std::uint8_t* row = plane.data + y * plane.stride;
      tight_memory[p].insert(tight_memory[p].end(), row, row + row_bytes);
    }
    tight.planes[p].data = tight_memory[p].data();
    tight.planes[p].stride = row_bytes;
    const std::ptrdiff_t wide_stride = row_bytes + 26;
    wide_memory[p].assign(static_cast<std::size_t>(wide_stride * plane.height), kGuard);
    wide.planes[p].data = wide_memory[p].data();
    wide.planes[p].stride = wide_stride;
  }
  WorkerPool workers(1);
  ASSERT_TRUE(PlaneWarper().Warp(tight, map, Interpolation::kBicubic, wide, workers).has_value());
  ExpectSameSamples(wide, expected, "padded");
  for (std::size_t p = 0; p < 3; ++p) {
    const MutablePlaneView& plane = wide.planes[p];
    for (int y = 0; y < plane.height; ++y) {
      for (std::ptrdiff_t b = plane.width * 2; b < plane.stride; ++b) {
        ASSERT_EQ(plane.data[y * plane.stride + b], kGuard) << "beyond row " << y;
      }
    }
  }
}

TEST(PlaneWarper, RefusesPicturesThatDoNotFit) {
  const Frame source = RandomFrame(Yuv420Layout(), 32, 16, 11);
  const BackwardMap map(32, 16, 3, 3);
  WorkerPool workers(1);
  const PlaneWarper warper;
  const auto code = [&](const FrameView& from, const BackwardMap& by, Frame to) {
    const Status status = warper.Warp(from, by, Interpolation::kBicubic, to, workers);
    return status ? std::optional<ErrorCode>() : status.error().code;
  };
  const auto refused = std::optional(ErrorCode::kInvalidArgument);
  EXPECT_EQ(code(source.View(), map, MakeFrame(Yuv420Layout(), 32, 16)), std::nullopt);
  EXPECT_EQ(code(source.View(), map, MakeFrame(Yuv420Layout(), 32, 18)), refused);
  EXPECT_EQ(code(source.View(), map, MakeFrame(Yuv420Layout(10), 32, 16)), refused);
  EXPECT_EQ(code(source.View(), BackwardMap(64, 16, 3, 3), MakeFrame(Yuv420Layout(), 32, 16)),
            refused);
  EXPECT_EQ(code(source.View(), BackwardMap(), MakeFrame(Yuv420Layout(), 32, 16)), refused);
  FrameView missing = source.View();
  missing.planes[2].data = nullptr;
  EXPECT_EQ(code(missing, map, MakeFrame(Yuv420Layout(), 32, 16)), refused);
}

}  // namespace
}  // namespace rsstab::stabilizer
