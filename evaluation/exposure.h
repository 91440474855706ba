// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_EVALUATION_EXPOSURE_H_
#define RSSTAB_EVALUATION_EXPOSURE_H_

#include <cstdint>

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

struct ExposureOptions {
  double noise_sigma = 2.0;  // of every sample of the RS picture, in 8-bit levels, >= 0
  std::uint64_t noise_seed = 1;
};

// Cuts the global-shutter view out of the middle of a photograph, at the largest scale that leaves
// room for every displaced pixel, so that nothing has to be invented at a border; and records it
// along `curve`, exactly: I_RS(y) = I_GS(H_ref<-row(y) y). Both pictures sample the photograph once
// (cubic convolution; a photograph with finer pixels than the view's is shrunk by area averages
// first). `photo` and the results are packed 8-bit RGB; the camera is a pinhole and says the size.
//
// A sampler of its own: it shares no code with the corrector it is to judge. Any thread.
// Errors: kInvalidArgument for another layout, an invalid camera, a photo of less than 16 pixels a
// side, or a motion that shows what lies behind the camera.
[[nodiscard]] Result<ExposedPair> Expose(const FrameView& photo, const Camera& camera,
                                         const ReadoutCurve& curve,
                                         const ExposureOptions& options = {});

}  // namespace rsstab::evaluation

#endif  // RSSTAB_EVALUATION_EXPOSURE_H_
