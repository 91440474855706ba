// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_EVALUATION_EXPOSURE_H_
#define RSSTAB_EVALUATION_EXPOSURE_H_

#include "evaluation/photo_scene.h"
#include "evaluation/readout_curve.h"
#include "igf/base/camera.h"
#include "igf/base/frame.h"
#include "igf/base/result.h"

namespace rsstab::evaluation {

// What a camera records of a photograph, and what it should have recorded.
struct ExposedPair {
  Frame rs;  // each row along its own rotation, with noise
  Frame gs;  // all rows along the middle one's, without noise
  // Photo pixels per picture pixel: below 1 the photograph was enlarged.
  double photo_per_pixel = 0.0;
};

// Records a photograph along `curve`, exactly: I_RS(y) = I_GS(H_ref<-row(y) y), both pictures cut
// from it as PhotoScene tells, with noise as `options` say on the RS picture only. Any thread.
// Errors: those of PhotoScene::Create.
[[nodiscard]] Result<ExposedPair> Expose(const FrameView& photo, const Camera& camera,
                                         const ReadoutCurve& curve,
                                         const ExposureOptions& options = {});

}  // namespace rsstab::evaluation

#endif  // RSSTAB_EVALUATION_EXPOSURE_H_
