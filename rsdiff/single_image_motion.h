// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_RSDIFF_SINGLE_IMAGE_MOTION_H_
#define RSSTAB_RSDIFF_SINGLE_IMAGE_MOTION_H_

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "igf/base/frame.h"
#include "igf/base/motion_field.h"
#include "igf/base/readout_motion.h"
#include "igf/base/result.h"
#include "rsdiff/backend/backend_options.h"
#include "rsdiff/model_file.h"
#include "rsdiff/rotation_curve.h"

namespace rsstab::rsdiff {

struct SamplingOptions {
  int steps = 0;           // DDIM steps; 0 = the model's default
  int samples = 8;         // drawn at once, 1 .. 1024
  double guidance = -1.0;  // classifier-free guidance scale; negative = the model's default
  double eta = -1.0;       // noise of each step, 0 .. 1; negative = the model's default
  std::uint64_t seed = 0;  // same seed, same noise: sample i is the same however many there are
};

// What one image tells of its readout. Motion at full image size, reference row the middle.
struct SingleImageMotion {
  MotionField field;  // mean over the samples
  // Standard deviation of the samples' displacements, length in px: at each vertex of the field,
  // and root mean square over them. One sample says nothing of its error: infinity.
  std::vector<float> vertex_spread_px;
  double spread_px = 0.0;
  // Models of rotation curves only, else empty: mean and standard deviation of (a, b, r) per band,
  // and every sample's curve; zero at the middle row.
  RotationCurve curve_mean;
  RotationCurve curve_deviation;
  std::vector<RotationCurve> curves;
};

// From one rolling-shutter picture to the motion of its readout. Not thread safe: one call at a
// time.
class SingleImageEstimator {
 public:
  // `model`: the JSON of a model or its folder (FindModel turns names into paths).
  // Errors: those of ReadModelFile and LoadDenoiser.
  [[nodiscard]] static Result<SingleImageEstimator> Load(const std::filesystem::path& model,
                                                         const BackendOptions& backend = {});
  // With a denoiser of the caller's, for a model of the caller's. Its shapes fit the model.
  // Errors: kInvalidArgument for a schedule that makes no sense or shapes that do not fit.
  [[nodiscard]] static Result<SingleImageEstimator> Create(ModelInfo model,
                                                           std::unique_ptr<Denoiser> denoiser);

  SingleImageEstimator(SingleImageEstimator&&) noexcept;
  SingleImageEstimator& operator=(SingleImageEstimator&&) noexcept;
  ~SingleImageEstimator();

  // `image` of any size from 1x1, any layout, 8 to 16 bits. `focal_px` in pixels of that image, 1
  // image width unless given. A picture without structure gives what the network makes of it.
  // Errors: kInvalidArgument for options outside their range or a focal length that is not
  // positive; those of MakeCondition and DdimSampler.
  [[nodiscard]] Result<SingleImageMotion> Estimate(const FrameView& image,
                                                   const SamplingOptions& options = {},
                                                   std::optional<double> focal_px = {},
                                                   const FieldGrid& grid = {});

  [[nodiscard]] const ModelInfo& model() const;

 private:
  struct Impl;
  explicit SingleImageEstimator(std::unique_ptr<Impl> impl);

  std::unique_ptr<Impl> impl_;
};

}  // namespace rsstab::rsdiff

#endif  // RSSTAB_RSDIFF_SINGLE_IMAGE_MOTION_H_
