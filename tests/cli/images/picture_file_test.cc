// SPDX-License-Identifier: Apache-2.0
#include "cli/images/picture_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <exiv2/exiv2.hpp>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "tests/support/test_paths.h"

namespace rsstab::images {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr int kWidth = 48;
constexpr int kHeight = 33;

// Every channel another slope, so that a swap shows.
cv::Mat Slopes(int type) {
  cv::Mat picture(kHeight, kWidth, type);
  const double top = picture.depth() == CV_8U ? 255.0 : 65535.0;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      for (int c = 0; c < picture.channels(); ++c) {
        const double share = (c + 1.0) / 5.0 + 0.1 * x / kWidth + 0.05 * y / kHeight;
        if (picture.depth() == CV_8U) {
          picture.ptr<std::uint8_t>(y)[x * picture.channels() + c] =
              static_cast<std::uint8_t>(top * share);
        } else {
          picture.ptr<std::uint16_t>(y)[x * picture.channels() + c] =
              static_cast<std::uint16_t>(top * share);
        }
      }
    }
  }
  return picture;
}

void WriteBytes(const std::string& path, const Bytes& bytes) {
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()),
             static_cast<std::streamsize>(bytes.size()));
}

// A proper header and no entries; only what says its colour space matters here.
constexpr int kProfileBytes = 132;
Exiv2::DataBuf Profile(const char* color_space) {
  Exiv2::DataBuf profile(kProfileBytes);
  std::memset(profile.pData_, 0, kProfileBytes);
  profile.pData_[3] = kProfileBytes;  // its size
  std::memcpy(profile.pData_ + 16, color_space, 4);
  std::memcpy(profile.pData_ + 36, "acsp", 4);
  return profile;
}

struct Tags {
  int orientation = 6;
  const char* color_space = "RGB ";
  bool with_thumbnail = false;
};

void Tag(const std::string& path, const Tags& tags) {
  auto image = Exiv2::ImageFactory::open(path);
  image->readMetadata();
  Exiv2::ExifData& exif = image->exifData();
  exif["Exif.Image.Orientation"] = static_cast<std::uint16_t>(tags.orientation);
  exif["Exif.Image.Model"] = "Pinhole 1";
  exif["Exif.Photo.FocalLengthIn35mmFilm"] = std::uint16_t{26};
  exif["Exif.GPSInfo.GPSLatitudeRef"] = "N";
  if (tags.with_thumbnail) {
    std::vector<std::uint8_t> thumbnail;
    cv::imencode(".jpg", cv::Mat::zeros(12, 16, CV_8UC3), thumbnail);
    Exiv2::ExifThumb(exif).setJpegThumbnail(thumbnail.data(), static_cast<long>(thumbnail.size()));
  }
  image->xmpData()["Xmp.dc.title"] = "A train";
  Exiv2::DataBuf profile = Profile(tags.color_space);
  image->setIccProfile(profile, false);
  image->writeMetadata();
}

struct Metadata {
  long orientation = 0;
  std::string model;
  std::string latitude;
  std::string title;
  long profile_bytes = 0;
  bool has_thumbnail = false;
};

Metadata ReadMetadata(const std::string& path) {
  auto image = Exiv2::ImageFactory::open(path);
  image->readMetadata();
  Exiv2::ExifData& exif = image->exifData();
  return {exif["Exif.Image.Orientation"].toLong(),
          exif["Exif.Image.Model"].toString(),
          exif["Exif.GPSInfo.GPSLatitudeRef"].toString(),
          image->xmpData()["Xmp.dc.title"].toString(),
          image->iccProfile()->size_,
          Exiv2::ExifThumb(exif).copy().size_ > 0};
}

class PictureFile : public ::testing::Test {
 protected:
  [[nodiscard]] std::string Path(const std::string& name) const { return folder_ / name; }

  // Reads `from`, writes it unchanged as `to`.
  std::vector<std::string> Copy(const std::string& from, const std::string& to, int quality = 95) {
    const auto picture = ReadPicture(Path(from));
    EXPECT_TRUE(picture) << picture.error().message;
    const auto encoded = EncodePicture(Path(to), picture->pixels.View(), quality, &picture->file);
    EXPECT_TRUE(encoded) << encoded.error().message;
    WriteBytes(Path(to), encoded->bytes);
    return encoded->losses;
  }

 private:
  rsstab::testing::TemporaryFolder folder_;
};

TEST_F(PictureFile, DepthAndChannelsSurviveLosslessFormats) {
  const std::pair<const char*, std::vector<int>> formats[] = {
      {"png", {CV_8UC1, CV_8UC3, CV_8UC4, CV_16UC1, CV_16UC3, CV_16UC4}},
      {"tif", {CV_8UC1, CV_8UC3, CV_8UC4, CV_16UC1, CV_16UC3, CV_16UC4}},
      {"bmp", {CV_8UC1, CV_8UC3}},
      {"pgm", {CV_8UC1, CV_16UC1}},
      {"ppm", {CV_8UC3, CV_16UC3}}};
  for (const auto& [ending, types] : formats) {
    for (const int type : types) {
      SCOPED_TRACE(ending + std::string(" of type ") + std::to_string(type));
      const cv::Mat picture = Slopes(type);
      const std::string from = std::string("from.") + ending;
      const std::string to = std::string("to.") + ending;
      ASSERT_TRUE(cv::imwrite(Path(from), picture));
      EXPECT_THAT(Copy(from, to), IsEmpty());
      const cv::Mat back = cv::imread(Path(to), cv::IMREAD_UNCHANGED);
      ASSERT_EQ(back.type(), type);
      EXPECT_EQ(cv::norm(back, picture, cv::NORM_INF), 0.0);
    }
  }
}

TEST_F(PictureFile, ColoursAreRedFirst) {
  cv::imwrite(Path("blue.png"), cv::Mat(4, 4, CV_8UC3, cv::Scalar(250, 20, 10)));
  const auto picture = ReadPicture(Path("blue.png"));
  ASSERT_TRUE(picture);
  EXPECT_EQ(picture->pixels.planes[0].data[0], 10);
  EXPECT_EQ(picture->pixels.planes[0].data[2], 250);
}

TEST_F(PictureFile, MetadataGoesAlongAndTheStoredRowsStay) {
  for (const char* ending : {"jpg", "png", "tif", "webp"}) {
    for (const int orientation : {1, 3, 6, 8}) {
      SCOPED_TRACE(std::string(ending) + " " + std::to_string(orientation));
      const cv::Mat picture = Slopes(CV_8UC3);
      const std::string from = std::string("from.") + ending;
      const std::string to = std::string("to.") + ending;
      ASSERT_TRUE(cv::imwrite(Path(from), picture));
      const cv::Mat stored = cv::imread(Path(from), cv::IMREAD_UNCHANGED);
      Tag(Path(from), {.orientation = orientation});
      const auto read = ReadPicture(Path(from));
      ASSERT_TRUE(read) << read.error().message;
      ASSERT_EQ(read->pixels.width, kWidth);  // not turned
      EXPECT_EQ(read->facts.orientation, orientation);
      cv::Mat rgb;
      cv::cvtColor(stored, rgb, cv::COLOR_BGR2RGB);
      for (int y = 0; y < kHeight; ++y) {
        ASSERT_EQ(
            std::memcmp(rgb.ptr(y), read->pixels.planes[0].data + y * read->pixels.planes[0].stride,
                        std::size_t{3} * kWidth),
            0);
      }
      ASSERT_TRUE(read->facts.focal_per_diagonal);
      EXPECT_NEAR(*read->facts.focal_per_diagonal, 26.0 / 43.27, 1e-3);
      EXPECT_THAT(Copy(from, to), IsEmpty());
      const Metadata metadata = ReadMetadata(Path(to));
      EXPECT_EQ(metadata.orientation, orientation);
      EXPECT_EQ(metadata.model, "Pinhole 1");
      EXPECT_EQ(metadata.latitude, "N");
      EXPECT_THAT(metadata.title, HasSubstr("A train"));
      if (ending != std::string("webp")) {  // Exiv2 cannot put one into the input
        EXPECT_EQ(metadata.profile_bytes, kProfileBytes);
      }
      // The file is still the picture that was written, not the one that was read.
      EXPECT_EQ(ReadPicture(Path(to))->pixels.height, kHeight);
    }
  }
}

// Exiv2 reads back what it writes even where others do not, so here the chunks themselves.
TEST_F(PictureFile, ProfilesStandWhereTheirFormatsWantThem) {
  cv::imwrite(Path("from.jpg"), Slopes(CV_8UC3));
  Tag(Path("from.jpg"), {});
  const Exiv2::DataBuf profile = Profile("RGB ");
  const std::string expected(reinterpret_cast<const char*>(profile.pData_), kProfileBytes);
  Copy("from.jpg", "to.webp");
  const Bytes webp_bytes = ReadPicture(Path("to.webp"))->file;
  const std::string webp(webp_bytes.begin(), webp_bytes.end());
  EXPECT_THAT(webp, HasSubstr(std::string("ICCP\x84\0\0\0", 8) + expected));
  EXPECT_EQ(ReadMetadata(Path("to.webp")).profile_bytes, kProfileBytes);
  Copy("from.jpg", "to.png");
  const Bytes png_bytes = ReadPicture(Path("to.png"))->file;
  const std::string png(png_bytes.begin(), png_bytes.end());
  const std::size_t chunk = png.find("iCCPICC profile");
  ASSERT_NE(chunk, std::string::npos);
  Bytes inflated(kProfileBytes);
  uLongf size = inflated.size();
  ASSERT_EQ(uncompress(inflated.data(), &size, png_bytes.data() + chunk + 17, 1000), Z_OK);
  EXPECT_EQ(std::string(inflated.begin(), inflated.end()), expected);
}

TEST_F(PictureFile, MetadataCrossesFormats) {
  cv::imwrite(Path("from.tif"), Slopes(CV_16UC3));
  Tag(Path("from.tif"), {.orientation = 8});
  EXPECT_THAT(Copy("from.tif", "to.jpg"), ::testing::ElementsAre("16 bits become 8"));
  const Metadata metadata = ReadMetadata(Path("to.jpg"));
  EXPECT_EQ(metadata.orientation, 8);
  EXPECT_EQ(metadata.model, "Pinhole 1");
  EXPECT_EQ(metadata.profile_bytes, kProfileBytes);
  const cv::Mat eight = cv::imread(Path("to.jpg"), cv::IMREAD_UNCHANGED);
  ASSERT_EQ(eight.size(), cv::Size(kWidth, kHeight));
  EXPECT_LT(cv::norm(eight, Slopes(CV_8UC3), cv::NORM_INF), 8.0);
}

TEST_F(PictureFile, PreviewAndAlienProfileAreLeftOut) {
  cv::imwrite(Path("from.jpg"), Slopes(CV_8UC1));
  Tag(Path("from.jpg"), {.color_space = "CMYK", .with_thumbnail = true});
  ASSERT_TRUE(ReadMetadata(Path("from.jpg")).has_thumbnail);
  Copy("from.jpg", "to.jpg");
  const Metadata metadata = ReadMetadata(Path("to.jpg"));
  EXPECT_FALSE(metadata.has_thumbnail);
  EXPECT_EQ(metadata.profile_bytes, 0);
  EXPECT_EQ(metadata.model, "Pinhole 1");
}

TEST_F(PictureFile, LossesAreTold) {
  cv::imwrite(Path("from.png"), Slopes(CV_16UC4));
  Tag(Path("from.png"), {});
  EXPECT_THAT(Copy("from.png", "to.jpg"),
              ::testing::ElementsAre("transparency is left out", "16 bits become 8"));
  EXPECT_THAT(
      Copy("from.png", "to.ppm"),
      ::testing::ElementsAre("transparency is left out", HasSubstr("metadata is left out")));
}

TEST_F(PictureFile, QualityIsObeyed) {
  cv::imwrite(Path("from.png"), Slopes(CV_8UC3));
  Copy("from.png", "fine.jpg", 100);
  Copy("from.png", "coarse.jpg", 10);
  EXPECT_GT(std::filesystem::file_size(Path("fine.jpg")),
            std::filesystem::file_size(Path("coarse.jpg")));
  Copy("from.png", "lossless.webp", 100);
  EXPECT_EQ(cv::norm(cv::imread(Path("lossless.webp")), Slopes(CV_8UC3), cv::NORM_INF), 0.0);
}

TEST_F(PictureFile, FurtherPagesAreCounted) {
  cv::imwritemulti(Path("pages.tif"),
                   std::vector<cv::Mat>{Slopes(CV_8UC3), cv::Mat::zeros(9, 9, CV_8UC3)});
  const auto picture = ReadPicture(Path("pages.tif"));
  ASSERT_TRUE(picture) << picture.error().message;
  EXPECT_EQ(picture->pages, 2U);
  EXPECT_EQ(picture->pixels.width, kWidth);
}

TEST_F(PictureFile, RefusalsNameTheFileAndTheReason) {
  WriteBytes(Path("empty.jpg"), {});
  WriteBytes(Path("text.jpg"), {'h', 'e', 'l', 'l', 'o'});
  cv::imwrite(Path("float.tif"), cv::Mat::ones(8, 8, CV_32FC3));
  const std::pair<const char*, ErrorCode> cases[] = {{"missing.jpg", ErrorCode::kNotFound},
                                                     {"empty.jpg", ErrorCode::kCorruptData},
                                                     {"text.jpg", ErrorCode::kCorruptData},
                                                     {"float.tif", ErrorCode::kUnsupported},
                                                     {".", ErrorCode::kIo}};
  for (const auto& [name, code] : cases) {
    const auto picture = ReadPicture(Path(name));
    ASSERT_FALSE(picture) << name;
    EXPECT_EQ(picture.error().code, code) << picture.error().message;
    EXPECT_THAT(picture.error().message, HasSubstr(name));
  }
  cv::imwrite(Path("colour.png"), Slopes(CV_8UC3));
  const auto colour = ReadPicture(Path("colour.png"));
  ASSERT_TRUE(colour);
  for (const char* name : {"to", "to.gif", "to.pgm"}) {
    const auto encoded = EncodePicture(Path(name), colour->pixels.View(), 95);
    ASSERT_FALSE(encoded) << name;
    EXPECT_THAT(encoded.error().message, HasSubstr(name));
  }
}

TEST_F(PictureFile, CutOffFilesDoNotCrash) {
  for (const char* ending : {"jpg", "png", "tif", "webp", "bmp", "jp2"}) {
    const std::string whole = Path(std::string("whole.") + ending);
    cv::Mat large;
    cv::resize(Slopes(CV_8UC3), large, cv::Size(200, 150));
    ASSERT_TRUE(cv::imwrite(whole, large));
    if (ending != std::string("bmp") && ending != std::string("jp2")) {
      Tag(whole, {.with_thumbnail = ending == std::string("jpg")});
    }
    const Bytes bytes = ReadPicture(whole)->file;
    for (std::size_t kept = 0; kept < bytes.size(); kept += 1 + bytes.size() / 40) {
      WriteBytes(Path("cut"), Bytes(bytes.begin(), bytes.begin() + static_cast<long>(kept)));
      const auto picture = ReadPicture(Path("cut"));
      EXPECT_FALSE(picture && ending == std::string("jpg")) << kept;
      if (picture) {
        (void)EncodePicture(Path("to.png"), picture->pixels.View(), 95, &picture->file);
      }
    }
  }
}

}  // namespace
}  // namespace rsstab::images
