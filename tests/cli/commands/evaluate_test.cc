// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/evaluate.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "cli/commands/evaluate_methods.h"
#include "cli/commands/evaluate_pictures.h"
#include "cli/commands/evaluate_synthetic.h"
#include "igf/base/whole_file.h"
#include "tests/evaluation/test_methods.h"
#include "tests/evaluation/test_photos.h"
#include "tests/support/test_paths.h"

namespace rsstab::cli {
namespace {

using evaluation::MethodSet;
using rsstab::testing::MakePhoto;
using rsstab::testing::TemporaryFolder;
using rsstab::testing::ToldMethod;
using rsstab::testing::Waves;
using rsstab::testing::WritePhoto;
using ::testing::HasSubstr;
using ::testing::Not;
using Json = nlohmann::json;

constexpr std::uint64_t kMaxBytes = 1U << 20U;

// Keeps what would be printed.
EvaluationOutput Into(std::string& table) {
  return [&table](const std::string& text) -> Status {
    table = text;
    return {};
  };
}

Result<MethodSet> ToldMethods() {
  MethodSet set;
  set.methods.push_back(std::make_unique<evaluation::NoCorrection>());
  set.methods.push_back(std::make_unique<ToldMethod>("half", 0.5));
  set.sampler = std::make_unique<ToldMethod>("sampler", 1.0, 16, 0.01);
  set.skew = std::make_unique<ToldMethod>("half", 0.5);
  return set;
}

void WritePhotos(const TemporaryFolder& folder, int count) {
  for (int i = 0; i < count; ++i) {
    WritePhoto(folder / (std::to_string(i) + ".png"),
               MakePhoto(160, 120, [i](int x, int y) { return Waves(x, y, i); }));
  }
}

EvaluateOptions TinyModel(const TemporaryFolder& photos) {
  EvaluateOptions options;
  options.photos = photos.path().string();
  options.model = rsstab::testing::SourceFile("tests/rsdiff/data/tiny_model").string();
  options.linearity_photos = 0;
  return options;
}

TEST(Evaluate, ReportsHoldEveryFigure) {
  const TemporaryFolder folder;
  WritePhotos(folder, 2);
  const TemporaryFolder lists;
  ASSERT_TRUE(WriteWholeFile((lists / "list.csv").string(), "0.png,houses\n1.png,cats\n"));
  EvaluateOptions options;
  options.photos = folder.path().string();
  options.structured = (lists / "list.csv").string();
  options.structured_source = "houses";
  options.linearity_photos = 1;
  options.jobs = 1;
  const auto report = EvaluateSynthetic(options, ToldMethods, SilentLogger());
  ASSERT_TRUE(report) << report.error().message;

  const Json json = Json::parse(FormatJson(*report));
  EXPECT_EQ(json["protocol"], "synthetic-val");
  EXPECT_EQ(json["photos"], 2);
  EXPECT_EQ(json["samples"], 8);
  EXPECT_EQ(json["settings"]["structured-source"], "houses");
  for (const char* figure : {"epe", "psnr", "ssim", "ms", "u", "v", "epe_median", "epe_p90",
                             "epe_change", "u_ratio", "valid"}) {
    EXPECT_TRUE(json["methods"]["half"][figure].is_number()) << figure;
  }
  EXPECT_NEAR(json["methods"]["half"]["epe_ratio"].get<double>(), 0.5, 0.03);
  EXPECT_LT(json["methods"]["half"]["epe_change_interval"][1].get<double>(), 0.0);
  EXPECT_EQ(json["groups"].size(), 12U);
  int structured = 0;
  for (const Json& group : json["groups"]) {
    structured += group["photos"] == "structured" ? 1 : 0;
    EXPECT_EQ(group["coverage"]["all"], 1.0);
    if (group["motion"] == "still") {
      EXPECT_TRUE(group["methods"]["half"]["u_ratio"].is_null());
    }
  }
  EXPECT_EQ(structured, 6);
  EXPECT_NEAR(json["skew"]["slope"].get<double>(), 0.5, 0.01);
  EXPECT_NEAR(json["skew"]["zero_crossing"].get<double>(), 1.0, 1e-6);

  const std::string text = FormatText(*report);
  EXPECT_THAT(text, HasSubstr("skew-twist, structured photos, 1 pictures"));
  EXPECT_THAT(text, HasSubstr("still, 2 pictures"));
  EXPECT_THAT(text, HasSubstr("truth inside the central 80%"));
  EXPECT_THAT(text, HasSubstr("response to a known skew"));
  EXPECT_THAT(text, Not(HasSubstr("nan")));

  const std::string csv = FormatCsv(*report);
  EXPECT_THAT(csv.substr(0, csv.find('\n')), HasSubstr(",declined"));
  // A head, and 2 photos x 5 motions x 2 methods.
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 21);
  EXPECT_THAT(csv, HasSubstr("0.png,1,skew-twist,"));
  EXPECT_THAT(csv, HasSubstr("1.png,0,still,"));
}

TEST(Evaluate, ModelsAreLoadedAndFilesWritten) {
  const TemporaryFolder folder;
  WritePhotos(folder, 2);
  const TemporaryFolder written;
  EvaluateOptions options = TinyModel(folder);
  options.regression_model = options.model;
  options.limit = 1;
  options.samples = 3;
  options.csv = (written / "out.csv").string();
  options.json = (written / "out.json").string();
  std::string table;
  const Status status = RunEvaluate(options, SilentLogger(), Into(table));
  ASSERT_TRUE(status) << status.error().message;
  for (const char* method : {"none", "regression", "sample", "mean"}) {
    EXPECT_THAT(table, HasSubstr(std::string("\n") + method + " "));
  }
  EXPECT_THAT(table, Not(HasSubstr("response to a known skew")));
  const Json json = Json::parse(ReadWholeFile(options.json, kMaxBytes).value());
  EXPECT_EQ(json["samples"], 4);
  EXPECT_TRUE(json["methods"]["mean"]["epe"].is_number());
  EXPECT_FALSE(json.contains("skew"));
  const std::string csv = ReadWholeFile(options.csv, kMaxBytes).value();
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 1 + 5 * 4);
}

TEST(Evaluate, PairsAreReported) {
  const TemporaryFolder folder;
  const Frame photo = MakePhoto(96, 64, [](int x, int y) { return Waves(x, y); });
  std::filesystem::create_directories(folder / "Fastec/seq_01");
  WritePhoto(folder / "Fastec/seq_01/rs_1.png", photo);
  WritePhoto(folder / "Fastec/seq_01/gs_1.png", photo);
  EvaluateOptions options = TinyModel(folder);
  options.methods = "none,gyro,diffusion@samples=2,steps=1";
  options.protocol = EvaluationProtocol::kPairs;
  options.pairs = folder.path().string();
  const auto factory = MakeMethodFactory(options);
  ASSERT_TRUE(factory) << factory.error().message;
  const auto report = EvaluatePictures(options, *factory, SilentLogger());
  ASSERT_TRUE(report) << report.error().message;
  const Json json = Json::parse(FormatJson(*report));
  EXPECT_EQ(json["samples"], 1);
  EXPECT_EQ(json["methods"]["none"]["psnr"], 60.0);  // the same picture: the limit
  EXPECT_TRUE(json["methods"]["none"]["epe"].is_null());
  EXPECT_EQ(json["methods"]["gyro"]["pictures"], 0);  // there is no log
  EXPECT_TRUE(json["methods"]["diffusion@samples=2,steps=1"]["psnr_untouched"].is_number());
  EXPECT_THAT(FormatText(*report), HasSubstr("all, 1 pictures"));
  EXPECT_THAT(FormatText(*report), Not(HasSubstr("\ngyro ")));
  EXPECT_THAT(FormatText(*report), HasSubstr("with what they need: gyro."));
  EXPECT_THAT(FormatText(*report), Not(HasSubstr("nan")));
  EXPECT_THAT(FormatCsv(*report), HasSubstr("Fastec/seq_01,Fastec/seq_01,,,Fastec/seq_01,96,64,"));
}

TEST(Evaluate, WhatIsLeftOutIsTold) {
  const TemporaryFolder folder;
  WritePhotos(folder, 1);
  ASSERT_TRUE(WriteWholeFile((folder / "broken, too.png").string(), "x"));
  EvaluateOptions options;
  options.photos = folder.path().string();
  options.linearity_photos = 0;
  const auto report = EvaluateSynthetic(options, ToldMethods, SilentLogger());
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_THAT(FormatText(*report), HasSubstr("left out: broken, too.png: "));
  EXPECT_EQ(Json::parse(FormatJson(*report))["left_out"][0]["name"], "broken, too.png");
  EXPECT_EQ(Json::parse(FormatJson(*report))["photos"], 1);
}

TEST(Evaluate, MistakesAreNamed) {
  const TemporaryFolder folder;
  WritePhotos(folder, 1);
  struct Case {
    const char* says;
    std::function<void(EvaluateOptions&)> change;
  };
  const std::vector<Case> cases = {
      {"--photos", [](EvaluateOptions& o) { o.photos.clear(); }},
      {"/nonexistent", [](EvaluateOptions& o) { o.photos = "/nonexistent"; }},
      {"--pairs", [](EvaluateOptions& o) { o.protocol = EvaluationProtocol::kPairs; }},
      {"rs-real:FOLDER", [](EvaluateOptions& o) { o.protocol = EvaluationProtocol::kRsReal; }},
      {"rs_1.png",
       [](EvaluateOptions& o) {
         o.protocol = EvaluationProtocol::kPairs;
         o.pairs = o.photos;
       }},
      {"no .npz",
       [](EvaluateOptions& o) {
         o.protocol = EvaluationProtocol::kRsReal;
         o.rs_real = o.photos;
       }},
      {"no setting 'speed'", [](EvaluateOptions& o) { o.methods = "diffusion@speed=2"; }},
      {"without a method", [](EvaluateOptions& o) { o.methods = "none,steps=2"; }},
      {"bands", [](EvaluateOptions& o) { o.methods = "gyro-onestep@bands=0"; }},
      {"'magic'", [](EvaluateOptions& o) { o.methods = "none,magic"; }},
      {"--calibration-samples", [](EvaluateOptions& o) { o.calibration_samples = 4; }},
      {"/nonexistent", [](EvaluateOptions& o) { o.model = "/nonexistent/model.json"; }},
      {"/nonexistent", [](EvaluateOptions& o) { o.regression_model = "/nonexistent/model.json"; }},
      {"/nonexistent", [](EvaluateOptions& o) { o.structured = "/nonexistent/list.csv"; }},
      {"/nonexistent", [](EvaluateOptions& o) { o.csv = "/nonexistent/out.csv"; }},
  };
  for (const Case& mistake : cases) {
    EvaluateOptions options = TinyModel(folder);
    mistake.change(options);
    std::string table;
    const Status status = RunEvaluate(options, SilentLogger(), Into(table));
    ASSERT_FALSE(status) << mistake.says;
    EXPECT_THAT(status.error().message, HasSubstr(mistake.says));
  }
}

}  // namespace
}  // namespace rsstab::cli
