// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_EVALUATION_PICTURE_PROTOCOL_H_
#define RSSTAB_EVALUATION_PICTURE_PROTOCOL_H_

#include <cstdint>
#include <functional>
#include <limits>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "evaluation/for_each_item.h"
#include "evaluation/labelled_picture.h"
#include "evaluation/motion_method.h"
#include "igf/base/result.h"

namespace rsstab::evaluation {

inline constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

// What one method made of one picture. NaN: nobody knows (no truth, no frame before), or the method
// cannot be asked here (no gyro log, no second frame).
struct MethodFigures {
  std::string method;
  bool declined = false;  // it said that the picture does not tell: left as it is
  // Corrected picture against the truth, over the valid pixels that the method found inside the
  // recorded frame; and the untouched picture over the same ones.
  double psnr_db = kUnknown;
  double ssim = kUnknown;
  double untouched_psnr_db = kUnknown;
  double untouched_ssim = kUnknown;
  // Over the valid pixels, px: end-point error; mean of its |x| and |y| parts; mean length of its
  // change since the frame before.
  double epe_px = kUnknown;
  double horizontal_px = kUnknown;
  double vertical_px = kUnknown;
  double flicker_px = kUnknown;
  double valid_share = kUnknown;  // pixels behind PSNR and SSIM, of all
  double moved_px = kUnknown;     // mean length of the estimated field
  double ms = kUnknown;           // from picture to field, with whatever else was running

  [[nodiscard]] bool Answered() const { return moved_px == moved_px; }
};

struct PictureRecord {
  std::string name;
  std::string clip;
  std::string split;
  std::string strength;
  std::string source;
  int width = 0;
  int height = 0;
  std::vector<MethodFigures> methods;  // in the order of the method set
};

struct PictureFailure {
  std::string name;
  Error error;
};

// All that came of one clip.
struct ClipResult {
  std::vector<PictureRecord> records;
  std::vector<PictureFailure> failures;  // pictures that are left out, and why
};

struct PictureOptions {
  std::uint64_t seed = 1;
  int jobs = 1;                // clips at a time; the figures are the same for any number
  std::set<std::string> skip;  // clips that are done already
};

// Judges every method on every picture of every clip that is not skipped. `done` is told of each
// clip when it is finished, one call at a time, in any order. Memory: three pictures and one error
// field per method, for each job, however large the data set is.
// Errors: those of the factory; kCancelled; the error of the first `done` that failed, after which
// no further clip is begun.
[[nodiscard]] Status RunPictureProtocol(const PictureSet& set, const PictureOptions& options,
                                        const MethodFactory& factory,
                                        const std::function<Status(ClipResult result)>& done,
                                        const EvaluationProgress& progress = {});

// What a method says of one picture.
struct PictureAnswer {
  std::string method;
  MotionField field;  // told from the picture's reference row; zero where the method declined
};
struct PictureInspection {
  LabelledPicture picture;
  std::vector<PictureAnswer> answers;  // methods that cannot be asked here are missing
};

// Asks the methods about one picture of a clip, exactly as RunPictureProtocol does with this seed,
// for those who want to see more than figures.
// Errors: kNotFound for a picture that the set does not have; those of the set and the methods.
[[nodiscard]] Result<PictureInspection> InspectPicture(const PictureSet& set,
                                                       const std::string& clip,
                                                       const std::string& picture,
                                                       std::uint64_t seed, MethodSet& methods);

}  // namespace rsstab::evaluation

#endif  // RSSTAB_EVALUATION_PICTURE_PROTOCOL_H_
