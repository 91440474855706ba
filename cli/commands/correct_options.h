// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_COMMANDS_CORRECT_OPTIONS_H_
#define RSSTAB_CLI_COMMANDS_CORRECT_OPTIONS_H_

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "stabilizer/interpolation.h"
#include "stabilizer/pipeline/option_table.h"

namespace rsstab::cli {

// What `rs-stabilize correct IMAGE...` is told. Defaults are the member initialisers.
struct CorrectOptions {
  std::vector<std::string> images;  // files, folders and patterns
  std::string output;               // file or folder; empty: only fields are wanted
  std::string field_folder;         // empty: no fields are wanted
  bool overwrite = false;
  int quality = 95;
  bool full_frame = false;
  stabilizer::Interpolation interpolation = stabilizer::Interpolation::kLanczos;

  double strength = 1.0;
  std::optional<double> focal_px;  // empty: from EXIF, else one picture width

  std::string model;  // see rsdiff/model_path.h; empty: the installed compact model
  int samples = 8;
  int steps = 0;                   // 0 = as the model says
  std::optional<double> guidance;  // empty: as the model says
  std::optional<double> eta;       // empty: as the model says
  std::uint64_t seed = 0;
  std::string device = "auto";
  int threads = 0;  // 0 = one per processor
};

// All options but the pictures, which are the command's positional arguments.
[[nodiscard]] const pipeline::OptionTable<CorrectOptions>& CorrectOptionTable();

// Checks what must go together. Errors: kInvalidArgument naming the option.
[[nodiscard]] Status Validate(const CorrectOptions& options);

}  // namespace rsstab::cli

#endif  // RSSTAB_CLI_COMMANDS_CORRECT_OPTIONS_H_
