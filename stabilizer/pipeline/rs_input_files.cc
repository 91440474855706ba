// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/pipeline/rs_input_files.h"

#include <utility>

#include "igf/camera_profile_reader.h"
#include "igf/imu_axes.h"

namespace rsstab::pipeline {

Result<RsInputs> ReadCameraInput(const StabilizeOptions& options, int width, int height) {
  RsInputs inputs;
  if (options.camera_file.empty()) {
    return inputs;
  }
  const auto profile = igf::ReadCameraProfile(options.camera_file);
  if (!profile) {
    return Propagate(profile.error());
  }
  const auto fitted = igf::ProfileForVideo(*profile, width, height);
  if (!fitted) {
    return Propagate(fitted.error(), options.camera_file);
  }
  if (fitted->focal_is_known) {
    inputs.camera = fitted->camera;
  }
  inputs.readout_s = fitted->camera.readout_s;
  return inputs;
}

Result<igf::GyroParseOptions> GyroParseOptionsFrom(const StabilizeOptions& options) {
  igf::GyroParseOptions parse;
  if (!options.gyro_axes.empty()) {
    const auto axes = igf::ParseAxisString(options.gyro_axes);
    if (!axes) {
      return Propagate(axes.error(), "--gyro-axes");
    }
    parse.camera_from_sensor = *axes;
  }
  return parse;
}

void AddGyro(igf::GyroRecording recording, const std::string& origin, const Logger& logger,
             RsInputs& inputs) {
  inputs.gyro_origin = origin;
  for (const std::string& note : recording.notes) {
    logger->warn("{}: {}", origin, note);
  }
  if (!inputs.readout_s) {
    inputs.readout_s = recording.readout_s;
  }
  inputs.gyro = std::move(recording.gyro);
}

Result<RsInputs> ReadRsInputFiles(const StabilizeOptions& options, int width, int height,
                                  const Logger& logger) {
  auto inputs = ReadCameraInput(options, width, height);
  if (!inputs || options.gyro_file.empty()) {
    return inputs;
  }
  const auto parse = GyroParseOptionsFrom(options);
  if (!parse) {
    return Propagate(parse.error());
  }
  auto recording = igf::ReadGyroLog(options.gyro_file, *parse);
  if (!recording) {
    return Propagate(std::move(recording.error()));
  }
  AddGyro(std::move(*recording), options.gyro_file, logger, *inputs);
  return inputs;
}

}  // namespace rsstab::pipeline
