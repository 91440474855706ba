// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/correct_plan.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "tests/support/test_paths.h"

namespace rsstab::cli {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

CorrectOptions To(const std::string& output, const std::string& field_folder = "",
                  bool overwrite = false) {
  CorrectOptions options;
  options.output = output;
  options.field_folder = field_folder;
  options.overwrite = overwrite;
  return options;
}

class CorrectPlan : public ::testing::Test {
 protected:
  void SetUp() override {
    std::filesystem::create_directory(folder_ / "there");
    std::filesystem::create_directory(folder_ / "other");
    for (const char* name : {"a.jpg", "b.jpg", "other/a.jpg", "a.tif", "there/b.jpg"}) {
      std::ofstream(Path(name)) << name;
    }
  }
  [[nodiscard]] std::string Path(const std::string& name) const { return folder_ / name; }

  // Plans for pictures in the folder; `options` names places in it.
  [[nodiscard]] Result<CorrectionPlan> Plan(const std::vector<std::string>& names,
                                            CorrectOptions options) const {
    images::ImageList list;
    for (const std::string& name : names) {
      list.paths.push_back(Path(name));
    }
    list.is_plural = names.size() > 1;
    options.output = options.output.empty() ? "" : Path(options.output);
    options.field_folder = options.field_folder.empty() ? "" : Path(options.field_folder);
    return PlanCorrections(options, list);
  }

  void ExpectProblem(const std::vector<std::string>& names, const CorrectOptions& options,
                     const std::string& words) const {
    const auto plan = Plan(names, options);
    ASSERT_TRUE(plan) << plan.error().message;
    ASSERT_EQ(plan->problems.size(), 1U);
    EXPECT_EQ(plan->jobs.size(), names.size() - 1);
    EXPECT_THAT(plan->problems[0].message, HasSubstr(words));
    EXPECT_THAT(plan->problems[0].message, HasSubstr(Path(names.back())));
  }

 private:
  testing::TemporaryFolder folder_;
};

TEST_F(CorrectPlan, OnePictureGoesIntoAFile) {
  const auto plan = Plan({"a.jpg"}, To("new.png"));
  ASSERT_TRUE(plan);
  ASSERT_EQ(plan->jobs.size(), 1U);
  EXPECT_EQ(plan->jobs[0].output, Path("new.png"));
  EXPECT_FALSE(plan->jobs[0].field);
  EXPECT_THAT(plan->folders, IsEmpty());
}

TEST_F(CorrectPlan, OnePictureGoesIntoAFolderThatIsThereOrMeant) {
  for (const char* output : {"there", "new/"}) {
    const auto plan = Plan({"a.jpg"}, To(output));
    ASSERT_TRUE(plan);
    EXPECT_EQ(std::filesystem::path(plan->jobs[0].output).filename(), "a.jpg");
    EXPECT_THAT(plan->folders, ::testing::ElementsAre(Path(output)));
  }
}

TEST_F(CorrectPlan, SeveralPicturesKeepTheirNames) {
  const auto plan = Plan({"a.jpg", "b.jpg"}, To("new", "fields"));
  ASSERT_TRUE(plan);
  ASSERT_EQ(plan->jobs.size(), 2U);
  EXPECT_EQ(plan->jobs[1].output, Path("new/b.jpg"));
  EXPECT_EQ(plan->jobs[1].field->flo, Path("fields/b.flo"));
  EXPECT_THAT(plan->folders, ::testing::ElementsAre(Path("new"), Path("fields")));
}

TEST_F(CorrectPlan, FieldsAlonePlanNoPicture) {
  const auto plan = Plan({"a.jpg"}, To("", "fields"));
  ASSERT_TRUE(plan);
  EXPECT_EQ(plan->jobs[0].output, "");
  EXPECT_EQ(plan->jobs[0].field->npz, Path("fields/a.npz"));
}

TEST_F(CorrectPlan, SeveralPicturesNeedAFolder) {
  const auto plan = Plan({"a.jpg", "b.jpg"}, To("a.tif", "", true));
  ASSERT_FALSE(plan);
  EXPECT_THAT(plan.error().message, HasSubstr("a.tif"));
}

TEST_F(CorrectPlan, InputsAreNeverOverwritten) {
  const CorrectOptions in_place = To(".", "", true);
  ExpectProblem({"a.jpg"}, in_place, "is an input itself");
  std::filesystem::create_hard_link(Path("b.jpg"), Path("there/a.jpg"));
  // there/a.jpg is the other picture of the same run under another name.
  const auto plan = Plan({"a.jpg", "b.jpg"}, To("there", "", true));
  ASSERT_TRUE(plan);
  ASSERT_EQ(plan->problems.size(), 1U);
  EXPECT_THAT(plan->problems[0].message, HasSubstr("is an input itself"));
  EXPECT_EQ(plan->jobs.size(), 1U);  // there/b.jpg is no input
}

TEST_F(CorrectPlan, ExistingFilesNeedOverwrite) {
  ExpectProblem({"b.jpg"}, To("there"), "--overwrite");
  EXPECT_EQ(Plan({"b.jpg"}, To("there", "", true))->jobs.size(), 1U);
  std::ofstream(Path("b-field.png")) << "x";
  ExpectProblem({"b.jpg"}, To("new.jpg", "."), "b-field.png");
}

TEST_F(CorrectPlan, TwoPicturesOfOneNameDoNotShareIt) {
  ExpectProblem({"a.jpg", "other/a.jpg"}, To("new"), "separate runs");
  ExpectProblem({"a.jpg", "a.tif"}, To("new", "fields"), "a.flo");
}

}  // namespace
}  // namespace rsstab::cli
