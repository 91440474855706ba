// SPDX-License-Identifier: Apache-2.0
#include "plugin/frei0r/analysis_path.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>

#include "tests/support/test_paths.h"

namespace rsstab::frei0r {
namespace {

using rsstab::testing::TemporaryFolder;

class AnalysisPathTest : public ::testing::Test {
 protected:
  void SetUp() override { unsetenv(kAnalysisVariable); }
  void TearDown() override { unsetenv(kAnalysisVariable); }
  std::string Make(const std::string& name) {
    std::ofstream(folder_ / name) << "x";
    return folder_ / name;
  }
  TemporaryFolder folder_;
};

TEST_F(AnalysisPathTest, NothingMeansLive) { EXPECT_EQ(AnalysisPath(""), ""); }

TEST_F(AnalysisPathTest, VariableStandsInForTheParameter) {
  setenv(kAnalysisVariable, "/a:b|c.rsstab", 1);
  EXPECT_EQ(AnalysisPath(""), "/a:b|c.rsstab");
  EXPECT_EQ(AnalysisPath("/other"), "/other");
}

TEST_F(AnalysisPathTest, DecodesWhatIsNoFileAsItStands) {
  const std::string path = Make("a:b|c d%.rsstab");
  const std::string folder = folder_.path();
  EXPECT_EQ(AnalysisPath(folder + "/a%3ab%7Cc%20d%.rsstab"), path);
}

TEST_F(AnalysisPathTest, AFileWithAPercentSignIsFoundFirst) {
  Make("a:b");
  const std::string path = Make("a%3Ab");
  EXPECT_EQ(AnalysisPath(path), path);
}

TEST_F(AnalysisPathTest, AMissingFileKeepsItsNameForTheMessage) {
  EXPECT_EQ(AnalysisPath("/none/a%3Ab"), "/none/a%3Ab");
}

TEST(DecodePercent, LeavesWhatIsNoCode) {
  EXPECT_EQ(DecodePercent("100%"), "100%");
  EXPECT_EQ(DecodePercent("%4"), "%4");
  EXPECT_EQ(DecodePercent("%zz%4x%00"), "%zz%4x%00");
  EXPECT_EQ(DecodePercent("%25%41"), "%A");
}

}  // namespace
}  // namespace rsstab::frei0r
