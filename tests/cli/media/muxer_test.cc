// SPDX-License-Identifier: Apache-2.0
// Copied streams, chapters and metadata, through reader and writer.
#include "cli/media/muxer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "tests/cli/media/media_test_support.h"
#include "tests/support/test_paths.h"

namespace rsstab::media {
namespace {

using ::rsstab::testing::DevelopmentData;
using ::rsstab::testing::TemporaryFolder;
using testing::ClipRecipe;
using testing::CollectWarnings;
using testing::CopyClip;
using ::testing::ElementsAre;
using testing::FileContent;
using ::testing::HasSubstr;
using testing::Inspect;
using ::testing::IsEmpty;
using testing::MakeClip;
using testing::RemuxRecipe;
using testing::SmallRecipe;
using testing::StreamContent;
using testing::Warnings;

// Packets come out byte for byte, and on time: MP4 keeps each track's clock, Matroska rounds to
// milliseconds.
void ExpectSamePackets(const StreamContent& expected, const StreamContent& got,
                       double tolerance_s) {
  EXPECT_EQ(got.codec, expected.codec);
  EXPECT_EQ(got.extradata, expected.extradata);
  ASSERT_EQ(got.packets.size(), expected.packets.size());
  for (std::size_t i = 0; i < got.packets.size(); ++i) {
    EXPECT_EQ(got.packets[i].bytes, expected.packets[i].bytes) << "packet " << i;
    EXPECT_NEAR(got.packets[i].pts_s, expected.packets[i].pts_s, tolerance_s) << "packet " << i;
  }
}

// MP4 fills the time between subtitles with empty texts of two bytes and adds a bit rate to their
// description; libav's muxer does both by itself.
StreamContent WithoutGaps(const StreamContent& stream) {
  StreamContent dense = stream;
  if (stream.type == "subtitle") {
    dense.extradata.clear();
    std::erase_if(dense.packets, [](const auto& packet) { return packet.bytes.size() == 2; });
  }
  return dense;
}

class MuxerTest : public ::testing::Test {
 protected:
  void SetUp() override {
    ClipRecipe recipe = SmallRecipe();
    recipe.frames = 90;
    ASSERT_TRUE(MakeClip(folder_ / "video.mp4", recipe));
  }
  WriterOptions Options() {
    WriterOptions options;
    options.preset = "ultrafast";
    options.logger = warnings_.logger;
    return options;
  }
  void Copy(const std::string& from, const std::string& to) {
    const Result<std::int64_t> frames = CopyClip(folder_ / from, folder_ / to, Options());
    ASSERT_TRUE(frames) << frames.error().message;
    EXPECT_EQ(*frames, 90);
  }

  TemporaryFolder folder_;
  Warnings warnings_ = CollectWarnings();
};

TEST_F(MuxerTest, Mp4KeepsAudioSubtitlesTelemetryChaptersAndMetadata) {
  RemuxRecipe recipe;
  recipe.with_audio = true;
  recipe.subtitle_codec = "mov_text";
  recipe.with_data = true;
  recipe.with_chapters = true;
  recipe.metadata = {{"title", "Harbour"},
                     {"com.apple.quicktime.make", "Phone maker"},
                     {"creation_time", "2024-05-06T07:08:09.000000Z"}};
  Remux(folder_ / "video.mp4", folder_ / "in.mp4", recipe);
  Copy("in.mp4", "out.mp4");
  EXPECT_THAT(*warnings_.texts, IsEmpty());
  const FileContent in = Inspect(folder_ / "in.mp4");
  FileContent out = Inspect(folder_ / "out.mp4");
  for (const char* type : {"audio", "subtitle"}) {
    SCOPED_TRACE(type);
    ASSERT_EQ(out.OfType(type).size(), 1U);
    ExpectSamePackets(WithoutGaps(*in.OfType(type)[0]), WithoutGaps(*out.OfType(type)[0]), 1e-9);
    EXPECT_EQ(out.OfType(type)[0]->metadata.at("language"),
              in.OfType(type)[0]->metadata.at("language"));
  }
  ASSERT_GE(out.OfType("data").size(), 1U);
  EXPECT_EQ(out.OfType("data")[0]->tag, "gpmd");
  ExpectSamePackets(*in.OfType("data")[0], *out.OfType("data")[0], 1e-9);
  EXPECT_EQ(out.chapters, in.chapters);
  ASSERT_EQ(out.chapters.size(), 2U);
  EXPECT_EQ(out.chapters[1].second, "Arrival");
  for (const auto& [key, value] : recipe.metadata) {
    EXPECT_EQ(out.metadata[key], value) << key;
  }
}

TEST_F(MuxerTest, MatroskaKeepsAudioSubtitlesAttachmentsChapters) {
  RemuxRecipe recipe;
  recipe.with_audio = true;
  recipe.subtitle_codec = "subrip";
  recipe.with_attachment = true;
  recipe.with_chapters = true;
  recipe.metadata = {{"title", "Harbour"}, {"SOMETHING", "else"}};
  Remux(folder_ / "video.mp4", folder_ / "in.mkv", recipe);
  Copy("in.mkv", "out.mkv");
  EXPECT_THAT(*warnings_.texts, IsEmpty());
  const FileContent in = Inspect(folder_ / "in.mkv");
  FileContent out = Inspect(folder_ / "out.mkv");
  for (const char* type : {"audio", "subtitle", "attachment"}) {
    SCOPED_TRACE(type);
    ASSERT_EQ(in.OfType(type).size(), 1U);
    ASSERT_EQ(out.OfType(type).size(), 1U);
    ExpectSamePackets(*in.OfType(type)[0], *out.OfType(type)[0], 1e-9);
  }
  EXPECT_EQ(out.OfType("attachment")[0]->metadata.at("filename"), "letters.ttf");
  EXPECT_EQ(out.chapters, in.chapters);
  EXPECT_EQ(out.metadata["SOMETHING"], "else");
}

TEST_F(MuxerTest, WhatTheContainerCannotHoldIsNamed) {
  RemuxRecipe recipe;
  recipe.with_audio = true;
  recipe.subtitle_codec = "subrip";
  recipe.with_attachment = true;
  Remux(folder_ / "video.mp4", folder_ / "in.mkv", recipe);
  Copy("in.mkv", "out.mp4");
  EXPECT_THAT(*warnings_.texts,
              ElementsAre(::testing::AllOf(HasSubstr("subtitle stream 2 (subrip)"),
                                           HasSubstr("attachment stream 3 (ttf)"))));
  const FileContent in = Inspect(folder_ / "in.mkv");
  const FileContent out = Inspect(folder_ / "out.mp4");
  ASSERT_EQ(out.OfType("audio").size(), 1U);
  EXPECT_TRUE(out.OfType("subtitle").empty());
  // Matroska's millisecond clock, rounded to the audio clock of MP4.
  ExpectSamePackets(*in.OfType("audio")[0], *out.OfType("audio")[0], 1e-3);
}

TEST_F(MuxerTest, SoundStaysWithThePicture) {
  RemuxRecipe recipe;
  recipe.with_audio = true;
  for (int i = 0; i < 90; ++i) {
    recipe.video_times.push_back(45000 + 3000 * i);  // the picture begins half a second late
  }
  Remux(folder_ / "video.mp4", folder_ / "in.mp4", recipe);
  for (const char* name : {"out.mp4", "out.mkv", "out.mov"}) {
    Copy("in.mp4", name);
    const FileContent in = Inspect(folder_ / "in.mp4");
    const FileContent out = Inspect(folder_ / name);
    const double in_lead =
        in.OfType("video")[0]->packets[0].pts_s - in.OfType("audio")[0]->packets[0].pts_s;
    const double out_lead =
        out.OfType("video")[0]->packets[0].pts_s - out.OfType("audio")[0]->packets[0].pts_s;
    EXPECT_NEAR(in_lead, 0.5, 1e-3);
    EXPECT_NEAR(out_lead, in_lead, 1e-3) << name;
  }
}

// Encoded sound begins before zero; the picture must not move for it.
TEST_F(MuxerTest, PictureKeepsItsTimeBesideSoundBeforeZero) {
  RemuxRecipe recipe;
  recipe.with_audio = true;
  recipe.audio_start = -1024;
  Remux(folder_ / "video.mp4", folder_ / "in.mp4", recipe);
  for (const char* name : {"out.mp4", "out.mkv"}) {
    Copy("in.mp4", name);
    const FileContent out = Inspect(folder_ / name);
    EXPECT_NEAR(out.OfType("video")[0]->packets[0].pts_s, 0.0, 1e-9) << name;
    // libav does not read the first one's time back from Matroska when the codec does not tell it.
    EXPECT_NEAR(out.OfType("audio")[0]->packets[1].pts_s, 0.0, 5e-4) << name;
    EXPECT_NEAR(out.OfType("audio")[0]->packets[9].pts_s, 8 * 1024.0 / 44100.0, 5e-4) << name;
  }
}

TEST_F(MuxerTest, ConstantRateContainerIsTold) {
  RemuxRecipe recipe;
  for (int i = 0; i < 90; ++i) {
    recipe.video_times.push_back(3000 * i + (i > 40 ? 30000 : 0));
  }
  Remux(folder_ / "video.mp4", folder_ / "in.mp4", recipe);
  Copy("in.mp4", "out.avi");
  EXPECT_THAT(*warnings_.texts, ElementsAre(HasSubstr("constant rate")));
  EXPECT_EQ(testing::ReadClip(folder_ / "out.avi")->frames.size(), 90U);
}

TEST_F(MuxerTest, BroadcastStreamsStartAtZeroElsewhere) {
  ClipRecipe recipe = SmallRecipe();
  recipe.description.time_base = {1, 90000};
  for (int i = 0; i < recipe.frames; ++i) {
    recipe.times.push_back(90000 * 3600 + 3003 * i);
  }
  ASSERT_TRUE(MakeClip(folder_ / "in.ts", recipe));
  ASSERT_EQ(testing::ReadClip(folder_ / "in.ts")->frames.size(), 12U);
  ASSERT_EQ(CopyClip(folder_ / "in.ts", folder_ / "out.mp4", Options()), 12);
  const Result<testing::Clip> out = testing::ReadClip(folder_ / "out.mp4");
  ASSERT_TRUE(out);
  EXPECT_EQ(out->info.start_s, 0.0);
  EXPECT_NEAR(out->frames[11].time_s, 11 * 3003 / 90000.0, 1e-9);
}

TEST_F(MuxerTest, CopyingCanBeSwitchedOff) {
  RemuxRecipe recipe;
  recipe.with_audio = true;
  recipe.with_chapters = true;
  Remux(folder_ / "video.mp4", folder_ / "in.mp4", recipe);
  WriterOptions options = Options();
  options.copy_streams = false;
  ASSERT_TRUE(CopyClip(folder_ / "in.mp4", folder_ / "out.mp4", options));
  const FileContent out = Inspect(folder_ / "out.mp4");
  EXPECT_EQ(out.streams.size(), 1U);
  EXPECT_TRUE(out.chapters.empty());
  EXPECT_THAT(*warnings_.texts, IsEmpty());
}

TEST_F(MuxerTest, WriterMustComeBeforeTheFirstFrame) {
  auto reader = VideoReader::Open((folder_ / "video.mp4").string(), {});
  ASSERT_TRUE(reader);
  ASSERT_TRUE((*reader)->Read());
  const auto writer = VideoWriter::Open((folder_ / "out.mp4").string(), **reader, Options());
  ASSERT_FALSE(writer);
  EXPECT_EQ(writer.error().code, ErrorCode::kInternal);
}

TEST_F(MuxerTest, WriterOutlivesItsSource) {
  RemuxRecipe recipe;
  recipe.with_audio = true;
  Remux(folder_ / "video.mp4", folder_ / "in.mp4", recipe);
  auto reader = VideoReader::Open((folder_ / "in.mp4").string(), {});
  ASSERT_TRUE(reader);
  auto writer = VideoWriter::Open((folder_ / "out.mp4").string(), **reader, Options());
  ASSERT_TRUE(writer);
  std::vector<VideoFrame> frames;
  while (auto frame = (*reader)->Read().value()) {
    frames.push_back(std::move(*frame));
  }
  reader->reset();
  for (const VideoFrame& frame : frames) {
    ASSERT_TRUE((*writer)->Write(frame));
  }
  ASSERT_TRUE((*writer)->Finish());
  const FileContent in = Inspect(folder_ / "in.mp4");
  const FileContent out = Inspect(folder_ / "out.mp4");
  ExpectSamePackets(*in.OfType("audio")[0], *out.OfType("audio")[0], 1e-9);
}

TEST_F(MuxerTest, RealGoProFileKeepsSoundAndTelemetry) {
  const auto karma = DevelopmentData("clips/karma.mp4");
  if (!karma) {
    GTEST_SKIP() << "the development clips are not there";
  }
  ASSERT_EQ(CopyClip(*karma, folder_ / "out.mp4", Options()), 362);
  const FileContent in = Inspect(*karma);
  const FileContent out = Inspect(folder_ / "out.mp4");
  ExpectSamePackets(*in.OfType("audio")[0], *out.OfType("audio")[0], 1e-9);
  EXPECT_EQ(out.OfType("video")[0]->packets.size(), 362U);
  const auto gpmd = [](const FileContent& content) {
    for (const StreamContent* stream : content.OfType("data")) {
      if (stream->tag == "gpmd") {
        return stream;
      }
    }
    return static_cast<const StreamContent*>(nullptr);
  };
  ASSERT_NE(gpmd(out), nullptr);
  ExpectSamePackets(*gpmd(in), *gpmd(out), 1e-9);
}

}  // namespace
}  // namespace rsstab::media
