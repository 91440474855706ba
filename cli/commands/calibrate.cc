// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/calibrate.h"

#include <iostream>
#include <utility>

#include "cli/output_names.h"
#include "cli/passes.h"
#include "igf/base/whole_file.h"
#include "igf/camera_profile_reader.h"

namespace rsstab::cli {
namespace {

Status CheckOutputs(const std::string& input, const CalibrateOptions& options) {
  for (const std::string& file : {options.output, options.curves}) {
    if (Status status = file.empty() ? Status() : CheckOutput(input, file, options.overwrite);
        !status) {
      return status;
    }
  }
  if (!options.output.empty() && options.output == options.curves) {
    return Fail(ErrorCode::kInvalidArgument,
                "--output and --curves both name {}; give them different files", options.output);
  }
  return {};
}

}  // namespace

Status RunCalibrate(const Invocation& invocation, const CommandContext& context) {
  const CalibrateOptions& options = invocation.calibrate;
  if (Status status = CheckOutputs(invocation.input, options); !status) {
    return status;
  }
  auto clip = OpenClip(invocation.input, invocation.stabilize, context.logger);
  if (!clip) {
    return Propagate(clip.error());
  }
  const auto report = CalibrateClip(std::move(*clip), invocation.stabilize, context);
  if (!report) {
    return Propagate(report.error());
  }
  if (!options.output.empty()) {
    const std::string camera = igf::FormatCameraJson(pipeline::ToCalibratedCamera(*report));
    if (Status status = WriteWholeFile(options.output, camera); !status) {
      return status;
    }
  }
  if (!options.curves.empty()) {
    if (report->curves.empty()) {
      context.logger->warn("{} is not written: there is no curve, {}", options.curves,
                           report->readout_s.given ? "as the readout time was given"
                                                   : "as nothing in the clip tells");
    } else if (Status status = WriteWholeFile(options.curves, FormatCalibrationChart(*report));
               !status) {
      return status;
    }
  }
  const std::string text = options.json ? FormatCalibrationJson(*report, invocation.input)
                                        : FormatCalibrationText(*report, invocation.input);
  if (!(std::cout << text << std::flush)) {
    return Fail(ErrorCode::kIo, "standard output cannot be written");
  }
  return {};
}

}  // namespace rsstab::cli
