// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_COMMANDS_CLIP_METHOD_H_
#define RSSTAB_CLI_COMMANDS_CLIP_METHOD_H_

#include <optional>
#include <string>
#include <vector>

#include "cli/commands/clip_set.h"
#include "cli/encode_options.h"
#include "igf/base/log.h"
#include "igf/base/result.h"
#include "igf/simulation_truth.h"
#include "stabilizer/analysis_file.h"
#include "stabilizer/pipeline/stabilize_options.h"

namespace rsstab::cli {

enum class ClipTool {
  kNone,     // the clip as it is
  kOwn,      // this program
  kVidstab,  // FFmpeg's two passes of vid.stab
  kDeshake,  // FFmpeg's deshake
};

// One way to steady a clip.
struct ClipMethod {
  std::string name;  // as the user wrote it
  ClipTool tool = ClipTool::kNone;
  pipeline::StabilizeOptions options;  // kOwn only
};

// The words that stand for methods: input, each word of the option --rs, vidstab, deshake.
[[nodiscard]] std::vector<std::string> ClipMethodNames();

// "input,off,gyro@gyro-offset=0.005,readout=20,vidstab": a list as method_list.h has it; methods of
// this program may have options of the main command as settings (a switch is name=true).
// Errors: those of ParseMethodList; kInvalidArgument for an unknown word (naming all), an option
// that is none, has a bad value or does not go with the method, or an empty list.
[[nodiscard]] Result<std::vector<ClipMethod>> ParseClipMethods(const std::string& list);

// Why a tool cannot run here; empty when it can. Asks the `ffmpeg` on PATH what filters it has.
[[nodiscard]] std::optional<Error> WhyToolIsMissing(ClipTool tool);

struct ClipEncoding {
  double crf = 0.0;  // of x264
  std::string preset;
};

// The same for this program: replaces `output`.
[[nodiscard]] EncodeOptions EncodeAs(const ClipEncoding& encoding, const std::string& output);

// What a method made of a clip.
struct SteadyResult {
  std::string clip;           // to be measured; the input itself for kNone
  std::string analysis_file;  // empty but for kOwn
  std::optional<stabilizer::ClipAnalysis> analysis;
  double analysis_s = 0.0;  // wall time of the first pass; 0 where there is none
  double render_s = 0.0;    // of the second, decoding and encoding included
};

// Runs the method on the clip; what it writes goes to `folder` and replaces what the last one wrote
// there. The own methods go through the code of the main command. On simulated clips `gyro` is told
// everything (log, its offset, camera, readout time), `auto` the log only, all others nothing but
// the pictures; what the method's own options say goes first. `truth`: of a simulated clip, else
// null. `logger` hears what analysis and rendering have to say, not what is odd about the file.
// Errors: those of the stabilizer or of RunChild.
[[nodiscard]] Result<SteadyResult> RunClipMethod(const ClipMethod& method,
                                                 const EvaluationClip& clip,
                                                 const igf::SimulationTruth* truth,
                                                 const ClipEncoding& encoding,
                                                 const std::string& folder, const Logger& logger);

}  // namespace rsstab::cli

#endif  // RSSTAB_CLI_COMMANDS_CLIP_METHOD_H_
