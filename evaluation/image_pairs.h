// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_EVALUATION_IMAGE_PAIRS_H_
#define RSSTAB_EVALUATION_IMAGE_PAIRS_H_

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "evaluation/for_each_item.h"
#include "evaluation/motion_method.h"
#include "igf/base/result.h"

namespace rsstab::evaluation {

// A rolling-shutter picture and its global-shutter truth at the middle row's instant.
struct ImagePair {
  std::string name;  // the folder, relative to where the search began
  std::filesystem::path rs;
  std::filesystem::path gs;
};

// All folders at or below `root` that hold rs_1.png and gs_1.png (the naming of the Fastec-RS and
// Carla-RS sets of Liu et al., CVPR 2020), in the order of their names.
// Errors: kNotFound for a folder that cannot be read or holds no pair.
[[nodiscard]] Result<std::vector<ImagePair>> FindImagePairs(const std::filesystem::path& root);

// One method on one pair. Pixels without a source are left out; the untouched picture is measured
// over the same ones, since displacements are largest at the borders that drop out.
struct PairScore {
  std::string method;
  double psnr_db = 0.0;
  double ssim = 0.0;
  double untouched_psnr_db = 0.0;
  double untouched_ssim = 0.0;
  double valid_share = 0.0;
  double moved_px = 0.0;  // mean length of the field
  double ms = 0.0;
};

struct PairRecord {
  std::string name;
  int width = 0;
  int height = 0;
  std::vector<PairScore> methods;
};

struct PairRecords {
  std::vector<PairRecord> pairs;
  std::vector<std::pair<std::string, Error>> failures;  // pairs that are left out, and why
};

struct PairOptions {
  std::uint64_t seed = 1;
  int jobs = 1;
};

// Judges every method on every pair. Errors: those of the factory; kCancelled; the first pair's
// when every one failed.
[[nodiscard]] Result<PairRecords> RunImagePairs(std::span<const ImagePair> pairs,
                                                const PairOptions& options,
                                                const MethodFactory& factory,
                                                const EvaluationProgress& progress = {});

}  // namespace rsstab::evaluation

#endif  // RSSTAB_EVALUATION_IMAGE_PAIRS_H_
