// SPDX-License-Identifier: Apache-2.0
#include "igf/rs_simulator.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <numbers>
#include <vector>

#include "igf/base/rolling_shutter.h"
#include "igf/base/rotation.h"
#include "igf/motion_presets.h"
#include "igf/scene_painter.h"

namespace rsstab::igf {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr int kWidth = 160;
constexpr int kHeight = 90;
constexpr double kFocalPx = 138.0;

// Steady turn at `rate` (rad/s, camera axes) through the identity at time 0.
OrientationTrack SteadyTurn(const Eigen::Vector3d& rate) {
  std::vector<double> times_s;
  std::vector<Eigen::Quaterniond> orientations;
  for (int i = -100; i <= 100; ++i) {
    times_s.push_back(0.01 * i);
    orientations.push_back(ExpSo3(Eigen::Vector3d(0.01 * i * rate)));
  }
  return *OrientationTrack::Create(std::move(times_s), std::move(orientations));
}

std::shared_ptr<const TextureScene> Street() {
  return std::make_shared<TextureScene>(
      *TextureScene::FromPicture(*PaintStreet(1024, 512, 1), kPaintedWidthTan, kFocalPx));
}

// A picture of two crossed waves with a known value in every direction of the wall ahead: the
// B-spline of a sampled wave is the wave times (2 + cos w) / 3, w rad a texel.
class Waves {
 public:
  Waves() {
    RgbPicture picture{kTexels, kTexels, {}};
    for (int y = 0; y < kTexels; ++y) {
      for (int x = 0; x < kTexels; ++x) {
        const double level = 128.0 + kSwing * (std::cos(kAcross * x) + std::cos(kDown * y));
        picture.pixels.insert(picture.pixels.end(), 3,
                              static_cast<std::uint8_t>(std::lround(level)));
      }
    }
    scene = std::make_shared<TextureScene>(*TextureScene::FromPicture(picture, 2.0, kFocal));
  }

  // Full-range luma, 0..1, in a direction of the wall ahead.
  [[nodiscard]] static double Luma(const Eigen::Vector3d& direction) {
    const double x = (kTexels - 1) / 2.0 + kTexels / 2.0 * direction.x() / direction.z();
    const double y = (kTexels - 1) / 2.0 + kTexels / 2.0 * direction.y() / direction.z();
    const double wave_x = (2.0 + std::cos(kAcross)) / 3.0 * std::cos(kAcross * x);
    const double wave_y = (2.0 + std::cos(kDown)) / 3.0 * std::cos(kDown * y);
    return (128.0 + kSwing * (wave_x + wave_y)) / 255.0;
  }

  static constexpr int kTexels = 400;
  static constexpr double kFocal = kTexels / 2.0 / 1.25;
  static constexpr double kAcross = kTurn / 17.0;
  static constexpr double kDown = kTurn / 23.0;
  static constexpr double kSwing = 60.0;

  std::shared_ptr<const TextureScene> scene;
};

RsSimulatorOptions WithReadout(double readout_s) {
  RsSimulatorOptions options;
  options.readout_s = readout_s;
  return options;
}

std::vector<std::uint8_t> Bytes(const Frame& frame) {
  std::vector<std::uint8_t> bytes;
  for (int p = 0; p < frame.layout.num_planes; ++p) {
    const MutablePlaneView& plane = frame.planes[static_cast<std::size_t>(p)];
    const std::ptrdiff_t row_bytes = plane.width * frame.layout.BytesPerSample();
    for (int y = 0; y < plane.height; ++y) {
      const std::uint8_t* row = plane.data + y * plane.stride;
      bytes.insert(bytes.end(), row, row + row_bytes);
    }
  }
  return bytes;
}

PixelLayout DeepGray() {
  PixelLayout layout = GrayLayout(16);
  layout.full_range = true;
  return layout;
}

double DeepLuma(const Frame& frame, int x, int y) {
  std::uint16_t value = 0;
  std::memcpy(&value, frame.planes[0].data + y * frame.planes[0].stride + 2 * x, sizeof(value));
  return value / 65535.0;
}

// Every pixel against the closed form: scene(R(t(y))^T K^-1 y). A rotation of the wrong sense, a
// row time half a row off, or a middle row at the wrong place all exceed the tolerance many times.
TEST(RsSimulator, EveryPixelSeesItsOwnDirectionAtItsOwnTime) {
  const Waves waves;
  const Camera camera = Camera::Pinhole(kWidth, kHeight, Waves::kFocal);
  const Eigen::Vector3d rate(1.1, -1.7, 2.3);  // a row takes 0.01 to 0.05 px
  for (const double readout_s : {0.03, -0.02, 0.0}) {
    RsSimulatorOptions options;
    options.readout_s = readout_s;
    const auto simulator = RsSimulator::Create(waves.scene, camera, SteadyTurn(rate), options);
    ASSERT_TRUE(simulator) << simulator.error().message;
    WorkerPool pool(1);
    constexpr double kFrameTimeS = 0.05;
    const auto frame = simulator->RenderRs(kFrameTimeS, DeepGray(), pool);
    ASSERT_TRUE(frame) << frame.error().message;
    double sum = 0.0;
    for (int y = 0; y < kHeight; ++y) {
      const double t = RowExposureTime(kFrameTimeS, static_cast<double>(y), kHeight, readout_s);
      const Eigen::Quaterniond world_from_camera = ExpSo3(Eigen::Vector3d(t * rate));
      for (int x = 0; x < kWidth; ++x) {
        const Eigen::Vector3d ray = *camera.UnprojectPixel({x, y});
        const double error = DeepLuma(*frame, x, y) - Waves::Luma(world_from_camera * ray);
        sum += error * error;
      }
    }
    // The texels have 8 bits: a third of a level each, averaged over some by the spline. One pixel
    // of motion is 10 levels RMS, so this bounds the place to 0.02 px.
    constexpr double kQuantisation = 0.25 / 255.0;
    EXPECT_LT(std::sqrt(sum / (kWidth * kHeight)), kQuantisation) << readout_s;
  }
}

TEST(RsSimulator, YawToTheRightMovesThePictureLeft) {
  const Waves waves;
  const Camera camera = Camera::Pinhole(kWidth, kHeight, Waves::kFocal);
  constexpr double kTimeS = 0.1;
  const double shift_px = 3.0;
  const double rate = std::atan(shift_px / Waves::kFocal) / kTimeS;
  const auto simulator = RsSimulator::Create(waves.scene, camera, SteadyTurn({0.0, rate, 0.0}));
  ASSERT_TRUE(simulator);
  WorkerPool pool(1);
  const auto before = simulator->RenderGs(0.0, DeepGray(), pool);
  const auto after = simulator->RenderGs(kTimeS, DeepGray(), pool);
  ASSERT_TRUE(before && after);
  // At the centre, where a yaw is a plain shift (to 0.001 px within 8 px).
  constexpr double kTolerance = 0.005;
  for (int x = kWidth / 2 - 4; x <= kWidth / 2 + 4; ++x) {
    EXPECT_NEAR(DeepLuma(*after, x, kHeight / 2), DeepLuma(*before, x + 3, kHeight / 2),
                kTolerance);
  }
}

TEST(RsSimulator, TwinIsTheMiddleRowsInstant) {
  const auto scene = Street();
  const Camera camera = Camera::Pinhole(kWidth, kHeight + 1, kFocalPx);  // odd: has a middle row
  RsSimulatorOptions options;
  options.readout_s = 0.03;
  const auto simulator = RsSimulator::Create(scene, camera, SteadyTurn({0.5, 2.0, 1.0}), options);
  options.readout_s = 0.0;
  const auto global = RsSimulator::Create(scene, camera, SteadyTurn({0.5, 2.0, 1.0}), options);
  ASSERT_TRUE(simulator && global);
  WorkerPool pool(1);
  const auto rs = simulator->RenderRs(0.1, GrayLayout(), pool);
  const auto gs = simulator->RenderGs(0.1, GrayLayout(), pool);
  const auto rs_without_readout = global->RenderRs(0.1, GrayLayout(), pool);
  ASSERT_TRUE(rs && gs && rs_without_readout);
  EXPECT_EQ(Bytes(*gs), Bytes(*rs_without_readout));
  EXPECT_NE(Bytes(*gs), Bytes(*rs));
  const int middle = kHeight / 2;
  EXPECT_EQ(0, std::memcmp(rs->planes[0].data + middle * rs->planes[0].stride,
                           gs->planes[0].data + middle * gs->planes[0].stride, kWidth));
}

// Read out upwards, row v is exposed when row H - 1 - v is read downwards.
TEST(RsSimulator, BottomToTopReadoutIsTheMirroredTiming) {
  const Waves waves;
  const Camera camera = Camera::Pinhole(kWidth, kHeight, Waves::kFocal);
  RsSimulatorOptions options;
  options.readout_s = 0.03;
  const auto down = RsSimulator::Create(waves.scene, camera, SteadyTurn({0.0, 2.0, 0.0}), options);
  options.readout_s = -0.03;
  const auto up = RsSimulator::Create(waves.scene, camera, SteadyTurn({0.0, 2.0, 0.0}), options);
  // The same turn backwards in time is the same as the readout backwards.
  const auto up_reversed =
      RsSimulator::Create(waves.scene, camera, SteadyTurn({0.0, -2.0, 0.0}), options);
  ASSERT_TRUE(down && up && up_reversed);
  WorkerPool pool(1);
  const auto a = down->RenderRs(0.0, DeepGray(), pool);
  const auto b = up->RenderRs(0.0, DeepGray(), pool);
  const auto c = up_reversed->RenderRs(0.0, DeepGray(), pool);
  ASSERT_TRUE(a && b && c);
  EXPECT_NE(Bytes(*a), Bytes(*b));
  // Equal but for the round-off of where the rows' times fall between orientation samples.
  constexpr double kRoundOff = 2.0 / 65535.0;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      ASSERT_NEAR(DeepLuma(*a, x, y), DeepLuma(*c, x, y), kRoundOff) << x << " " << y;
    }
  }
}

TEST(RsSimulator, ChromaRowsHaveTheirOwnTime) {
  // Chroma follows luma where the picture is one hue: Cb and Cr are then fixed multiples of luma.
  RgbPicture picture{Waves::kTexels, Waves::kTexels, {}};
  for (int y = 0; y < Waves::kTexels; ++y) {
    for (int x = 0; x < Waves::kTexels; ++x) {
      const double level = 0.5 + 0.4 * std::cos(kTurn * x / 40.0);
      for (const double share : {200.0, 100.0, 50.0}) {
        picture.pixels.push_back(static_cast<std::uint8_t>(std::lround(level * share)));
      }
    }
  }
  const auto scene =
      std::make_shared<TextureScene>(*TextureScene::FromPicture(picture, 2.0, Waves::kFocal));
  const Camera camera = Camera::Pinhole(kWidth, kHeight, Waves::kFocal);
  RsSimulatorOptions options;
  options.readout_s = 0.03;
  const auto simulator = RsSimulator::Create(scene, camera, SteadyTurn({0.0, 3.0, 0.0}), options);
  ASSERT_TRUE(simulator);
  WorkerPool pool(1);
  PixelLayout layout = Yuv420Layout(16);
  layout.full_range = true;
  const auto frame = simulator->RenderRs(0.0, layout, pool);
  ASSERT_TRUE(frame) << frame.error().message;
  const double luma_of_hue = 0.2126 * 200 + 0.7152 * 100 + 0.0722 * 50;
  const double cr_of_hue = 0.5 * 200 - 0.454153 * 100 - 0.045847 * 50;
  double sum = 0.0;
  for (int y = 0; y < kHeight / 2; ++y) {
    for (int x = 0; x < kWidth / 2; ++x) {
      std::uint16_t cr = 0;
      std::memcpy(&cr, frame->planes[2].data + y * frame->planes[2].stride + 2 * x, sizeof(cr));
      // Chroma sample (x, y) sits at luma (2x, 2y + 0.5): between two luma rows.
      const double luma =
          0.5 * (DeepLuma(*frame, 2 * x, 2 * y) + DeepLuma(*frame, 2 * x, 2 * y + 1));
      const double error = (cr - 32768.0) / 65535.0 - luma * cr_of_hue / luma_of_hue;
      sum += error * error;
    }
  }
  // Chroma is drawn at half the density, hence a little softer, and 8-bit texels; a pixel of luma
  // motion changes Cr by 0.012 RMS.
  constexpr double kTolerance = 0.002;
  EXPECT_LT(std::sqrt(sum / (kWidth * kHeight / 4)), kTolerance);
}

TEST(RsSimulator, SameBytesForAnyNumberOfThreadsAndEveryTime) {
  const auto scene = Street();
  RsSimulatorOptions options;
  options.readout_s = 0.02;
  options.noise_sigma = 2.0;
  options.exposure_s = 0.01;
  options.exposure_samples = 3;
  options.foreground = ForegroundObject{};
  const auto simulator = RsSimulator::Create(scene, Camera::Pinhole(kWidth, kHeight, kFocalPx),
                                             SteadyTurn({0.5, 2.0, 1.0}), options);
  ASSERT_TRUE(simulator) << simulator.error().message;
  WorkerPool one(1);
  WorkerPool three(3);
  const auto a = simulator->RenderRs(0.1, Yuv420Layout(), one, 4);
  const auto b = simulator->RenderRs(0.1, Yuv420Layout(), three, 4);
  const auto other_noise = simulator->RenderRs(0.1, Yuv420Layout(), one, 5);
  ASSERT_TRUE(a && b && other_noise);
  EXPECT_EQ(Bytes(*a), Bytes(*b));
  EXPECT_NE(Bytes(*a), Bytes(*other_noise));
}

TEST(RsSimulator, NoiseHasTheAskedStrength) {
  const auto scene = Street();
  RsSimulatorOptions options;
  const Camera camera = Camera::Pinhole(kWidth, kHeight, kFocalPx);
  const auto clean = RsSimulator::Create(scene, camera, SteadyTurn({0, 0, 0}), options);
  options.noise_sigma = 4.0;
  const auto noisy = RsSimulator::Create(scene, camera, SteadyTurn({0, 0, 0}), options);
  ASSERT_TRUE(clean && noisy);
  WorkerPool pool(1);
  const auto a = clean->RenderGs(0.0, DeepGray(), pool);
  const auto b = noisy->RenderGs(0.0, DeepGray(), pool);
  ASSERT_TRUE(a && b);
  double sum = 0.0;
  double square = 0.0;
  int count = 0;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const double before = DeepLuma(*a, x, y);
      if (before > 0.1 && before < 0.9) {  // clear of clipping
        const double noise = 255.0 * (DeepLuma(*b, x, y) - before);
        sum += noise;
        square += noise * noise;
        ++count;
      }
    }
  }
  // Over 10000 samples: 5 standard errors.
  EXPECT_NEAR(sum / count, 0.0, 0.2);
  EXPECT_NEAR(std::sqrt(square / count), 4.0, 0.15);
}

TEST(RsSimulator, BlurIsTheMeanOverTheExposure) {
  const auto scene = Street();
  const Camera camera = Camera::Pinhole(kWidth, kHeight, kFocalPx);
  RsSimulatorOptions options;
  options.exposure_s = 0.02;
  options.exposure_samples = 2;
  const auto blurred = RsSimulator::Create(scene, camera, SteadyTurn({0, 2, 0}), options);
  const auto sharp = RsSimulator::Create(scene, camera, SteadyTurn({0, 2, 0}));
  ASSERT_TRUE(blurred && sharp);
  WorkerPool pool(1);
  const auto mean = blurred->RenderGs(0.1, DeepGray(), pool);
  const auto early = sharp->RenderGs(0.095, DeepGray(), pool);
  const auto late = sharp->RenderGs(0.105, DeepGray(), pool);
  ASSERT_TRUE(mean && early && late);
  constexpr double kRoundOff = 2.0 / 65535.0;
  for (int x = 0; x < kWidth; ++x) {
    EXPECT_NEAR(DeepLuma(*mean, x, 40), 0.5 * (DeepLuma(*early, x, 40) + DeepLuma(*late, x, 40)),
                kRoundOff);
  }
}

TEST(RsSimulator, ForegroundMovesWhileTheCameraRests) {
  const auto scene = Street();
  const Camera camera = Camera::Pinhole(kWidth, kHeight, kFocalPx);
  RsSimulatorOptions options;
  options.foreground = ForegroundObject{};
  options.foreground->rate_rad_s = 0.5;
  const auto with = RsSimulator::Create(scene, camera, SteadyTurn({0, 0, 0}), options);
  const auto without = RsSimulator::Create(scene, camera, SteadyTurn({0, 0, 0}));
  ASSERT_TRUE(with && without);
  WorkerPool pool(1);
  const auto background = without->RenderGs(0.0, DeepGray(), pool);
  const auto centre_of_object = [&](double time_s) {
    const auto frame = with->RenderGs(time_s, DeepGray(), pool);
    double sum = 0.0;
    int count = 0;
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        if (std::abs(DeepLuma(*frame, x, y) - DeepLuma(*background, x, y)) > 1e-3) {
          sum += x;
          ++count;
        }
      }
    }
    return sum / count;
  };
  constexpr double kTolerance = 0.5;  // px: a hard-edged disc of 14 px radius
  EXPECT_NEAR(centre_of_object(0.0), camera.cx, kTolerance);
  EXPECT_NEAR(centre_of_object(0.4), camera.cx + kFocalPx * std::tan(0.2), kTolerance);
}

TEST(RsSimulator, BentLensesSeeTheSceneThroughTheirOwnRays) {
  const Waves waves;
  Camera camera = Camera::Pinhole(kWidth, kHeight, Waves::kFocal);
  camera.model = LensModel::kFisheye;
  camera.distortion = {-0.02, 0.003, 0.0, 0.0};
  const auto simulator = RsSimulator::Create(waves.scene, camera, SteadyTurn({0, 1, 0}));
  ASSERT_TRUE(simulator) << simulator.error().message;
  WorkerPool pool(1);
  const auto frame = simulator->RenderGs(0.1, DeepGray(), pool);
  ASSERT_TRUE(frame);
  constexpr double kQuantisation = 1.5 / 255.0;
  for (int y = 0; y < kHeight; y += 7) {
    for (int x = 0; x < kWidth; x += 7) {
      const Eigen::Vector3d ray = *camera.UnprojectPixel({x, y});
      EXPECT_NEAR(DeepLuma(*frame, x, y), Waves::Luma(ExpSo3(Eigen::Vector3d(0, 0.1, 0)) * ray),
                  kQuantisation);
    }
  }
}

// Every view of every preset is filled: what lies outside the picture is its reflection. The
// picture here is white, so any hole would be dark.
TEST(RsSimulator, NoPresetShowsABorder) {
  const RgbPicture white{64, 36, std::vector<std::uint8_t>(64 * 36 * 3, 255)};
  const auto scene = std::make_shared<TextureScene>(*TextureScene::FromPicture(white, 1.3, 69.0));
  WorkerPool pool(1);
  for (const MotionPreset preset : kMotionPresets) {
    RsSimulatorOptions options;
    options.readout_s = UsualReadout(preset);
    const auto simulator = RsSimulator::Create(scene, Camera::Pinhole(80, 45, 69.0),
                                               *MakePresetOrientation(preset, 1, 10.0), options);
    ASSERT_TRUE(simulator) << simulator.error().message;
    for (int n = 0; n < 300; n += 3) {
      const auto frame = simulator->RenderRs(n / 30.0, GrayLayout(), pool);
      ASSERT_TRUE(frame) << frame.error().message;
      const std::vector<std::uint8_t> bytes = Bytes(*frame);
      ASSERT_GE(*std::min_element(bytes.begin(), bytes.end()), 234);  // limited-range white: 235
    }
  }
}

TEST(RsSimulator, OddSizesAndDeepChroma) {
  const auto scene = Street();
  WorkerPool pool(1);
  for (const auto& [width, height] : {std::pair{1, 1}, {2, 1}, {17, 13}, {3, 64}}) {
    const auto simulator = RsSimulator::Create(scene, Camera::Pinhole(width, height, 20.0),
                                               SteadyTurn({1, 1, 1}), WithReadout(0.03));
    ASSERT_TRUE(simulator) << simulator.error().message;
    EXPECT_TRUE(simulator->RenderRs(0.0, Yuv420Layout(), pool));
    EXPECT_TRUE(simulator->RenderRs(0.0, Yuv420Layout(10), pool));
  }
}

TEST(RsSimulator, RefusesWhatItCannotKnow) {
  const auto scene = Street();
  const Camera camera = Camera::Pinhole(kWidth, kHeight, kFocalPx);
  const OrientationTrack track = SteadyTurn({0, 0, 0});
  EXPECT_FALSE(RsSimulator::Create(nullptr, camera, track));
  EXPECT_FALSE(RsSimulator::Create(scene, Camera{}, track));
  EXPECT_FALSE(RsSimulator::Create(scene, camera, track, WithReadout(std::nan(""))));
  RsSimulatorOptions no_samples;
  no_samples.exposure_samples = 0;
  EXPECT_FALSE(RsSimulator::Create(scene, camera, track, no_samples));
  const auto simulator = RsSimulator::Create(scene, camera, track, WithReadout(0.03));
  ASSERT_TRUE(simulator);
  WorkerPool pool(1);
  EXPECT_FALSE(simulator->RenderRs(0.99, GrayLayout(), pool));  // the motion ends at 1.0
  EXPECT_FALSE(simulator->RenderRs(std::nan(""), GrayLayout(), pool));
  EXPECT_FALSE(simulator->RenderRs(0.0, RgbaLayout(), pool));
  EXPECT_TRUE(simulator->RenderGs(0.99, GrayLayout(), pool));
}

}  // namespace
}  // namespace rsstab::igf
