// SPDX-License-Identifier: Apache-2.0
#include "rsdiff/model_path.h"

#include <dlfcn.h>

#include <cstdlib>
#include <system_error>

namespace rsstab::rsdiff {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFolderVariable = "RSSTAB_MODEL_DIR";
constexpr const char* kInstalledFolder = "share/rs-stabilize/models";

bool Exists(const fs::path& path) {
  std::error_code ignored;
  return fs::exists(path, ignored);
}

// The program or shared library that this function was linked into.
fs::path OwnBinary() {
  std::error_code error;
  fs::path program = fs::read_symlink("/proc/self/exe", error);
  Dl_info info{};
  if (dladdr(reinterpret_cast<const void*>(&OwnBinary), &info) != 0 && info.dli_fname != nullptr) {
    // For the program itself this is argv[0], which need not be a path.
    fs::path holder = fs::canonical(info.dli_fname, error);
    if (!error) {
      return holder;
    }
  }
  return program;
}

// `name` as a file or folder of models in `folder`; empty when it is not there.
fs::path ModelIn(const fs::path& folder, const std::string& name) {
  fs::path model = folder / name / "model.json";
  return Exists(model) ? model : fs::path();
}

}  // namespace

Result<fs::path> FindModel(const std::string& wanted) {
  const std::string name = wanted.empty() ? kDefaultModel : wanted;
  const bool is_bare = name.find('/') == std::string::npos && !fs::path(name).has_extension();
  if (!wanted.empty() && (Exists(wanted) || !is_bare)) {
    std::error_code ignored;
    const fs::path file =
        fs::is_directory(wanted, ignored) ? fs::path(wanted) / "model.json" : fs::path(wanted);
    if (!Exists(file)) {
      return Fail(ErrorCode::kNotFound, "model {}: no such file", file.string());
    }
    return file;
  }
  if (const char* folder = std::getenv(kFolderVariable); folder != nullptr && *folder != '\0') {
    if (fs::path model = ModelIn(folder, name); !model.empty()) {
      return model;
    }
    return Fail(ErrorCode::kNotFound,
                "there is no model \"{}\" in {}, where the environment variable {} points", name,
                folder, kFolderVariable);
  }
  const fs::path binary = OwnBinary();
  for (fs::path above = binary.parent_path(); !above.empty(); above = above.parent_path()) {
    if (fs::path model = ModelIn(above / kInstalledFolder, name); !model.empty()) {
      return model;
    }
    if (above == above.root_path()) {
      break;
    }
  }
  return Fail(ErrorCode::kNotFound,
              "there is no model \"{}\" in any {} above {}; name a model file, or set the "
              "environment variable {} to the folder that holds models",
              name, kInstalledFolder, binary.parent_path().string(), kFolderVariable);
}

}  // namespace rsstab::rsdiff
