// SPDX-License-Identifier: Apache-2.0
// The `correct` command and --rs diffusion, as a user runs them, with a model whose answer is
// known.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <exiv2/exiv2.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "tests/cli/images/npz_reader.h"
#include "tests/end_to_end/program.h"
#include "tests/support/random_scene.h"
#include "tests/support/skew_model.h"
#include "tests/support/test_clip.h"
#include "tests/support/test_paths.h"

namespace rsstab::testing {
namespace {

using ::testing::HasSubstr;

constexpr int kWidth = 400;
constexpr int kHeight = 300;
// Levels of 255: grid of field and map (0.05 px) on a slope of some 10 levels per px, rounding.
constexpr double kMeanError = 1.0;
constexpr int kBorder = 24;  // px that the motion moves out of view

// 16 bits, three channels that differ; with the motion of the skew model or without.
cv::Mat Scene(bool recorded) {
  const WaveScene scene(5);
  cv::Mat picture(kHeight, kWidth, CV_16UC3);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const Eigen::Vector2d pixel(x, y);
      const Eigen::Vector2d place =
          recorded ? UnskewedFromRecorded(pixel, kWidth, kHeight, kWidth) : pixel;
      for (int c = 0; c < 3; ++c) {
        const double level = scene.At(place + Eigen::Vector2d(300.0 * c, 0.0));
        picture.at<cv::Vec3w>(y, x)[c] =
            static_cast<std::uint16_t>(std::clamp(257.0 * level, 0.0, 65535.0));
      }
    }
  }
  return picture;
}

// Mean difference in levels of 255, away from the borders.
double MeanDifference(const cv::Mat& a, const cv::Mat& b) {
  const cv::Rect inner(kBorder, kBorder, a.cols - 2 * kBorder, a.rows - 2 * kBorder);
  const double unit = a.depth() == CV_16U ? 257.0 : 1.0;
  return cv::norm(a(inner), b(inner), cv::NORM_L1) /
         static_cast<double>(inner.area() * a.channels()) / unit;
}

class Correct : public ::testing::Test {
 protected:
  [[nodiscard]] std::string Path(const std::string& name) const { return folder_ / name; }
  static ProgramResult Run(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "correct");
    arguments.insert(arguments.end(), {"--model", SkewModel().string()});
    return RunOrFail(arguments);
  }

 private:
  TemporaryFolder folder_;
};

TEST_F(Correct, KnownSkewIsUndone) {
  cv::imwrite(Path("in.png"), Scene(true));
  Run({Path("in.png"), "-o", Path("out.png"), "--full-frame"});
  const cv::Mat out = cv::imread(Path("out.png"), cv::IMREAD_UNCHANGED);
  ASSERT_EQ(out.type(), CV_16UC3);
  EXPECT_GT(MeanDifference(cv::imread(Path("in.png"), cv::IMREAD_UNCHANGED), Scene(false)), 10.0);
  EXPECT_LT(MeanDifference(out, Scene(false)), kMeanError);
}

TEST_F(Correct, FieldFilesTellTheSameMotionAtFullSize) {
  cv::imwrite(Path("in.png"), Scene(true));
  // --strength is part of what was corrected.
  Run({Path("in.png"), "-o", Path("out.png"), "--field", Path("fields/new"), "--strength", "0.5"});
  const auto arrays = ReadNpz(ReadText(Path("fields/new/in.npz")));
  const std::vector<float>& field = arrays.at("field.npy").values;
  constexpr std::size_t kPixels = std::size_t{kWidth} * kHeight;
  ASSERT_EQ(field.size(), 2 * kPixels);
  for (const Eigen::Vector2i& x : {Eigen::Vector2i(20, 15), Eigen::Vector2i(350, 280)}) {
    const auto i = static_cast<std::size_t>(x.y() * kWidth + x.x());
    const Eigen::Vector2d displacement(field[i], field[kPixels + i]);
    const Eigen::Vector2d back =
        UnskewedFromRecorded(x.cast<double>() + 2.0 * displacement, kWidth, kHeight, kWidth);
    EXPECT_LT((back - x.cast<double>()).norm(), 0.02);  // bilinear between the field's vertices
  }
  EXPECT_EQ(std::filesystem::file_size(Path("fields/new/in.flo")), 12 + 8 * kPixels);
  const cv::Mat colors = cv::imread(Path("fields/new/in-field.png"));
  ASSERT_EQ(colors.size(), cv::Size(kWidth, kHeight));
  // The middle row does not move: white.
  EXPECT_GT(cv::norm(colors.at<cv::Vec3b>(kHeight / 2, kWidth / 2), cv::NORM_INF), 240.0);
}

TEST_F(Correct, StrengthZeroIsTheSamePicture) {
  cv::imwrite(Path("in.png"), Scene(true));
  Run({Path("in.png"), "-o", Path("out.png"), "--strength", "0"});
  EXPECT_EQ(cv::norm(cv::imread(Path("out.png"), cv::IMREAD_UNCHANGED),
                     cv::imread(Path("in.png"), cv::IMREAD_UNCHANGED), cv::NORM_INF),
            0.0);
}

TEST_F(Correct, StoredRowsAreTheSensorsWhateverTheOrientation) {
  // Grey in three channels: JPEG keeps colours in half the size only.
  const auto grey = [](cv::Mat scene) {
    cv::extractChannel(scene, scene, 0);
    scene.convertTo(scene, CV_8U, 1.0 / 257.0);
    cv::cvtColor(scene, scene, cv::COLOR_GRAY2BGR);
    return scene;
  };
  const cv::Mat recorded = grey(Scene(true));
  const cv::Mat truth = grey(Scene(false));
  for (const char* name : {"in.jpg", "in.tif"}) {
    cv::imwrite(Path(name), recorded, {cv::IMWRITE_JPEG_QUALITY, 98});
    {
      auto image = Exiv2::ImageFactory::open(Path(name));
      image->readMetadata();
      image->exifData()["Exif.Image.Orientation"] = std::uint16_t{6};
      // 36 mm across a picture of 4:3: one width is 0.8 of the diagonal.
      image->exifData()["Exif.Photo.FocalLengthIn35mmFilm"] =
          static_cast<std::uint16_t>(std::lround(43.2666 * 0.8));
      image->writeMetadata();
    }
    const std::string out = std::string("out-") + name;
    Run({Path(name), "-o", Path(out), "--full-frame", "--quality", "98"});
    const auto image = Exiv2::ImageFactory::open(Path(out));
    image->readMetadata();
    EXPECT_EQ(image->exifData()["Exif.Image.Orientation"].toLong(), 6);
    // The decoder turns a TIFF; a JPEG stays as stored.
    cv::Mat stored = cv::imread(Path(out), cv::IMREAD_UNCHANGED);
    if (stored.rows != kHeight) {
      cv::rotate(stored, stored, cv::ROTATE_90_COUNTERCLOCKWISE);
    }
    ASSERT_EQ(stored.size(), truth.size());
    EXPECT_LT(MeanDifference(stored, truth), kMeanError + 1.0) << name;  // JPEG twice
  }
}

TEST_F(Correct, ManyPicturesGoIntoAFolder) {
  std::filesystem::create_directory(Path("trip"));
  cv::imwrite(Path("trip/a.png"), Scene(true));
  cv::imwrite(Path("trip/b.jpg"), Scene(true));
  cv::imwrite(Path("c.bmp"), cv::Mat::zeros(7, 5, CV_8UC1));
  const ProgramResult run = Run({Path("trip"), Path("*.bmp"), "-o", Path("new/folder")});
  for (const char* name : {"a.png", "b.jpg", "c.bmp"}) {
    EXPECT_TRUE(std::filesystem::exists(Path(std::string("new/folder/") + name))) << name;
  }
  EXPECT_THAT(run.error, HasSubstr("3 pictures corrected"));
}

TEST_F(Correct, SameSeedSameBytes) {
  cv::imwrite(Path("in.png"), Scene(true));
  Run({Path("in.png"), "-o", Path("one.png"), "--threads", "1", "--eta", "0.5"});
  Run({Path("in.png"), "-o", Path("two.png"), "--threads", "3", "--eta", "0.5"});
  EXPECT_EQ(ReadText(Path("one.png")), ReadText(Path("two.png")));
}

TEST_F(Correct, ClipsTakeTheirMotionFromPictures) {
  TestClip clip;
  clip.frames = 10;
  WriteTestClip(Path("clip.mp4"), clip);
  const std::vector<std::string> diffusion = {"--rs", "diffusion", "--model", SkewModel().string()};
  const auto with = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), diffusion.begin(), diffusion.end());
    return arguments;
  };
  const ProgramResult info = RunOrFail(with({"info", Path("clip.mp4")}));
  EXPECT_THAT(info.output, HasSubstr("diffusion model skew"));
  RunOrFail(with({Path("clip.mp4"), "-o", Path("out.mkv"), "--codec", "ffv1"}));
  RunOrFail(with({Path("clip.mp4"), "-o", Path("again.mkv"), "--codec", "ffv1"}));
  RunOrFail({Path("clip.mp4"), "-o", Path("off.mkv"), "--codec", "ffv1", "--rs", "off"});
  EXPECT_EQ(ReadText(Path("out.mkv")), ReadText(Path("again.mkv")));
  EXPECT_NE(ReadText(Path("out.mkv")), ReadText(Path("off.mkv")));
}

}  // namespace
}  // namespace rsstab::testing
