// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_IGF_RS_SIMULATOR_H_
#define RSSTAB_IGF_RS_SIMULATOR_H_

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "igf/base/camera.h"
#include "igf/base/frame.h"
#include "igf/base/parallel_for.h"
#include "igf/base/result.h"
#include "igf/orientation_track.h"
#include "igf/texture_scene.h"

namespace rsstab::igf {

// A disc with a pattern of its own that crosses the scene, for what a camera rotation cannot
// explain. It lies at infinity too, and moves at a constant rate about the world's vertical. Its
// edge is hard: as in a real occlusion, it is the one thing in a picture that is not band-limited.
struct ForegroundObject {
  double azimuth_rad = 0.0;    // at time 0; 0 = world z, growing to the right
  double elevation_rad = 0.0;  // growing upwards
  double rate_rad_s = 0.35;    // to the right
  double radius_rad = 0.1;     // in (0, 0.5]
  std::uint64_t seed = 1;      // of its colours
};

struct RsSimulatorOptions {
  double readout_s = 0.0;    // signed; see rolling_shutter.h. |readout_s| < 1
  double exposure_s = 0.0;   // each row's shutter time, centred on its exposure time; [0, 1)
  int exposure_samples = 1;  // instants averaged over the exposure (1 = no motion blur), 1..64
  double noise_sigma = 0.0;  // of every sample, in 8-bit levels, [0, 50]; the RS clip and its GS
                             // twin get different noise
  std::uint64_t noise_seed = 1;
  std::optional<ForegroundObject> foreground;
};

// What a rotating camera with a rolling shutter sees of a scene at infinity, exactly:
//   I_RS(y) = scene(R(t(y))^T K^-1 y),  t(y) = RowExposureTime(t_n, row of y, H, readout)
// (row homography K_scene R^T K^-1; lens distortion through Camera::UnprojectPixel). Every sample,
// chroma too, is taken at its own position and its own row's time; nothing is warped twice.
//
// It shares no sampling code with what it judges. Const methods from any thread, any order; same
// arguments, same bytes, for any number of threads.
class RsSimulator {
 public:
  // Errors: kInvalidArgument for a camera that does not validate, options outside their ranges, or
  // a pixel that the lens model cannot turn into a ray.
  [[nodiscard]] static Result<RsSimulator> Create(std::shared_ptr<const TextureScene> scene,
                                                  const Camera& camera,
                                                  OrientationTrack orientation,
                                                  const RsSimulatorOptions& options = {});

  // The frame whose middle row is exposed at frame_time_s. `layout`: gray or planar YUV (BT.709),
  // 8..16 bit, any chroma shift. `noise_index` tells frames apart for the noise (the frame number).
  // Errors: kInvalidArgument for another layout, or when the orientation track does not cover the
  // readout and exposure of this frame.
  [[nodiscard]] Result<Frame> RenderRs(double frame_time_s, const PixelLayout& layout,
                                       WorkerPool& pool, std::int64_t noise_index = 0) const;

  // The global-shutter twin: all rows at frame_time_s.
  [[nodiscard]] Result<Frame> RenderGs(double frame_time_s, const PixelLayout& layout,
                                       WorkerPool& pool, std::int64_t noise_index = 0) const;

  [[nodiscard]] const Camera& camera() const { return camera_; }
  [[nodiscard]] const OrientationTrack& orientation() const { return orientation_; }
  [[nodiscard]] const RsSimulatorOptions& options() const { return options_; }

 private:
  struct RowJob;

  RsSimulator(std::shared_ptr<const TextureScene> scene, Camera camera,
              OrientationTrack orientation, const RsSimulatorOptions& options);

  [[nodiscard]] Result<Frame> Render(double frame_time_s, double readout_s,
                                     const PixelLayout& layout, WorkerPool& pool,
                                     std::uint64_t noise_stream) const;
  void RenderRow(const RowJob& job, int row) const;

  std::shared_ptr<const TextureScene> scene_;
  Camera camera_;
  OrientationTrack orientation_;
  RsSimulatorOptions options_;
};

}  // namespace rsstab::igf

#endif  // RSSTAB_IGF_RS_SIMULATOR_H_
