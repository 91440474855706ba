// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_EVALUATION_BASELINES_HOMOGRAPHY_MIXTURE_H_
#define RSSTAB_EVALUATION_BASELINES_HOMOGRAPHY_MIXTURE_H_

#include <Eigen/Core>
#include <string>
#include <vector>

#include "evaluation/motion_method.h"
#include "igf/base/point_tracks.h"

namespace rsstab::evaluation {

// What phones take for a readout, as a share of the frame interval: 20 ms at 30 frames/s. Without a
// calibration it is a guess.
inline constexpr double kGuessedReadoutShare = 0.6;

// Homography mixtures: M. Grundmann, V. Kwatra, D. Castro, I. Essa, "Calibration-Free Rolling
// Shutter Removal", ICCP 2012, section 3. Between two frames a point x of row y moves by
//   H(y) = sum_k w_k(y) H_k,  w_k Gaussian about the middle of row block k (eq. 5),
// ten blocks that share their perspective part (the paper's 6-parameter mixtures), fitted by
// iteratively reweighted least squares on normalised points (DLT with h33 = 1, eq. 7), with a pull
// of neighbouring blocks towards each other (eq. 10).
// Departure: the paper rectifies a frame against one that is rectified already, along a whole clip.
// Of two or three raw frames the mixtures tell how the picture moves at the time of each row; the
// motion inside the frame is their integral over the readout, as a share of the frame interval that
// is guessed (neither lens nor readout are asked for).
class HomographyMixtureMethod final : public MotionMethod {
 public:
  explicit HomographyMixtureMethod(double readout_share = kGuessedReadoutShare)
      : readout_share_(readout_share) {}

  [[nodiscard]] std::string Name() const override { return "homography-mixture"; }
  // Errors: kUnsupported without a frame before or after; kUntrustworthy with too few tracks.
  [[nodiscard]] Result<MethodAnswer> Estimate(const MethodInput& input) override;

 private:
  double readout_share_;
};

// One mixture in the pixels of its tracks, to_from_from: blocks from top to bottom by the row in
// the EARLIER frame (`by_from`) or the later one. Empty when the tracks do not determine it.
[[nodiscard]] std::vector<Eigen::Matrix3d> FitHomographyMixture(const PointTracks& tracks,
                                                                bool by_from);

}  // namespace rsstab::evaluation

#endif  // RSSTAB_EVALUATION_BASELINES_HOMOGRAPHY_MIXTURE_H_
