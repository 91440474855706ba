// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_RSDIFF_MODEL_PATH_H_
#define RSSTAB_RSDIFF_MODEL_PATH_H_

#include <filesystem>
#include <string>

#include "igf/base/result.h"

namespace rsstab::rsdiff {

// The model that is used unless another one is asked for.
inline constexpr const char* kDefaultModel = "compact";

// Finds the model file that `wanted` means: a JSON file, a folder with a model.json, or the bare
// name of an installed model ("" = kDefaultModel). Names are looked up in
//   1. the folder in the environment variable RSSTAB_MODEL_DIR, and nowhere else when it is set;
//   2. share/rs-stabilize/models beside or above the program or shared library that holds this code
//      (which covers an installation under any prefix, and the build tree).
// Errors: kNotFound, saying where it was looked for.
[[nodiscard]] Result<std::filesystem::path> FindModel(const std::string& wanted = "");

}  // namespace rsstab::rsdiff

#endif  // RSSTAB_RSDIFF_MODEL_PATH_H_
