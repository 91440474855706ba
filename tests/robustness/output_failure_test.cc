// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include "tests/robustness/damage.h"

namespace rsstab::testing {
namespace {

class OutputFailure : public Damage {
 protected:
  void SetUp() override { WriteTestClip(Path("clip.mp4")); }
};

TEST_F(OutputFailure, ExistingFileIsKeptUnlessToldOtherwise) {
  WriteText(Path("out.mp4"), "precious");
  ExpectRefusal({"clip.mp4", "-o", "out.mp4"}, 1, "--overwrite");
  EXPECT_EQ(ReadBytes(Path("out.mp4")).size(), 8U);
  ExpectSuccess({"clip.mp4", "-o", "out.mp4", "--overwrite"}, "out.mp4", 12);
}

TEST_F(OutputFailure, DefaultNameLiesBesideTheInput) {
  ExpectSuccess({"clip.mp4"}, "clip-stable.mp4", 12);
  ExpectRefusal({"clip.mp4"}, 1, "clip-stable.mp4");
}

TEST_F(OutputFailure, OutputIsTheInput) {
  const Bytes before = ReadBytes(Path("clip.mp4"));
  ExpectRefusal({"clip.mp4", "-o", "clip.mp4", "--overwrite"}, 1, "clip.mp4");
  ExpectRefusal(
      {"clip.mp4", "-o", "./../" + Path(".").parent_path().filename().string() + "/clip.mp4",
       "--overwrite"},
      1, "clip.mp4");
  std::filesystem::create_symlink("clip.mp4", Path("link.mp4"));
  ExpectRefusal({"clip.mp4", "-o", "link.mp4", "--overwrite"}, 1, "link.mp4");
  std::filesystem::create_hard_link(Path("clip.mp4"), Path("twin.mp4"));
  ExpectRefusal({"clip.mp4", "-o", "twin.mp4", "--overwrite"}, 1, "twin.mp4");
  EXPECT_EQ(ReadBytes(Path("clip.mp4")), before);
}

TEST_F(OutputFailure, FolderThatIsNotThere) {
  ExpectRefusal({"clip.mp4", "-o", "no/such/out.mp4"}, 1, "no/such");
}

TEST_F(OutputFailure, FolderWhereNobodyMayWrite) {
  // Even root cannot make files there.
  ExpectRefusal({"clip.mp4", "-o", "/proc/rs-stabilize.mp4"}, 1,
                "the folder '/proc' takes no new file");
}

TEST_F(OutputFailure, OutputIsAFolder) {
  std::filesystem::create_directory(Path("out.mp4"));
  ExpectRefusal({"clip.mp4", "-o", "out.mp4", "--overwrite"}, 1, "out.mp4");
}

TEST_F(OutputFailure, FullDisk) {
  TestClip clip;
  clip.width = 640;
  clip.height = 480;
  WriteTestClip(Path("big.mp4"), clip);
  ProgramSettings settings;
  settings.max_file_bytes = 30'000;
  ExpectRefusal({"big.mp4", "-o", "out.mp4", "--codec", "mjpeg"}, 1, "", settings);
}

TEST_F(OutputFailure, FullDevice) { ExpectRefusal({"clip.mp4", "-o", "/dev/full"}, 1, ""); }

TEST_F(OutputFailure, HelpThatCannotBeWritten) {
  ProgramSettings settings;
  settings.folder = Path(".");
  for (const char* arguments : {"--help", "evaluate --help", "--version", "info clip.mp4"}) {
    const std::string script = "\"$0\" " + std::string(arguments) + " > /dev/full";
    const ProgramResult run = RunProgram("/bin/sh", {"-c", script, RSSTAB_PROGRAM}, settings);
    EXPECT_EQ(run.exit_code, 1) << arguments;
    EXPECT_THAT(run.error, ::testing::HasSubstr("standard output cannot be written")) << arguments;
  }
}

TEST_F(OutputFailure, ReportTakesNoFilesPlace) {
  WriteText(Path("report.html"), "precious");
  ExpectRefusal({"clip.mp4", "-o", "out.mp4", "--report", "report.html"}, 1, "--overwrite");
  EXPECT_EQ(ReadBytes(Path("report.html")).size(), 8U);
  const Bytes before = ReadBytes(Path("clip.mp4"));
  ExpectRefusal({"clip.mp4", "-o", "out.mp4", "--report", "clip.mp4", "--overwrite"}, 1,
                "clip.mp4");
  EXPECT_EQ(ReadBytes(Path("clip.mp4")), before);
  ExpectRefusal({"clip.mp4", "-o", "out.mp4", "--report", "out.mp4"}, 1, "out.mp4");
  ExpectRefusal({"clip.mp4", "-o", "out.mp4", "--report", "no/such/report.html"}, 1, "no/such");
}

TEST_F(OutputFailure, ClipStaysWhenOnlyTheReportFails) {
  const ProgramResult run = Run({"clip.mp4", "-o", "out.mp4", "--report", "/dev/full"});
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.error, ::testing::HasSubstr("/dev/full"));
  EXPECT_EQ(CountFrames(Path("out.mp4")), 12);
}

TEST_F(OutputFailure, ReaderOfThePipeGoesAway) {
  ProgramSettings settings;
  settings.close_output = true;
  ExpectRefusal({"clip.mp4", "-o", "-"}, 1, "", settings);
}

TEST_F(OutputFailure, PipeGetsAWholeClip) {
  const ProgramResult run = Run({"clip.mp4", "-o", "-"});
  EXPECT_EQ(run.exit_code, 0) << run.error;
  WriteText(Path("piped.mkv"), run.output);
  EXPECT_EQ(CountFrames(Path("piped.mkv")), 12);
}

TEST_F(OutputFailure, UnknownContainerCodecAndOptions) {
  ExpectRefusal({"clip.mp4", "-o", "out.unknown"}, 1, "out.unknown");
  ExpectRefusal({"clip.mp4", "-o", "out.mp4", "--codec", "no-such-codec"}, 1, "no-such-codec");
  ExpectRefusal({"clip.mp4", "-o", "out.mp4", "--pix-fmt", "no-such-format"}, 1, "no-such-format");
  ExpectRefusal({"clip.mp4", "-o", "out.mp4", "--preset", "no-such-preset"}, 1, "no-such-preset");
  ExpectRefusal({"clip.mp4", "-o", "out.mp4", "--encoder-option", "no-such-option=1"}, 1,
                "no-such-option");
  ExpectRefusal({"clip.mp4", "-o", "out.webm", "--codec", "libx264"}, 1, "webm");
}

TEST_F(OutputFailure, WrongUsage) {
  for (const std::vector<std::string>& arguments :
       std::vector<std::vector<std::string>>{{"clip.mp4", "--crop", "7"},
                                             {"clip.mp4", "--smoothness", "nan"},
                                             {"clip.mp4", "--mesh", "999x999"},
                                             {"clip.mp4", "--threads", "-3"},
                                             {"clip.mp4", "--crf", "1e99"},
                                             {"clip.mp4", "extra.mp4"},
                                             {"clip.mp4", "--bogus"}}) {
    const ProgramResult run = Run(arguments);
    EXPECT_EQ(run.exit_code, 2) << run.error;
    EXPECT_THAT(run.error, ::testing::StartsWith("rs-stabilize: "));
  }
}

}  // namespace
}  // namespace rsstab::testing
