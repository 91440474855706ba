// SPDX-License-Identifier: Apache-2.0
#include "rsdiff/model_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "igf/base/whole_file.h"
#include "tests/support/test_paths.h"

namespace rsstab::rsdiff {
namespace {

using nlohmann::json;
using rsstab::testing::TemporaryFolder;
using ::testing::HasSubstr;

std::filesystem::path TinyModel() {
  return rsstab::testing::SourceFile("tests/rsdiff/data/tiny_model");
}

json TinyJson() {
  std::ifstream in(TinyModel() / "model.json");
  return json::parse(in);
}

Result<ModelInfo> Read(const TemporaryFolder& folder, const std::string& text) {
  const std::filesystem::path file = folder / "model.json";
  EXPECT_TRUE(WriteWholeFile(file.string(), text));
  return ReadModelFile(file);
}

TEST(Sha256, IsTheStandardsOne) {
  // FIPS 180-4 examples.
  EXPECT_EQ(*Sha256("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(*Sha256(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
}

TEST(ReadModelFile, ReadsACompactModelFromItsFolderOrItsFile) {
  for (const std::filesystem::path& path : {TinyModel(), TinyModel() / "model.json"}) {
    const auto info = ReadModelFile(path);
    ASSERT_TRUE(info) << info.error().message;
    EXPECT_EQ(info->name, "tiny");
    EXPECT_EQ(info->library, NetworkLibrary::kOpenCvDnn);
    EXPECT_EQ(info->condition_kind, ConditionKind::kOrientationPlanes);
    EXPECT_EQ(info->condition, (Shape{73, 24, 16}));
    EXPECT_EQ(info->motion_kind, MotionKind::kRotationCurve);
    EXPECT_EQ(info->motion, (Shape{3, 24, 1}));
    EXPECT_EQ(info->curve_scale, Eigen::Vector3d(0.04, 0.05, 0.08));
    EXPECT_EQ(info->schedule, ScheduleKind::kCosine);
    EXPECT_EQ(info->diffusion_steps, 1000);
    EXPECT_EQ(info->objective, Objective::kX0);
    EXPECT_EQ(info->sampling.steps, 4);
    EXPECT_EQ(info->sampling.eta, 0.5);
    EXPECT_EQ(info->sampling.clip_range, 4.0);
    EXPECT_EQ(info->sampling.guidance, 1.5);
    EXPECT_EQ(info->sampling.guidance_rescale, 0.25);
    EXPECT_EQ(info->spread_scale, 1.75);
    EXPECT_EQ(info->time_embedding_size, 4);
    EXPECT_EQ(info->encoder.path, TinyModel() / "encoder.onnx");
    ASSERT_EQ(info->denoisers.size(), 2U);
    EXPECT_EQ(info->denoisers[0].batch, 1);
    EXPECT_EQ(info->denoisers[1].batch, 4);
    EXPECT_TRUE(ReadWeights(info->encoder));
    EXPECT_TRUE(ReadWeights(info->denoisers[1]));
  }
}

TEST(ReadModelFile, ReadsAReferenceModel) {
  const TemporaryFolder folder;
  json model = TinyJson();
  model["backend"] = "torch";
  model["condition"] = {{"kind", "rgb"}, {"channels", 3}, {"rows", 64}, {"columns", 64}};
  model["motion"] = {
      {"kind", "dense-field"}, {"rows", 64}, {"columns", 64}, {"reference_row", "first"}};
  model["sampling"] = {{"steps", 8}};
  model["weights"] = {{"network", {{"file", "net.pt"}, {"sha256", std::string(64, 'a')}}}};
  model.erase("time_embedding");
  const auto info = Read(folder, model.dump());
  ASSERT_TRUE(info) << info.error().message;
  EXPECT_EQ(info->library, NetworkLibrary::kTorch);
  EXPECT_EQ(info->motion, (Shape{2, 64, 64}));
  EXPECT_EQ(info->reference_row, ReferenceRow::kFirst);
  EXPECT_EQ(info->network.path, folder / "net.pt");
  EXPECT_EQ(info->sampling.eta, 0.0);
  EXPECT_EQ(info->sampling.clip_range, 1.0);
  EXPECT_EQ(info->sampling.guidance, 1.0);
  const auto weights = ReadWeights(info->network);
  ASSERT_FALSE(weights);
  EXPECT_EQ(weights.error().code, ErrorCode::kNotFound);
  EXPECT_THAT(weights.error().message, HasSubstr("net.pt"));
}

struct Damage {
  const char* pointer;  // what is replaced (JSON pointer)
  json value;           // null: removed
  ErrorCode code;
  const char* says;
};

TEST(ReadModelFile, RefusesDamageAndSaysWhere) {
  const TemporaryFolder folder;
  const std::vector<Damage> damages = {
      {"/format", "something else", ErrorCode::kCorruptData, "format"},
      {"/format", nullptr, ErrorCode::kCorruptData, "format"},
      {"/version", 2, ErrorCode::kUnsupported, "version 2"},
      {"/version", "1", ErrorCode::kCorruptData, "version"},
      {"/name", nullptr, ErrorCode::kCorruptData, "name"},
      {"/backend", "abacus", ErrorCode::kUnsupported, "\"opencv-dnn\", \"torch\""},
      {"/backend", 7, ErrorCode::kCorruptData, "backend"},
      {"/condition", nullptr, ErrorCode::kCorruptData, "condition"},
      {"/condition", json::array(), ErrorCode::kCorruptData, "condition"},
      {"/condition/kind", "smell", ErrorCode::kUnsupported, "condition.kind"},
      {"/condition/kind", "rgb", ErrorCode::kCorruptData, "3 channels"},
      {"/condition/rows", 0, ErrorCode::kCorruptData, "condition.rows"},
      {"/condition/rows", 2.5, ErrorCode::kCorruptData, "whole number"},
      {"/condition/channels", 1e30, ErrorCode::kCorruptData, "condition.channels"},
      {"/condition/channels", 41, ErrorCode::kUnsupported, "73x24x16"},
      {"/motion", 3, ErrorCode::kCorruptData, "motion"},
      {"/motion/kind", "", ErrorCode::kCorruptData, "motion.kind"},
      {"/motion/bands", -1, ErrorCode::kCorruptData, "motion.bands"},
      {"/motion/scale", {0.1, 0.1}, ErrorCode::kCorruptData, "motion.scale"},
      {"/motion/scale", {0.1, 0.1, 0.0}, ErrorCode::kCorruptData, "motion.scale"},
      {"/motion/scale", {0.1, "a", 0.1}, ErrorCode::kCorruptData, "motion.scale"},
      {"/diffusion/steps", 0, ErrorCode::kCorruptData, "diffusion.steps"},
      {"/diffusion/schedule", "sudden", ErrorCode::kUnsupported, "\"linear\", \"cosine\""},
      {"/diffusion/objective", "y", ErrorCode::kUnsupported, "objective"},
      {"/sampling/steps", 1001, ErrorCode::kCorruptData, "sampling.steps"},
      {"/sampling/eta", 1.5, ErrorCode::kCorruptData, "sampling.eta"},
      {"/sampling/clip_range", 0.0, ErrorCode::kCorruptData, "clip_range"},
      {"/sampling/spread_scale", 0.0, ErrorCode::kCorruptData, "spread_scale"},
      {"/sampling/guidance", "much", ErrorCode::kCorruptData, "guidance"},
      {"/time_embedding/size", 3, ErrorCode::kCorruptData, "even"},
      {"/weights", nullptr, ErrorCode::kCorruptData, "weights"},
      {"/weights/encoder", nullptr, ErrorCode::kCorruptData, "weights.encoder"},
      {"/weights/encoder/file", "../x.onnx", ErrorCode::kCorruptData, "own folder"},
      {"/weights/encoder/file", "/etc/passwd", ErrorCode::kCorruptData, "own folder"},
      {"/weights/encoder/file", "..", ErrorCode::kCorruptData, "own folder"},
      {"/weights/encoder/sha256", "abc", ErrorCode::kCorruptData, "sha256"},
      {"/weights/encoder/sha256", std::string(64, 'G'), ErrorCode::kCorruptData, "sha256"},
      {"/weights/denoiser", json::array(), ErrorCode::kCorruptData, "denoiser"},
      {"/weights/denoiser/0", 5, ErrorCode::kCorruptData, "denoiser"},
      {"/weights/denoiser/1/batch", 0, ErrorCode::kCorruptData, "batch"},
  };
  for (const Damage& damage : damages) {
    json model = TinyJson();
    const json::json_pointer pointer(damage.pointer);
    if (damage.value.is_null()) {
      model[pointer.parent_pointer()].erase(pointer.back());
    } else {
      model[pointer] = damage.value;
    }
    const auto info = Read(folder, model.dump());
    ASSERT_FALSE(info) << damage.pointer << " " << damage.value;
    EXPECT_EQ(info.error().code, damage.code) << info.error().message;
    EXPECT_THAT(info.error().message, HasSubstr(damage.says));
    EXPECT_THAT(info.error().message, HasSubstr("model.json"));
  }
}

TEST(ReadModelFile, RefusesTextThatIsCutOff) {
  const TemporaryFolder folder;
  const std::string whole = TinyJson().dump();
  for (std::size_t length = 1; length < whole.size(); length += 13) {
    EXPECT_FALSE(Read(folder, whole.substr(0, length))) << length;
  }
  EXPECT_FALSE(Read(folder, "[]"));
  EXPECT_FALSE(Read(folder, "\"text\""));
}

TEST(ReadModelFile, SaysWhenThereIsNone) {
  const TemporaryFolder folder;
  for (const std::filesystem::path& path : {folder.path(), folder / "other.json"}) {
    const auto info = ReadModelFile(path);
    ASSERT_FALSE(info);
    EXPECT_EQ(info.error().code, ErrorCode::kNotFound);
    EXPECT_THAT(info.error().message, HasSubstr(".json"));
  }
}

TEST(ReadWeights, RefusesOneChangedBit) {
  const TemporaryFolder folder;
  const ModelInfo info = *ReadModelFile(TinyModel());
  std::string bytes = *ReadWeights(info.encoder);
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 1);
  WeightFile damaged = info.encoder;
  damaged.path = folder / "encoder.onnx";
  ASSERT_TRUE(WriteWholeFile(damaged.path.string(), bytes));
  const auto read = ReadWeights(damaged);
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().code, ErrorCode::kCorruptData);
  EXPECT_THAT(read.error().message, HasSubstr("encoder.onnx is damaged"));
  EXPECT_THAT(read.error().message, HasSubstr(info.encoder.sha256));
}

}  // namespace
}  // namespace rsstab::rsdiff
