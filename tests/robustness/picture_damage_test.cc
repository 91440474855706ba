// SPDX-License-Identifier: Apache-2.0
// The `correct` command and --rs diffusion against bad pictures, places and models.
#include <gmock/gmock.h>
#include <spdlog/fmt/fmt.h>

#include <map>
#include <opencv2/imgcodecs.hpp>

#include "tests/robustness/damage.h"
#include "tests/support/skew_model.h"

namespace rsstab::testing {
namespace {

using ::testing::HasSubstr;

class PictureDamage : public Damage {
 protected:
  void SetUp() override {
    cv::Mat picture(60, 80, CV_8UC3);
    cv::randu(picture, 0, 255);
    cv::imwrite(Path("good.png"), picture);
    cv::imwrite(Path("good.jpg"), picture);
    std::filesystem::copy(SkewModel(), Path("model"));
  }

  [[nodiscard]] static std::vector<std::string> With(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "correct");
    arguments.insert(arguments.end(), {"--model", "model"});
    return arguments;
  }
  void ExpectNo(const std::vector<std::string>& arguments, const std::string& words) {
    ExpectRefusal(With(arguments), 1, words);
  }
  void ExpectDone(const std::vector<std::string>& arguments) {
    const ProgramResult run = Run(With(arguments));
    EXPECT_EQ(run.exit_code, 0) << run.error;
  }
};

TEST_F(PictureDamage, BrokenPicturesAreNamed) {
  Bytes bytes = ReadBytes(Path("good.jpg"));
  bytes.resize(bytes.size() / 2);
  WriteBytes(Path("cut.jpg"), bytes);
  bytes = ReadBytes(Path("good.png"));
  bytes.resize(bytes.size() / 2);
  WriteBytes(Path("cut.png"), bytes);
  WriteText(Path("text.jpg"), "this is no picture");
  WriteBytes(Path("empty.jpg"), {});
  std::filesystem::create_directory(Path("nothing"));
  for (const char* name : {"cut.jpg", "cut.png", "text.jpg", "empty.jpg", "missing.jpg", "nothing",
                           "no*.jpg", "/dev/null"}) {
    ExpectNo({name, "-o", "out.png"}, name);
  }
}

TEST_F(PictureDamage, OthersGoOnAfterOneThatFails) {
  WriteText(Path("bad.jpg"), "this is no picture");
  const ProgramResult run =
      Run(With({"good.png", "bad.jpg", "missing.tif", "good.jpg", "-o", "out"}));
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.error, HasSubstr("bad.jpg: "));
  EXPECT_THAT(run.error, HasSubstr("missing.tif: no such file"));
  EXPECT_THAT(run.error, HasSubstr("2 of 4 pictures could not be corrected"));
  EXPECT_TRUE(std::filesystem::exists(Path("out/good.png")));
  EXPECT_TRUE(std::filesystem::exists(Path("out/good.jpg")));
  EXPECT_FALSE(std::filesystem::exists(Path("out/bad.jpg")));
}

TEST_F(PictureDamage, InputsAndForeignFilesAreKept) {
  const Bytes before = ReadBytes(Path("good.png"));
  ExpectNo({"good.png", "-o", "good.png", "--overwrite"}, "is an input itself");
  ExpectNo({"good.png", "-o", ".", "--overwrite"}, "is an input itself");
  ExpectNo({"good.png", "-o", "good.jpg"}, "--overwrite");
  EXPECT_EQ(ReadBytes(Path("good.png")), before);
}

TEST_F(PictureDamage, PlacesThatCannotBeWritten) {
  ExpectNo({"good.png", "-o", "no/such/out.png"}, "no/such/out.png");
  ExpectNo({"good.png", "-o", "/proc/rs-stabilize.png"}, "/proc/rs-stabilize.png");
  ExpectNo({"good.png", "good.jpg", "-o", "/proc/rs-stabilize"}, "/proc/rs-stabilize");
  ExpectNo({"good.png", "--field", "/proc/rs-stabilize"}, "/proc/rs-stabilize");
  ExpectNo({"good.png", "good.jpg", "-o", "model/model.json"}, "model/model.json");
  ExpectNo({"good.png", "-o", "out"}, "out");
  ExpectNo({"good.png", "-o", "out.gif"}, "out.gif");
}

TEST_F(PictureDamage, FullDisk) {
  ProgramSettings settings;
  settings.max_file_bytes = 2000;
  ExpectRefusal(With({"good.png", "-o", "out.png"}), 1, "out.png", settings);
  ExpectRefusal(With({"good.png", "--field", "fields"}), 1, "fields/good.flo", settings);
}

TEST_F(PictureDamage, ModelsThatAreMissingOrWrong) {
  const auto with_model = [](const std::string& model) {
    return std::vector<std::string>{"correct", "good.png", "-o", "out.png", "--model", model};
  };
  ExpectRefusal(with_model("missing.json"), 1, "missing.json");
  ExpectRefusal(with_model("no-such-name"), 1, "no-such-name");
  WriteText(Path("text.json"), "{");
  ExpectRefusal(with_model("text.json"), 1, "text.json");
  WriteBytes(Path("model/encoder.onnx"), {});
  ExpectRefusal(with_model("model"), 1, "encoder.onnx");
  std::filesystem::remove(Path("model/encoder.onnx"));
  ExpectRefusal(with_model("model"), 1, "encoder.onnx");
  WriteTestClip(Path("clip.mp4"));
  ExpectRefusal({"clip.mp4", "-o", "out.mp4", "--rs", "diffusion", "--model", "missing.json"}, 1,
                "missing.json");
}

TEST_F(PictureDamage, DevicesThatAreNotThere) {
  ExpectNo({"good.png", "-o", "out.png", "--device", "cuda"}, "cuda");
}

TEST_F(PictureDamage, SizesAndDepthsOfAllKinds) {
  std::filesystem::create_directory(Path("odd"));
  std::map<std::string, cv::Mat> pictures;
  for (const auto& [width, height] : {std::pair(1, 1), std::pair(1, 50), std::pair(50, 1),
                                      std::pair(2, 2), std::pair(37, 23), std::pair(4000, 3)}) {
    for (const int type : {CV_8UC1, CV_8UC3, CV_8UC4, CV_16UC1, CV_16UC4}) {
      cv::Mat picture(height, width, type);
      cv::randu(picture, 0, 250);
      const std::string name = fmt::format("{}-{}-{}.png", width, height, type);
      cv::imwrite(Path("odd/" + name), picture);
      pictures[name] = picture;
    }
  }
  ExpectDone({"odd", "-o", "out", "--field", "fields"});
  for (const auto& [name, picture] : pictures) {
    const cv::Mat out = cv::imread(Path("out/" + name), cv::IMREAD_UNCHANGED);
    EXPECT_EQ(out.size(), picture.size()) << name;
    EXPECT_EQ(out.type(), picture.type()) << name;
  }
}

TEST_F(PictureDamage, PicturesWithoutStructure) {
  cv::imwrite(Path("black.png"), cv::Mat::zeros(48, 64, CV_8UC3));
  ExpectDone({"black.png", "-o", "out.png"});
  EXPECT_EQ(cv::norm(cv::imread(Path("out.png")), cv::NORM_INF), 0.0);
}

TEST_F(PictureDamage, WrongUsage) {
  for (const std::vector<std::string>& arguments : std::vector<std::vector<std::string>>{
           {"correct"},
           {"correct", "good.png"},
           {"correct", "-o", "out.png"},
           {"correct", "good.png", "-o", "x.png", "--strength", "3"},
           {"correct", "good.png", "-o", "x.png", "--samples", "0"},
           {"correct", "good.png", "-o", "x.png", "--eta", "nan"},
           {"correct", "good.png", "-o", "x.png", "--device", "abacus"}}) {
    const ProgramResult run = Run(arguments);
    EXPECT_EQ(run.exit_code, 2) << run.error;
    EXPECT_THAT(run.error, ::testing::StartsWith("rs-stabilize: "));
  }
}

}  // namespace
}  // namespace rsstab::testing
