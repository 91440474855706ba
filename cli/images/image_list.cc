// SPDX-License-Identifier: Apache-2.0
#include "cli/images/image_list.h"

#include <glob.h>

#include <algorithm>
#include <filesystem>
#include <set>
#include <system_error>
#include <utility>

#include "cli/images/picture_file.h"

namespace rsstab::images {
namespace {

namespace fs = std::filesystem;

Result<std::vector<std::string>> PicturesIn(const fs::path& folder) {
  std::vector<std::string> paths;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    const fs::path& path = entry->path();
    std::error_code ignored;
    if (!path.filename().string().starts_with(".") && HasPictureEnding(path.string()) &&
        !entry->is_directory(ignored)) {
      paths.push_back(path.string());
    }
  }
  if (error) {
    return Fail(ErrorCode::kIo, "{}: {}", folder.string(), error.message());
  }
  if (paths.empty()) {
    return Fail(ErrorCode::kNotFound, "{}: there is no picture in this folder", folder.string());
  }
  std::sort(paths.begin(), paths.end());
  return paths;
}

// The files that a pattern matches; folders among them are left out.
std::vector<std::string> Matches(const std::string& pattern) {
  glob_t found{};
  std::vector<std::string> paths;
  if (glob(pattern.c_str(), 0, nullptr, &found) == 0) {
    for (std::size_t i = 0; i < found.gl_pathc; ++i) {
      std::error_code ignored;
      if (!fs::is_directory(found.gl_pathv[i], ignored)) {
        paths.emplace_back(found.gl_pathv[i]);
      }
    }
  }
  globfree(&found);
  return paths;
}

}  // namespace

ImageList ListImages(const std::vector<std::string>& arguments) {
  ImageList list;
  list.is_plural = arguments.size() > 1;
  std::set<std::string> known;
  const auto add = [&](const std::vector<std::string>& paths) {
    for (const std::string& path : paths) {
      if (known.insert(path).second) {
        list.paths.push_back(path);
      }
    }
  };
  for (const std::string& argument : arguments) {
    std::error_code ignored;
    if (fs::is_directory(argument, ignored)) {
      list.is_plural = true;
      auto paths = PicturesIn(argument);
      if (paths) {
        add(*paths);
      } else {
        list.problems.push_back(std::move(paths.error()));
      }
    } else if (!fs::exists(argument, ignored) &&
               argument.find_first_of("*?[") != std::string::npos) {
      list.is_plural = true;
      const std::vector<std::string> paths = Matches(argument);
      add(paths);
      if (paths.empty()) {
        list.problems.push_back(
            {ErrorCode::kNotFound, argument + ": no file has a name of this pattern"});
      }
    } else {
      add({argument});
    }
  }
  return list;
}

}  // namespace rsstab::images
