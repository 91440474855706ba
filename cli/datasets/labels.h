// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_DATASETS_LABELS_H_
#define RSSTAB_CLI_DATASETS_LABELS_H_

#include <cstdint>
#include <vector>

#include "cli/images/npz_reader.h"
#include "evaluation/labelled_picture.h"
#include "igf/base/frame.h"
#include "igf/base/result.h"

namespace rsstab::datasets {

// The true field of a picture whose `rs` is there: an array of 2 x H x W numbers, x then y,
// backward displacement in px. Pixels whose source lies outside the recorded frame, or that have
// none, become invalid. Errors: kCorruptData for another shape; those of ToFloats.
[[nodiscard]] Status SetTruth(const images::NpyArray& field, evaluation::LabelledPicture& picture);

// The darkest that an edge without a picture is in pictures stored without loss, and in JPEG.
inline constexpr int kExactBlack = 2;
inline constexpr int kJpegBlack = 16;

// One byte a pixel, row by row: 0 for black edges, else 1. An edge is what no channel of which is
// brighter than `level` and what hangs together with the picture's border; a pixel beside it does
// not count either, since warping mixes the two. `picture`: packed 8-bit RGB.
// Errors: kInvalidArgument for another layout.
[[nodiscard]] Result<std::vector<std::uint8_t>> OutsideBlackEdges(const FrameView& picture,
                                                                  int level);

// Makes black edges of either picture invalid; where the truth is known, also pixels whose source
// is one. Errors as above.
[[nodiscard]] Status LeaveOutBlackEdges(int rs_black, int gs_black,
                                        evaluation::LabelledPicture& picture);

}  // namespace rsstab::datasets

#endif  // RSSTAB_CLI_DATASETS_LABELS_H_
