// SPDX-License-Identifier: Apache-2.0
#include "igf/gpmf_parser.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <numbers>
#include <random>
#include <sstream>
#include <string>

#include "tests/support/gpmf_writer.h"
#include "tests/support/test_paths.h"

namespace rsstab::igf {
namespace {

using ::rsstab::testing::Bytes;
using ::rsstab::testing::Join;
using ::rsstab::testing::KlvFloats;
using ::rsstab::testing::KlvInt16;
using ::rsstab::testing::KlvNest;
using ::rsstab::testing::KlvRaw;
using ::rsstab::testing::KlvString;
using ::rsstab::testing::KlvUint32;
using ::rsstab::testing::KlvUint64;
using ::testing::HasSubstr;

constexpr int kScale = 1000;
constexpr int kSamplesPerPayload = 200;
constexpr double kExact = 1e-12;

// Channels 1, 2, 3 (times 1/kScale rad/s) plus the sample's number on the first.
std::vector<int> Rows(int count, int first = 0) {
  std::vector<int> values;
  for (int i = 0; i < count; ++i) {
    values.insert(values.end(), {1 + first + i, 2, 3});
  }
  return values;
}

Bytes GyroStream(const std::vector<Bytes>& properties, const Bytes& data) {
  return KlvNest("STRM", {Join(properties), data});
}

Bytes PlainGyroStream(int first = 0, int count = kSamplesPerPayload) {
  return GyroStream({KlvString("STNM", "Gyroscope (z,x,y)"), KlvString("SIUN", "rad/s", true),
                     KlvInt16("SCAL", {kScale})},
                    KlvInt16("GYRO", Rows(count, first), 3));
}

Bytes Device(const std::vector<Bytes>& streams, std::uint32_t id = 1,
             const std::string& name = "Camera") {
  return KlvNest("DEVC", {KlvUint32("DVID", id), KlvString("DVNM", name), Join(streams)});
}

struct Track {
  std::vector<Bytes> bytes;
  std::vector<GpmfPayload> payloads;

  void Add(Bytes payload, double start_s, double duration_s = 1.0) {
    bytes.push_back(std::move(payload));
    payloads.push_back({{}, start_s, duration_s});
    for (std::size_t i = 0; i < bytes.size(); ++i) {
      payloads[i].bytes = bytes[i];
    }
  }
};

// Three payloads of one second each; `make(i)` gives the i-th.
template <typename Make>
Result<GyroRecording> ParseThree(const Make& make, const GyroParseOptions& options = {}) {
  Track track;
  for (int i = 0; i < 3; ++i) {
    track.Add(make(i), i);
  }
  return ParseGpmf(track.payloads, options);
}

Result<GyroRecording> ParseThreeOf(const Bytes& payload) {
  return ParseThree([&](int) { return payload; });
}

Eigen::Vector3d FirstRate(const Result<GyroRecording>& recording) {
  EXPECT_TRUE(recording.has_value()) << (recording ? "" : recording.error().message);
  if (!recording) {
    return Eigen::Vector3d::Zero();
  }
  return recording->gyro.samples().front().rate_rad_s * kScale;
}

// Tolerance for values that are whole after multiplication by kScale.
MATCHER_P3(IsRate, x, y, z, "") { return (arg - Eigen::Vector3d(x, y, z)).norm() < 1e-9; }

bool HasNote(const GyroRecording& recording, const std::string& words) {
  for (const std::string& note : recording.notes) {
    if (note.find(words) != std::string::npos) {
      return true;
    }
  }
  return false;
}

TEST(GpmfParser, ReadsScaleAxesTimeAndName) {
  const auto recording =
      ParseThree([](int i) { return Device({PlainGyroStream(kSamplesPerPayload * i)}); });
  ASSERT_TRUE(recording.has_value()) << recording.error().message;
  EXPECT_EQ(recording->device_name, "Camera");
  EXPECT_FALSE(recording->readout_s.has_value());
  EXPECT_TRUE(recording->notes.empty());
  const auto samples = recording->gyro.samples();
  ASSERT_EQ(samples.size(), 600U);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    EXPECT_NEAR(samples[i].time_s, static_cast<double>(i) / 200.0, 1e-9);
    // Stored Z, X, Y: camera (-2, -1, -3).
    ASSERT_THAT(samples[i].rate_rad_s * kScale, IsRate(-2, -1 - static_cast<double>(i), -3));
  }
}

TEST(GpmfParser, AxisOrderByTagsThenDeviceThenName) {
  const Bytes scale = KlvInt16("SCAL", {kScale});
  const Bytes data = KlvInt16("GYRO", Rows(kSamplesPerPayload), 3);
  const Bytes hero5_name = KlvString("STNM", "Gyroscope (z,x,y)");
  const std::vector<float> mtrx = {0, 0, 1, 0, -1, 0, 1, 0, 0};

  // (c0, c1, c2) = (Y, -X, Z): camera (-X, -Z, -Y) = (c1, -c2, -c0).
  for (const bool one_row : {false, true}) {
    EXPECT_THAT(FirstRate(ParseThreeOf(Device({GyroStream(
                    {scale, KlvString("ORIN", "YxZ", one_row), KlvString("ORIO", "ZXY", one_row)},
                    data)}))),
                IsRate(2, -3, -1));
  }
  for (const int columns : {1, 9}) {
    EXPECT_THAT(FirstRate(ParseThreeOf(Device({GyroStream(
                    {scale, KlvFloats("MTRX", mtrx, columns), KlvString("ORIO", "ZXY")}, data)}))),
                IsRate(2, -3, -1));
    EXPECT_THAT(FirstRate(ParseThreeOf(
                    Device({GyroStream({scale, KlvFloats("MTRX", mtrx, columns)}, data)}))),
                IsRate(2, -3, -1));
  }
  // A matrix of noughts is no matrix; ORIN then decides.
  EXPECT_THAT(FirstRate(ParseThreeOf(Device({GyroStream(
                  {scale, KlvFloats("MTRX", std::vector<float>(9, 0.0F)), KlvString("ORIN", "ZXY")},
                  data)}))),
              IsRate(-2, -1, -3));
  // HERO6 and Fusion carry the HERO5's stream name; GoPro documents Y,-X,Z and -Y,X,Z.
  const Bytes named = GyroStream({scale, hero5_name}, data);
  EXPECT_THAT(FirstRate(ParseThreeOf(Device({named}, 1, "Hero6 Black"))), IsRate(2, -3, -1));
  EXPECT_THAT(FirstRate(ParseThreeOf(Device({named}, 1, "Fusion"))), IsRate(-2, -3, 1));
  EXPECT_THAT(FirstRate(ParseThreeOf(Device({named}))), IsRate(-2, -1, -3));
  EXPECT_THAT(FirstRate(ParseThreeOf(
                  Device({GyroStream({scale, KlvString("STNM", "Gyroscope (-y, x, z)")}, data)}))),
              IsRate(-2, -3, 1));
  // Nothing told: the usual order, and a word about it.
  const auto silent = ParseThreeOf(Device({GyroStream({scale}, data)}));
  EXPECT_THAT(FirstRate(silent), IsRate(-2, -1, -3));
  EXPECT_TRUE(HasNote(*silent, "Z, X, Y is assumed"));

  GyroParseOptions options;
  options.camera_from_sensor = Eigen::Matrix3d::Identity();
  EXPECT_THAT(FirstRate(ParseThree([&](int) { return Device({named}); }, options)),
              IsRate(1, 2, 3));
}

TEST(GpmfParser, ScalePerChannelTypesAndUnits) {
  const Bytes order = KlvString("ORIN", "ZXY");
  const Bytes data = KlvInt16("GYRO", Rows(kSamplesPerPayload), 3);
  EXPECT_THAT(FirstRate(ParseThreeOf(
                  Device({GyroStream({order, KlvInt16("SCAL", {1000, 500, 250})}, data)}))),
              IsRate(-4, -1, -12));
  EXPECT_THAT(FirstRate(ParseThreeOf(Device({GyroStream(
                  {order, KlvString("SIUN", "deg/s"), KlvInt16("SCAL", {kScale})}, data)}))) *
                  (180.0 / std::numbers::pi),
              IsRate(-2, -1, -3));
  std::vector<float> floats;
  for (int i = 0; i < kSamplesPerPayload; ++i) {
    floats.insert(floats.end(), {0.5F, 0.25F, 0.125F});
  }
  EXPECT_THAT(FirstRate(ParseThreeOf(Device(
                  {GyroStream({order, KlvInt16("SCAL", {1})}, KlvFloats("GYRO", floats, 3))}))),
              IsRate(-250, -500, -125));
  // The same rows as a structure described by TYPE, spelled out and as an array.
  const Bytes raw = KlvInt16("GYRO", Rows(kSamplesPerPayload), 3);
  const Bytes complex_data =
      KlvRaw("GYRO", '?', 6, kSamplesPerPayload, Bytes(raw.begin() + 8, raw.end()));
  for (const std::string type : {"sss", "s[3]"}) {
    EXPECT_THAT(FirstRate(ParseThreeOf(Device({GyroStream(
                    {order, KlvString("TYPE", type), KlvInt16("SCAL", {kScale})}, complex_data)}))),
                IsRate(-2, -1, -3));
  }
}

TEST(GpmfParser, RefusesAGyroWithoutAUsableScale) {
  const Bytes data = KlvInt16("GYRO", Rows(kSamplesPerPayload), 3);
  for (const Bytes& scale :
       {Bytes{}, KlvInt16("SCAL", {0}), KlvInt16("SCAL", {1, 2}), KlvString("SCAL", "four")}) {
    const auto recording = ParseThreeOf(Device({GyroStream({scale}, data)}));
    ASSERT_FALSE(recording.has_value());
    EXPECT_THAT(recording.error().message, HasSubstr("SCAL"));
  }
}

TEST(GpmfParser, TakesTheCameraNotTheDrone) {
  const Bytes drone = Device(
      {GyroStream({KlvInt16("SCAL", {kScale})}, KlvInt16("GYRO", std::vector<int>(600, 77), 3))},
      16835857, "GoPro Karma v1.0");
  const Bytes camera = Device({PlainGyroStream()});
  for (const Bytes& payload : {Join({camera, drone}), Join({drone, camera})}) {
    const auto recording = ParseThreeOf(payload);
    EXPECT_THAT(FirstRate(recording), IsRate(-2, -1, -3));
    EXPECT_EQ(recording->device_name, "Camera");
  }
}

TEST(GpmfParser, LastPayloadThatClaimsTooMuchDoesNotBendTheRate) {
  Track track;
  for (int i = 0; i < 12; ++i) {
    track.Add(Device({PlainGyroStream()}), i);
  }
  track.Add(Device({PlainGyroStream(0, 14)}), 12.0, 1.0);
  const auto recording = ParseGpmf(track.payloads);
  ASSERT_TRUE(recording.has_value()) << recording.error().message;
  EXPECT_NEAR(recording->gyro.mean_rate_hz(), 200.0, 1e-6);
  EXPECT_NEAR(recording->gyro.end_s(), 12.0 + 13.0 / 200.0, 1e-9);
}

TEST(GpmfParser, StampsTellTheRateAndTheTrackTheOrigin) {
  // The sensor runs at 202 Hz by its stamps; the track's times jitter by a packet of 4 samples.
  constexpr double kRate_hz = 202.0;
  Track track;
  double first = 0.0;
  for (int i = 0; i < 20; ++i) {
    const int count = i % 2 == 0 ? 200 : 204;
    const auto stamp_us = static_cast<std::uint64_t>(82'006'526.0 + first / kRate_hz * 1e6);
    track.Add(Device({GyroStream({KlvUint64("STMP", stamp_us), KlvInt16("SCAL", {kScale})},
                                 KlvInt16("GYRO", Rows(count), 3))}),
              first / kRate_hz + (i % 2 == 0 ? 0.0 : 0.01));
    first += count;
  }
  const auto recording = ParseGpmf(track.payloads);
  ASSERT_TRUE(recording.has_value()) << recording.error().message;
  EXPECT_NEAR(recording->gyro.mean_rate_hz(), kRate_hz, 1e-3);  // stamps are whole microseconds
  EXPECT_NEAR(recording->gyro.start_s(), 0.0, 0.011);
}

TEST(GpmfParser, StampsThatContradictTheTrackAreLeftOut) {
  const auto recording = ParseThree([](int i) {
    return Device({GyroStream(
        {KlvUint64("STMP", static_cast<std::uint64_t>(i) * 100), KlvInt16("SCAL", {kScale})},
        KlvInt16("GYRO", Rows(200), 3))});
  });
  ASSERT_TRUE(recording.has_value());
  EXPECT_NEAR(recording->gyro.mean_rate_hz(), 200.0, 1e-6);
  EXPECT_TRUE(HasNote(*recording, "contradict"));
}

TEST(GpmfParser, ALostPayloadLeavesAGap) {
  Track track;
  for (const int i : {0, 1, 2, 3, 5, 6, 7, 8, 9}) {
    track.Add(Device({GyroStream({KlvUint32("TSMP", static_cast<std::uint32_t>(200 * (i + 1))),
                                  KlvInt16("SCAL", {kScale})},
                                 KlvInt16("GYRO", Rows(200), 3))}),
              i);
  }
  const auto recording = ParseGpmf(track.payloads);
  ASSERT_TRUE(recording.has_value()) << recording.error().message;
  ASSERT_EQ(recording->gyro.gaps().size(), 1U);
  EXPECT_NEAR(recording->gyro.gaps()[0].begin_s, 4.0 - 1.0 / 200.0, 1e-9);
  EXPECT_NEAR(recording->gyro.gaps()[0].end_s, 5.0, 1e-9);
}

TEST(GpmfParser, ACountThatMakesNoSenseIsReplacedByCounting) {
  for (const std::uint32_t wrong : {0U, 5U, 4'000'000'000U}) {
    const auto recording = ParseThree([&](int i) {
      return Device({GyroStream(
          {KlvUint32("TSMP", i == 1 ? wrong : 200U * (i + 1U)), KlvInt16("SCAL", {kScale})},
          KlvInt16("GYRO", Rows(200), 3))});
    });
    ASSERT_TRUE(recording.has_value()) << recording.error().message;
    EXPECT_NEAR(recording->gyro.mean_rate_hz(), 200.0, 1e-6) << wrong;
  }
}

TEST(GpmfParser, DelayMovesSamplesBack) {
  const auto recording = ParseThree([](int) {
    return Device({GyroStream({KlvFloats("TIMO", {0.25F}), KlvInt16("SCAL", {kScale})},
                              KlvInt16("GYRO", Rows(200), 3))});
  });
  ASSERT_TRUE(recording.has_value());
  EXPECT_NEAR(recording->gyro.start_s(), -0.25, 1e-9);
}

TEST(GpmfParser, ReadoutTimeIsTheMedianOfSrot) {
  const Bytes readout = KlvNest("STRM", {KlvFloats("SROT", {8.015F, 8.015F, 8.016F, 0.0F, 9e9F})});
  const auto recording = ParseThreeOf(Device({PlainGyroStream(), readout}));
  ASSERT_TRUE(recording.has_value());
  ASSERT_TRUE(recording->readout_s.has_value());
  EXPECT_NEAR(*recording->readout_s, 8.015e-3, 1e-8);
}

TEST(GpmfParser, OddButLegalStreams) {
  const Bytes empty_stream = KlvNest("STRM", {KlvUint32("TICK", 0), KlvString("STNM", "3A STATS")});
  const Bytes faces =
      KlvNest("STRM", {KlvString("TYPE", "Lffff"), KlvRaw("FACE", '?', 20, 0, {}),
                       KlvRaw("FACE", '?', 20, 0, {}), KlvRaw("FACE", '?', 20, 1, Bytes(20))});
  const Bytes nested_faces = KlvNest(
      "STRM", {KlvNest("FACE", {KlvUint32("TICK", 1), KlvRaw("GYRO", 's', 6, 1, Bytes(6))})});
  const Bytes no_samples = KlvNest("STRM", {KlvInt16("SCAL", {1}), KlvRaw("GYRO", 's', 6, 0, {})});
  const Bytes split =
      GyroStream({KlvInt16("SCAL", {kScale})},
                 Join({KlvInt16("GYRO", Rows(100), 3), KlvRaw("GYRO", 's', 6, 0, {}),
                       KlvInt16("GYRO", Rows(100, 100), 3)}));
  const auto recording = ParseThreeOf(
      Join({Device({KlvNest("STRM", {}), empty_stream, faces, nested_faces, no_samples, split}),
            KlvNest("DEVC", {}), Bytes(12, 0)}));
  ASSERT_TRUE(recording.has_value()) << recording.error().message;
  EXPECT_EQ(recording->gyro.samples().size(), 600U);
  EXPECT_THAT(recording->gyro.samples()[150].rate_rad_s * kScale, IsRate(-2, -151, -3));
  EXPECT_FALSE(HasNote(*recording, "damaged"));
  EXPECT_FALSE(HasNote(*recording, "not GPMF"));
}

TEST(GpmfParser, SkipsGarbageBeforeTheFirstDevice) {
  std::mt19937 random(1);
  Bytes garbage(301);
  for (auto& byte : garbage) {
    byte = static_cast<std::uint8_t>(random());
  }
  const auto recording = ParseThreeOf(Join({garbage, Device({PlainGyroStream()})}));
  EXPECT_THAT(FirstRate(recording), IsRate(-2, -1, -3));
  EXPECT_TRUE(HasNote(*recording, "903 bytes"));
}

TEST(GpmfParser, DropsUnreadableSamplesAtTheStart) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const auto recording = ParseThree([&](int i) {
    std::vector<float> values(600, 0.5F);
    if (i == 0) {
      values[0] = values[3] = nan;
      values[7] = 1e30F;
    }
    return Device({GyroStream({KlvInt16("SCAL", {1})}, KlvFloats("GYRO", values, 3))});
  });
  ASSERT_TRUE(recording.has_value()) << recording.error().message;
  EXPECT_EQ(recording->gyro.samples().size(), 597U);
  EXPECT_NEAR(recording->gyro.start_s(), 3.0 / 200.0, 1e-9);
  EXPECT_TRUE(HasNote(*recording, "3 unreadable"));
}

TEST(GpmfParser, RefusesNanInTheMiddle) {
  const auto recording = ParseThree([&](int i) {
    std::vector<float> values(600, 0.5F);
    if (i == 1) {
      values[30] = std::numeric_limits<float>::quiet_NaN();
    }
    return Device({GyroStream({KlvInt16("SCAL", {1})}, KlvFloats("GYRO", values, 3))});
  });
  ASSERT_FALSE(recording.has_value());
  EXPECT_THAT(recording.error().message, HasSubstr("gyro sample 210"));
}

TEST(GpmfParser, KeepsWholeRowsOfATruncatedPayload) {
  Track track;
  track.Add(Device({PlainGyroStream()}), 0.0);
  track.Add(Device({PlainGyroStream()}), 1.0);
  Bytes cut = Device({PlainGyroStream()});
  cut.erase(cut.end() - 605, cut.end());  // in the middle of a row; a row is 6 bytes
  track.Add(cut, 2.0);
  const auto recording = ParseGpmf(track.payloads);
  ASSERT_TRUE(recording.has_value()) << recording.error().message;
  EXPECT_EQ(recording->gyro.samples().size(), 400U + (1200U - 605U) / 6U);
  EXPECT_TRUE(HasNote(*recording, "cut-off"));
}

TEST(GpmfParser, LengthsBeyondTheContainerDoNotReachIntoTheNext) {
  // A GYRO that claims more rows than its stream holds would read the next stream as rates.
  const Bytes rows = KlvInt16("GYRO", Rows(10), 3);
  const Bytes liar =
      KlvNest("STRM", {KlvInt16("SCAL", {kScale}),
                       KlvRaw("GYRO", 's', 6, 150, Bytes(rows.begin() + 8, rows.end()))});
  const auto recording = ParseThreeOf(Device({liar, PlainGyroStream()}));
  EXPECT_THAT(FirstRate(recording), IsRate(-2, -1, -3));
  EXPECT_EQ(recording->gyro.samples().size(), 600U);
  EXPECT_TRUE(HasNote(*recording, "damaged"));
}

TEST(GpmfParser, AContainerThatClaimsTooMuchLosesNoNeighbour) {
  const Bytes gyro = PlainGyroStream();
  const Bytes long_stream = KlvNest("STRM", {KlvUint32("TICK", 1)}, 60000);
  EXPECT_THAT(FirstRate(ParseThreeOf(Device({long_stream, gyro}))), IsRate(-2, -1, -3));
  const Bytes long_device = KlvNest("DEVC", {KlvUint32("DVID", 9)}, 60000);
  EXPECT_THAT(FirstRate(ParseThreeOf(Join({long_device, Device({gyro})}))), IsRate(-2, -1, -3));
}

TEST(GpmfParser, SurvivesADepthBomb) {
  for (const std::string_view key : {"DEVC", "STRM", "FACE"}) {
    Bytes bomb;
    for (int i = 0; i < 100000; ++i) {
      const Bytes header = KlvRaw(key, '\0', 255, 65535, {});
      bomb.insert(bomb.end(), header.begin(), header.end());
    }
    const auto recording = ParseThreeOf(bomb);
    ASSERT_FALSE(recording.has_value());
    EXPECT_THAT(recording.error().message, HasSubstr("no gyro"));
    // Behind the bomb in the same payload, a device is still found unless an item swallowed it.
    if (key != "FACE") {
      EXPECT_THAT(FirstRate(ParseThreeOf(Join({bomb, Device({PlainGyroStream()})}))),
                  IsRate(-2, -1, -3));
    }
  }
}

TEST(GpmfParser, RefusesPayloadsWithoutUsableTime) {
  const Bytes payload = Device({PlainGyroStream()});
  Track same;
  same.Add(payload, 0.0);
  same.Add(payload, 0.0);
  EXPECT_THAT(ParseGpmf(same.payloads).error().message, HasSubstr("timestamps"));
  Track single;
  single.Add(payload, 0.0, -1.0);
  EXPECT_THAT(ParseGpmf(single.payloads).error().message, HasSubstr("duration"));
  single.payloads[0].start_s = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(ParseGpmf(single.payloads).error().message, HasSubstr("payload 0"));
  EXPECT_THAT(ParseGpmf({}).error().message, HasSubstr("no gyro"));
}

TEST(GpmfParser, ASinglePayloadSpreadsOverItsDuration) {
  for (const double duration_s : {2.0, 0.0}) {
    Track track;
    track.Add(Device({PlainGyroStream()}), 3.0, duration_s);
    const auto recording = ParseGpmf(track.payloads);
    ASSERT_TRUE(recording.has_value()) << recording.error().message;
    EXPECT_NEAR(recording->gyro.start_s(), 3.0, kExact);
    EXPECT_NEAR(recording->gyro.mean_rate_hz(), duration_s > 0.0 ? 100.0 : 200.0 / 1.001, 1e-6);
    EXPECT_TRUE(HasNote(*recording, "single telemetry payload"));
  }
}

TEST(GpmfParser, SplitsWhereADeviceAppearsAgain) {
  const Bytes camera = Device({PlainGyroStream()});
  const Bytes drone = Device({}, 7, "drone");
  const Bytes file = Join({Bytes(5, 0xee), camera, drone, camera, drone, camera});
  const auto payloads = SplitGpmfPayloads(file);
  ASSERT_EQ(payloads.size(), 3U);
  EXPECT_EQ(payloads[0].bytes.data(), file.data() + 5);
  EXPECT_EQ(payloads[0].bytes.size(), camera.size() + drone.size());
  EXPECT_EQ(payloads[2].bytes.size(), camera.size());
  EXPECT_NEAR(payloads[2].start_s, 2.002, kExact);
  EXPECT_TRUE(SplitGpmfPayloads({}).empty());
  EXPECT_TRUE(SplitGpmfPayloads(Bytes(100, 'D')).empty());
}

// ---- Damage at random: never a crash, a hang or a sample that is not a number.

void ExpectSane(const Bytes& file) {
  const auto recording = ParseGpmf(SplitGpmfPayloads(file));
  if (!recording) {
    EXPECT_FALSE(recording.error().message.empty());
    return;
  }
  for (const GyroSample& sample : recording->gyro.samples()) {
    ASSERT_TRUE(std::isfinite(sample.time_s) && sample.rate_rad_s.allFinite());
  }
}

void Torture(const Bytes& file, int rounds, unsigned seed) {
  std::mt19937 random(seed);
  for (int round = 0; round < rounds; ++round) {
    Bytes damaged = file;
    if (round % 3 == 0) {
      damaged.resize(random() % (damaged.size() + 1));
    }
    const unsigned flips = round % 3 == 1 ? 1 : random() % 64;
    for (unsigned i = 0; i < flips && !damaged.empty(); ++i) {
      damaged[random() % damaged.size()] = static_cast<std::uint8_t>(random());
    }
    ExpectSane(damaged);
  }
}

TEST(GpmfParserDamage, SyntheticPayloads) {
  const Bytes payload = Join(
      {Device({PlainGyroStream(0, 20), KlvNest("STRM", {KlvFloats("SROT", {8.0F, 8.0F})})}),
       Device(
           {KlvNest("STRM", {KlvString("TYPE", "f[2]L"), KlvRaw("ABCD", '?', 12, 1, Bytes(12))})},
           5, "other")});
  const Bytes file = Join({payload, payload, payload});
  for (std::size_t length = 0; length < file.size(); ++length) {
    ExpectSane(Bytes(file.begin(), file.begin() + static_cast<std::ptrdiff_t>(length)));
  }
  Torture(file, 2000, 42);
}

// ---- Real files.

Bytes ReadAll(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return Bytes(std::istreambuf_iterator<char>(in), {});
}

#define SKIP_WITHOUT(variable, name)                                  \
  const auto variable = ::rsstab::testing::DevelopmentData(name);     \
  if (!variable) {                                                    \
    GTEST_SKIP() << "development data " << (name) << " is not there"; \
  }

TEST(GpmfParserDamage, RealPayloads) {
  SKIP_WITHOUT(folder, "gyro");
  unsigned seed = 1;
  for (const char* name : {"hero5.raw", "hero6.raw", "karma.raw", "hero7.raw", "Fusion.raw"}) {
    Torture(ReadAll(*folder / name), 150, seed++);
  }
}

struct RawCase {
  const char* file;
  const char* device;
  std::size_t samples;
  int scale;
  Eigen::Vector3d first;  // stored integers of the first sample turned to camera axes
};

TEST(GpmfParserRealFiles, RawPayloads) {
  SKIP_WITHOUT(folder, "gyro");
  const std::vector<RawCase> cases = {
      {"hero5.raw", "Camera", 399, 3755, {-153, -185, -105}},
      {"karma.raw", "Camera", 392, 3755, {-70, -172, -125}},
      {"hero6.raw", "Hero6 Black", 204, 1878, {-345, 508, 1211}},
      {"hero7.raw", "Hero7 Black", 3369, 1878, {2897, -631, -3478}},
      {"Fusion.raw", "Fusion", 3300, 939, {-312, 432, -249}},
  };
  for (const RawCase& c : cases) {
    const Bytes file = ReadAll(*folder / c.file);
    const auto recording = ParseGpmf(SplitGpmfPayloads(file));
    ASSERT_TRUE(recording.has_value()) << c.file << ": " << recording.error().message;
    EXPECT_EQ(recording->device_name, c.device);
    EXPECT_EQ(recording->gyro.samples().size(), c.samples) << c.file;
    EXPECT_LT((recording->gyro.samples()[0].rate_rad_s * c.scale - c.first).norm(), 1e-9) << c.file;
  }
}

TEST(GpmfParserRealFiles, Hero7TellsItsReadoutTime) {
  SKIP_WITHOUT(path, "gyro/hero7.raw");
  const Bytes file = ReadAll(*path);
  const auto payloads = SplitGpmfPayloads(file);
  EXPECT_EQ(payloads.size(), 17U);
  const auto recording = ParseGpmf(payloads);
  ASSERT_TRUE(recording.has_value()) << recording.error().message;
  ASSERT_TRUE(recording->readout_s.has_value());
  EXPECT_NEAR(*recording->readout_s, 8.015e-3, 2e-6);
}

// karma.mp4 against values that GoPro's own reader decoded. Its payloads lie in the file whole, so
// finding them needs no demuxer; the container times them at multiples of 1.001 s, the nominal one.
TEST(GpmfParserRealFiles, KarmaEqualsTheDecodedLog) {
  SKIP_WITHOUT(clip, "clips/karma.mp4");
  SKIP_WITHOUT(csv, "gyro/karma_gyro.csv");
  const Bytes file = ReadAll(*clip);
  const auto payloads = SplitGpmfPayloads(file);
  ASSERT_EQ(payloads.size(), 13U);
  const auto recording = ParseGpmf(payloads);
  ASSERT_TRUE(recording.has_value()) << recording.error().message;
  EXPECT_EQ(recording->device_name, "Camera");
  const auto samples = recording->gyro.samples();
  ASSERT_EQ(samples.size(), 4795U);

  std::ifstream in(*csv);
  std::string line;
  std::getline(in, line);
  double worst_time_s = 0.0;
  double worst_rate = 0.0;
  for (const GyroSample& sample : samples) {
    ASSERT_TRUE(std::getline(in, line));
    std::istringstream row(line);
    double t = 0.0;
    double g[3] = {};
    char comma = 0;
    ASSERT_TRUE(row >> t >> comma >> g[0] >> comma >> g[1] >> comma >> g[2]);
    worst_time_s = std::max(worst_time_s, std::abs(sample.time_s - t));
    worst_rate =
        std::max(worst_rate,
                 (sample.rate_rad_s - Eigen::Vector3d(-g[1], -g[0], -g[2])).cwiseAbs().maxCoeff());
  }
  RecordProperty("worst_time_s", std::to_string(worst_time_s));
  RecordProperty("worst_rate_rad_s", std::to_string(worst_rate));
  EXPECT_LT(worst_time_s, 1e-6);  // the file has six decimals
  EXPECT_LT(worst_rate, 1e-8);    // and nine
  EXPECT_NEAR(recording->gyro.mean_rate_hz(), 397.18059, 1e-4);
  EXPECT_NEAR(recording->gyro.start_s(), 0.0083407, 1e-6);
}

}  // namespace
}  // namespace rsstab::igf
