// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_EVALUATION_LABELLED_PICTURE_H_
#define RSSTAB_EVALUATION_LABELLED_PICTURE_H_

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "igf/base/camera.h"
#include "igf/base/frame.h"
#include "igf/base/result.h"
#include "igf/gyro_log.h"

namespace rsstab::evaluation {

// A rolling-shutter picture with its truth, and whatever else its data set knows.
struct LabelledPicture {
  Frame rs;  // packed 8-bit RGB
  Frame gs;  // the same, as seen at the instant of the reference row
  double reference_row = 0.0;
  // Backward displacement of each pixel, row by row (I_GS(x) = I_RS(x + G(x))); empty where nobody
  // knows it.
  std::vector<Eigen::Vector2f> truth;
  // One byte a pixel, row by row, 0 = does not count: of the GS picture (black edges, no source in
  // the recorded frame), and of the RS picture (black edges). Empty: all of them count.
  std::vector<std::uint8_t> valid;
  std::vector<std::uint8_t> rs_valid;

  std::optional<Camera> camera;      // with its readout time, where known
  std::optional<igf::GyroLog> gyro;  // at time 0 the middle row was exposed
  double frame_interval_s = 0.0;     // to the next frame of the clip; 0 = unknown
  std::optional<Frame> previous;     // a frame before it that has no truth of its own

  // How reports tell pictures apart; empty where they do not.
  std::string split;     // "train", "test"
  std::string strength;  // of the motion
  std::string source;    // the photograph or clip that several pictures were made from
};

// Pictures that follow one another in time; a single one where the data set has no clips.
struct PictureClip {
  std::string name;
  std::vector<std::string> pictures;  // in the order of time
};

// A data set that is read picture by picture. Const methods from any thread.
class PictureSet {
 public:
  virtual ~PictureSet() = default;

  [[nodiscard]] virtual std::span<const PictureClip> Clips() const = 0;

  // Errors name the file.
  [[nodiscard]] virtual Result<LabelledPicture> Load(const std::string& picture) const = 0;
};

}  // namespace rsstab::evaluation

#endif  // RSSTAB_EVALUATION_LABELLED_PICTURE_H_
