// SPDX-License-Identifier: Apache-2.0
// The plugin inside MLT, which is inside Kdenlive, Shotcut and Flowblade.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "tests/plugin/frei0r/host_programs.h"

namespace rsstab::frei0r::testing {
namespace {

constexpr double kSameFrames_db = 45.0;  // the way to RGB and back
// Some stretches of a clip hold more detail for RGB to lose; a neighbouring frame is below 35.
constexpr double kSameFewFrames_db = 42.0;
constexpr int kWidth = 320;
constexpr int kHeight = 240;
constexpr int kFrames = 40;

class MeltTest : public HostPrograms {
 protected:
  // A project with one clip, from frame `in` on, and the effect on it.
  std::string WriteProject(int in, const std::string& properties) {
    std::ofstream(Path("project.mlt"))
        << "<?xml version=\"1.0\"?>\n<mlt>\n"
        << "<profile width=\"" << kWidth << "\" height=\"" << kHeight
        << "\" progressive=\"1\" sample_aspect_num=\"1\" sample_aspect_den=\"1\" "
           "display_aspect_num=\"4\" display_aspect_den=\"3\" frame_rate_num=\"30\" "
           "frame_rate_den=\"1\" colorspace=\"601\"/>\n"
        << "<producer id=\"clip\" in=\"" << in << "\" out=\"" << kFrames - 1 << "\">\n"
        << "<property name=\"resource\">" << Path("clip.mkv") << "</property>\n"
        << "<filter><property name=\"mlt_service\">frei0r.rsstabilize</property>" << properties
        << "</filter>\n</producer>\n"
        << "<playlist id=\"track\"><entry producer=\"clip\" in=\"" << in << "\" out=\""
        << kFrames - 1 << "\"/></playlist>\n</mlt>\n";
    return Path("project.mlt");
  }

  std::string Render(const std::string& project, int threads) {
    return Melt({project, "-progress2", "-consumer", "avformat:" + Path("out.mkv"), "vcodec=ffv1",
                 "pix_fmt=yuv420p", "an=1", "real_time=-" + std::to_string(threads)});
  }

  static std::string Property(const std::string& name, const std::string& value) {
    return "<property name=\"" + name + "\">" + value + "</property>";
  }
};

TEST_F(MeltTest, AProjectGivesTheProgramsFrames) {
  RSSTAB_NEEDS_MELT();
  MakeClip("clip", kWidth, kHeight, kFrames);
  const std::string said = Render(WriteProject(0, Property("0", Path("clip.rsstab"))), 1);
  EXPECT_EQ(CountOf(said, "rsstabilize:"), 0) << said;
  EXPECT_GT(Psnr(Path("out.mkv"), Path("clip-cli.mkv")), kSameFrames_db);
}

TEST_F(MeltTest, ATrimmedClipOnSeveralThreadsDoesToo) {
  RSSTAB_NEEDS_MELT();
  MakeClip("clip", kWidth, kHeight, kFrames);
  const std::string said =
      Render(WriteProject(9, Property("Analysis file", Path("clip.rsstab"))), 3);
  EXPECT_EQ(CountOf(said, "rsstabilize:"), 0) << said;
  Filter(Path("clip-cli.mkv"), "trim=start_frame=9,setpts=PTS-STARTPTS", Path("expected.mkv"));
  EXPECT_GT(Psnr(Path("out.mkv"), Path("expected.mkv")), kSameFewFrames_db);
}

TEST_F(MeltTest, LiveModeGivesWhatFFmpegGives) {
  RSSTAB_NEEDS_MELT();
  MakeClip("clip", kWidth, kHeight, kFrames);
  const std::string said = Render(WriteProject(0, Property("Smoothness", "0.2")), 1);
  EXPECT_EQ(CountOf(said, "rsstabilize:"), 0) << said;
  Filter(Path("clip.mkv"), "frei0r=rsstabilize:||0.2", Path("expected.mkv"));
  EXPECT_GT(Psnr(Path("out.mkv"), Path("expected.mkv")), kSameFrames_db);
}

TEST_F(MeltTest, AMissingFileIsSaidOnce) {
  RSSTAB_NEEDS_MELT();
  MakeClip("clip", kWidth, kHeight, kFrames);
  const std::string said = Render(WriteProject(0, Property("0", "/nowhere.rsstab")), 1);
  EXPECT_EQ(CountOf(said, "rsstabilize:"), 1) << said;
}

}  // namespace
}  // namespace rsstab::frei0r::testing
