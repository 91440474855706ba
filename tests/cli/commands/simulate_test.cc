// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/simulate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "cli/media/video_reader.h"
#include "igf/base/parallel_for.h"
#include "igf/base/rotation.h"
#include "igf/camera_profile_reader.h"
#include "igf/csv_parser.h"
#include "igf/gyro_integrator.h"
#include "igf/gyro_log_reader.h"
#include "tests/support/test_paths.h"

namespace rsstab::cli {
namespace {

constexpr const char* kNames[] = {"rs.mp4", "gs.mp4", "gyro.csv", "camera.json", "truth.json"};

SimulateOptions SmallClip(const std::filesystem::path& folder) {
  SimulateOptions options;
  options.output = folder.string();
  options.width = 160;
  options.height = 90;
  options.duration_s = 0.4;
  options.threads = 1;
  return options;
}

std::vector<Frame> ReadClip(const std::filesystem::path& path) {
  auto reader = media::VideoReader::Open(path.string(), {});
  EXPECT_TRUE(reader) << reader.error().message;
  std::vector<Frame> frames;
  while (true) {
    auto next = (*reader)->Read();
    EXPECT_TRUE(next) << next.error().message;
    if (!next || !*next) {
      return frames;
    }
    frames.push_back((*next)->frame);
  }
}

double MeanLumaDifference(const Frame& a, const Frame& b) {
  double sum = 0.0;
  for (int y = 0; y < a.height; ++y) {
    for (int x = 0; x < a.width; ++x) {
      sum += std::abs(a.planes[0].data[y * a.planes[0].stride + x] -
                      b.planes[0].data[y * b.planes[0].stride + x]);
    }
  }
  return sum / (a.width * a.height);
}

TEST(RunSimulate, WritesClipsLogCameraAndTruthThatBelongTogether) {
  const testing::TemporaryFolder folder;
  SimulateOptions options = SmallClip(folder / "new" / "folder");
  options.motion = igf::MotionPreset::kFastPan;
  options.gyro_offset_s = 0.75;
  options.crf = 0.0;
  std::int64_t done = 0;
  const Status status = RunSimulate(options, SilentLogger(), [&](std::int64_t n, std::int64_t all) {
    EXPECT_EQ(all, 12);
    EXPECT_EQ(n, ++done);
    return true;
  });
  ASSERT_TRUE(status) << status.error().message;
  EXPECT_EQ(done, 12);
  const std::filesystem::path out = options.output;

  const auto truth = igf::ReadSimulationTruth((out / "truth.json").string());
  ASSERT_TRUE(truth) << truth.error().message;
  ASSERT_EQ(truth->frame_times_s.size(), 12U);
  const auto camera = igf::ReadCameraProfile((out / "camera.json").string());
  ASSERT_TRUE(camera) << camera.error().message;
  EXPECT_EQ(camera->camera.width, 160);
  EXPECT_DOUBLE_EQ(camera->camera.fx, 80.0 * std::sqrt(3.0));
  EXPECT_EQ(camera->camera.readout_s, 0.025);

  // The log on its own clock integrates to the truth's turns.
  const auto log = igf::ReadGyroLog((out / "gyro.csv").string());
  ASSERT_TRUE(log) << log.error().message;
  const auto track = igf::IntegrateGyro(log->gyro);
  ASSERT_TRUE(track);
  const igf::OrientationTrack on_video_clock = track->WithOffset(0.75);
  constexpr double kTolerance = 2e-5;  // rad; SLERP over the integrator's steps of 0.5 ms
  for (std::size_t n = 0; n + 1 < 12; ++n) {
    const auto turn = [&](const igf::OrientationTrack& t) -> Eigen::Quaterniond {
      return *t.CameraFromWorld(truth->frame_times_s[n + 1]) *
             t.CameraFromWorld(truth->frame_times_s[n])->conjugate();
    };
    EXPECT_LT(
        LogSo3(Eigen::Quaterniond(turn(on_video_clock) * turn(truth->orientation).conjugate()))
            .norm(),
        kTolerance);
  }

  // Lossless clips hold exactly what the simulator draws at the truth's times.
  const auto simulation = PrepareSimulation(options, SilentLogger());
  ASSERT_TRUE(simulation) << simulation.error().message;
  const std::vector<Frame> rs = ReadClip(out / "rs.mp4");
  const std::vector<Frame> gs = ReadClip(out / "gs.mp4");
  ASSERT_EQ(rs.size(), 12U);
  ASSERT_EQ(gs.size(), 12U);
  WorkerPool pool(1);
  for (std::size_t n = 0; n < 12; ++n) {
    const double t = truth->frame_times_s[n];
    const auto index = static_cast<std::int64_t>(n);
    EXPECT_EQ(0.0, MeanLumaDifference(
                       rs[n], *simulation->simulator.RenderRs(t, Yuv420Layout(), pool, index)));
    EXPECT_EQ(0.0, MeanLumaDifference(
                       gs[n], *simulation->simulator.RenderGs(t, Yuv420Layout(), pool, index)));
  }
}

TEST(RunSimulate, RefusesToReplaceFilesUnlessTold) {
  const testing::TemporaryFolder folder;
  SimulateOptions options = SmallClip(folder.path());
  options.duration_s = 0.1;
  std::ofstream(folder / "camera.json") << "mine";
  const Status refused = RunSimulate(options, SilentLogger());
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kInvalidArgument);
  EXPECT_FALSE(std::filesystem::exists(folder / "rs.mp4"));
  options.overwrite = true;
  const Status done = RunSimulate(options, SilentLogger());
  EXPECT_TRUE(done) << done.error().message;
}

TEST(RunSimulate, StoppedLeavesNothingBehind) {
  const testing::TemporaryFolder folder;
  const Status status = RunSimulate(SmallClip(folder / "new"), SilentLogger(),
                                    [](std::int64_t done, std::int64_t) { return done < 3; });
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().code, ErrorCode::kCancelled);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(RunSimulate, OddSizesKeepAllTheirChroma) {
  const testing::TemporaryFolder folder;
  SimulateOptions options = SmallClip(folder.path());
  options.width = 33;
  options.height = 17;
  options.duration_s = 0.1;
  options.foreground = true;
  const Status status = RunSimulate(options, SilentLogger());
  ASSERT_TRUE(status) << status.error().message;
  const std::vector<Frame> frames = ReadClip(folder / "rs.mp4");
  ASSERT_EQ(frames.size(), 3U);
  EXPECT_EQ(frames[0].width, 33);
  EXPECT_EQ(frames[0].layout.chroma_shift_x, 0);
}

TEST(RunSimulate, FollowsAGyroLog) {
  const testing::TemporaryFolder folder;
  {
    std::ofstream csv(folder / "log.csv");
    csv << "t,gx,gy,gz\n";
    for (int i = 0; i <= 400; ++i) {  // 2 s of a steady yaw to the right
      csv << 5.0 + 0.005 * i << ",0,0.2,0\n";
    }
  }
  SimulateOptions options = SmallClip(folder / "out");
  options.motion_gyro = (folder / "log.csv").string();
  options.duration_s.reset();
  const auto simulation = PrepareSimulation(options, SilentLogger());
  ASSERT_TRUE(simulation) << simulation.error().message;
  // 0.3 s are kept back on both sides.
  EXPECT_EQ(simulation->truth.frame_times_s.size(), 42U);
  const auto rate = simulation->truth.orientation.MeanRate(0.1, 0.2);
  ASSERT_TRUE(rate);
  EXPECT_NEAR((*rate - Eigen::Vector3d(0.0, 0.2, 0.0)).norm(), 0.0, 1e-9);

  options.duration_s = 1.5;
  const auto too_long = PrepareSimulation(options, SilentLogger());
  ASSERT_FALSE(too_long);
  EXPECT_EQ(too_long.error().code, ErrorCode::kInvalidArgument);
}

TEST(PrepareSimulation, FilmsAPicture) {
  const auto photo = testing::DevelopmentData("images/val/val_00001.jpg");
  if (!photo) {
    GTEST_SKIP() << "needs a photograph of the development data";
  }
  const testing::TemporaryFolder folder;
  SimulateOptions options = SmallClip(folder.path());
  options.image = photo->string();
  const auto simulation = PrepareSimulation(options, SilentLogger());
  EXPECT_TRUE(simulation) << simulation.error().message;
}

TEST(PrepareSimulation, NamesWhatItCannotRead) {
  const testing::TemporaryFolder folder;
  SimulateOptions options = SmallClip(folder.path());
  options.image = (folder / "none.png").string();
  const auto missing = PrepareSimulation(options, SilentLogger());
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().code, ErrorCode::kNotFound);
  EXPECT_NE(missing.error().message.find("none.png"), std::string::npos);

  std::ofstream(folder / "text.png") << "not a picture";
  options.image = (folder / "text.png").string();
  const auto damaged = PrepareSimulation(options, SilentLogger());
  ASSERT_FALSE(damaged);
  EXPECT_EQ(damaged.error().code, ErrorCode::kCorruptData);

  options.image.clear();
  options.width = -5;
  EXPECT_FALSE(PrepareSimulation(options, SilentLogger()));
}

TEST(PrepareSimulation, SeedsChangeMotionAndLogNoise) {
  const testing::TemporaryFolder folder;
  SimulateOptions options = SmallClip(folder.path());
  options.gyro_noise_rad_s = 0.01;
  options.gyro_bias_rad_s = 0.02;
  const auto a = PrepareSimulation(options, SilentLogger());
  const auto b = PrepareSimulation(options, SilentLogger());
  options.seed = 2;
  const auto c = PrepareSimulation(options, SilentLogger());
  ASSERT_TRUE(a && b && c);
  const auto rate = [](const Result<Simulation>& s) { return s->gyro.samples()[50].rate_rad_s; };
  EXPECT_EQ(rate(a), rate(b));
  EXPECT_NE(rate(a), rate(c));
}

TEST(FrameRateFromNumber, KnowsNtscRates) {
  EXPECT_EQ(FrameRateFromNumber(30.0), (media::Rational{30, 1}));
  EXPECT_EQ(FrameRateFromNumber(29.97), (media::Rational{30000, 1001}));
  EXPECT_EQ(FrameRateFromNumber(23.976), (media::Rational{24000, 1001}));
  EXPECT_EQ(FrameRateFromNumber(59.94), (media::Rational{60000, 1001}));
  EXPECT_EQ(FrameRateFromNumber(12.5), (media::Rational{12500, 1000}));
}

TEST(SimulateOptionTable, DefaultsObeyTheirOwnRules) {
  EXPECT_TRUE(pipeline::ValidateOptions(SimulateOptionTable(), SimulateOptions{}));
}

}  // namespace
}  // namespace rsstab::cli
