// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/clip_method.h"

#include <algorithm>
#include <filesystem>
#include <sstream>
#include <string_view>
#include <utility>

#include "cli/child_process.h"
#include "cli/commands/method_list.h"
#include "cli/passes.h"
#include "cli/stopwatch.h"

namespace rsstab::cli {
namespace {

namespace fs = std::filesystem;
using pipeline::StabilizeOptions;
using StabilizeSpec = pipeline::OptionSpec<StabilizeOptions>;

const char* const kInput = "input";
const char* const kVidstab = "vidstab";
const char* const kDeshake = "deshake";
const char* const kSteadyClip = "steady.mkv";

const StabilizeSpec* FindOption(const std::string& name) {
  const auto& table = pipeline::StabilizeOptionTable();
  const auto found = std::find_if(table.begin(), table.end(),
                                  [&](const StabilizeSpec& spec) { return spec.name == name; });
  return found == table.end() ? nullptr : &*found;
}

std::vector<std::string> RsWords() {
  std::vector<std::string> words;
  std::istringstream choices(FindOption("rs")->value_name);
  for (std::string word; std::getline(choices, word, '|');) {
    words.push_back(word);
  }
  return words;
}

Status ApplySetting(const std::string& name, const std::string& value, ClipMethod& method) {
  const StabilizeSpec* const spec = FindOption(name);
  if (spec == nullptr || spec->name == "rs") {
    return Fail(ErrorCode::kInvalidArgument,
                "--methods: {}: the main command has no option --{} that could go with a method.",
                method.name, name);
  }
  if (Status status = spec->set(method.options, value); !status) {
    return Propagate(status.error(), "--methods: " + method.name);
  }
  return {};
}

Result<ClipMethod> MakeMethod(const MethodSpec& spec) {
  ClipMethod method;
  method.name = spec.text;
  const std::vector<std::string> rs_words = RsWords();
  if (std::find(rs_words.begin(), rs_words.end(), spec.name) != rs_words.end()) {
    method.tool = ClipTool::kOwn;
    if (Status status = FindOption("rs")->set(method.options, spec.name); !status) {
      return Propagate(status.error());
    }
  } else if (spec.name == kVidstab || spec.name == kDeshake) {
    method.tool = spec.name == kVidstab ? ClipTool::kVidstab : ClipTool::kDeshake;
  } else if (spec.name != kInput) {
    return Fail(ErrorCode::kInvalidArgument, "--methods: there is no method '{}'; choose from {}.",
                spec.name, fmt::join(ClipMethodNames(), ", "));
  }
  if (!spec.settings.empty() && method.tool != ClipTool::kOwn) {
    return Fail(ErrorCode::kInvalidArgument, "--methods: {}: '{}' takes no options.", spec.text,
                spec.name);
  }
  for (const auto& [name, value] : spec.settings) {
    if (Status status = ApplySetting(name, value, method); !status) {
      return Propagate(status.error());
    }
  }
  if (Status status = pipeline::Validate(method.options); !status) {
    return Propagate(status.error(), "--methods: " + spec.text);
  }
  return method;
}

// What is known of a simulated clip, as far as the method is to be told.
void TellWhatIsKnown(const EvaluationClip& clip, const igf::SimulationTruth& truth,
                     StabilizeOptions& options) {
  const bool told_all = options.rs == pipeline::RsChoice::kGyro;
  if (!told_all && options.rs != pipeline::RsChoice::kAuto) {
    return;
  }
  if (options.gyro_file.empty()) {
    options.gyro_file = (clip.folder / "gyro.csv").string();
  }
  if (!told_all) {
    return;
  }
  if (options.camera_file.empty()) {
    options.camera_file = (clip.folder / "camera.json").string();
  }
  if (!options.gyro_offset_s) {
    options.gyro_offset_s = truth.gyro_offset_s;
  }
  if (!options.readout_s) {
    options.readout_s = clip.kind == ClipKind::kTwin ? 0.0 : truth.camera.readout_s;
  }
}

Result<SteadyResult> RunOwn(const StabilizeOptions& options, const std::string& input,
                            const ClipEncoding& encoding, const fs::path& folder,
                            const Logger& logger) {
  const ProgressSink nowhere{ProgressStyle::kNone, 80, [](std::string_view) {}, [] { return 0.0; }};
  const CommandContext context{logger, std::make_shared<ProgressReporter>(nowhere)};
  SteadyResult result;
  result.clip = (folder / kSteadyClip).string();
  result.analysis_file = (folder / "analysis").string();
  const Stopwatch first_pass;
  auto clip = OpenClip(input, options, SilentLogger());
  if (!clip) {
    return Propagate(clip.error());
  }
  auto analysis = AnalyzeClip(std::move(*clip), options, result.analysis_file, {1, 2}, context);
  if (!analysis) {
    return Propagate(analysis.error());
  }
  result.analysis = std::move(*analysis);
  result.analysis_s = first_pass.Seconds();

  const Stopwatch second_pass;
  auto second_look = OpenClip(input, options, SilentLogger());
  if (!second_look) {
    return Propagate(second_look.error());
  }
  auto output = OpenOutput(EncodeAs(encoding, result.clip), options, **second_look, SilentLogger());
  if (!output) {
    return Propagate(output.error());
  }
  if (Status rendered = RenderClip(std::move(*second_look), std::move(*output), options,
                                   result.analysis_file, {2, 2}, context);
      !rendered) {
    return Propagate(rendered.error());
  }
  result.render_s = second_pass.Seconds();
  return result;
}

// Quiet, no questions asked. Filters name files relative to the folder it runs in: their own syntax
// would trip over some paths.
std::vector<std::string> FfmpegCommand(const std::string& input, const std::string& filter,
                                       const std::vector<std::string>& output) {
  std::vector<std::string> command = {
      "ffmpeg",   "-hide_banner", "-loglevel", "error",
      "-nostdin", "-y",           "-i",        "file:" + fs::absolute(input).string(),
      "-map",     "0:v:0",        "-vf",       filter};
  command.insert(command.end(), output.begin(), output.end());
  return command;
}

Result<SteadyResult> RunFfmpeg(ClipTool tool, const std::string& input,
                               const ClipEncoding& encoding, const fs::path& folder) {
  SteadyResult result;
  result.clip = (folder / kSteadyClip).string();
  std::string filter = "deshake";
  if (tool == ClipTool::kVidstab) {
    const Stopwatch first_pass;
    const auto detected =
        RunChild(FfmpegCommand(input, "vidstabdetect=shakiness=8:accuracy=15:result=motion.trf",
                               {"-f", "null", "-"}),
                 folder);
    if (!detected) {
      return Propagate(detected.error());
    }
    result.analysis_s = first_pass.Seconds();
    filter = "vidstabtransform=smoothing=30:optzoom=1:input=motion.trf";
  }
  const Stopwatch last_pass;
  // Every frame of the clip, once, whatever its timestamps say: frames are compared by number.
  const auto rendered = RunChild(
      FfmpegCommand(input, filter,
                    {"-fps_mode", "passthrough", "-c:v", "libx264", "-crf",
                     fmt::format("{}", encoding.crf), "-preset", encoding.preset, kSteadyClip}),
      folder);
  if (!rendered) {
    return Propagate(rendered.error());
  }
  result.render_s = last_pass.Seconds();
  return result;
}

}  // namespace

EncodeOptions EncodeAs(const ClipEncoding& encoding, const std::string& output) {
  EncodeOptions encode;
  encode.output = output;
  encode.overwrite = true;
  encode.codec = "libx264";
  encode.crf = encoding.crf;
  encode.preset = encoding.preset;
  return encode;
}

std::vector<std::string> ClipMethodNames() {
  std::vector<std::string> names = {kInput};
  for (std::string& word : RsWords()) {
    names.push_back(std::move(word));
  }
  names.insert(names.end(), {kVidstab, kDeshake});
  return names;
}

Result<std::vector<ClipMethod>> ParseClipMethods(const std::string& list) {
  const auto specs = ParseMethodList(list);
  if (!specs) {
    return Propagate(specs.error());
  }
  std::vector<ClipMethod> methods;
  for (const MethodSpec& spec : *specs) {
    auto method = MakeMethod(spec);
    if (!method) {
      return Propagate(method.error());
    }
    methods.push_back(std::move(*method));
  }
  if (methods.empty()) {
    return Fail(ErrorCode::kInvalidArgument, "--methods: name at least one of {}.",
                fmt::join(ClipMethodNames(), ", "));
  }
  return methods;
}

std::optional<Error> WhyToolIsMissing(ClipTool tool) {
  if (tool != ClipTool::kVidstab && tool != ClipTool::kDeshake) {
    return std::nullopt;
  }
  const std::string filter = tool == ClipTool::kVidstab ? "vidstabdetect" : "deshake";
  const auto filters = RunChild({"ffmpeg", "-hide_banner", "-filters"}, ".");
  if (!filters) {
    return filters.error();
  }
  if (filters->find(" " + filter + " ") == std::string::npos) {
    return Error{ErrorCode::kNotFound,
                 "the ffmpeg on PATH was built without the filter " + filter + "."};
  }
  return std::nullopt;
}

Result<SteadyResult> RunClipMethod(const ClipMethod& method, const EvaluationClip& clip,
                                   const igf::SimulationTruth* truth, const ClipEncoding& encoding,
                                   const std::string& folder, const Logger& logger) {
  const std::string input = clip.video.string();
  if (method.tool == ClipTool::kNone) {
    SteadyResult untouched;
    untouched.clip = input;
    return untouched;
  }
  if (method.tool != ClipTool::kOwn) {
    return RunFfmpeg(method.tool, input, encoding, folder);
  }
  StabilizeOptions options = method.options;
  if (truth != nullptr) {
    TellWhatIsKnown(clip, *truth, options);
  }
  return RunOwn(options, input, encoding, folder, logger);
}

}  // namespace rsstab::cli
