// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_PASSES_H_
#define RSSTAB_CLI_PASSES_H_

#include <functional>
#include <memory>
#include <string>

#include "cli/command_context.h"
#include "cli/encode_options.h"
#include "cli/media/video_reader.h"
#include "cli/media/video_writer.h"
#include "igf/base/result.h"
#include "stabilizer/analysis_file.h"
#include "stabilizer/pipeline/calibrator.h"
#include "stabilizer/pipeline/stabilize_options.h"

namespace rsstab::cli {

// Which of how many passes of the whole command a pass is, for the progress.
struct PassNumber {
  int pass = 1;
  int passes = 1;
};

// Opens the clip. Errors: those of VideoReader::Open; kUnsupported for standard input, which
// cannot be read twice.
[[nodiscard]] Result<std::unique_ptr<media::VideoReader>> OpenClip(
    const std::string& input, const pipeline::StabilizeOptions& options, const Logger& logger);

struct SteadyClip {
  std::string path;
  std::unique_ptr<media::VideoWriter> writer;
};

// Opens the output for frames that stem from `clip`: the named file, or the default one beside the
// clip (in Matroska, should its own container not carry the encoding).
[[nodiscard]] Result<SteadyClip> OpenOutput(const EncodeOptions& encode,
                                            const pipeline::StabilizeOptions& options,
                                            media::VideoReader& clip, const Logger& logger);

// Pass 1: looks at the whole clip and writes `analysis_file`. Errors: kCancelled when the user
// asked to stop; otherwise those of reader, gyro and analysis. Nothing is left after an error.
[[nodiscard]] Result<stabilizer::ClipAnalysis> AnalyzeClip(
    std::unique_ptr<media::VideoReader> clip, const pipeline::StabilizeOptions& options,
    const std::string& analysis_file, PassNumber number, const CommandContext& context);

// Looks at the whole clip and says what it tells about its camera. Errors as above.
[[nodiscard]] Result<pipeline::CalibrationReport> CalibrateClip(
    std::unique_ptr<media::VideoReader> clip, const pipeline::StabilizeOptions& options,
    const CommandContext& context);

// Sees each frame and what became of it, in order; an error ends the pass.
using RenderObserver = std::function<Status(const media::VideoFrame& frame, const Frame& steady)>;

// Pass 2: writes the steady clip, and logs what became of it. Errors as above.
[[nodiscard]] Status RenderClip(std::unique_ptr<media::VideoReader> clip, SteadyClip output,
                                const pipeline::StabilizeOptions& options,
                                const std::string& analysis_file, PassNumber number,
                                const CommandContext& context, const RenderObserver& observer = {});

}  // namespace rsstab::cli

#endif  // RSSTAB_CLI_PASSES_H_
