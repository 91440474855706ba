// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/compare.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <filesystem>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "cli/media/video_reader.h"
#include "cli/pages/compare_page.h"
#include "cli/pages/report_file.h"
#include "cli/stage_times.h"
#include "igf/base/parallel_for.h"
#include "igf/camera_profile_reader.h"

namespace rsstab::cli {
namespace {

namespace fs = std::filesystem;

// Assumed where a clip does not tell; most cameras do 30.
constexpr double kUsualFramesPerSecond = 30.0;

struct TruthFiles {
  fs::path twin;    // the global-shutter clip
  fs::path camera;  // camera JSON
};

Result<TruthFiles> FindTruth(const fs::path& named) {
  std::error_code ignored;
  const bool is_folder = fs::is_directory(named, ignored);
  const fs::path folder = is_folder ? named : named.parent_path();
  const bool is_clip = !is_folder && named.extension() != ".json";
  TruthFiles files{is_clip ? named : folder / "gs.mp4", folder / "camera.json"};
  for (const fs::path& file : {files.twin, files.camera}) {
    if (!fs::is_regular_file(file, ignored)) {
      return Fail(ErrorCode::kNotFound,
                  "{}: no such file; --truth takes the folder that `rs-stabilize simulate` wrote, "
                  "with gs.mp4 and camera.json in it.",
                  file.string());
    }
  }
  return files;
}

// One clip, read in step with the others.
struct Source {
  std::unique_ptr<media::VideoReader> reader;
  std::optional<media::VideoFrame> frame;
  std::int64_t frames = 0;  // read so far

  [[nodiscard]] Status Next() {
    auto next = reader->Read();
    if (!next) {
      return Propagate(next.error(), reader->info().path);
    }
    frame = std::move(*next);
    frames += frame ? 1 : 0;
    return {};
  }
};

Result<Source> OpenSource(const std::string& path, int threads, const Logger& logger) {
  auto reader = media::VideoReader::Open(path, {threads, logger});
  if (!reader) {
    return Propagate(reader.error());
  }
  return Source{std::move(*reader), std::nullopt, 0};
}

// Whether a clip shows the same view as the twin, of whatever size.
Status CheckShape(const media::VideoInfo& clip, const media::VideoInfo& twin) {
  constexpr double kRounding = 0.01;  // of sides that were scaled to whole pixels
  const double aspect = static_cast<double>(clip.width) / clip.height;
  const double twin_aspect = static_cast<double>(twin.width) / twin.height;
  if (std::abs(aspect / twin_aspect - 1.0) > kRounding) {
    return Fail(ErrorCode::kInvalidArgument,
                "--truth: {} is {} x {}, {} is {} x {}: this is the truth of another clip.",
                twin.path, twin.width, twin.height, clip.path, clip.width, clip.height);
  }
  return {};
}

// The twin, and what is measured against it.
struct Truth {
  Source twin;
  Camera camera;
  stabilizer::TruthMeter input;
  stabilizer::TruthMeter output;
};

Result<Truth> OpenTruth(const CompareOptions& options, const Logger& logger) {
  const auto files = FindTruth(options.truth);
  if (!files) {
    return Propagate(files.error());
  }
  const auto profile = igf::ReadCameraProfile(files->camera.string());
  if (!profile) {
    return Propagate(profile.error());
  }
  auto meter = stabilizer::TruthMeter::Create(profile->camera);
  if (!meter) {
    return Propagate(meter.error(), files->camera.string());
  }
  auto twin = OpenSource(files->twin.string(), options.threads, logger);
  if (!twin) {
    return Propagate(twin.error());
  }
  return Truth{std::move(*twin), profile->camera, *meter, *meter};
}

// One meter's work on the frames at hand.
using Measurement = std::function<Status()>;

// Meters share nothing, so they run side by side.
Status MeasureAll(const std::vector<Measurement>& measurements, WorkerPool& pool) {
  std::vector<Status> results(measurements.size());
  pool.ForBlocks(static_cast<int>(measurements.size()), 1, [&](int index, int) {
    const auto i = static_cast<std::size_t>(index);
    try {
      results[i] = measurements[i]();
    } catch (const std::exception& exception) {
      results[i] = Fail(ErrorCode::kInternal, "A frame cannot be measured: {}", exception.what());
    }
  });
  for (Status& result : results) {
    if (!result) {
      return std::move(result);
    }
  }
  return {};
}

// Pushes the frame of `clip` into `meter`, while there is one.
Measurement OfClip(const Source& clip, stabilizer::ClipMeter& meter) {
  return [&clip, &meter] { return clip.frame ? meter.Push(clip.frame->frame.View()) : Status{}; };
}

// The same of the frames of two clips, while both have one.
template <typename Meter>
Measurement OfBoth(const Source& first, const Source& second, Meter& meter) {
  return [&first, &second, &meter] {
    return first.frame && second.frame
               ? meter.Push(first.frame->frame.View(), second.frame->frame.View())
               : Status{};
  };
}

CompareReport::Clip Describe(const media::VideoInfo& info, const stabilizer::ClipMeter& meter) {
  CompareReport::Clip clip{info.path, info.width, info.height, info.frame_rate.Value(), {}, {}, {}};
  if (!(clip.frames_per_second > 0.0)) {
    clip.frames_per_second = kUsualFramesPerSecond;
  }
  clip.metrics = meter.Measure(clip.frames_per_second);
  clip.poses = meter.Path();
  return clip;
}

// Says why figures against the truth are doubtful or missing. Of the twin at most one frame more
// than the clips have was read.
void WarnOfTruth(const CompareOptions& options, const CompareReport& report, std::int64_t frames,
                 std::int64_t twin_frames, const Logger& logger) {
  if (frames != twin_frames) {
    logger->warn("compare: the truth {} has {} frames than {}; frames were paired by their number",
                 options.truth, twin_frames < frames ? "fewer" : "more", options.input);
  }
  for (const CompareReport::Clip* clip : {&report.input, &report.output}) {
    if (clip->truth && clip->truth->frames > 0 && !clip->truth->camera_residual) {
      logger->warn("compare: no frame of {} could be brought onto the truth {}; is it this clip's?",
                   clip->path, options.truth);
    }
  }
}

}  // namespace

Result<CompareReport> CompareClips(const CompareOptions& options, const Logger& logger,
                                   const CompareProgress& progress, CompareScope scope,
                                   const CompareObserver& observer) {
  auto input = OpenSource(options.input, options.threads, logger);
  if (!input) {
    return Propagate(input.error());
  }
  std::optional<Source> output;
  if (scope != CompareScope::kInputOnly) {
    auto opened = OpenSource(options.output, options.threads, logger);
    if (!opened) {
      return Propagate(opened.error());
    }
    output.emplace(std::move(*opened));
  }
  std::optional<Truth> truth;
  if (!options.truth.empty()) {
    auto opened = OpenTruth(options, logger);
    if (!opened) {
      return Propagate(opened.error());
    }
    truth.emplace(std::move(*opened));
    for (const Source* clip : {&*input, output ? &*output : nullptr}) {
      if (clip == nullptr) {
        continue;
      }
      if (Status shape = CheckShape(clip->reader->info(), truth->twin.reader->info()); !shape) {
        return Propagate(shape.error());
      }
    }
  }
  stabilizer::ClipMeter input_meter;
  stabilizer::ClipMeter output_meter;
  stabilizer::PairMeter pair_meter;
  std::vector<Source*> sources = {&*input};
  std::vector<Measurement> measurements;
  if (scope != CompareScope::kOutputOnly) {
    measurements.push_back(OfClip(*input, input_meter));
    if (truth) {
      measurements.push_back(OfBoth(*input, truth->twin, truth->input));
    }
  }
  if (output) {
    sources.push_back(&*output);
    measurements.push_back(OfClip(*output, output_meter));
    measurements.push_back(OfBoth(*input, *output, pair_meter));
    if (truth) {
      measurements.push_back(OfBoth(*output, truth->twin, truth->output));
    }
  }
  std::int64_t expected = 0;
  for (const Source* source : sources) {
    expected = std::max(expected, source->reader->info().frame_count);
  }
  if (truth) {
    sources.push_back(&truth->twin);
  }
  WorkerPool pool(ResolveThreadCount(options.threads));
  for (std::int64_t index = 0;; ++index) {
    for (Source* source : sources) {
      if (Status read = source->Next(); !read) {
        return Propagate(read.error());
      }
    }
    if (!input->frame && !(output && output->frame)) {
      break;
    }
    if (Status measured = MeasureAll(measurements, pool); !measured) {
      return Propagate(measured.error());
    }
    if (observer && output) {
      const auto at = [](const Source& source) { return source.frame ? &*source.frame : nullptr; };
      ComparedFrames frames;
      frames.index = index;
      frames.input_info = &input->reader->info();
      frames.output_info = &output->reader->info();
      frames.input_meter = &input_meter;
      frames.input = at(*input);
      frames.output = at(*output);
      if (truth) {
        frames.twin = at(truth->twin);
        frames.input_residual = truth->input.LastResidual();
        frames.camera = &truth->camera;
      }
      if (Status observed = observer(frames); !observed) {
        return Propagate(observed.error());
      }
    }
    if (progress && !progress(index + 1, expected)) {
      return Fail(ErrorCode::kCancelled, "Stopped after {} frames, as asked.", index + 1);
    }
  }
  CompareReport report;
  const auto truth_of = [&truth](stabilizer::TruthMeter Truth::*meter) {
    return truth ? std::optional((*truth.*meter).Measure()) : std::nullopt;
  };
  if (scope != CompareScope::kOutputOnly) {
    report.input = Describe(input->reader->info(), input_meter);
    report.input.truth = truth_of(&Truth::input);
  }
  if (output) {
    report.output = Describe(output->reader->info(), output_meter);
    report.output.truth = truth_of(&Truth::output);
  }
  report.pair = pair_meter.Measure();
  if (output && input->frames != output->frames) {
    logger->warn("compare: {} has {} frames, {} has {}; frames were paired by their number",
                 options.input, input->frames, options.output, output->frames);
  }
  if (truth) {
    WarnOfTruth(options, report, input->frames, truth->twin.frames, logger);
  }
  return report;
}

Status RunCompare(const CompareOptions& options, const Logger& logger, std::ostream& out,
                  const CompareProgress& progress) {
  std::optional<ReportFile> file;
  ComparePage page;
  CompareObserver observer;
  if (!options.report.empty()) {
    auto opened =
        ReportFile::Open(options.report, options.overwrite, {options.input, options.output});
    if (!opened) {
      return Propagate(opened.error());
    }
    file.emplace(std::move(*opened));
    observer = [&page](const ComparedFrames& frames) { return page.Observe(frames); };
  }
  StageTimes times;
  const auto report = times.Measure("Decode and measure both clips", [&] {
    return CompareClips(options, logger, progress, CompareScope::kBoth, observer);
  });
  if (!report) {
    return Propagate(report.error());
  }
  if (file) {
    const auto html = page.Make(*report, options, times.stages());
    if (!html) {
      return Propagate(html.error(), options.report);
    }
    if (Status written = file->Write(*html); !written) {
      return written;
    }
  }
  out << (options.json ? FormatCompareJson(*report) : FormatCompareText(*report)) << std::flush;
  if (!out) {
    return Fail(ErrorCode::kIo, "The report could not be written to standard output.");
  }
  return {};
}

}  // namespace rsstab::cli
