// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/pipeline/online_rs_source.h"

#include <utility>

namespace rsstab::pipeline {

Result<OnlineRsSelection> SelectOnlineRsSource(const StabilizeOptions& options,
                                               const ClipGeometry& clip, RsInputs inputs,
                                               const Logger& logger) {
  if (inputs.gyro && !options.gyro_offset_s) {
    if (options.rs == RsChoice::kGyro) {
      return Fail(ErrorCode::kUnsupported,
                  "live, the gyro log {} cannot be brought into step with a clip that is not known "
                  "yet: give --gyro-offset (`rs-stabilize analyze` finds it)",
                  inputs.gyro_origin);
    }
    logger->warn("the gyro log {} is not used: live mode needs --gyro-offset", inputs.gyro_origin);
    inputs.gyro.reset();
  }
  auto selection = SelectRsSource(options, clip, inputs, {}, logger);
  if (!selection) {
    return Propagate(std::move(selection.error()));
  }
  OnlineRsSelection online{std::move(*selection), nullptr};
  online.delayed = dynamic_cast<DelayedRsSource*>(online.selection.source.get());
  return online;
}

}  // namespace rsstab::pipeline
