// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/pipeline/track_spool.h"

#include <gtest/gtest.h>
#include <stdlib.h>

#include <filesystem>
#include <optional>
#include <string>

namespace rsstab::pipeline {
namespace {

namespace fs = std::filesystem;

// Sets TMPDIR for one test.
class TemporaryFolderVariable {
 public:
  explicit TemporaryFolderVariable(const std::string& value) {
    if (const char* before = getenv("TMPDIR")) {
      before_ = before;
    }
    setenv("TMPDIR", value.c_str(), 1);
  }
  ~TemporaryFolderVariable() {
    before_ ? setenv("TMPDIR", before_->c_str(), 1) : unsetenv("TMPDIR");
  }
  TemporaryFolderVariable(const TemporaryFolderVariable&) = delete;
  TemporaryFolderVariable& operator=(const TemporaryFolderVariable&) = delete;

 private:
  std::optional<std::string> before_;
};

FrameObservation Observation(int index) {
  FrameObservation o;
  o.pts = 1000 + index;
  o.time_s = 0.04 * index;
  o.fingerprint[5] = static_cast<std::uint8_t>(index);
  o.attempted_points = 7 * index;
  o.tracks.width = 640;
  o.tracks.height = 360;
  o.tracks.from_time_s = 0.04 * (index - 1);
  o.tracks.to_time_s = 0.04 * index;
  for (int i = 0; i < index; ++i) {  // the first one has none
    const auto x = static_cast<float>(i);
    o.tracks.matches.push_back({{x, 2.0F * x}, {x + 0.25F, 2.0F * x - 0.5F}});
  }
  return o;
}

TEST(TrackSpool, GivesBackWhatWentInAsOftenAsAsked) {
  auto spool = TrackSpool::Create();
  ASSERT_TRUE(spool);
  for (int i = 0; i < 4; ++i) {
    ASSERT_TRUE((*spool)->Append(Observation(i)));
  }
  EXPECT_EQ((*spool)->count(), 4);
  for (int round = 0; round < 2; ++round) {
    ASSERT_TRUE((*spool)->Rewind());
    for (int i = 0; i < 4; ++i) {
      const auto read = (*spool)->Next();
      ASSERT_TRUE(read && *read);
      const FrameObservation expected = Observation(i);
      const FrameObservation& o = **read;
      EXPECT_EQ(o.pts, expected.pts);
      EXPECT_EQ(o.time_s, expected.time_s);
      EXPECT_EQ(o.fingerprint, expected.fingerprint);
      EXPECT_EQ(o.attempted_points, expected.attempted_points);
      EXPECT_EQ(o.tracks.width, expected.tracks.width);
      EXPECT_EQ(o.tracks.height, expected.tracks.height);
      EXPECT_EQ(o.tracks.from_time_s, expected.tracks.from_time_s);
      EXPECT_EQ(o.tracks.to_time_s, expected.tracks.to_time_s);
      ASSERT_EQ(o.tracks.matches.size(), expected.tracks.matches.size());
      for (std::size_t k = 0; k < o.tracks.matches.size(); ++k) {
        EXPECT_EQ(o.tracks.matches[k].from, expected.tracks.matches[k].from);
        EXPECT_EQ(o.tracks.matches[k].to, expected.tracks.matches[k].to);
      }
    }
    const auto end = (*spool)->Next();
    ASSERT_TRUE(end);
    EXPECT_FALSE(*end);
  }
}

TEST(TrackSpool, LiesWhereTmpdirSaysAndHasNoName) {
  const std::string folder = fs::path(::testing::TempDir()) / "track-spool-test";
  fs::create_directories(folder);
  {
    const TemporaryFolderVariable variable(folder);
    const auto spool = TrackSpool::Create();
    ASSERT_TRUE(spool);
    EXPECT_TRUE(fs::is_empty(folder));
  }
  fs::remove_all(folder);
  const TemporaryFolderVariable variable(folder);  // is no more
  const auto spool = TrackSpool::Create();
  ASSERT_FALSE(spool);
  EXPECT_EQ(spool.error().code, ErrorCode::kIo);
  EXPECT_NE(spool.error().message.find("TMPDIR"), std::string::npos);
}

}  // namespace
}  // namespace rsstab::pipeline
