// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/compare.h"

#include <algorithm>
#include <filesystem>
#include <memory>
#include <utility>

#include "cli/media/video_reader.h"
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

  [[nodiscard]] Status Next() {
    auto next = reader->Read();
    if (!next) {
      return Propagate(next.error(), reader->info().path);
    }
    frame = std::move(*next);
    return {};
  }
};

Result<Source> OpenSource(const std::string& path, int threads, const Logger& logger) {
  auto reader = media::VideoReader::Open(path, {threads, logger});
  if (!reader) {
    return Propagate(reader.error());
  }
  return Source{std::move(*reader), std::nullopt};
}

// The twin, and what is measured against it.
struct Truth {
  Source twin;
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
  return Truth{std::move(*twin), *meter, *meter};
}

Status MeasureTruth(Truth& truth, const Source& input, const Source& output) {
  if (Status read = truth.twin.Next(); !read || !truth.twin.frame) {
    return read;
  }
  const FrameView twin = truth.twin.frame->frame.View();
  if (input.frame) {
    if (Status pushed = truth.input.Push(input.frame->frame.View(), twin); !pushed) {
      return pushed;
    }
  }
  return output.frame ? truth.output.Push(output.frame->frame.View(), twin) : Status{};
}

CompareReport::Clip Describe(const media::VideoInfo& info, const stabilizer::ClipMeter& meter) {
  CompareReport::Clip clip{info.path, info.width, info.height, info.frame_rate.Value(), {}, {}};
  if (!(clip.frames_per_second > 0.0)) {
    clip.frames_per_second = kUsualFramesPerSecond;
  }
  clip.metrics = meter.Measure(clip.frames_per_second);
  return clip;
}

}  // namespace

Result<CompareReport> CompareClips(const CompareOptions& options, const Logger& logger,
                                   const CompareProgress& progress) {
  auto input = OpenSource(options.input, options.threads, logger);
  if (!input) {
    return Propagate(input.error());
  }
  auto output = OpenSource(options.output, options.threads, logger);
  if (!output) {
    return Propagate(output.error());
  }
  std::optional<Truth> truth;
  if (!options.truth.empty()) {
    auto opened = OpenTruth(options, logger);
    if (!opened) {
      return Propagate(opened.error());
    }
    truth.emplace(std::move(*opened));
  }
  stabilizer::ClipMeter input_meter;
  stabilizer::ClipMeter output_meter;
  stabilizer::PairMeter pair_meter;
  const std::int64_t expected =
      std::max(input->reader->info().frame_count, output->reader->info().frame_count);
  for (std::int64_t index = 0;; ++index) {
    for (Source* source : {&*input, &*output}) {
      if (Status read = source->Next(); !read) {
        return Propagate(read.error());
      }
    }
    if (!input->frame && !output->frame) {
      break;
    }
    Status pushed;
    if (input->frame) {
      pushed = input_meter.Push(input->frame->frame.View());
    }
    if (pushed && output->frame) {
      pushed = output_meter.Push(output->frame->frame.View());
    }
    if (pushed && input->frame && output->frame) {
      pushed = pair_meter.Push(input->frame->frame.View(), output->frame->frame.View());
    }
    if (pushed && truth) {
      pushed = MeasureTruth(*truth, *input, *output);
    }
    if (!pushed) {
      return Propagate(pushed.error());
    }
    if (progress && !progress(index + 1, expected)) {
      return Fail(ErrorCode::kCancelled, "Stopped after {} frames, as asked.", index + 1);
    }
  }
  CompareReport report{Describe(input->reader->info(), input_meter),
                       Describe(output->reader->info(), output_meter), pair_meter.Measure()};
  if (truth) {
    report.input.truth = truth->input.Measure();
    report.output.truth = truth->output.Measure();
  }
  if (report.input.metrics.frames != report.output.metrics.frames) {
    logger->warn("compare: {} has {} frames, {} has {}; frames were paired by their number",
                 report.input.path, report.input.metrics.frames, report.output.path,
                 report.output.metrics.frames);
  }
  return report;
}

Status RunCompare(const CompareOptions& options, const Logger& logger, std::ostream& out,
                  const CompareProgress& progress) {
  const auto report = CompareClips(options, logger, progress);
  if (!report) {
    return Propagate(report.error());
  }
  out << (options.json ? FormatCompareJson(*report) : FormatCompareText(*report)) << std::flush;
  if (!out) {
    return Fail(ErrorCode::kIo, "The report could not be written to standard output.");
  }
  return {};
}

}  // namespace rsstab::cli
