// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_COMMANDS_SIMULATE_H_
#define RSSTAB_CLI_COMMANDS_SIMULATE_H_

#include <cstdint>
#include <functional>

#include "cli/commands/simulate_options.h"
#include "cli/media/video_info.h"
#include "igf/base/log.h"
#include "igf/base/result.h"
#include "igf/gyro_log.h"
#include "igf/rs_simulator.h"
#include "igf/simulation_truth.h"

namespace rsstab::cli {

// A simulated clip before its first frame is drawn.
struct Simulation {
  igf::RsSimulator simulator;
  igf::GyroLog gyro;           // on its own clock, errors included
  igf::SimulationTruth truth;  // frame times, motion, camera
  media::Rational frame_rate;
};

// Frames a second -> a fraction: NTSC rates (n * 1000 / 1001) are recognised, others are rounded to
// 1/1000.
[[nodiscard]] media::Rational FrameRateFromNumber(double fps);

// Loads or paints the scene and lays out motion, frame times and gyro log. Frame n is at n / fps.
// Errors: a picture or gyro log that cannot be read (named), a log shorter than the clip, options
// outside their table's ranges.
[[nodiscard]] Result<Simulation> PrepareSimulation(const SimulateOptions& options,
                                                   const Logger& logger);

// Called after each frame (a rolling-shutter picture and its twin); false stops.
using SimulateProgress = std::function<bool(std::int64_t frames_done, std::int64_t frames)>;

// With options.rs_real what RunSimulateRsReal does; else writes rs.mp4 (rolling shutter), gs.mp4
// (its global-shutter twin, each frame at the instant of the middle row), gyro.csv, camera.json and
// truth.json into options.output, which is made if it is missing. A file gets its name when it is
// complete, the clips first. Errors: those of PrepareSimulation; kInvalidArgument when a file
// exists and overwrite is off; kIo; kCancelled.
[[nodiscard]] Status RunSimulate(const SimulateOptions& options, const Logger& logger,
                                 const SimulateProgress& progress = {});

}  // namespace rsstab::cli

#endif  // RSSTAB_CLI_COMMANDS_SIMULATE_H_
