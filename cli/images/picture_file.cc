// SPDX-License-Identifier: Apache-2.0
#include "cli/images/picture_file.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <iostream>
#include <memory>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string_view>
#include <utility>

#include "igf/base/whole_file.h"

namespace rsstab::images {
namespace {

constexpr std::uint64_t kMaxFileBytes = std::uint64_t{4} << 30U;

// What a format that OpenCV writes can hold.
struct Format {
  std::string_view ending;
  bool deep;   // 16 bits beside 8
  bool alpha;  // a fourth channel
  bool grey = true;
  bool color = true;
};
constexpr std::array<Format, 14> kFormats = {{{".jpg", false, false},
                                              {".jpeg", false, false},
                                              {".jpe", false, false},
                                              {".png", true, true},
                                              {".tif", true, true},
                                              {".tiff", true, true},
                                              {".webp", false, true},
                                              {".jp2", true, false},
                                              {".bmp", false, false},
                                              {".dib", false, false},
                                              {".pgm", true, false, true, false},
                                              {".ppm", true, false, false, true},
                                              {".pnm", true, false},
                                              {".pam", false, false}}};

std::string EndingOf(const std::string& path) {
  std::string ending = std::filesystem::path(path).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return ending;
}

const Format* FormatOf(const std::string& path) {
  const std::string ending = EndingOf(path);
  const auto* found = std::find_if(kFormats.begin(), kFormats.end(),
                                   [&](const Format& format) { return format.ending == ending; });
  return found == kFormats.end() ? nullptr : found;
}

bool IsTiff(const Bytes& file) {
  constexpr std::string_view kLittle("II*\0", 4);
  constexpr std::string_view kBig("MM\0*", 4);
  const std::string_view head(reinterpret_cast<const char*>(file.data()),
                              std::min<std::size_t>(file.size(), 4));
  return head == kLittle || head == kBig;
}

// OpenCV's message without the place in its source.
std::string Reason(const cv::Exception& error) {
  std::string text = error.err.empty() ? error.what() : error.err;
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

// OpenCV has blue first, everybody else red.
void SwapRedAndBlue(const cv::Mat& from, cv::Mat& to) {
  if (from.channels() == 1) {
    to = from;
  } else {
    cv::cvtColor(from, to, from.channels() == 3 ? cv::COLOR_BGR2RGB : cv::COLOR_BGRA2RGBA);
  }
}

// OpenCV prints its own words about damaged files; while this lives, it does not.
class QuietOpenCv {
 public:
  QuietOpenCv()
      : buffer_(std::cerr.rdbuf(nullptr)),
        level_(cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT)) {}
  QuietOpenCv(const QuietOpenCv&) = delete;
  QuietOpenCv& operator=(const QuietOpenCv&) = delete;
  ~QuietOpenCv() {
    cv::utils::logging::setLogLevel(level_);
    std::cerr.rdbuf(buffer_);
    std::cerr.clear();
  }

 private:
  std::streambuf* buffer_;
  cv::utils::logging::LogLevel level_;
};

// True for a JPEG file that ends before its end marker: libjpeg fills up with grey. `file` begins
// with the marker of a JPEG image.
bool IsCutOffJpeg(const Bytes& file) {
  constexpr std::uint8_t kStartOfScan = 0xDA;
  constexpr std::uint8_t kEnd = 0xD9;
  std::size_t at = 2;
  while (at + 3 < file.size()) {
    const std::uint8_t marker = file[at + 1];
    if (file[at] != 0xFF) {
      return false;  // not what this knows to walk through: the decoder's word counts
    }
    if (marker == kEnd) {
      return false;
    }
    if (marker == 0xFF) {  // filling
      ++at;
      continue;
    }
    at += 2 + (std::size_t{file[at + 2]} << 8U) + file[at + 3];
    if (marker != kStartOfScan) {
      continue;
    }
    // In a scan FF is followed by 00, or by a restart marker, or it ends the scan.
    const auto ends_scan = [&file](std::size_t i) {
      const std::uint8_t next = file[i + 1];
      return file[i] == 0xFF && next != 0x00 && (next < 0xD0 || next > 0xD7);
    };
    while (at + 1 < file.size() && !ends_scan(at)) {
      ++at;
    }
  }
  return !(at + 1 < file.size() && file[at] == 0xFF && file[at + 1] == kEnd);
}

bool IsJpeg(const Bytes& file) {
  return file.size() > 2 && file[0] == 0xFF && file[1] == 0xD8 && file[2] == 0xFF;
}

Result<cv::Mat> Decode(const std::string& path, const Bytes& file) {
  if (IsJpeg(file) && IsCutOffJpeg(file)) {
    return Fail(ErrorCode::kCorruptData, "{}: the file ends in the middle of the picture", path);
  }
  cv::Mat stored;
  const QuietOpenCv quiet;
  try {
    // "Unchanged" leaves depth, alpha and (but for TIFF) the orientation alone.
    stored = cv::imdecode(file, cv::IMREAD_UNCHANGED);
  } catch (const cv::Exception& error) {
    return Fail(ErrorCode::kCorruptData, "{}: {}", path, Reason(error));
  }
  if (stored.empty()) {
    return Fail(ErrorCode::kCorruptData,
                "{}: this is no picture that can be read, or it is damaged", path);
  }
  const bool known_depth = stored.depth() == CV_8U || stored.depth() == CV_16U;
  const bool known_channels =
      stored.channels() == 1 || stored.channels() == 3 || stored.channels() == 4;
  if (!known_depth || !known_channels) {
    return Fail(ErrorCode::kUnsupported,
                "{}: pictures of 8 or 16 bits a sample, grey or colour, can be corrected; this one "
                "has other samples",
                path);
  }
  return stored;
}

// Shares the samples of `picture`.
Frame ToFrame(cv::Mat picture) {
  Frame frame;
  frame.layout.num_planes = 1;
  frame.layout.channels[0] = picture.channels();
  frame.layout.bit_depth = picture.depth() == CV_8U ? 8 : 16;
  frame.layout.is_rgb = picture.channels() > 1;
  frame.layout.full_range = true;
  frame.width = picture.cols;
  frame.height = picture.rows;
  frame.planes[0] = {picture.data, static_cast<std::ptrdiff_t>(picture.step), picture.cols,
                     picture.rows};
  frame.storage = std::make_shared<cv::Mat>(std::move(picture));
  return frame;
}

// The picture as OpenCV wants it, with what `format` cannot hold taken away.
cv::Mat FitToFormat(const FrameView& pixels, const Format& format,
                    std::vector<std::string>& losses) {
  const PixelLayout& layout = pixels.layout;
  const int depth = layout.bit_depth == 8 ? CV_8U : CV_16U;
  // cv::Mat has no const view; it is only read.
  const cv::Mat shared(pixels.height, pixels.width, CV_MAKETYPE(depth, layout.channels[0]),
                       const_cast<std::uint8_t*>(
                           pixels.planes[0].data),  // NOLINT(cppcoreguidelines-pro-type-const-cast)
                       static_cast<std::size_t>(pixels.planes[0].stride));
  cv::Mat picture;
  SwapRedAndBlue(shared, picture);
  if (picture.channels() == 4 && !format.alpha) {
    cv::cvtColor(picture, picture, cv::COLOR_BGRA2BGR);
    losses.emplace_back("transparency is left out");
  }
  if (depth == CV_16U && !format.deep) {
    picture.convertTo(picture, CV_8U, 1.0 / 257.0);
    losses.emplace_back("16 bits become 8");
  }
  if (picture.channels() == 1 && !format.grey) {
    cv::cvtColor(picture, picture, cv::COLOR_GRAY2BGR);
  }
  return picture;
}

std::vector<int> EncoderSettings(int quality) {
  constexpr int kLossless = 101;  // of WebP
  constexpr int kPerMille = 10;   // JPEG 2000 counts in thousandths of the raw size
  return {cv::IMWRITE_JPEG_QUALITY,
          quality,
          cv::IMWRITE_WEBP_QUALITY,
          quality == 100 ? kLossless : quality,
          cv::IMWRITE_JPEG2000_COMPRESSION_X1000,
          quality * kPerMille};
}

}  // namespace

Result<Picture> ReadPicture(const std::string& path) {
  const auto content = ReadWholeFile(path, kMaxFileBytes);
  if (!content) {
    return Propagate(content.error());
  }
  Picture picture;
  picture.file.assign(content->begin(), content->end());
  picture.facts = ReadFacts(picture.file);
  const bool is_turned_by_decoder = IsTiff(picture.file) && picture.facts.orientation != 1;
  const auto upright = is_turned_by_decoder ? WithoutOrientation(picture.file) : picture.file;
  if (!upright) {
    return Propagate(upright.error(), path);
  }
  auto stored = Decode(path, *upright);
  if (!stored) {
    return Propagate(stored.error());
  }
  if (IsTiff(picture.file)) {
    picture.pages = cv::imcount(path);
  }
  SwapRedAndBlue(*stored, *stored);
  picture.pixels = ToFrame(std::move(*stored));
  return picture;
}

Result<EncodedPicture> EncodePicture(const std::string& path, const FrameView& pixels, int quality,
                                     const Bytes* original) {
  const Format* format = FormatOf(path);
  if (format == nullptr) {
    return Fail(ErrorCode::kUnsupported,
                "{}: pictures can be written as .jpg, .png, .tif, .webp, .jp2, .bmp, .pgm, .ppm, "
                ".pnm and .pam",
                path);
  }
  if (!format->color && pixels.layout.channels[0] > 1) {
    return Fail(ErrorCode::kInvalidArgument, "{}: this format holds no colours", path);
  }
  EncodedPicture encoded;
  const QuietOpenCv quiet;
  try {
    const cv::Mat picture = FitToFormat(pixels, *format, encoded.losses);
    if (!cv::imencode(std::string(format->ending), picture, encoded.bytes,
                      EncoderSettings(quality))) {
      return Fail(ErrorCode::kInvalidArgument, "{}: this format cannot hold the picture", path);
    }
  } catch (const cv::Exception& error) {
    return Fail(ErrorCode::kInvalidArgument, "{}: this format cannot hold the picture: {}", path,
                Reason(error));
  }
  if (original == nullptr) {
    return encoded;
  }
  auto complete = WithMetadataOf(*original, encoded.bytes, pixels.layout.channels[0]);
  if (complete) {
    encoded.bytes = std::move(*complete);
  } else {
    encoded.losses.push_back("metadata is left out: " + complete.error().message);
  }
  return encoded;
}

bool HasPictureEnding(const std::string& path) { return FormatOf(path) != nullptr; }

}  // namespace rsstab::images
