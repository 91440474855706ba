// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <random>

#include "tests/robustness/damage.h"

namespace rsstab::testing {
namespace {

using ::testing::HasSubstr;

using ClipDamage = Damage;

TEST_F(ClipDamage, MissingFile) { ExpectRefusal({"nowhere.mp4"}, 1, "nowhere.mp4"); }

TEST_F(ClipDamage, FolderInsteadOfAFile) {
  std::filesystem::create_directory(Path("folder.mp4"));
  ExpectRefusal({"folder.mp4"}, 1, "folder.mp4");
}

TEST_F(ClipDamage, EmptyFile) {
  WriteText(Path("empty.mp4"), "");
  ExpectRefusal({"empty.mp4"}, 1, "empty.mp4");
}

TEST_F(ClipDamage, TextRenamedToVideo) {
  WriteText(Path("text.mp4"), std::string(5000, 'a') + "\nnot a video\n");
  ExpectRefusal({"text.mp4"}, 1, "text.mp4");
}

TEST_F(ClipDamage, PlaylistThatPointsElsewhere) {
  WriteText(Path("list.m3u8"),
            "#EXTM3U\n#EXT-X-TARGETDURATION:10\n#EXTINF:10,\nfile:///etc/passwd\n");
  ExpectRefusal({"list.m3u8"}, 1, "list.m3u8");
}

TEST_F(ClipDamage, NoVideoStream) {
  // A tenth of a second of silence: 8 kHz, mono, 8 bit.
  std::string wav = "RIFF";
  const auto little = [&wav](std::uint32_t value, int bytes) {
    for (int i = 0; i < bytes; ++i) {
      wav += static_cast<char>(value >> (8 * i));
    }
  };
  little(36 + 800, 4);
  wav += "WAVEfmt ";
  little(16, 4);
  little(1, 2);
  little(1, 2);
  little(8000, 4);
  little(8000, 4);
  little(1, 2);
  little(8, 2);
  wav += "data";
  little(800, 4);
  WriteText(Path("sound.wav"), wav + std::string(800, '\x80'));
  ExpectRefusal({"sound.wav", "-o", "out.mp4"}, 1, "sound.wav");
}

TEST_F(ClipDamage, TruncatedMp4WithoutItsIndex) {
  WriteTestClip(Path("whole.mp4"));
  Bytes bytes = ReadBytes(Path("whole.mp4"));
  bytes.resize(bytes.size() / 2);
  WriteBytes(Path("cut.mp4"), bytes);
  ExpectRefusal({"cut.mp4"}, 1, "cut.mp4");
}

TEST_F(ClipDamage, TruncatedMatroskaKeepsWhatThereIs) {
  WriteTestClip(Path("whole.mkv"));
  Bytes bytes = ReadBytes(Path("whole.mkv"));
  bytes.resize(bytes.size() * 2 / 3);
  WriteBytes(Path("cut.mkv"), bytes);
  ExpectSuccess({"cut.mkv", "-o", "out.mkv"}, "out.mkv", -1);
}

TEST_F(ClipDamage, CorruptedPacketsMidStream) {
  TestClip clip;
  clip.frames = 24;
  WriteTestClip(Path("whole.mkv"), clip);
  const Bytes whole = ReadBytes(Path("whole.mkv"));
  for (const unsigned seed : {1U, 2U, 3U}) {
    std::mt19937 random(seed);
    Bytes bytes = whole;
    for (std::size_t i = bytes.size() / 3; i < bytes.size() * 2 / 3; i += 40) {
      bytes[i] = static_cast<std::uint8_t>(random());
    }
    WriteBytes(Path("damaged.mkv"), bytes);
    const ProgramResult run = Run({"damaged.mkv", "-o", "out.mkv", "--overwrite"});
    EXPECT_EQ(run.exit_code, 0) << run.error;
    EXPECT_GT(CountFrames(Path("out.mkv")), 6);
  }
}

TEST_F(ClipDamage, RandomBytesInEveryContainersClothes) {
  std::mt19937 random(7);
  for (const char* name : {"a.mp4", "a.mkv", "a.avi", "a.ts", "a.webm"}) {
    TestClip clip;
    clip.frames = 3;
    const bool webm = std::string(name) == "a.webm";
    WriteTestClip(Path(webm ? "b.mkv" : name), clip);
    Bytes bytes = ReadBytes(Path(webm ? "b.mkv" : name));
    for (std::uint8_t& byte : bytes) {
      if (random() % 16 == 0) {
        byte = static_cast<std::uint8_t>(random());
      }
    }
    WriteBytes(Path(name), bytes);
    const ProgramResult run = Run({name, "-o", "out.mkv", "--overwrite"});
    EXPECT_TRUE(run.exit_code == 0 || run.exit_code == 1) << name << run.error;
  }
}

TEST_F(ClipDamage, HugeClaimedSizeIsRefusedBeforeMemoryIsAsked) {
  for (const char* size : {"W100000 H100000", "W2000000000 H2", "W0 H16", "W-5 H16"}) {
    WriteText(Path("huge.y4m"),
              std::string("YUV4MPEG2 ") + size + " F30:1 Ip A1:1 C420jpeg\nFRAME\n0123456789");
    ExpectRefusal({"huge.y4m", "-o", "out.mkv"}, 1, "huge.y4m");
  }
}

TEST_F(ClipDamage, LargeClaimedSizeWithoutThePixels) {
  WriteText(Path("large.y4m"), "YUV4MPEG2 W16000 H16000 F30:1 Ip A1:1 C420jpeg\nFRAME\n0123456789");
  ExpectRefusal({"large.y4m", "-o", "out.mkv"}, 1, "large.y4m");
}

TEST_F(ClipDamage, OneAndTwoFrames) {
  for (const int frames : {1, 2, 3}) {
    TestClip clip;
    clip.frames = frames;
    WriteTestClip(Path("short.mp4"), clip);
    ExpectSuccess({"short.mp4", "-o", "out.mp4", "--overwrite"}, "out.mp4", frames);
  }
}

TEST_F(ClipDamage, BlackAndFrozenStretchesHoldStill) {
  TestClip clip;
  clip.shake_px = 0.0;
  WriteTestClip(Path("frozen.mp4"), clip);
  ExpectSuccess({"frozen.mp4", "-o", "out.mp4"}, "out.mp4", clip.frames);
  // Black frames: a y4m needs no encoder.
  std::string black = "YUV4MPEG2 W64 H48 F30:1 Ip A1:1 C420jpeg\n";
  for (int i = 0; i < 5; ++i) {
    black += "FRAME\n" + std::string(64 * 48, '\x10') + std::string(64 * 48 / 2, '\x80');
  }
  WriteText(Path("black.y4m"), black);
  ExpectSuccess({"black.y4m", "-o", "black.mkv"}, "black.mkv", 5);
}

TEST_F(ClipDamage, StandardInputIsNoClipForTwoPasses) { ExpectRefusal({"-"}, 1, "twice"); }

}  // namespace
}  // namespace rsstab::testing
