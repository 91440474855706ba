// SPDX-License-Identifier: Apache-2.0
#include "cli/datasets/pair_set.h"

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "cli/datasets/labels.h"
#include "cli/images/flo_file.h"
#include "cli/images/npz_reader.h"
#include "cli/images/picture_file.h"
#include "evaluation/photo.h"

namespace rsstab::datasets {
namespace {

namespace fs = std::filesystem;

using evaluation::LabelledPicture;
using evaluation::PictureClip;

struct Pair {
  std::string name;
  std::string clip;  // equal to the name where the pair is no frame of a clip
  fs::path rs;
  fs::path gs;
  fs::path field;     // empty: nobody knows it
  fs::path previous;  // empty: there is none, or it is a pair of its own
  bool reference_is_first = false;
};

using Files = std::set<fs::path>;  // of one folder

bool EndsWith(const std::string& stem, const std::string& ending, std::string& front) {
  if (!stem.ends_with(ending)) {
    return false;
  }
  front = stem.substr(0, stem.size() - ending.size());
  return true;
}

// `stem` with any ending that a picture may have, or an empty path.
fs::path PictureNamed(const Files& files, const fs::path& folder, const std::string& stem) {
  const fs::path prefix = folder / stem;
  for (auto file = files.lower_bound(prefix); file != files.end(); ++file) {
    if (file->stem() != stem) {
      if (!file->stem().string().starts_with(stem)) {
        break;
      }
      continue;
    }
    if (images::HasPictureEnding(file->string())) {
      return *file;
    }
  }
  return {};
}

fs::path FieldNamed(const fs::path& folder, const std::string& stem) {
  std::error_code ignored;
  for (const fs::path& place : {folder, folder / "flow", folder.parent_path() / "flow"}) {
    for (const char* ending : {".flo", ".npz"}) {
      if (fs::path path = place / (stem + ending); fs::is_regular_file(path, ignored)) {
        return path;
      }
    }
  }
  return {};
}

class PairFinder {
 public:
  PairFinder(fs::path root, bool reference_is_first)
      : root_(std::move(root)), reference_is_first_(reference_is_first) {}

  void Look(const fs::path& folder, const Files& files) {
    for (const fs::path& file : files) {
      if (images::HasPictureEnding(file.string())) {
        LookAt(folder, files, file);
      }
    }
    if (folder.filename() == "rs") {
      LookBeside(folder, files);
    }
  }

  std::vector<Pair> pairs;

 private:
  [[nodiscard]] std::string NameOf(const fs::path& path) const {
    return path.lexically_relative(root_).generic_string();
  }

  void LookAt(const fs::path& folder, const Files& files, const fs::path& rs) {
    const std::string stem = rs.stem().string();
    std::string name;
    if (stem == "rs_1") {
      const fs::path gs = PictureNamed(files, folder, "gs_1");
      if (!gs.empty()) {
        pairs.push_back({NameOf(folder), NameOf(folder), rs, gs, FieldNamed(folder, "flow_1"),
                         PictureNamed(files, folder, "rs_0"), false});
      }
    } else if (EndsWith(stem, "_rolling", name)) {
      const fs::path middle = PictureNamed(files, folder, name + "_global_middle");
      const fs::path first = PictureNamed(files, folder, name + "_global_first");
      if (!middle.empty() || !first.empty()) {
        pairs.push_back({NameOf(folder / name),
                         NameOf(folder),
                         rs,
                         middle.empty() ? first : middle,
                         FieldNamed(folder, name),
                         {},
                         middle.empty()});
      }
    } else if (EndsWith(stem, "_rs", name)) {
      const fs::path gs = PictureNamed(files, folder, name + "_gs");
      if (!gs.empty()) {
        Add(NameOf(folder / name), rs, gs, FieldNamed(folder, name));
      }
    }
  }

  // rs/NAME and its sibling gs/NAME.
  void LookBeside(const fs::path& folder, const Files& files) {
    const fs::path beside = folder.parent_path() / "gs";
    Files truths;
    std::error_code ignored;
    for (fs::directory_iterator entry(beside, ignored), end; !ignored && entry != end;
         entry.increment(ignored)) {
      truths.insert(entry->path());
    }
    for (const fs::path& rs : files) {
      const std::string stem = rs.stem().string();
      const fs::path gs = PictureNamed(truths, beside, stem);
      if (!gs.empty() && images::HasPictureEnding(rs.string())) {
        Add(NameOf(folder.parent_path() / stem), rs, gs, FieldNamed(folder, stem));
      }
    }
  }

  void Add(const std::string& name, const fs::path& rs, const fs::path& gs, const fs::path& field) {
    pairs.push_back({name, name, rs, gs, field, {}, reference_is_first_});
  }

  fs::path root_;
  bool reference_is_first_;
};

Result<images::NpyArray> ReadField(const fs::path& path) {
  if (path.extension() == ".flo") {
    return images::ReadFlo(path.string());
  }
  auto arrays = images::ReadNpz(path.string());
  if (!arrays) {
    return Propagate(arrays.error());
  }
  for (const char* name : {"field", "out_flow"}) {
    if (const auto found = arrays->find(name); found != arrays->end()) {
      return std::move(found->second);
    }
  }
  return Fail(ErrorCode::kCorruptData, "{}: there is no array field or out_flow", path.string());
}

bool IsJpeg(const fs::path& path) {
  const std::string ending = path.extension().string();
  return ending == ".jpg" || ending == ".jpeg" || ending == ".JPG" || ending == ".JPEG";
}

Result<LabelledPicture> LoadPair(const Pair& pair) {
  auto rs = evaluation::LoadPhoto(pair.rs);
  auto gs = rs ? evaluation::LoadPhoto(pair.gs) : rs;
  if (!gs) {
    return Propagate(gs.error());
  }
  if (rs->width != gs->width || rs->height != gs->height) {
    return Fail(ErrorCode::kCorruptData, "{}: {} is {}x{}, {} is {}x{}; a pair must be of one size",
                pair.name, pair.rs.filename().string(), rs->width, rs->height,
                pair.gs.filename().string(), gs->width, gs->height);
  }
  LabelledPicture picture;
  picture.rs = std::move(*rs);
  picture.gs = std::move(*gs);
  picture.reference_row = pair.reference_is_first ? 0.0 : (picture.rs.height - 1) / 2.0;
  picture.source = pair.clip;
  if (!pair.field.empty()) {
    const auto field = ReadField(pair.field);
    if (!field) {
      return Propagate(field.error());
    }
    if (Status status = SetTruth(*field, picture); !status) {
      return Propagate(status.error(), pair.field.string());
    }
  }
  if (!pair.previous.empty()) {
    auto previous = evaluation::LoadPhoto(pair.previous);
    if (!previous) {
      return Propagate(previous.error());
    }
    if (previous->width == picture.rs.width && previous->height == picture.rs.height) {
      picture.previous = std::move(*previous);
    }
  }
  const auto black = [](const fs::path& path) { return IsJpeg(path) ? kJpegBlack : kExactBlack; };
  if (Status status = LeaveOutBlackEdges(black(pair.rs), black(pair.gs), picture); !status) {
    return Propagate(status.error(), pair.name);
  }
  return picture;
}

class PairSet final : public evaluation::PictureSet {
 public:
  explicit PairSet(std::vector<Pair> pairs) {
    for (Pair& pair : pairs) {
      if (clips_.empty() || clips_.back().name != pair.clip) {
        clips_.push_back({pair.clip, {}});
      }
      clips_.back().pictures.push_back(pair.name);
      const std::string name = pair.name;
      pairs_.emplace(name, std::move(pair));
    }
  }

  [[nodiscard]] std::span<const PictureClip> Clips() const override { return clips_; }

  [[nodiscard]] Result<LabelledPicture> Load(const std::string& name) const override {
    const auto found = pairs_.find(name);
    if (found == pairs_.end()) {
      return Fail(ErrorCode::kNotFound, "{}: there is no such pair", name);
    }
    return LoadPair(found->second);
  }

 private:
  std::vector<PictureClip> clips_;
  std::map<std::string, Pair> pairs_;
};

}  // namespace

Result<std::unique_ptr<evaluation::PictureSet>> OpenPairs(const fs::path& folder,
                                                          bool reference_is_first) {
  std::map<fs::path, Files> folders;
  std::error_code error;
  fs::recursive_directory_iterator entry(folder, error);
  for (; !error && entry != fs::recursive_directory_iterator(); entry.increment(error)) {
    if (entry->is_regular_file(error)) {
      folders[entry->path().parent_path()].insert(entry->path());
    }
  }
  if (error) {
    return Fail(ErrorCode::kNotFound, "{}: the folder cannot be read: {}.", folder.string(),
                error.message());
  }
  PairFinder finder(folder, reference_is_first);
  for (const auto& [path, files] : folders) {
    finder.Look(path, files);
  }
  if (finder.pairs.empty()) {
    return Fail(ErrorCode::kNotFound,
                "{}: it holds no pair of pictures such as rs_1.png and gs_1.png, "
                "001_rolling.png and 001_global_middle.png, rs/a.png and gs/a.png, or a_rs.png and "
                "a_gs.png.",
                folder.string());
  }
  std::sort(finder.pairs.begin(), finder.pairs.end(), [](const Pair& a, const Pair& b) {
    return std::tie(a.clip, a.name) < std::tie(b.clip, b.name);
  });
  return std::make_unique<PairSet>(std::move(finder.pairs));
}

}  // namespace rsstab::datasets
