// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include "tests/robustness/damage.h"

namespace rsstab::testing {
namespace {

// Long enough that no machine is through with it before the signal arrives.
class Stopping : public Damage {
 protected:
  void SetUp() override {
    TestClip clip;
    clip.width = 320;
    clip.height = 240;
    clip.frames = 240;
    WriteTestClip(Path("long.mkv"), clip);
  }
};

TEST_F(Stopping, CtrlCInTheFirstPassLeavesNothing) {
  ProgramSettings settings;
  settings.signal_after = "\"frames_done\":";
  ExpectRefusal({"long.mkv", "-o", "out.mkv", "--progress", "json"}, 1, "stopped", settings);
}

TEST_F(Stopping, TerminateInTheSecondPassLeavesNothing) {
  ProgramSettings settings;
  settings.signal_after = "\"pass\":2";
  settings.signal = SIGTERM;
  ExpectRefusal({"long.mkv", "-o", "out.mkv", "--progress", "json"}, 1, "stopped", settings);
}

TEST_F(Stopping, AnalysisLeavesNoHalfFile) {
  ProgramSettings settings;
  settings.signal_after = "\"frames_done\":";
  ExpectRefusal({"analyze", "long.mkv", "--progress", "json"}, 1, "stopped", settings);
}

}  // namespace
}  // namespace rsstab::testing
