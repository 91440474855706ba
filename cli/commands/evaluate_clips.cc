// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/evaluate_clips.h"

#include <algorithm>
#include <utility>

#include "cli/cancellation.h"
#include "cli/commands/clip_method.h"
#include "cli/commands/codec_cost.h"
#include "cli/media/video_reader.h"
#include "cli/output_names.h"
#include "igf/simulation_truth.h"

namespace rsstab::cli {
namespace {

constexpr double kMilli = 1e3;
// Clips of a kind whose pictures are kept: they are what makes a page large.
constexpr int kMostShown = 4;

// The other messages of a run, of which there are many, would only hide what is told here.
Logger WarningsOnly(const Logger& logger) {
  Logger quiet = logger->clone(logger->name());
  quiet->set_level(std::max(logger->level(), spdlog::level::warn));
  return quiet;
}

Result<std::optional<igf::SimulationTruth>> ReadTruth(const EvaluationClip& clip) {
  if (clip.kind == ClipKind::kReal) {
    return std::nullopt;
  }
  auto truth = igf::ReadSimulationTruth((clip.folder / "truth.json").string());
  if (!truth) {
    return Propagate(truth.error());
  }
  if (clip.kind == ClipKind::kTwin) {
    truth->camera.readout_s = 0.0;
  }
  return std::move(*truth);
}

// Whether the file is a clip at all. What is odd about it is told here, once for all methods.
Status TryClip(const EvaluationClip& clip, const Logger& logger) {
  const auto reader = media::VideoReader::Open(clip.video.string(), {0, logger});
  return reader ? Status{} : Propagate(reader.error());
}

void NoteCodec(const CodecCost& cost, ClipRun& run, ClipRecord& clip) {
  const double frames = static_cast<double>(std::max<std::int64_t>(1, run.clip.metrics.frames));
  clip.decode_ms = kMilli * cost.decode_s / frames;
  clip.recode_ms = kMilli * cost.recode_s / frames;
  if (run.total_ms) {
    run.own_ms = *run.total_ms - *clip.recode_ms - (run.analysis_ms ? *clip.decode_ms : 0.0);
  }
}

// How far the rotations that the methods found are from the true ones, or, where nobody knows
// those, from what the first method that read a gyro log took from it.
Status ScorePaths(const igf::SimulationTruth* truth, ClipRecord& clip) {
  const ClipRun* log = nullptr;
  evaluation::OrientationPath reference;
  if (truth != nullptr) {
    reference = evaluation::TruePath(*truth);
  } else {
    const auto with_log = std::find_if(clip.runs.begin(), clip.runs.end(),
                                       [](const ClipRun& run) { return run.rs_source == "gyro"; });
    if (with_log == clip.runs.end()) {
      return {};
    }
    log = &*with_log;
    reference = log->path;
  }
  for (ClipRun& run : clip.runs) {
    if (!run.field || &run == log) {
      continue;
    }
    auto score = evaluation::ScorePathAngle(run.path, reference, 1.0 / run.clip.frames_per_second);
    if (!score) {
      return Propagate(score.error(), clip.name + ", " + run.method);
    }
    run.angle = *score;
  }
  return {};
}

class Evaluation {
 public:
  Evaluation(const EvaluateOptions& options, std::vector<ClipMethod> methods, std::size_t clips,
             const Logger& logger, const evaluation::EvaluationProgress& progress)
      : encoding_{options.crf, options.preset},
        methods_(std::move(methods)),
        logger_(logger),
        quiet_(WarningsOnly(logger)),
        progress_(progress),
        clips_(clips),
        with_pictures_(!options.report.empty()) {
    for (const ClipMethod& method : methods_) {
      report_.methods.push_back(method.name);
    }
  }

  // Takes out the methods that need what is not there.
  void LeaveOutMissingTools() {
    std::erase_if(methods_, [this](const ClipMethod& method) {
      const auto missing = WhyToolIsMissing(method.tool);
      if (missing) {
        LeaveOut(method.name, *missing);
      }
      return missing.has_value();
    });
  }

  Status Evaluate(const EvaluationClip& clip, const std::string& folder) {
    const std::size_t runs_then = runs_done_ + methods_.size();
    auto truth = ReadTruth(clip);
    Status usable = truth ? TryClip(clip, quiet_) : Propagate(truth.error());
    if (!usable) {
      LeaveOut(clip.name, usable.error());
      return AdvanceTo(runs_then);
    }
    ClipRecord record;
    record.name = clip.name;
    record.kind = clip.kind;
    if (*truth) {
      record.readout_s = (*truth)->camera.readout_s;
    }
    std::optional<CodecCost> codec;
    if (Status status = TimeCodec(clip, folder, codec); !status) {
      return status;
    }
    if (Status status = BeginShowcase(clip, *truth ? &**truth : nullptr, record); !status) {
      return status;
    }
    for (const ClipMethod& method : methods_) {
      auto run = Run(method, clip, *truth ? &**truth : nullptr, folder, record.showcase);
      if (run) {
        if (codec) {
          NoteCodec(*codec, *run, record);
        }
        record.runs.push_back(std::move(*run));
      } else if (run.error().code == ErrorCode::kCancelled) {
        return Propagate(run.error());
      } else {
        LeaveOut(clip.name + ", " + method.name, run.error());
      }
      if (Status status = AdvanceTo(runs_done_ + 1); !status) {
        return status;
      }
    }
    if (Status status = ScorePaths(*truth ? &**truth : nullptr, record); !status) {
      return status;
    }
    report_.clips.push_back(std::move(record));
    return {};
  }

  [[nodiscard]] ClipsReport TakeReport() { return std::move(report_); }

 private:
  void LeaveOut(const std::string& name, const Error& error) {
    logger_->warn("evaluate: {} is left out: {}", name, error.message);
    report_.header.failures.emplace_back(name, error);
  }

  Status AdvanceTo(std::size_t runs) {
    runs_done_ = runs;
    const auto all = static_cast<std::int64_t>(clips_ * methods_.size());
    if (progress_ && !progress_(static_cast<std::int64_t>(runs_done_), all)) {
      return Fail(ErrorCode::kCancelled, "Stopped after {} of {} runs, as asked.", runs_done_, all);
    }
    return {};
  }

  // What every method pays for; left out where nothing is timed.
  Status TimeCodec(const EvaluationClip& clip, const std::string& folder,
                   std::optional<CodecCost>& cost) {
    if (std::all_of(methods_.begin(), methods_.end(),
                    [](const ClipMethod& method) { return method.tool == ClipTool::kNone; })) {
      return {};
    }
    auto measured =
        MeasureCodecCost(clip.video.string(), EncodeAs(encoding_, folder + "recoded.mkv"));
    if (measured) {
      cost = *measured;
    } else if (measured.error().code == ErrorCode::kCancelled) {
      return Propagate(measured.error());
    } else {
      LeaveOut(clip.name + ", time without any method", measured.error());
    }
    return {};
  }

  static Result<CompareReport> Measure(const EvaluationClip& clip, const std::string& result,
                                       bool is_input) {
    CompareOptions compare;
    compare.input = clip.video.string();
    compare.output = result;
    compare.truth = clip.folder.string();
    return CompareClips(
        compare, SilentLogger(), [](std::int64_t, std::int64_t) { return !CancelRequested(); },
        is_input ? CompareScope::kInputOnly : CompareScope::kOutputOnly);
  }

  // The clip as it is tells which of its frames are shown.
  Result<ClipShowcase> OpenShowcase(const EvaluationClip& clip, const igf::SimulationTruth* truth) {
    auto input = Measure(clip, "", true);
    if (!input) {
      return Propagate(input.error());
    }
    input_ = std::move(*input);
    return truth != nullptr ? ClipShowcase::Create(input_->input, (clip.folder / "gs.mp4").string(),
                                                   truth->camera)
                            : ClipShowcase::Create(input_->input, "", std::nullopt);
  }

  Status BeginShowcase(const EvaluationClip& clip, const igf::SimulationTruth* truth,
                       ClipRecord& record) {
    input_.reset();
    int& shown = truth != nullptr ? simulated_shown_ : real_shown_;
    if (!with_pictures_ || clip.kind == ClipKind::kTwin || shown == kMostShown) {
      return {};
    }
    auto showcase = OpenShowcase(clip, truth);
    if (showcase) {
      record.showcase = std::move(*showcase);
      ++shown;
    } else if (showcase.error().code == ErrorCode::kCancelled) {
      return Propagate(showcase.error());
    } else {
      LeaveOut(clip.name + ", pictures", showcase.error());
    }
    return {};
  }

  Result<ClipRun> Run(const ClipMethod& method, const EvaluationClip& clip,
                      const igf::SimulationTruth* truth, const std::string& folder,
                      std::optional<ClipShowcase>& showcase) {
    const auto steady = RunClipMethod(method, clip, truth, encoding_, folder, quiet_);
    if (!steady) {
      return Propagate(steady.error());
    }
    const bool is_input = method.tool == ClipTool::kNone;
    const auto measured =
        is_input && input_ ? Result<CompareReport>(*input_) : Measure(clip, steady->clip, is_input);
    if (!measured) {
      return Propagate(measured.error());
    }
    ClipRun run;
    run.method = method.name;
    run.clip = is_input ? measured->input : measured->output;
    if (showcase) {
      if (Status status = showcase->Add(method.name, steady->clip, run.clip); !status) {
        return Propagate(status.error());
      }
    }
    if (is_input) {
      return run;
    }
    run.pair = measured->pair;
    const double frames = static_cast<double>(std::max<std::int64_t>(1, run.clip.metrics.frames));
    if (steady->analysis_s > 0.0) {
      run.analysis_ms = kMilli * steady->analysis_s / frames;
    }
    run.render_ms = kMilli * steady->render_s / frames;
    run.total_ms = run.analysis_ms.value_or(0.0) + *run.render_ms;
    if (!steady->analysis) {
      return run;
    }
    run.rs_source = steady->analysis->rs_source;
    run.rs_reason = steady->analysis->rs_reason;
    if (steady->analysis->readout_s != 0.0) {
      run.readout_s = steady->analysis->readout_s;
    }
    const auto field = evaluation::ScoreRsFields(steady->analysis_file, truth);
    if (!field) {
      return Propagate(field.error());
    }
    run.field = *field;
    auto path = evaluation::ReadOrientationPath(steady->analysis_file);
    if (!path) {
      return Propagate(path.error());
    }
    run.path = std::move(*path);
    return run;
  }

  ClipEncoding encoding_;
  std::vector<ClipMethod> methods_;
  Logger logger_;
  Logger quiet_;
  const evaluation::EvaluationProgress& progress_;
  std::size_t clips_;
  bool with_pictures_;
  std::optional<CompareReport> input_;  // of the clip at hand, where its pictures are kept
  int real_shown_ = 0;
  int simulated_shown_ = 0;
  std::size_t runs_done_ = 0;
  ClipsReport report_;
};

}  // namespace

Result<ClipsReport> EvaluateClips(const EvaluateOptions& options, const Logger& logger,
                                  const evaluation::EvaluationProgress& progress) {
  const std::string list = options.methods == EvaluateOptions().methods
                               ? fmt::format("{}", fmt::join(ClipMethodNames(), ","))
                               : options.methods;
  if (options.clips.empty()) {
    return Fail(ErrorCode::kInvalidArgument,
                "--clips: the protocol clips needs a folder of clips.");
  }
  auto methods = ParseClipMethods(list);
  if (!methods) {
    return Propagate(methods.error());
  }
  auto clips = FindClips(options.clips, options.twins);
  if (!clips) {
    return Propagate(clips.error());
  }
  if (options.limit > 0 && static_cast<std::int64_t>(clips->size()) > options.limit) {
    clips->resize(static_cast<std::size_t>(options.limit));
  }
  const auto scratch = ScratchFolder::Create();
  if (!scratch) {
    return Propagate(scratch.error());
  }
  Evaluation evaluation(options, std::move(*methods), clips->size(), logger, progress);
  evaluation.LeaveOutMissingTools();
  for (const EvaluationClip& clip : *clips) {
    if (Status status = evaluation.Evaluate(clip, scratch->File("")); !status) {
      return Propagate(status.error());
    }
  }
  ClipsReport report = evaluation.TakeReport();
  EvaluateOptions settings = options;
  settings.protocol = EvaluationProtocol::kClips;
  report.header = MakeHeader(settings, std::move(report.header.failures));
  if (std::all_of(report.clips.begin(), report.clips.end(),
                  [](const ClipRecord& clip) { return clip.runs.empty(); })) {
    const auto& [name, error] = report.header.failures.back();
    return Fail(error.code, "{}: there is nothing to report; {} is left out: {}", options.clips,
                name, error.message);
  }
  return report;
}

}  // namespace rsstab::cli
