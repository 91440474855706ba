// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_EVALUATION_SYNTHETIC_PROTOCOL_H_
#define RSSTAB_EVALUATION_SYNTHETIC_PROTOCOL_H_

#include <cstdint>
#include <filesystem>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "evaluation/for_each_item.h"
#include "evaluation/motion_method.h"
#include "evaluation/picture_protocol.h"
#include "evaluation/readout_curve.h"
#include "evaluation/skew_response.h"
#include "evaluation/spread_coverage.h"
#include "igf/base/result.h"

namespace rsstab::evaluation {

struct SyntheticOptions {
  std::uint64_t seed = 1;
  int jobs = 1;              // photographs at a time; the figures are the same for any number
  int linearity_photos = 0;  // how many photographs, from the first, are skewed by known factors
  std::set<std::string> structured;  // file names of photographs that are told apart as well
};

// What one method made of one picture.
struct MethodScore {
  std::string method;
  bool declined = false;       // it said that the picture does not tell: left as it is
  double epe_px = 0.0;         // end-point error over the pixels that the frame recorded
  double horizontal_px = 0.0;  // mean of its |x| part
  double vertical_px = 0.0;    // mean of its |y| part
  double psnr_db = 0.0;  // over the pixels that the frame recorded and the method found inside it
  double ssim = 0.0;
  double valid_share = 0.0;  // how many those are, of all
  double ms = 0.0;           // wall time from picture to field, with whatever else was running
};

struct SampleRecord {
  std::string photo;
  std::size_t photo_index = 0;
  bool structured = false;
  MotionClass motion_class = MotionClass::kStill;
  double focal_widths = 0.0;
  bool top_to_bottom = true;
  double photo_per_pixel = 0.0;
  std::vector<MethodScore> methods;      // in the order of the method set
  std::optional<AxisCoverage> coverage;  // where the sampler draws curves
};

struct SyntheticRecords {
  std::vector<SampleRecord> samples;           // photo by photo, moving classes first, then still
  std::vector<std::vector<SkewAnswer>> skews;  // by photo
  std::vector<std::pair<std::string, Error>> failures;  // photos that are left out, and why
};

// The protocol synthetic-val of docs/evaluation.md: every photograph in four motions and one still
// frame, judged by every method. Memory: one photograph and one picture for each job.
// Errors: those of the factory; kCancelled; kCorruptData when every photograph failed.
[[nodiscard]] Result<SyntheticRecords> RunSyntheticProtocol(
    std::span<const std::filesystem::path> photos, const SyntheticOptions& options,
    const MethodFactory& factory, const EvaluationProgress& progress = {});

// Makes one of a photograph's pictures again, and asks the methods about it, exactly as
// RunSyntheticProtocol does with this seed, for those who want to see more than figures.
// Errors: those of the photograph and the methods.
[[nodiscard]] Result<PictureInspection> InspectSyntheticSample(const std::filesystem::path& photo,
                                                               MotionClass motion_class,
                                                               std::uint64_t seed,
                                                               MethodSet& methods);

}  // namespace rsstab::evaluation

#endif  // RSSTAB_EVALUATION_SYNTHETIC_PROTOCOL_H_
