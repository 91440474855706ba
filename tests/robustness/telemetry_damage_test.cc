// SPDX-License-Identifier: Apache-2.0
// Clips with a GoPro telemetry track that has something wrong with it.
#include <gmock/gmock.h>

#include <random>

#include "tests/cli/media/raw_media.h"
#include "tests/robustness/damage.h"
#include "tests/support/gpmf_writer.h"

namespace rsstab::testing {
namespace {

constexpr int kRate = 200;    // samples in a payload that lasts a second
constexpr int kScale = 1000;  // stored values per rad/s

class TelemetryDamage : public Damage {
 protected:
  void SetUp() override {
    TestClip clip;
    clip.frames = 60;  // two seconds
    WriteTestClip(Path("plain.mp4"), clip);
  }

  // A payload of `samples` gyro rows, with `before` in front of its first item.
  static Bytes Payload(int samples, const Bytes& before = {}) {
    std::vector<int> values;
    for (int i = 0; i < samples; ++i) {
      values.insert(values.end(), {i % 7, -20, 10});
    }
    const Bytes stream = KlvNest("STRM", {KlvString("STNM", "Gyroscope (z,x,y)"),
                                          KlvInt16("SCAL", {kScale}), KlvInt16("GYRO", values, 3)});
    return Join(
        {before, KlvNest("DEVC", {KlvUint32("DVID", 1), KlvString("DVNM", "Camera"), stream})});
  }

  void MakeClip(const std::vector<Bytes>& payloads) {
    media::testing::RemuxRecipe recipe;
    recipe.with_data = true;
    recipe.data_packets = payloads;
    media::testing::Remux(Path("plain.mp4"), Path("clip.mp4"), recipe);
  }

  [[nodiscard]] static std::vector<std::string> WithGyro() {
    return {"clip.mp4",      "-o", "out.mp4",   "--overwrite", "--rs",    "gyro",
            "--gyro-offset", "0",  "--readout", "16",          "--focal", "150"};
  }
};

Bytes Noise(std::size_t size, unsigned seed) {
  std::mt19937 random(seed);
  Bytes bytes(size);
  for (std::uint8_t& byte : bytes) {
    byte = static_cast<std::uint8_t>(random());
  }
  return bytes;
}

TEST_F(TelemetryDamage, UndamagedWorks) {
  MakeClip({Payload(kRate), Payload(kRate), Payload(kRate)});
  ExpectSuccess(WithGyro(), "out.mp4", 60);
}

TEST_F(TelemetryDamage, GarbageRowsAtTheStart) {
  MakeClip({Payload(kRate, Noise(64, 1)), Payload(kRate), Payload(kRate)});
  ExpectSuccess(WithGyro(), "out.mp4", 60);
}

TEST_F(TelemetryDamage, LastPayloadClaimsTimePastTheEnd) {
  MakeClip({Payload(kRate), Payload(kRate), Payload(7)});  // 7 samples for a whole second
  ExpectSuccess(WithGyro(), "out.mp4", 60);
}

TEST_F(TelemetryDamage, NothingButNoise) {
  MakeClip({Noise(400, 2), Noise(400, 3)});
  ExpectRefusal(WithGyro(), 1, "clip.mp4");
  // Nobody insists on the gyro: the clip is steadied all the same.
  ExpectSuccess({"clip.mp4", "-o", "out.mp4"}, "out.mp4", 60);
}

TEST_F(TelemetryDamage, PayloadsCutOff) {
  Bytes cut = Payload(kRate);
  cut.resize(cut.size() / 2);
  MakeClip({Payload(kRate), cut, Payload(kRate)});
  const ProgramResult run = Run(WithGyro());
  EXPECT_TRUE(run.exit_code == 0 || run.exit_code == 1) << run.error;
}

TEST_F(TelemetryDamage, AnySingleByteMayBeWrong) {
  const Bytes good = Payload(20);
  for (unsigned seed = 0; seed < 6; ++seed) {
    Bytes bad = good;
    bad[(seed * 37) % good.size()] ^= 0xFF;
    MakeClip({bad, Payload(kRate), Payload(kRate)});
    const ProgramResult run = Run({"info", "clip.mp4"});
    EXPECT_EQ(run.exit_code, 0) << run.error;
  }
}

}  // namespace
}  // namespace rsstab::testing
