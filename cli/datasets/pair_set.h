// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_DATASETS_PAIR_SET_H_
#define RSSTAB_CLI_DATASETS_PAIR_SET_H_

#include <filesystem>
#include <memory>

#include "evaluation/labelled_picture.h"
#include "igf/base/result.h"

namespace rsstab::datasets {

// Pairs of a rolling-shutter picture and its global-shutter truth, at or below a folder:
//   rs_1.png, gs_1.png                       demo pictures of Fastec-RS and Carla-RS (Liu et al.,
//                                            CVPR 2020); rs_0.png is the frame before
//   001_rolling.png, 001_global_middle.png   the sets themselves; a folder is a clip. Without the
//                                            middle row's truth, 001_global_first.png: the first's
//   rs/NAME.png, gs/NAME.png                 one folder of each
//   NAME_rs.png, NAME_gs.png                 one beside the other
// In the last two forms (Building, RS-Homo and the like) any picture format will do; the true field
// may lie beside as NAME.flo or NAME.npz (array `field` or `out_flow`), or in a folder flow/; and
// the truth's instant is `reference_is_first` ? the first row's : the middle row's.
//
// Valid pixels: those without black edges; where a field is known, as in RS-Real.
// Errors: kNotFound for a folder that cannot be read or holds no pair.
[[nodiscard]] Result<std::unique_ptr<evaluation::PictureSet>> OpenPairs(
    const std::filesystem::path& folder, bool reference_is_first);

}  // namespace rsstab::datasets

#endif  // RSSTAB_CLI_DATASETS_PAIR_SET_H_
