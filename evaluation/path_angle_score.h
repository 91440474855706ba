// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_EVALUATION_PATH_ANGLE_SCORE_H_
#define RSSTAB_EVALUATION_PATH_ANGLE_SCORE_H_

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "igf/base/result.h"
#include "igf/simulation_truth.h"
#include "stabilizer/analysis_file.h"

namespace rsstab::evaluation {

// Where the camera looked, frame by frame; empty where nobody knows.
using OrientationPath = std::vector<std::optional<stabilizer::FrameOrientation>>;

// What pass 1 stored in an analysis file. Errors: those of stabilizer::AnalysisReader.
[[nodiscard]] Result<OrientationPath> ReadOrientationPath(const std::string& analysis_file);
// The true one: one world, middle rows.
[[nodiscard]] OrientationPath TruePath(const igf::SimulationTruth& truth);

// How far a path of rotations is from another one. Root mean squares.
struct PathAngleScore {
  double known_share = 0.0;  // of the frames: orientation known in both paths
  // Angle between the two orientations of a frame, after the one constant rotation between the two
  // world frames that leaves least (one for each pair of worlds). A slow drift counts in full.
  std::optional<double> angle_deg;
  std::optional<double> uncorrected_angle_deg;  // the same of a camera that does not turn at all
  // Between the two paths' rotations from one frame to the next, over the time between them: free
  // of drift. `rate_axes_deg_s` are its parts about the camera's axes x, y, z of the later frame.
  std::optional<double> rate_deg_s;
  std::optional<Eigen::Vector3d> rate_axes_deg_s;
  // Mean of the same, with its sign: the part of it that is steady, as a gyro's bias is.
  std::optional<Eigen::Vector3d> drift_axes_deg_s;
  std::optional<double> uncorrected_rate_deg_s;
};

// `frame_interval_s`: between frames, which are taken as evenly spaced. Steps between worlds and
// to frames that one path does not know count nowhere; "uncorrected" goes over all frames of
// `reference`.
// Errors: kInvalidArgument when the paths differ in length, or the interval is not above 0.
[[nodiscard]] Result<PathAngleScore> ScorePathAngle(const OrientationPath& found,
                                                    const OrientationPath& reference,
                                                    double frame_interval_s);

}  // namespace rsstab::evaluation

#endif  // RSSTAB_EVALUATION_PATH_ANGLE_SCORE_H_
