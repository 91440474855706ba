// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_EVALUATION_CORRECTION_SCORE_H_
#define RSSTAB_EVALUATION_CORRECTION_SCORE_H_

#include <cstdint>
#include <vector>

#include "igf/base/frame.h"
#include "igf/base/motion_field.h"
#include "igf/base/parallel_for.h"
#include "igf/base/result.h"
#include "stabilizer/metrics/image_metrics.h"

namespace rsstab::evaluation {

// A rolling-shutter picture put right by a field, as the program renders it (bicubic, once).
struct CorrectedPicture {
  Frame picture;
  std::vector<std::uint8_t> valid;  // 1 where the source lies inside the recorded frame
};

// `field` of the picture's size. Errors: kInvalidArgument for another one; those of PlaneWarper.
[[nodiscard]] Result<CorrectedPicture> CorrectPicture(const FrameView& rs, const MotionField& field,
                                                      WorkerPool& workers);

struct PictureScore {
  double psnr_db = 0.0;
  double ssim = 0.0;
  double valid_share = 0.0;  // of all pixels, 0 .. 1
};

// A picture against the truth, over the pixels of `valid`. Errors: those of Psnr.
[[nodiscard]] Result<PictureScore> ScorePicture(const FrameView& picture, const FrameView& truth,
                                                stabilizer::PixelMask valid);

}  // namespace rsstab::evaluation

#endif  // RSSTAB_EVALUATION_CORRECTION_SCORE_H_
