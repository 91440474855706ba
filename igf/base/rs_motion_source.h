// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_IGF_BASE_RS_MOTION_SOURCE_H_
#define RSSTAB_IGF_BASE_RS_MOTION_SOURCE_H_

#include <Eigen/Geometry>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>

#include "igf/base/frame.h"
#include "igf/base/motion_field.h"
#include "igf/base/point_tracks.h"
#include "igf/base/result.h"

namespace rsstab {

// The frame whose readout motion is asked for.
struct FrameContext {
  std::int64_t index = 0;            // counted from 0 in presentation order
  double time_s = 0.0;               // time of the middle row, video clock
  const FrameView* image = nullptr;  // null when NeedsImage() is false
};

struct RsMotion {
  MotionField field;       // reference row: the middle
  double spread_px = 0.0;  // one standard deviation of the field, px; 0 = exact
};

// Tells how the camera moved while one frame was read out. Implementations: a gyro log (igf), a
// single image (rsdiff), the fusion of all (stabilizer).
class RsMotionSource {
 public:
  virtual ~RsMotionSource() = default;

  // What the log and the analysis file call it: "gyro", "diffusion".
  [[nodiscard]] virtual std::string Name() const = 0;

  // True when EstimateMotion looks at the picture (pass 1 then keeps it at hand).
  [[nodiscard]] virtual bool NeedsImage() const = 0;

  // Sources that learn from what moves between frames are shown every frame in order, with its
  // tracks from the one before (empty for the first and after a cut), and may answer for a frame
  // only once they have seen some beyond it. FinishObserving: no more frames will come.
  virtual void Observe(const PointTracks& tracks, double time_s) {
    (void)tracks;
    (void)time_s;
  }
  virtual void FinishObserving() {}
  // How many frames beyond one it may have to see, repeated frames not counted.
  [[nodiscard]] virtual int DelayFrames() const { return 0; }
  // EstimateMotion may be asked for frames below this number. A source that looks at pictures
  // answers at once.
  [[nodiscard]] virtual std::int64_t NumAnswerable() const {
    return std::numeric_limits<std::int64_t>::max();
  }

  // Motion of one frame. kUntrustworthy when this frame cannot be told (a gap in the log): the
  // caller then leaves the frame as it is. Any order of frames; not thread safe.
  [[nodiscard]] virtual Result<RsMotion> EstimateMotion(const FrameContext& frame) = 0;

  // Camera orientation at a time of the video clock, where the source knows it; camera_from_world.
  [[nodiscard]] virtual std::optional<Eigen::Quaterniond> CameraFromWorld(double time_s) const {
    (void)time_s;
    return std::nullopt;
  }
  // How the camera turned from one time to another, to_camera_from_from_camera. Empty where the
  // source does not know both, or does not know one against the other (a gap in the log, a cut).
  [[nodiscard]] virtual std::optional<Eigen::Quaterniond> TurnBetween(double from_s,
                                                                      double to_s) const {
    const auto from = CameraFromWorld(from_s);
    const auto to = CameraFromWorld(to_s);
    return from && to ? std::optional<Eigen::Quaterniond>(*to * from->conjugate()) : std::nullopt;
  }
};

}  // namespace rsstab

#endif  // RSSTAB_IGF_BASE_RS_MOTION_SOURCE_H_
