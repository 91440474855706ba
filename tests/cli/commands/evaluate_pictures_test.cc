// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/evaluate_pictures.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <spdlog/sinks/ostream_sink.h>
#include <spdlog/spdlog.h>
#include <sys/resource.h>

#include <csignal>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "cli/commands/evaluate.h"
#include "cli/commands/evaluate_methods.h"
#include "cli/commands/simulate.h"
#include "igf/base/whole_file.h"
#include "tests/evaluation/test_photos.h"
#include "tests/support/test_paths.h"

namespace rsstab::cli {
namespace {

using rsstab::testing::MakePhoto;
using rsstab::testing::TemporaryFolder;
using rsstab::testing::Waves;
using rsstab::testing::WritePhoto;
using ::testing::HasSubstr;
using ::testing::Not;
using Json = nlohmann::json;

constexpr std::uint64_t kMaxBytes = 1U << 24U;
constexpr double kPictureWidths = 160.0 / 800.0;  // strengths are defined at 800 px

// Keeps what would be printed.
EvaluationOutput Into(std::string& table) {
  return [&table](const std::string& text) -> Status {
    table = text;
    return {};
  };
}

// A small simulated set, and the options that evaluate it.
class EvaluatePicturesTest : public ::testing::Test {
 protected:
  void SetUp() override {
    for (int i = 0; i < 2; ++i) {
      WritePhoto(photos_ / (std::to_string(i) + ".png"),
                 MakePhoto(240, 180, [i](int x, int y) { return Waves(x, y, i); }));
    }
    simulate_.output = (folder_ / "set").string();
    simulate_.rs_real = true;
    simulate_.photos = photos_.path().string();
    simulate_.samples = 6;
    simulate_.size = "160x120";
    simulate_.threads = 2;
    evaluate_.protocol = EvaluationProtocol::kRsReal;
    evaluate_.rs_real = simulate_.output;
    evaluate_.methods = "none,gyro,gyro-onestep";
    evaluate_.jobs = 2;
  }

  void Simulate() {
    const Status status = RunSimulate(simulate_, SilentLogger());
    ASSERT_TRUE(status) << status.error().message;
  }

  Result<PictureReport> Evaluate(const evaluation::EvaluationProgress& progress = {}) {
    const auto factory = MakeMethodFactory(evaluate_);
    return factory ? EvaluatePictures(evaluate_, *factory, SilentLogger(), progress)
                   : Propagate(factory.error());
  }

  TemporaryFolder photos_;
  TemporaryFolder folder_;
  SimulateOptions simulate_;
  EvaluateOptions evaluate_;
};

// Everything but what depends on the machine's mood.
std::string CsvWithoutTimes(PictureReport report) {
  for (evaluation::PictureRecord& record : report.records) {
    for (evaluation::MethodFigures& method : record.methods) {
      method.ms = 0.0;
    }
  }
  return FormatCsv(report);
}

TEST_F(EvaluatePicturesTest, TheGyroLogExplainsASimulatedSet) {
  // Labels and logs come from one motion, sampled at 1 kHz; 0.02 px is what interpolation loses.
  constexpr double kExact_px = 0.02;
  simulate_.train_share = 0.5;
  Simulate();
  const auto report = Evaluate();
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_TRUE(report->header.failures.empty());
  ASSERT_EQ(report->records.size(), 6U);
  for (const evaluation::PictureRecord& record : report->records) {
    const auto& none = record.methods[0];
    const auto& gyro = record.methods[1];
    const auto& bands = record.methods[2];
    const double least = record.strength == "weak" ? 1.0 : record.strength == "medium" ? 3.0 : 8.0;
    const double most = record.strength == "weak" ? 3.0 : record.strength == "medium" ? 8.0 : 20.0;
    EXPECT_GT(none.epe_px, 0.97 * least * kPictureWidths) << record.name;
    EXPECT_LT(none.epe_px, 1.03 * most * kPictureWidths) << record.name;
    EXPECT_LT(gyro.epe_px, kExact_px) << record.name;
    // A flipped sign would give twice the uncorrected error; one step loses a little.
    EXPECT_LT(bands.epe_px, 0.2 * none.epe_px) << record.name;
    EXPECT_GT(gyro.psnr_db, none.psnr_db + 3.0) << record.name;
    EXPECT_GT(gyro.valid_share, 0.7);
  }
  ASSERT_EQ(report->groups.size(), 6U);  // all, two splits, three strengths
  EXPECT_EQ(report->groups[0].title, "all");
  EXPECT_EQ(report->groups[1].title, "split test");
  EXPECT_EQ(report->groups[1].pictures, 3U);
  EXPECT_THAT(FormatText(*report), HasSubstr("strength strong, 2 pictures"));
  const Json json = Json::parse(FormatJson(*report));
  EXPECT_EQ(json["samples"], 6);
  EXPECT_LT(json["methods"]["gyro"]["epe"].get<double>(), kExact_px);
  EXPECT_TRUE(json["methods"]["none"]["psnr_interval"][0].is_number());
  EXPECT_TRUE(json["methods"]["none"]["flicker"].is_null());
  const std::string csv = FormatCsv(*report);
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 1 + 6 * 3);
  EXPECT_THAT(FormatText(*report), Not(HasSubstr("nan")));
  evaluate_.split = DatasetSplit::kTrain;
  EXPECT_EQ(Evaluate()->records.size(), 3U);
}

TEST_F(EvaluatePicturesTest, SequencesAreJudgedForFlicker) {
  simulate_.frames = 3;
  simulate_.samples = 9;
  Simulate();
  const auto report = Evaluate();
  ASSERT_TRUE(report) << report.error().message;
  ASSERT_EQ(report->records.size(), 9U);
  EXPECT_EQ(report->records[3].clip, "test/npz/seq_0002");
  for (const evaluation::PictureRecord& record : report->records) {
    const bool is_first = record.name.ends_with("0001");
    EXPECT_EQ(std::isfinite(record.methods[1].flicker_px), !is_first) << record.name;
    if (!is_first) {
      EXPECT_LT(record.methods[1].flicker_px, 0.05) << record.name;
      EXPECT_GT(record.methods[0].flicker_px, record.methods[1].flicker_px) << record.name;
    }
  }
}

TEST_F(EvaluatePicturesTest, BrokenSamplesAreNamedAndTheRestGoesOn) {
  Simulate();
  const std::string broken = (folder_ / "set/test/npz/0002.npz").string();
  const std::string bytes = ReadWholeFile(broken, kMaxBytes).value();
  ASSERT_TRUE(WriteWholeFile(broken, bytes.substr(0, bytes.size() / 2)));
  const auto report = Evaluate();
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_EQ(report->records.size(), 5U);
  ASSERT_EQ(report->header.failures.size(), 1U);
  EXPECT_EQ(report->header.failures[0].first, "test/npz/0002");
  EXPECT_THAT(FormatText(*report), HasSubstr("left out: test/npz/0002: "));
}

TEST_F(EvaluatePicturesTest, AStoppedRunGoesOnWhereItWas) {
  Simulate();
  const auto whole = Evaluate();
  ASSERT_TRUE(whole);
  evaluate_.csv = (folder_ / "out.csv").string();
  evaluate_.jobs = 1;
  const auto stopped = Evaluate([](std::int64_t done, std::int64_t) { return done < 2; });
  ASSERT_FALSE(stopped);
  EXPECT_EQ(stopped.error().code, ErrorCode::kCancelled);
  const std::string state = evaluate_.csv + ".state";
  EXPECT_THAT(stopped.error().message, HasSubstr(state));
  // As if the machine had stopped in the middle of a line.
  const std::string half = ReadWholeFile(state, kMaxBytes).value() + "{\"clip\": \"test/n";
  ASSERT_TRUE(WriteWholeFile(state, half));
  std::int64_t done_again = 0;
  const auto resumed = Evaluate([&](std::int64_t, std::int64_t items) {
    done_again = items;
    return true;
  });
  ASSERT_TRUE(resumed) << resumed.error().message;
  EXPECT_EQ(done_again, 4);
  ASSERT_EQ(resumed->records.size(), 6U);
  EXPECT_EQ(CsvWithoutTimes(*resumed), CsvWithoutTimes(*whole));
  // It goes when all is written, and not before.
  EXPECT_TRUE(std::filesystem::exists(state));
  std::filesystem::create_directory(evaluate_.csv);
  std::string table;
  EXPECT_FALSE(RunEvaluate(evaluate_, SilentLogger(), Into(table)));
  EXPECT_EQ(table, "");  // told before the work begins
  EXPECT_TRUE(std::filesystem::exists(state));
  std::filesystem::remove(evaluate_.csv);
  ASSERT_TRUE(RunEvaluate(evaluate_, SilentLogger(), Into(table)));
  EXPECT_THAT(table, HasSubstr("all, 6 pictures"));
  EXPECT_TRUE(std::filesystem::exists(evaluate_.csv));
  EXPECT_FALSE(std::filesystem::exists(state));

  // Other settings do not go on from it.
  ASSERT_TRUE(WriteWholeFile(state, half));
  evaluate_.seed = 2;
  const auto other = Evaluate();
  ASSERT_FALSE(other);
  EXPECT_THAT(other.error().message, HasSubstr("other settings"));
}

TEST_F(EvaluatePicturesTest, AFileThatFailsTakesNothingWithIt) {
  Simulate();
  evaluate_.csv = (folder_ / "out.csv").string();
  evaluate_.json = (folder_ / "out.json").string();
  std::string table;
  // The table is there before any file, and somebody takes a file's name in the meantime.
  const Status status = RunEvaluate(evaluate_, SilentLogger(), [&](const std::string& text) {
    table = text;
    EXPECT_FALSE(std::filesystem::exists(evaluate_.json));
    return WriteWholeFile(evaluate_.csv, "precious");
  });
  ASSERT_FALSE(status);
  EXPECT_THAT(status.error().message, HasSubstr("out.csv"));
  EXPECT_THAT(table, HasSubstr("all, 6 pictures"));
  EXPECT_EQ(ReadWholeFile(evaluate_.csv, kMaxBytes).value(), "precious");
  EXPECT_TRUE(std::filesystem::exists(evaluate_.json));
  const std::string state = evaluate_.csv + ".state";
  EXPECT_TRUE(std::filesystem::exists(state));
  // The same command goes on from it.
  std::filesystem::remove(evaluate_.csv);
  evaluate_.overwrite = true;
  std::int64_t pictures = 0;
  ASSERT_TRUE(
      RunEvaluate(evaluate_, SilentLogger(), Into(table), [&](std::int64_t, std::int64_t n) {
        pictures += n;
        return true;
      }));
  EXPECT_EQ(pictures, 0);
  EXPECT_FALSE(std::filesystem::exists(state));
}

// A limit on the size of files fails as a full disk does.
TEST_F(EvaluatePicturesTest, AFullDiskLeavesTheTable) {
  Simulate();
  evaluate_.csv = (folder_ / "out.csv").string();
  struct rlimit usual {};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &usual), 0);
  auto* const usual_handler = std::signal(SIGXFSZ, SIG_IGN);
  struct rlimit tight = usual;
  tight.rlim_cur = 1000;
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &tight), 0);
  std::string table;
  const Status status = RunEvaluate(evaluate_, SilentLogger(), Into(table));
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &usual), 0);
  static_cast<void>(std::signal(SIGXFSZ, usual_handler));
  ASSERT_FALSE(status);
  EXPECT_THAT(status.error().message, HasSubstr("out.csv"));
  EXPECT_THAT(table, HasSubstr("all, 6 pictures"));
  EXPECT_FALSE(std::filesystem::exists(evaluate_.csv));
}

TEST_F(EvaluatePicturesTest, NothingIsOverwrittenUnlessToldTo) {
  Simulate();
  const std::string old = (folder_ / "old").string();
  ASSERT_TRUE(WriteWholeFile(old, "precious"));
  for (std::string EvaluateOptions::*file :
       {&EvaluateOptions::csv, &EvaluateOptions::json, &EvaluateOptions::report}) {
    EvaluateOptions options = evaluate_;
    options.*file = old;
    std::string table;
    const Status status = RunEvaluate(options, SilentLogger(), Into(table));
    ASSERT_FALSE(status);
    EXPECT_THAT(status.error().message, HasSubstr("--overwrite"));
    EXPECT_EQ(table, "");
    EXPECT_EQ(ReadWholeFile(old, kMaxBytes).value(), "precious");
  }
  EvaluateOptions options = evaluate_;
  options.csv = (folder_ / "new").string();
  options.json = (folder_ / "./new").string();
  std::string table;
  EXPECT_THAT(RunEvaluate(options, SilentLogger(), Into(table)).error().message,
              HasSubstr("another file of this command"));
}

TEST_F(EvaluatePicturesTest, TheSetIsTheSameForAnyNumberOfThreads) {
  Simulate();
  SimulateOptions again = simulate_;
  again.output = (folder_ / "again").string();
  again.threads = 1;
  ASSERT_TRUE(RunSimulate(again, SilentLogger()));
  for (const char* file :
       {"test/npz/0003.npz", "test/npz/0006.gyro.csv", "test/npz/0001.json", "test/jpg/0004.jpg"}) {
    EXPECT_EQ(ReadWholeFile((folder_ / "set" / file).string(), kMaxBytes).value(),
              ReadWholeFile((folder_ / "again" / file).string(), kMaxBytes).value())
        << file;
  }
  EXPECT_THAT(RunSimulate(again, SilentLogger()).error().message, HasSubstr("--overwrite"));
  again.overwrite = true;
  again.size = "4x9000";
  EXPECT_THAT(RunSimulate(again, SilentLogger()).error().message, HasSubstr("--size"));
  again.size = "64x48";
  again.readout_s = -0.02;
  EXPECT_THAT(RunSimulate(again, SilentLogger()).error().message, HasSubstr("--readout"));
}

TEST_F(EvaluatePicturesTest, SimulateSaysWhatItWrote) {
  simulate_.samples = 4;
  simulate_.train_share = 0.25;
  std::ostringstream lines;
  const auto sink = std::make_shared<spdlog::sinks::ostream_sink_mt>(lines);
  ASSERT_TRUE(RunSimulate(simulate_, std::make_shared<spdlog::logger>("test", sink)));
  EXPECT_THAT(lines.str(), HasSubstr("4 pictures of 160 x 120 (1 of train, 3 of test)"));
  EXPECT_THAT(lines.str(), HasSubstr("in " + simulate_.output));
}

TEST_F(EvaluatePicturesTest, NoNoiseIsNoNoise) {
  simulate_.photos.clear();
  simulate_.samples = 1;
  std::vector<std::string> labels;
  for (const std::optional<double> noise : {std::optional<double>(), {2.0}, {0.0}}) {
    simulate_.image_noise = noise;
    simulate_.overwrite = true;
    Simulate();
    labels.push_back(
        ReadWholeFile((folder_ / "set/test/npz/0001.npz").string(), kMaxBytes).value());
  }
  EXPECT_EQ(labels[0], labels[1]);  // what is usual
  EXPECT_NE(labels[0], labels[2]);
}

TEST_F(EvaluatePicturesTest, WithoutPhotographsStreetsArePainted) {
  simulate_.photos.clear();
  simulate_.samples = 1;
  Simulate();
  std::string table;
  const Status status = RunEvaluate(evaluate_, SilentLogger(), Into(table));
  ASSERT_TRUE(status) << status.error().message;
  EXPECT_THAT(table, HasSubstr("all, 1 pictures"));
}

}  // namespace
}  // namespace rsstab::cli
