// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_STABILIZER_PIPELINE_READOUT_FROM_PICTURES_H_
#define RSSTAB_STABILIZER_PIPELINE_READOUT_FROM_PICTURES_H_

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "igf/base/result.h"
#include "rsdiff/single_image_motion.h"
#include "stabilizer/luma_proxy.h"

namespace rsstab::pipeline {

// What the single pictures of a clip say of its readout time.
struct PictureReadout {
  double readout_s = 0.0;  // zero crossing
  double sigma_s = 0.0;    // infinite when the pictures do not answer to a skew at all
  // Share of a true skew that the model sees. It hedges, so this is small; not above 0: it sees
  // nothing in these pictures.
  double response = 0.0;
  std::size_t num_pictures = 0;
  // Skew that the model still sees after correcting with a candidate, as a share of the skew that
  // a readout of one frame interval gives: falls through 0 at the readout time.
  struct Remainder {
    double readout_s = 0.0;
    double skew = 0.0;
    double sigma = 0.0;
  };
  std::vector<Remainder> curve;
};

// Finds the readout time at which, after correction, a single-image model sees no remaining skew
// that goes with the camera's motion. The size of what the model says is not to be trusted (it
// hedges towards zero), its zero is. Unlike tracks this sees steady pans. Keeps a bounded number of
// small pictures: the fastest of the clip, some frames apart. In order, not thread safe.
class ReadoutPictures {
 public:
  // The next frame's luma proxy, and how its scene moved across the picture since the one before,
  // picture widths (x right, y down); empty for the first frame and where that is not known.
  void Push(stabilizer::GrayImage picture, const std::optional<Eigen::Vector2d>& shift);

  [[nodiscard]] std::size_t size() const { return kept_.size(); }

  // Asks the model about every picture kept, corrected with several candidates.
  // Errors: those of SingleImageEstimator::Estimate.
  [[nodiscard]] Result<PictureReadout> Ask(rsdiff::SingleImageEstimator& estimator,
                                           double frame_interval_s) const;

 private:
  struct Kept {
    std::int64_t frame;
    Eigen::Vector2d velocity;
    stabilizer::GrayImage picture;
  };
  void Offer(Kept candidate);

  std::int64_t num_frames_ = 0;
  std::optional<Kept> last_;  // its velocity is that of the way to it
  std::vector<Kept> kept_;    // fastest first
};

}  // namespace rsstab::pipeline

#endif  // RSSTAB_STABILIZER_PIPELINE_READOUT_FROM_PICTURES_H_
