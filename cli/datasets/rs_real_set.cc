// SPDX-License-Identifier: Apache-2.0
#include "cli/datasets/rs_real_set.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <system_error>
#include <utility>
#include <vector>

#include "cli/datasets/labels.h"
#include "cli/images/npz_reader.h"
#include "evaluation/photo.h"
#include "igf/base/whole_file.h"
#include "igf/camera_profile_reader.h"
#include "igf/csv_parser.h"

namespace rsstab::datasets {
namespace {

namespace fs = std::filesystem;

using evaluation::LabelledPicture;
using evaluation::PictureClip;
using images::NpyArray;

constexpr std::uint64_t kMostSideBytes = 64ULL << 20U;

struct PictureSource {
  fs::path npz;
  fs::path jpg;  // need not be there
  std::string split;
};

using Arrays = std::map<std::string, NpyArray>;

// Columns [begin, begin + width) of packed RGB rows of `stride` bytes.
Result<Frame> CopyColumns(const std::uint8_t* pixels, std::size_t stride, int begin, int width,
                          int height) {
  auto frame = AllocateFrame(evaluation::RgbLayout(), width, height);
  for (int y = 0; frame && y < height; ++y) {
    std::memcpy(frame->planes[0].data + y * frame->planes[0].stride,
                pixels + static_cast<std::size_t>(y) * stride + 3 * static_cast<std::size_t>(begin),
                3 * static_cast<std::size_t>(width));
  }
  return frame;
}

// `half`: which half of the .jpg has it, 0 or 1.
Result<Frame> PictureOf(const Arrays& arrays, const char* name, const fs::path& jpg, int half,
                        int& black) {
  const auto found = arrays.find(name);
  if (found != arrays.end()) {
    const NpyArray& array = found->second;
    if (array.shape.size() != 3 || array.shape[2] != 3 || array.kind != 'u' ||
        array.item_size != 1 || array.shape[0] == 0 || array.shape[1] == 0 ||
        array.shape[0] > 65535 || array.shape[1] > 65535) {
      return Fail(ErrorCode::kCorruptData, "array {} is no picture of H x W x 3 bytes", name);
    }
    black = kExactBlack;
    return CopyColumns(array.bytes.data(), 3 * array.shape[1], 0, static_cast<int>(array.shape[1]),
                       static_cast<int>(array.shape[0]));
  }
  std::error_code ignored;
  if (!fs::exists(jpg, ignored)) {
    return Fail(ErrorCode::kCorruptData, "there is no array {}, and no picture {} instead", name,
                jpg.string());
  }
  const auto both = evaluation::LoadPhoto(jpg);
  if (!both) {
    return Propagate(both.error());
  }
  black = kJpegBlack;
  return CopyColumns(both->planes[0].data, static_cast<std::size_t>(both->planes[0].stride),
                     half * (both->width / 2), both->width / 2, both->height);
}

Status ReadFlow(const Arrays& arrays, LabelledPicture& picture) {
  const auto found = arrays.find("out_flow");
  if (found == arrays.end()) {
    return Fail(ErrorCode::kCorruptData, "there is no array out_flow");
  }
  return SetTruth(found->second, picture);
}

// What lies beside a sample.
Status ReadSideFiles(const fs::path& npz, LabelledPicture& picture) {
  std::error_code ignored;
  if (const fs::path path = fs::path(npz).replace_extension(".json"); fs::exists(path, ignored)) {
    const auto text = ReadWholeFile(path.string(), kMostSideBytes);
    if (!text) {
      return Propagate(text.error());
    }
    const auto json = nlohmann::json::parse(*text, nullptr, false);
    if (!json.is_object()) {
      return Fail(ErrorCode::kCorruptData, "{}: this is no JSON object", path.string());
    }
    if (json.contains("camera")) {
      const auto camera = igf::ParseCameraJson(json["camera"].dump());
      if (!camera) {
        return Propagate(camera.error(), path.string());
      }
      if (camera->camera.width != picture.rs.width || camera->camera.height != picture.rs.height) {
        return Fail(ErrorCode::kCorruptData,
                    "{}: a camera of {}x{} did not take a picture of {}x{}", path.string(),
                    camera->camera.width, camera->camera.height, picture.rs.width,
                    picture.rs.height);
      }
      picture.camera = camera->camera;
    }
    try {
      picture.frame_interval_s = json.value("frame_interval_s", 0.0);
      picture.strength = json.value("strength", std::string());
      picture.source = json.value("source", std::string());
    } catch (const nlohmann::json::exception& error) {
      return Fail(ErrorCode::kCorruptData, "{}: {}", path.string(), error.what());
    }
  }
  if (const fs::path path = fs::path(npz).replace_extension(".gyro.csv");
      fs::exists(path, ignored)) {
    const auto text = ReadWholeFile(path.string(), kMostSideBytes);
    if (!text) {
      return Propagate(text.error());
    }
    auto log = igf::ParseGyroCsv(*text);
    if (!log) {
      return Propagate(log.error(), path.string());
    }
    picture.gyro = std::move(log->gyro);
  }
  return {};
}

// The picture that goes with a sample; `name` relative to the data set.
fs::path JpgOf(const fs::path& root, std::string name) {
  for (std::size_t at = 0; (at = name.find("npz", at)) != std::string::npos; at += 3) {
    name.replace(at, 3, "jpg");
  }
  return root / name;
}

Result<LabelledPicture> LoadSample(const fs::path& npz, const fs::path& jpg) {
  const auto arrays = images::ReadNpz(npz.string());
  if (!arrays) {
    return Propagate(arrays.error());
  }
  LabelledPicture picture;
  int rs_black = kExactBlack;
  int gs_black = kExactBlack;
  auto rs = PictureOf(*arrays, "condition", jpg, 0, rs_black);
  auto gs = rs ? PictureOf(*arrays, "gs", jpg, 1, gs_black) : rs;
  if (!gs) {
    return Propagate(gs.error(), npz.string());
  }
  if (rs->width != gs->width || rs->height != gs->height) {
    return Fail(ErrorCode::kCorruptData, "{}: condition is {}x{}, gs is {}x{}", npz.string(),
                rs->width, rs->height, gs->width, gs->height);
  }
  picture.rs = std::move(*rs);
  picture.gs = std::move(*gs);
  if (Status status = ReadFlow(*arrays, picture); !status) {
    return Propagate(status.error(), npz.string());
  }
  if (Status status = LeaveOutBlackEdges(rs_black, gs_black, picture); !status) {
    return Propagate(status.error(), npz.string());
  }
  if (Status status = ReadSideFiles(npz, picture); !status) {
    return Propagate(status.error());
  }
  return picture;
}

class RsRealSet final : public evaluation::PictureSet {
 public:
  RsRealSet(std::vector<PictureClip> clips, std::map<std::string, PictureSource> pictures)
      : clips_(std::move(clips)), pictures_(std::move(pictures)) {}

  [[nodiscard]] std::span<const PictureClip> Clips() const override { return clips_; }

  [[nodiscard]] Result<LabelledPicture> Load(const std::string& name) const override {
    const auto found = pictures_.find(name);
    if (found == pictures_.end()) {
      return Fail(ErrorCode::kNotFound, "{}: there is no such sample", name);
    }
    auto picture = LoadSample(found->second.npz, found->second.jpg);
    if (picture) {
      picture->split = found->second.split;
    }
    return picture;
  }

 private:
  std::vector<PictureClip> clips_;
  std::map<std::string, PictureSource> pictures_;
};

// Frame 10 comes after frame 9, with zeros in front or without.
bool IsEarlier(const std::string& a, const std::string& b) {
  const auto number = [](const std::string& name) {
    const std::string stem = fs::path(name).filename().string();
    return stem.substr(std::min(stem.find_first_not_of('0'), stem.size()));
  };
  const std::string first = number(a);
  const std::string second = number(b);
  const bool are_numbers = (first + second).find_first_not_of("0123456789") == std::string::npos;
  return are_numbers && first.size() != second.size() ? first.size() < second.size() : a < b;
}

Status FindSamples(const fs::path& root, const fs::path& folder, const std::string& split,
                   std::map<std::string, PictureSource>& pictures) {
  std::error_code error;
  fs::recursive_directory_iterator entry(folder, error);
  for (; !error && entry != fs::recursive_directory_iterator(); entry.increment(error)) {
    if (entry->path().extension() == ".npz" && entry->is_regular_file(error)) {
      const fs::path relative = entry->path().lexically_relative(root);
      pictures[fs::path(relative).replace_extension().generic_string()] = {
          entry->path(), JpgOf(root, relative.generic_string()), split};
    }
  }
  if (error) {
    return Fail(ErrorCode::kNotFound, "{}: the folder cannot be read: {}.", folder.string(),
                error.message());
  }
  return {};
}

}  // namespace

Result<std::unique_ptr<evaluation::PictureSet>> OpenRsReal(const fs::path& folder,
                                                           const std::string& split) {
  std::error_code ignored;
  const fs::path inside = folder / "RS_Real";
  const fs::path root = fs::is_directory(inside, ignored) ? inside : folder;
  std::map<std::string, PictureSource> pictures;
  bool has_splits = false;
  for (const char* name : {"train", "test"}) {
    if (fs::is_directory(root / name, ignored)) {
      has_splits = true;
      if (split == name || split == "all") {
        if (Status status = FindSamples(root, root / name, name, pictures); !status) {
          return Propagate(status.error());
        }
      }
    }
  }
  if (!has_splits) {
    if (Status status = FindSamples(root, root, "", pictures); !status) {
      return Propagate(status.error());
    }
  }
  if (pictures.empty()) {
    return Fail(ErrorCode::kNotFound, "{}: there is no .npz sample{} in it.", root.string(),
                split == "all" ? "" : " of the split " + split);
  }
  std::vector<PictureClip> clips;
  for (const auto& [name, picture] : pictures) {  // in the order of their names
    const std::string parent = fs::path(name).parent_path().generic_string();
    const bool is_frame = fs::path(parent).filename().string().starts_with("seq");
    if (is_frame && !clips.empty() && clips.back().name == parent) {
      clips.back().pictures.push_back(name);
    } else {
      clips.push_back({is_frame ? parent : name, {name}});
    }
  }
  for (PictureClip& clip : clips) {
    std::sort(clip.pictures.begin(), clip.pictures.end(), IsEarlier);
  }
  return std::make_unique<RsRealSet>(std::move(clips), std::move(pictures));
}

}  // namespace rsstab::datasets
