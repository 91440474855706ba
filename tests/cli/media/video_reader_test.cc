// SPDX-License-Identifier: Apache-2.0
#include "cli/media/video_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <functional>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include "tests/cli/media/media_test_support.h"
#include "tests/support/test_paths.h"

namespace rsstab::media {
namespace {

using ::rsstab::testing::DevelopmentData;
using ::rsstab::testing::TemporaryFolder;
using testing::Clip;
using testing::ClipRecipe;
using testing::CollectWarnings;
using ::testing::ElementsAre;
using ::testing::ElementsAreArray;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::MakeClip;
using testing::ReadClip;
using testing::RemuxRecipe;
using testing::SmallRecipe;
using testing::Warnings;

std::string Slurp(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

void Spill(const std::filesystem::path& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

Error OpenError(const std::filesystem::path& path) {
  const Result<Clip> clip = ReadClip(path);
  if (clip) {
    ADD_FAILURE() << path << " was read";
    return {};
  }
  EXPECT_THAT(clip.error().message, HasSubstr(path.filename().string())) << "names the file";
  return clip.error();
}

struct RealClip {
  const char* file;
  std::size_t frames;
  double period_s;
  bool is_damaged;
};

class VideoReaderRealClips : public ::testing::TestWithParam<RealClip> {};

TEST_P(VideoReaderRealClips, EveryFrameInOrderAtSaneTimes) {
  const RealClip& test = GetParam();
  const auto path = DevelopmentData(std::string("clips/") + test.file);
  if (!path) {
    GTEST_SKIP() << "the development clips are not there";
  }
  const Warnings warnings = CollectWarnings();
  auto reader = VideoReader::Open(path->string(), {2, warnings.logger});
  ASSERT_TRUE(reader) << reader.error().message;
  EXPECT_EQ((*reader)->info().frame_count, static_cast<std::int64_t>(test.frames));
  EXPECT_EQ((*reader)->info().timestamps_repaired, test.is_damaged);
  EXPECT_FALSE((*reader)->info().variable_frame_rate);
  EXPECT_NEAR((*reader)->info().frame_rate.Value() * test.period_s, 1.0, 1e-3);
  std::vector<double> times;
  while (true) {
    auto frame = (*reader)->Read();
    ASSERT_TRUE(frame) << frame.error().message;
    if (!*frame) {
      break;
    }
    EXPECT_EQ((*frame)->index, static_cast<std::int64_t>(times.size()));
    times.push_back((*frame)->time_s);
  }
  EXPECT_FALSE(*(*reader)->Read()) << "the end stays the end";
  ASSERT_EQ(times.size(), test.frames);
  for (std::size_t i = 1; i < times.size(); ++i) {
    // Within the rounding of two stamps.
    EXPECT_NEAR(times[i] - times[i - 1], test.period_s, 3e-5) << "frame " << i;
  }
  EXPECT_EQ(warnings.texts->size(), test.is_damaged ? 1U : 0U);
}

INSTANTIATE_TEST_SUITE_P(All, VideoReaderRealClips,
                         ::testing::Values(RealClip{"video-1.m4v", 494, 1.0 / 30.0, false},
                                           RealClip{"video-3.m4v", 246, 1.0 / 29.0, true},
                                           RealClip{"video-8.m4v", 447, 1.0 / 30.0, true},
                                           RealClip{"video-9.m4v", 572, 1.0 / 30.0, true},
                                           RealClip{"karma.mp4", 362, 1001.0 / 30000.0, false}));

TEST(VideoReader, DescribesARealClip) {
  const auto path = DevelopmentData("clips/karma.mp4");
  if (!path) {
    GTEST_SKIP() << "the development clips are not there";
  }
  const auto reader = VideoReader::Open(path->string(), {});
  ASSERT_TRUE(reader);
  const VideoInfo& info = (*reader)->info();
  EXPECT_EQ(info.width, 854);
  EXPECT_EQ(info.height, 480);
  EXPECT_EQ(info.codec, "h264");
  EXPECT_EQ(info.pixel_format, "yuvj420p");
  EXPECT_TRUE(info.layout.full_range);
  EXPECT_EQ(info.frame_rate, (Rational{30000, 1001}));
  EXPECT_EQ(info.color, (ColorTags{"pc", "bt709", "bt709", "bt709", "left"}));
  EXPECT_EQ(info.audio_streams, 1);
  EXPECT_THAT(info.telemetry_kinds, ElementsAre("tmcd", "gpmd", "fdsc"));
  EXPECT_NEAR(info.duration_s, 12.0787, 1e-3);
}

TEST(VideoReader, DamagedStampsAreRepairedVariableOnesKept) {
  const TemporaryFolder folder;
  ClipRecipe recipe = SmallRecipe();
  recipe.frames = 30;
  ASSERT_TRUE(MakeClip(folder / "a.mp4", recipe));
  RemuxRecipe damage;
  for (int i = 0; i < 30; ++i) {
    damage.video_times.push_back(3000 * i);
  }
  damage.video_times[1] = 9000;
  damage.video_times[2] = 9000;
  damage.video_times[29] += 27000;
  Remux(folder / "a.mp4", folder / "damaged.mp4", damage);
  const Result<Clip> repaired = ReadClip(folder / "damaged.mp4");
  ASSERT_TRUE(repaired) << repaired.error().message;
  EXPECT_TRUE(repaired->info.timestamps_repaired);
  ASSERT_EQ(repaired->frames.size(), 30U);
  for (std::size_t i = 0; i < 30; ++i) {
    EXPECT_NEAR(repaired->frames[i].time_s, static_cast<double>(i) / 30.0, 1e-4) << "frame " << i;
  }

  RemuxRecipe variable;
  std::vector<double> expected;
  for (int i = 0; i < 30; ++i) {
    variable.video_times.push_back(3000 * i + (i > 10 ? 12345 : 0) + (i * 977) % 1500);
    expected.push_back(static_cast<double>(variable.video_times.back()) / 90000.0);
  }
  Remux(folder / "a.mp4", folder / "variable.mp4", variable);
  const Result<Clip> kept = ReadClip(folder / "variable.mp4");
  ASSERT_TRUE(kept);
  EXPECT_FALSE(kept->info.timestamps_repaired);
  EXPECT_TRUE(kept->info.variable_frame_rate);
  for (std::size_t i = 0; i < 30; ++i) {
    EXPECT_NEAR(kept->frames[i].time_s, expected[i], 1e-9) << "frame " << i;
  }
}

TEST(VideoReader, DamagedPacketsAreConcealedAndCounted) {
  const TemporaryFolder folder;
  ClipRecipe recipe = SmallRecipe();
  recipe.frames = 30;
  ASSERT_TRUE(MakeClip(folder / "a.mp4", recipe));
  RemuxRecipe damage;
  damage.garbled_packets = {7, 8, 20};
  Remux(folder / "a.mp4", folder / "damaged.mp4", damage);
  const Warnings warnings = CollectWarnings();
  const Result<Clip> clip = ReadClip(folder / "damaged.mp4", warnings.logger);
  ASSERT_TRUE(clip) << clip.error().message;
  EXPECT_GE(clip->frames.size(), 27U) << "at most the damaged ones are missing";
  EXPECT_THAT(*warnings.texts, ElementsAre(HasSubstr("damaged packets")));
  for (const VideoFrame& frame : clip->frames) {
    EXPECT_NEAR(frame.time_s * 30.0, std::round(frame.time_s * 30.0), 1e-3) << "own times kept";
  }
}

TEST(VideoReader, FilesCutOffGiveWhatTheyHave) {
  const TemporaryFolder folder;
  for (const char* name : {"a.mkv", "a.ts", "a.mp4"}) {
    ClipRecipe recipe = SmallRecipe();
    recipe.frames = 60;
    recipe.options.muxer_options.clear();
    if (std::string(name) == "a.mp4") {
      recipe.options.muxer_options = {{"movflags", "+faststart"}};
    }
    ASSERT_TRUE(MakeClip(folder / name, recipe));
    const std::string bytes = Slurp(folder / name);
    const std::string cut_name = std::string("cut-") + name;
    Spill(folder / cut_name, bytes.substr(0, bytes.size() * 6 / 10));
    const Warnings warnings = CollectWarnings();
    const Result<Clip> clip = ReadClip(folder / cut_name, warnings.logger);
    ASSERT_TRUE(clip) << name << ": " << clip.error().message;
    EXPECT_GT(clip->frames.size(), 5U) << name;
    EXPECT_LT(clip->frames.size(), 60U) << name;
    if (std::string(name) == "a.mp4") {
      EXPECT_FALSE(warnings.texts->empty()) << name;
    }
  }
}

TEST(VideoReader, AnyDamageIsSurvived) {
  const TemporaryFolder folder;
  ClipRecipe recipe = SmallRecipe();
  recipe.frames = 30;
  std::mt19937 random(5);
  for (const char* name : {"a.mp4", "a.mkv", "a.ts"}) {
    ASSERT_TRUE(MakeClip(folder / name, recipe));
    const std::string bytes = Slurp(folder / name);
    for (int run = 0; run < 40; ++run) {
      std::string damaged = bytes;
      for (int k = 0; k < 1 + run; ++k) {
        damaged[random() % damaged.size()] = static_cast<char>(random());
      }
      const std::string damaged_name = std::string("damaged-") + name;
      Spill(folder / damaged_name, damaged);
      const Result<Clip> clip = ReadClip(folder / damaged_name);
      if (clip) {
        const std::vector<std::int64_t> times = clip->Times();
        EXPECT_TRUE(std::adjacent_find(times.begin(), times.end(), std::greater_equal<>()) ==
                    times.end());
      } else {
        EXPECT_FALSE(clip.error().message.empty());
      }
    }
  }
}

TEST(VideoReader, RefusesWhatIsNoVideo) {
  const TemporaryFolder folder;
  EXPECT_EQ(OpenError(folder / "absent.mp4").code, ErrorCode::kNotFound);
  Spill(folder / "empty.mp4", "");
  EXPECT_EQ(OpenError(folder / "empty.mp4").code, ErrorCode::kCorruptData);
  Spill(folder / "letter.mp4", "Dear reader,\nthis is a letter and no film.\n");
  EXPECT_EQ(OpenError(folder / "letter.mp4").code, ErrorCode::kCorruptData);
  std::mt19937 random(1);
  std::string noise(50000, '\0');
  std::generate(noise.begin(), noise.end(), [&random] { return static_cast<char>(random()); });
  Spill(folder / "noise.mp4", noise);
  OpenError(folder / "noise.mp4");
  std::filesystem::create_directory(folder / "folder.mp4");
  EXPECT_THAT(OpenError(folder / "folder.mp4").message, HasSubstr("folder"));
  // A playlist must not lead elsewhere.
  Spill(folder / "list.m3u8", "#EXTM3U\n#EXTINF:1,\nhttp://127.0.0.1:1/a.ts\n#EXT-X-ENDLIST\n");
  OpenError(folder / "list.m3u8");
}

TEST(VideoReader, Mp4WithoutIndexIsExplained) {
  const TemporaryFolder folder;
  ASSERT_TRUE(MakeClip(folder / "a.mp4", SmallRecipe()));
  const std::string bytes = Slurp(folder / "a.mp4");
  Spill(folder / "cut.mp4", bytes.substr(0, bytes.size() / 2));  // the index is at the end
  const Error error = OpenError(folder / "cut.mp4");
  EXPECT_EQ(error.code, ErrorCode::kCorruptData);
  EXPECT_THAT(error.message, HasSubstr("index"));
}

TEST(VideoReader, SoundAloneIsNoVideo) {
  const TemporaryFolder folder;
  std::string wav(
      "RIFF\x24\x08\0\0WAVEfmt \x10\0\0\0\x01\0\x01\0\x40\x1f\0\0\x40\x1f\0\0\x01\0\x08\0data", 40);
  wav += std::string("\0\x08\0\0", 4) + std::string(2048, '\x80');
  Spill(folder / "sound.wav", wav);
  EXPECT_THAT(OpenError(folder / "sound.wav").message, HasSubstr("no video stream"));
}

TEST(VideoReader, HugeClaimedSizeIsRefusedBeforeAllocating) {
  const TemporaryFolder folder;
  ClipRecipe recipe = SmallRecipe();
  recipe.options.codec = "mjpeg";
  ASSERT_TRUE(MakeClip(folder / "a.mov", recipe));
  std::string bytes = Slurp(folder / "a.mov");
  // The sample description: width and height, 16 bits each, 24 bytes after its name 'jpeg' follow
  // data reference, version, vendor and qualities.
  const std::size_t entry = bytes.find("jpeg", bytes.find("stsd"));
  ASSERT_NE(entry, std::string::npos);
  constexpr std::size_t kWidthOffset = 28;
  ASSERT_EQ(static_cast<unsigned char>(bytes[entry + kWidthOffset + 1]), 96U);
  bytes[entry + kWidthOffset] = '\xf0';
  bytes[entry + kWidthOffset + 2] = '\xf0';
  Spill(folder / "huge.mov", bytes);
  const Error error = OpenError(folder / "huge.mov");
  EXPECT_EQ(error.code, ErrorCode::kUnsupported);
  EXPECT_THAT(error.message, HasSubstr("16384"));
}

TEST(VideoReader, NothingDecodableIsAnError) {
  const TemporaryFolder folder;
  ASSERT_TRUE(MakeClip(folder / "a.mp4", SmallRecipe()));
  RemuxRecipe damage;
  for (int i = 0; i < 12; ++i) {
    damage.garbled_packets.push_back(i);
  }
  Remux(folder / "a.mp4", folder / "damaged.mp4", damage);
  const Result<Clip> clip = ReadClip(folder / "damaged.mp4");
  if (!clip) {
    EXPECT_EQ(clip.error().code, ErrorCode::kCorruptData);
  }
}

TEST(VideoReader, FramesOutliveTheReader) {
  const TemporaryFolder folder;
  ASSERT_TRUE(MakeClip(folder / "a.mp4", SmallRecipe()));
  Frame kept;
  {
    auto reader = VideoReader::Open((folder / "a.mp4").string(), {});
    ASSERT_TRUE(reader);
    kept = (*reader)->Read().value()->frame;
  }
  EXPECT_GT(testing::Psnr(kept, testing::TestPicture(kept.layout, 96, 72, 0)), 34.0);
}

TEST(VideoReader, SizeChangeWithinTheClipIsConverted) {
  const TemporaryFolder folder;
  ClipRecipe recipe = SmallRecipe();
  recipe.options.codec = "mjpeg";
  recipe.options.format = "mjpeg";
  ASSERT_TRUE(MakeClip(folder / "a.mjpeg", recipe));
  recipe.description.width = 64;
  recipe.description.height = 64;
  ASSERT_TRUE(MakeClip(folder / "b.mjpeg", recipe));
  Spill(folder / "both.mjpeg", Slurp(folder / "a.mjpeg") + Slurp(folder / "b.mjpeg"));
  const Warnings warnings = CollectWarnings();
  const Result<Clip> clip = ReadClip(folder / "both.mjpeg", warnings.logger);
  ASSERT_TRUE(clip) << clip.error().message;
  ASSERT_EQ(clip->frames.size(), 24U);
  EXPECT_EQ(clip->frames[20].frame.width, 96);
  EXPECT_THAT(*warnings.texts, ::testing::Contains(HasSubstr("64x64")));
}

}  // namespace
}  // namespace rsstab::media
