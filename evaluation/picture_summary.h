// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_EVALUATION_PICTURE_SUMMARY_H_
#define RSSTAB_EVALUATION_PICTURE_SUMMARY_H_

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "evaluation/picture_protocol.h"
#include "evaluation/statistics.h"

namespace rsstab::evaluation {

// Mean over the pictures, and its 95% interval by bootstrap over their sources (or clips). NaN
// where no picture has the figure.
struct MeanFigure {
  double mean = kUnknown;
  Interval interval{kUnknown, kUnknown};
};

// One method over a group of pictures: those on which it could be asked.
struct PictureMethodSummary {
  std::string method;
  std::size_t pictures = 0;  // that it answered
  std::size_t declined = 0;  // of them, left as they are because they did not tell
  MeanFigure psnr_db;
  MeanFigure ssim;
  MeanFigure epe_px;
  // End-point error less that of the first method, picture by picture.
  MeanFigure epe_change_px;
  MeanFigure flicker_px;
  double epe_median_px = kUnknown;
  double epe_p90_px = kUnknown;
  double horizontal_px = kUnknown;
  double vertical_px = kUnknown;
  double untouched_psnr_db = kUnknown;
  double untouched_ssim = kUnknown;
  double valid_share = kUnknown;
  double moved_px = kUnknown;
  double ms = kUnknown;
};

struct PictureGroup {
  std::string title;  // "all", "split test", "strength strong"
  std::size_t pictures = 0;
  std::vector<PictureMethodSummary> methods;

  // The methods that answered, and the names of those that could be asked about no picture.
  [[nodiscard]] std::vector<PictureMethodSummary> Asked() const;
  [[nodiscard]] std::vector<std::string> NotAsked() const;
};

// All pictures; then, where they are of several kinds, each split and each strength. All records
// hold the same methods, the first of which leaves the pictures alone.
[[nodiscard]] std::vector<PictureGroup> SummarisePictures(std::span<const PictureRecord> records,
                                                          std::uint64_t seed);

}  // namespace rsstab::evaluation

#endif  // RSSTAB_EVALUATION_PICTURE_SUMMARY_H_
