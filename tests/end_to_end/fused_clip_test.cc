// SPDX-License-Identifier: Apache-2.0
// Rolling shutter taken out without a gyro log, in clips that are hard on it: never worse than left
// alone, never a jump, never a frame lost.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/cli/media/media_test_support.h"
#include "tests/end_to_end/program.h"
#include "tests/support/test_paths.h"

namespace rsstab::testing {
namespace {

using media::VideoFrame;

// px at 640 px width: what tracks scatter from one measurement to the next.
constexpr double kMeasuringNoise = 0.03;
constexpr double kJitterNoise = 0.1;

using Edit = std::function<void(std::vector<VideoFrame>&)>;

class FusedClip : public ::testing::Test {
 protected:
  [[nodiscard]] std::string Path(const std::string& name) const { return folder_ / name; }

  void Simulate(const std::string& name, const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments = {"simulate",   Path(name), "--motion", "walking",
                                          "--width",    "480",      "--height", "270",
                                          "--duration", "1.8",      "--crf",    "4"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    RunOrFail(arguments);
  }

  // Writes the frames of `source` as `edit` leaves them, and how many there are.
  std::size_t Write(const std::string& source, const std::string& target, const Edit& edit) {
    auto reader = media::VideoReader::Open(Path(source), {1, SilentLogger()});
    EXPECT_TRUE(reader.has_value());
    media::WriterOptions options;
    options.codec = "ffv1";
    auto writer = media::VideoWriter::Open(Path(target), **reader, options);
    EXPECT_TRUE(writer.has_value()) << writer.error().message;
    std::vector<VideoFrame> frames = media::testing::ReadClip(Path(source))->frames;
    edit(frames);
    for (const VideoFrame& frame : frames) {
      EXPECT_TRUE((*writer)->Write(frame));
    }
    EXPECT_TRUE((*writer)->Finish());
    return frames.size();
  }

  nlohmann::json Steady(const std::string& clip, const std::string& rs, bool measure = true) {
    const std::string output = Path("out-" + rs + ".mkv");
    RunOrFail({Path(clip), "-o", output, "--rs", rs, "--codec", "ffv1", "--overwrite"});
    if (!measure) {
      return {};
    }
    return nlohmann::json::parse(RunOrFail({"compare", Path(clip), output, "--json"}).output)
        .at("output");
  }

  // How much of the rows' wobble that `off` leaves stays with `fused`, px.
  void ExpectNoHarm(const std::string& clip) {
    const nlohmann::json off = Steady(clip, "off");
    const nlohmann::json fused = Steady(clip, "fused");
    EXPECT_EQ(fused["frames"], off["frames"]);
    EXPECT_LT(fused["row_wobble_px"].get<double>(),
              off["row_wobble_px"].get<double>() + kMeasuringNoise);
    EXPECT_LT(fused["jitter_px"].get<double>(), off["jitter_px"].get<double>() + kJitterNoise);
  }

 private:
  TemporaryFolder folder_;
};

TEST_F(FusedClip, RowsWobbleLess) {
  Simulate("walk");
  const double off = Steady("walk/rs.mp4", "off")["row_wobble_px"];
  const double fused = Steady("walk/rs.mp4", "fused")["row_wobble_px"];
  EXPECT_LT(fused, 0.6 * off);
}

TEST_F(FusedClip, CutsRepeatedAndMissingFramesDoNoHarm) {
  Simulate("walk");
  Simulate("other", {"--seed", "7"});
  const auto other = media::testing::ReadClip(Path("other/rs.mp4"));
  ASSERT_TRUE(other);
  Write("walk/rs.mp4", "cut.mkv", [&](std::vector<VideoFrame>& frames) {
    for (std::size_t i = frames.size() / 2; i < frames.size(); ++i) {
      frames[i].frame = other->frames[i].frame;
    }
  });
  ExpectNoHarm("cut.mkv");
  Write("walk/rs.mp4", "repeated.mkv", [](std::vector<VideoFrame>& frames) {
    for (std::size_t i = 6; i < frames.size(); i += 7) {
      frames[i].frame = frames[i - 1].frame;
    }
  });
  ExpectNoHarm("repeated.mkv");
  Write("walk/rs.mp4", "missing.mkv", [](std::vector<VideoFrame>& frames) {
    std::vector<VideoFrame> kept;
    for (std::size_t i = 0; i < frames.size(); ++i) {
      if (i % 9 != 8) {
        kept.push_back(frames[i]);
      }
    }
    frames = kept;
  });
  ExpectNoHarm("missing.mkv");
}

TEST_F(FusedClip, BlurAndNoiseDoNoHarm) {
  Simulate("blurred", {"--exposure", "16", "--image-noise", "6"});
  ExpectNoHarm("blurred/rs.mp4");
}

TEST_F(FusedClip, AFewFramesComeThrough) {
  Simulate("walk");
  for (const std::size_t count : {1U, 2U, 3U}) {
    Write("walk/rs.mp4", "few.mkv",
          [count](std::vector<VideoFrame>& frames) { frames.resize(count); });
    Steady("few.mkv", "fused", false);
    const auto clip = media::testing::ReadClip(Path("out-fused.mkv"));
    ASSERT_TRUE(clip);
    EXPECT_EQ(clip->frames.size(), count);
    std::filesystem::remove(Path("few.mkv"));
  }
}

}  // namespace
}  // namespace rsstab::testing
