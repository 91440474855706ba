// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/analysis_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <limits>
#include <span>
#include <string_view>

#include "stabilizer/analysis_format_detail.h"
#include "tests/support/test_paths.h"

namespace rsstab::stabilizer {
namespace {

constexpr int kFrames = 5;

FrameAnalysis SomeFrame(int i) {
  FrameAnalysis frame;
  frame.pts = std::int64_t{1001} * i;
  frame.fingerprint.fill(static_cast<std::uint8_t>(10 * i));
  frame.rung = MotionRung::kMesh;
  frame.path_begins = i == 0;
  frame.crop_ratio = 0.95 - 0.01 * i;
  frame.rectified_from_output(0, 2) = 0.01 * i;
  if (i % 2 == 1) {
    frame.mesh_update = MotionField(640, 360, 17, 17);
    frame.mesh_update.At(3, 4) = {1.5F, -2.25F};
    frame.rs_field = MotionField(640, 360, 9, 33);
    frame.rs_field.At(8, 32) = {-12.5F, 0.125F};
    frame.orientation = {Eigen::Quaterniond(0.5, -0.5, 0.5, 0.5), static_cast<std::uint32_t>(i)};
  }
  return frame;
}

ClipAnalysis SomeClip() {
  ClipAnalysis clip;
  clip.program_version = "1.2.3";
  clip.width = 640;
  clip.height = 360;
  clip.frames_per_second = 29.97;
  clip.rs_source = "gyro";
  clip.rs_reason = "a log\nwith \"quotes\"";
  clip.readout_s = -0.02;
  clip.readout_sigma_s = 0.0005;
  clip.shutter = "rolling";
  clip.focal_px = 500.0;
  clip.focal_sigma_px = 6.0;
  clip.focal_trusted = true;
  clip.rotation_is_known = true;
  clip.gyro_offset_s = 0.125;
  clip.camera = Camera::Pinhole(640, 360, 500.0);
  clip.options = "--smoothness 1";
  return clip;
}

std::filesystem::path WriteSample(const testing::TemporaryFolder& folder) {
  auto path = folder / "clip.rsa";
  auto writer = AnalysisWriter::Create(path.string());
  EXPECT_TRUE(writer);
  for (int i = 0; i < kFrames; ++i) {
    EXPECT_TRUE((*writer)->Append(SomeFrame(i)));
  }
  EXPECT_TRUE((*writer)->Finish(SomeClip()));
  return path;
}

std::string ReadAll(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

TEST(AnalysisFile, RoundTrip) {
  const testing::TemporaryFolder folder;
  auto reader = AnalysisReader::Open(WriteSample(folder).string());
  ASSERT_TRUE(reader) << reader.error().message;
  const ClipAnalysis& clip = (*reader)->clip();
  EXPECT_EQ(clip.num_frames, kFrames);
  EXPECT_NEAR(clip.smallest_crop_ratio, 0.91, 1e-6);
  EXPECT_EQ(clip.rs_reason, SomeClip().rs_reason);
  EXPECT_EQ(clip.readout_s, -0.02);
  EXPECT_EQ(clip.readout_sigma_s, 0.0005);
  EXPECT_EQ(clip.shutter, "rolling");
  EXPECT_EQ(clip.focal_px, 500.0);
  EXPECT_EQ(clip.focal_sigma_px, 6.0);
  EXPECT_TRUE(clip.focal_trusted);
  EXPECT_TRUE(clip.rotation_is_known);
  EXPECT_EQ(clip.gyro_offset_s, 0.125);
  EXPECT_EQ(clip.camera->fx, 500.0);
  for (int i = 0; i < kFrames; ++i) {
    auto frame = (*reader)->Next();
    ASSERT_TRUE(frame && *frame);
    const FrameAnalysis expected = SomeFrame(i);
    EXPECT_EQ((*frame)->pts, expected.pts);
    EXPECT_EQ((*frame)->fingerprint, expected.fingerprint);
    EXPECT_EQ((*frame)->path_begins, expected.path_begins);
    EXPECT_EQ((*frame)->rectified_from_output, expected.rectified_from_output);
    EXPECT_EQ((*frame)->mesh_update.columns(), expected.mesh_update.columns());
    if (i % 2 == 1) {
      EXPECT_NEAR((*frame)->mesh_update.At(3, 4).y(), -2.25F, 1e-4F);
      EXPECT_NEAR((*frame)->rs_field.At(8, 32).x(), -12.5F, 1e-3F);
      EXPECT_EQ((*frame)->rs_field.reference_row(), 179.5);
    }
    ASSERT_EQ((*frame)->orientation.has_value(), i % 2 == 1);
    if (expected.orientation) {
      EXPECT_EQ((*frame)->orientation->camera_from_world.coeffs(),
                expected.orientation->camera_from_world.coeffs());
      EXPECT_EQ((*frame)->orientation->world, expected.orientation->world);
    }
  }
  const auto end = (*reader)->Next();
  ASSERT_TRUE(end);
  EXPECT_FALSE(*end);
}

TEST(AnalysisFile, SummariesFromBeforeTheClipWasCalibratedAreRead) {
  nlohmann::json summary = detail::ToJson(SomeClip());
  for (const char* key : {"readout_sigma_s", "shutter", "focal_px", "focal_sigma_px",
                          "focal_trusted", "rotation_is_known"}) {
    ASSERT_EQ(summary.erase(key), 1U) << key;
  }
  const ClipAnalysis clip = detail::FromJson(summary);
  EXPECT_EQ(clip.readout_s, -0.02);
  EXPECT_EQ(clip.shutter, "");
  EXPECT_EQ(clip.focal_px, 0.0);
  EXPECT_FALSE(clip.rotation_is_known);
}

template <typename T>
T NumberAt(const std::string& bytes, std::size_t offset) {
  T value{};
  std::memcpy(&value, bytes.data() + offset, sizeof value);
  return value;
}

// CRC-32 straight from its definition, bit by bit.
std::uint32_t Crc32(std::string_view bytes) {
  std::uint32_t crc = ~0U;
  for (const char byte : bytes) {
    crc ^= static_cast<std::uint8_t>(byte);
    for (int bit = 0; bit < 8; ++bit) {
      crc = (crc >> 1) ^ ((crc & 1U) != 0 ? 0xEDB88320U : 0U);
    }
  }
  return ~crc;
}

// Every offset below is one of docs/analysis-file.md: a change of layout needs a new format number.
TEST(AnalysisFile, BytesLieWhereTheFormatSays) {
  const testing::TemporaryFolder folder;
  const std::string bytes = ReadAll(WriteSample(folder));
  constexpr std::size_t kHeader = 12;
  constexpr std::size_t kPrefix = 8;
  constexpr std::size_t kFixedPart = 150;
  constexpr std::size_t kFooter = 40;
  constexpr std::size_t kNoField = 4;
  constexpr std::size_t kMesh = 12 + 4 * 17 * 17;
  constexpr std::size_t kRsField = 12 + 4 * 9 * 33;
  constexpr std::size_t kEvenBody = kFixedPart + 2 * kNoField;
  constexpr std::size_t kOrientation = 4 + 4 + 4 * 8;
  constexpr std::size_t kOddBody = kFixedPart + kMesh + kRsField + kOrientation;
  ASSERT_GT(bytes.size(), kHeader + kFooter);
  EXPECT_EQ(bytes.substr(0, kHeader), std::string("RSSTABAN\1\0\0\0", kHeader));

  EXPECT_EQ(NumberAt<std::uint32_t>(bytes, kHeader), kEvenBody);
  const std::size_t record = kHeader + kPrefix + kEvenBody;  // frame 1
  const std::size_t body = record + kPrefix;
  ASSERT_EQ(NumberAt<std::uint32_t>(bytes, record), kOddBody);
  EXPECT_EQ(NumberAt<std::uint32_t>(bytes, record + 4), Crc32(bytes.substr(body, kOddBody)));
  EXPECT_EQ(NumberAt<std::int64_t>(bytes, body), 1001);
  EXPECT_EQ(bytes.substr(body + 8, 64), std::string(64, '\x0A'));
  EXPECT_EQ(bytes[body + 72], 0);  // kMesh
  EXPECT_EQ(bytes[body + 73], 0);  // goes on
  EXPECT_EQ(bytes[kHeader + kPrefix + 73], 1);
  EXPECT_EQ(NumberAt<float>(bytes, body + 74), 0.94F);
  const std::array<double, 9> update = {1.0, 0.0, 0.01, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};
  EXPECT_EQ((NumberAt<std::array<double, 9>>(bytes, body + 78)), update);

  const std::size_t mesh = body + kFixedPart;
  EXPECT_EQ(NumberAt<std::uint16_t>(bytes, mesh), 17);
  EXPECT_EQ(NumberAt<std::uint16_t>(bytes, mesh + 2), 17);
  EXPECT_FLOAT_EQ(NumberAt<float>(bytes, mesh + 4), 2.25F / 32767.0F);
  EXPECT_EQ(NumberAt<float>(bytes, mesh + 8), 179.5F);
  const std::size_t vertex = mesh + 12 + std::size_t{4} * (4 * 17 + 3);
  EXPECT_EQ(NumberAt<std::int16_t>(bytes, vertex), 21845);  // 1.5 / 2.25 * 32767
  EXPECT_EQ(NumberAt<std::int16_t>(bytes, vertex + 2), -32767);
  const std::size_t rs_field = mesh + kMesh;
  EXPECT_EQ(NumberAt<std::uint16_t>(bytes, rs_field), 9);
  EXPECT_EQ(NumberAt<std::uint16_t>(bytes, rs_field + 2), 33);
  const std::size_t orientation = rs_field + kRsField;
  EXPECT_EQ(NumberAt<std::uint16_t>(bytes, orientation), 1);
  EXPECT_EQ(NumberAt<std::uint16_t>(bytes, orientation + 2), 36);
  EXPECT_EQ(NumberAt<std::uint32_t>(bytes, orientation + 4), 1);
  const std::array<double, 4> xyzw = {-0.5, 0.5, 0.5, 0.5};
  EXPECT_EQ((NumberAt<std::array<double, 4>>(bytes, orientation + 8)), xyzw);

  const std::size_t summary = kHeader + kFrames * kPrefix + 3 * kEvenBody + 2 * kOddBody;
  const std::size_t footer = bytes.size() - kFooter;
  EXPECT_EQ(NumberAt<std::uint64_t>(bytes, footer), summary);
  ASSERT_EQ(NumberAt<std::uint64_t>(bytes, footer + 8), footer - summary);
  EXPECT_EQ(bytes[summary], '{');
  EXPECT_EQ(NumberAt<std::uint32_t>(bytes, footer + 16),
            Crc32(bytes.substr(summary, footer - summary)));
  EXPECT_EQ(NumberAt<std::uint64_t>(bytes, footer + 20), kFrames);
  EXPECT_EQ(NumberAt<std::uint32_t>(bytes, footer + 28), Crc32(bytes.substr(footer, 28)));
  EXPECT_EQ(bytes.substr(footer + 32), "RSSTABEN");
  for (const char* key :
       {"program_version", "width", "height", "frames_per_second", "num_frames",
        "smallest_crop_ratio", "fixed_zoom", "smallest_kept_ratio", "mean_kept_ratio", "rs_source",
        "rs_reason", "readout_s", "gyro_offset_s", "camera", "options"}) {
    EXPECT_NE(bytes.find('"' + std::string(key) + '"', summary), std::string::npos) << key;
  }
}

// The optional part of an odd frame, as it is written.
ByteSink OrientationPart() {
  ByteSink sink;
  detail::PutOptionalParts(sink, SomeFrame(1));
  return sink;
}

bool IsRead(const ByteSink& sink, FrameAnalysis& frame) {
  frame = {};
  ByteSource source(sink.bytes());
  return detail::GetOptionalParts(source, frame) && source.remaining() == 0;
}

TEST(AnalysisFileParts, RecordsWithoutAnyAreOldOnesAndFine) {
  ByteSink none;
  detail::PutOptionalParts(none, SomeFrame(0));
  EXPECT_EQ(none.bytes().size(), 0U);
  FrameAnalysis frame;
  EXPECT_TRUE(IsRead(none, frame));
  EXPECT_FALSE(frame.orientation);
}

TEST(AnalysisFileParts, OnesOfLaterProgramsAreSkipped) {
  ByteSink sink;
  sink.Put(std::uint16_t{77});
  sink.Put(std::uint16_t{3});
  sink.Put(std::array<std::uint8_t, 3>{1, 2, 3});
  sink.Put(OrientationPart().bytes());
  sink.Put(std::uint16_t{78});
  sink.Put(std::uint16_t{0});
  FrameAnalysis frame;
  ASSERT_TRUE(IsRead(sink, frame));
  EXPECT_EQ(frame.orientation->world, 1U);
}

TEST(AnalysisFileParts, DamageIsRefused) {
  FrameAnalysis frame;
  const ByteSink good = OrientationPart();
  ASSERT_TRUE(IsRead(good, frame));
  const std::span<const std::uint8_t> bytes = good.bytes();
  for (std::size_t size = 1; size < bytes.size(); ++size) {
    ByteSink cut;
    cut.Put(bytes.first(size));
    EXPECT_FALSE(IsRead(cut, frame)) << size;
  }
  ByteSink twice;
  twice.Put(bytes);
  twice.Put(bytes);
  EXPECT_FALSE(IsRead(twice, frame));
  // Another length, and quaternions that are no rotation.
  constexpr std::size_t kSizeField = 2;
  constexpr std::size_t kQuaternion = 8;
  std::vector<std::uint8_t> changed(bytes.begin(), bytes.end());
  changed[kSizeField] -= 1;
  ByteSink shorter;
  shorter.Put(std::span<const std::uint8_t>(changed));
  EXPECT_FALSE(IsRead(shorter, frame));
  for (const double bad : {0.0, 0.6, std::nan(""), std::numeric_limits<double>::infinity()}) {
    changed.assign(bytes.begin(), bytes.end());
    std::memcpy(changed.data() + kQuaternion, &bad, sizeof bad);
    ByteSink sink;
    sink.Put(std::span<const std::uint8_t>(changed));
    EXPECT_FALSE(IsRead(sink, frame)) << bad;
  }
}

TEST(AnalysisFile, NothingIsLeftWithoutFinish) {
  const testing::TemporaryFolder folder;
  {
    auto writer = AnalysisWriter::Create((folder / "x.rsa").string());
    ASSERT_TRUE(writer);
    ASSERT_TRUE((*writer)->Append(SomeFrame(0)));
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(AnalysisFile, EveryFlippedByteIsNoticed) {
  const testing::TemporaryFolder folder;
  const std::string good = ReadAll(WriteSample(folder));
  const auto damaged_path = folder / "damaged.rsa";
  for (std::size_t i = 0; i < good.size(); i += 7) {
    std::string bytes = good;
    bytes[i] = static_cast<char>(bytes[i] ^ 0x41);
    std::ofstream(damaged_path, std::ios::binary) << bytes;
    auto reader = AnalysisReader::Open(damaged_path.string());
    bool noticed = !reader;
    for (int k = 0; reader && !noticed && k < kFrames; ++k) {
      noticed = !(*reader)->Next();
    }
    EXPECT_TRUE(noticed) << "byte " << i;
  }
}

TEST(AnalysisFile, EveryLengthIsHandled) {
  const testing::TemporaryFolder folder;
  const std::string good = ReadAll(WriteSample(folder));
  const auto cut_path = folder / "cut.rsa";
  for (std::size_t size = 0; size < good.size(); size += 13) {
    std::ofstream(cut_path, std::ios::binary) << good.substr(0, size);
    EXPECT_FALSE(AnalysisReader::Open(cut_path.string())) << size;
  }
}

TEST(AnalysisFile, SaysWhatIsWrong) {
  const testing::TemporaryFolder folder;
  EXPECT_THAT(AnalysisReader::Open("/nowhere/x.rsa").error().message,
              ::testing::HasSubstr("no analysis file"));
  std::ofstream(folder / "text.rsa") << "this is a text file, and not a short one either";
  EXPECT_THAT(AnalysisReader::Open((folder / "text.rsa").string()).error().message,
              ::testing::HasSubstr("is not an analysis file"));
  std::string newer = ReadAll(WriteSample(folder));
  newer[8] = 99;
  std::ofstream(folder / "newer.rsa", std::ios::binary) << newer;
  EXPECT_EQ(AnalysisReader::Open((folder / "newer.rsa").string()).error().code,
            ErrorCode::kUnsupported);
}

}  // namespace
}  // namespace rsstab::stabilizer
