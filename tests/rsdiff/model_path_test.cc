// SPDX-License-Identifier: Apache-2.0
#include "rsdiff/model_path.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>

#include "igf/base/whole_file.h"
#include "tests/support/test_paths.h"

namespace rsstab::rsdiff {
namespace {

namespace fs = std::filesystem;
using rsstab::testing::TemporaryFolder;
using ::testing::HasSubstr;

// Sets the variable for one test.
class FindModelTest : public ::testing::Test {
 protected:
  void SetUp() override {
    fs::create_directories(folder_ / "mine");
    ASSERT_TRUE(WriteWholeFile((folder_ / "mine" / "model.json").string(), "{}"));
    unsetenv("RSSTAB_MODEL_DIR");
  }
  void TearDown() override { unsetenv("RSSTAB_MODEL_DIR"); }

  TemporaryFolder folder_;
};

TEST_F(FindModelTest, TakesAFileOrAFolder) {
  const fs::path file = folder_.path() / "mine" / "model.json";
  EXPECT_EQ(*FindModel(file.string()), file);
  EXPECT_EQ(*FindModel(file.parent_path().string()), file);
}

TEST_F(FindModelTest, LooksForNamesWhereTheVariablePoints) {
  setenv("RSSTAB_MODEL_DIR", folder_.path().c_str(), 1);
  EXPECT_EQ(*FindModel("mine"), folder_.path() / "mine" / "model.json");
  const auto other = FindModel("yours");
  ASSERT_FALSE(other);
  EXPECT_EQ(other.error().code, ErrorCode::kNotFound);
  EXPECT_THAT(other.error().message, HasSubstr("RSSTAB_MODEL_DIR"));
  const auto standard = FindModel();
  ASSERT_FALSE(standard);
  EXPECT_THAT(standard.error().message, HasSubstr(kDefaultModel));
}

TEST_F(FindModelTest, SaysWhatItLookedFor) {
  for (const char* wanted : {"no/such/folder", "missing.json"}) {
    const auto model = FindModel(wanted);
    ASSERT_FALSE(model);
    EXPECT_EQ(model.error().code, ErrorCode::kNotFound);
    EXPECT_THAT(model.error().message, HasSubstr(wanted));
  }
  const auto name = FindModel("no-such-model");
  ASSERT_FALSE(name);
  EXPECT_THAT(name.error().message, HasSubstr("share/rs-stabilize/models"));
  // A folder without a model in it.
  EXPECT_FALSE(FindModel(folder_.path().string()));
}

// The build tree has the source tree's models where an installation has them.
TEST_F(FindModelTest, FindsInstalledModelsAboveTheProgram) {
  const fs::path models = rsstab::testing::SourceFile("rsdiff/models");
  if (!fs::exists(models / kDefaultModel / "model.json")) {
    GTEST_SKIP() << "no model is shipped yet";
  }
  const auto found = FindModel();
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_TRUE(fs::equivalent(*found, models / kDefaultModel / "model.json"));
}

}  // namespace
}  // namespace rsstab::rsdiff
