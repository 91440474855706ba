// SPDX-License-Identifier: Apache-2.0
#include "evaluation/gyro_method.h"

#include <algorithm>

#include "igf/gyro_integrator.h"
#include "igf/intra_gyro_field.h"

namespace rsstab::evaluation {

Result<MethodAnswer> GyroMethod::Estimate(const MethodInput& input) {
  if (input.gyro == nullptr || input.camera == nullptr || !input.camera->readout_s) {
    return Fail(ErrorCode::kUnsupported,
                "the picture has no gyro log with a calibrated lens and readout time");
  }
  const auto track = igf::IntegrateGyro(*input.gyro);
  if (!track) {
    return Propagate(track.error());
  }
  const Camera& camera = *input.camera;
  const double readout_s = *camera.readout_s;
  if (bands_ > 0) {
    igf::BandFieldOptions options;
    options.bands = std::min(bands_, camera.height);
    options.reference_band =
        std::clamp(static_cast<int>((input.ReferenceRow() + 0.5) / camera.height * options.bands),
                   0, options.bands - 1);
    // Bands meet at steps, which a vertex grid can only follow with a vertex on every row.
    options.grid.rows = camera.height;
    auto field = igf::ComputeBandField(camera, *track, 0.0, readout_s, options);
    if (!field) {
      return Propagate(field.error());
    }
    field->set_reference_row(input.ReferenceRow());
    return MethodAnswer{std::move(*field), {}};
  }
  const auto motion =
      igf::ComputeReadoutMotion(camera, *track, 0.0, readout_s, input.ReferenceRow());
  if (!motion) {
    return Propagate(motion.error());
  }
  auto field = ComputeReadoutField(camera, *motion);
  if (!field) {
    return Propagate(field.error());
  }
  field->set_reference_row(input.ReferenceRow());
  return MethodAnswer{std::move(*field), {}};
}

}  // namespace rsstab::evaluation
