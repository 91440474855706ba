// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_IMAGES_FIELD_FILES_H_
#define RSSTAB_CLI_IMAGES_FIELD_FILES_H_

#include <array>
#include <filesystem>
#include <span>
#include <string>

#include "igf/base/motion_field.h"
#include "igf/base/parallel_for.h"
#include "igf/base/result.h"

namespace rsstab::images {

// The files that tell one picture's motion field to other programs.
struct FieldFiles {
  std::string flo;      // see flo_file.h
  std::string npz;      // `field` 2 x height x width (x, then y) and `spread` height x width, px
  std::string picture;  // PNG, see flow_colors.h

  // folder/name.flo, folder/name.npz, folder/name-field.png
  FieldFiles(const std::filesystem::path& folder, const std::string& name);
  [[nodiscard]] std::array<std::string, 3> All() const { return {flo, npz, picture}; }
};

// Writes them, each pixel its own displacement. `vertex_spread_px`: one number for each vertex of
// `field`, infinite where nothing is known. Replaces files that exist.
// Errors: kInvalidArgument when there is not one spread for each vertex; kIo.
[[nodiscard]] Status WriteFieldFiles(const FieldFiles& files, const MotionField& field,
                                     std::span<const float> vertex_spread_px, WorkerPool& workers);

}  // namespace rsstab::images

#endif  // RSSTAB_CLI_IMAGES_FIELD_FILES_H_
