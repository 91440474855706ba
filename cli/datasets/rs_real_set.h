// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_DATASETS_RS_REAL_SET_H_
#define RSSTAB_CLI_DATASETS_RS_REAL_SET_H_

#include <filesystem>
#include <map>
#include <memory>
#include <string>

#include "evaluation/labelled_picture.h"
#include "igf/base/result.h"

namespace rsstab::datasets {

// RS-Real in its published layout: train/**/*.npz and test/**/*.npz, each with the arrays
// `condition` (RS picture, H x W x 3 bytes, RGB), `gs` (its corrected picture) and `out_flow`
// (2 x H x W, x then y: backward displacement in px, zero on the FIRST row). For the test split a
// picture that the .npz lacks is taken from the .jpg (RS left, GS right) on the same path with
// every "npz" in it replaced by "jpg".
//
// What simulated sets have beside a sample, and the published one has not:
//   <name>.json      {"camera": camera JSON, "frame_interval_s", "strength", "source"}, all
//   optional <name>.gyro.csv  gyro log whose time 0 is that of the middle row
// Files of a folder whose name begins with "seq" are consecutive frames of one clip, by name.
//
// Valid pixels: those whose source lies inside the recorded frame, less black edges of either
// picture.
//
// `split`: "train", "test" or "all". A folder with neither is read as a whole.
// Errors: kNotFound when there is no sample.
[[nodiscard]] Result<std::unique_ptr<evaluation::PictureSet>> OpenRsReal(
    const std::filesystem::path& folder, const std::string& split);

}  // namespace rsstab::datasets

#endif  // RSSTAB_CLI_DATASETS_RS_REAL_SET_H_
