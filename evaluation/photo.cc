// SPDX-License-Identifier: Apache-2.0
#include "evaluation/photo.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdint>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <sstream>
#include <string_view>
#include <system_error>

#include "igf/base/whole_file.h"

namespace rsstab::evaluation {
namespace {

constexpr std::uint64_t kMaxPhotoBytes = 1ULL << 30U;
constexpr std::uint64_t kMaxListBytes = 1ULL << 26U;
constexpr std::array<std::string_view, 8> kEndings = {".jpg",  ".jpeg", ".png",  ".tif",
                                                      ".tiff", ".bmp",  ".webp", ".ppm"};

bool IsPhotoName(const std::filesystem::path& path) {
  std::string ending = path.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return std::find(kEndings.begin(), kEndings.end(), ending) != kEndings.end();
}

}  // namespace

PixelLayout RgbLayout() {
  PixelLayout layout = RgbaLayout();
  layout.channels[0] = 3;
  return layout;
}

Result<Frame> LoadPhoto(const std::filesystem::path& path) {
  const Result<std::string> bytes = ReadWholeFile(path.string(), kMaxPhotoBytes);
  if (!bytes) {
    return Propagate(bytes.error());
  }
  try {
    const cv::Mat encoded(1, static_cast<int>(bytes->size()), CV_8U,
                          const_cast<char*>(bytes->data()));  // only read
    const cv::Mat picture = cv::imdecode(encoded, cv::IMREAD_COLOR);
    if (picture.empty()) {
      return Fail(ErrorCode::kCorruptData,
                  "{}: this is no picture that can be read; give a PNG, JPEG or TIFF file.",
                  path.string());
    }
    Result<Frame> frame = AllocateFrame(RgbLayout(), picture.cols, picture.rows);
    if (!frame) {
      return Propagate(frame.error(), path.string());
    }
    cv::Mat rgb(picture.rows, picture.cols, CV_8UC3, frame->planes[0].data,
                static_cast<std::size_t>(frame->planes[0].stride));
    cv::cvtColor(picture, rgb, cv::COLOR_BGR2RGB);
    return frame;
  } catch (const cv::Exception& error) {
    return Fail(ErrorCode::kCorruptData, "{}: {}", path.string(), error.err);
  }
}

Result<std::vector<std::filesystem::path>> ListPhotos(const std::filesystem::path& folder) {
  std::error_code error;
  std::vector<std::filesystem::path> photos;
  std::filesystem::directory_iterator entry(folder, error);
  for (; !error && entry != std::filesystem::directory_iterator(); entry.increment(error)) {
    if (IsPhotoName(entry->path()) && entry->is_regular_file(error)) {
      photos.push_back(entry->path());
    }
  }
  if (error) {
    return Fail(ErrorCode::kNotFound, "{}: the folder cannot be read: {}.", folder.string(),
                error.message());
  }
  if (photos.empty()) {
    return Fail(ErrorCode::kNotFound,
                "{}: no picture in this folder; give one with JPEG, PNG or TIFF files.",
                folder.string());
  }
  std::sort(photos.begin(), photos.end());
  return photos;
}

Result<std::set<std::string>> ReadPhotoList(const std::filesystem::path& file,
                                            const std::string& text) {
  const Result<std::string> content = ReadWholeFile(file.string(), kMaxListBytes);
  if (!content) {
    return Propagate(content.error());
  }
  std::set<std::string> names;
  std::istringstream lines(*content);
  for (std::string line; std::getline(lines, line);) {
    if (!line.empty() && line.back() == '\r') {
      line.pop_back();
    }
    if (const std::string name = line.substr(0, line.find(','));
        !name.empty() && line.find(text) != std::string::npos) {
      names.insert(name);
    }
  }
  if (names.empty()) {
    return Fail(ErrorCode::kNotFound, "{}: no line of this list {}.", file.string(),
                text.empty() ? "names a photo" : "contains '" + text + "'");
  }
  return names;
}

}  // namespace rsstab::evaluation
