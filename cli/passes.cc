// SPDX-License-Identifier: Apache-2.0
#include "cli/passes.h"

#include <filesystem>
#include <utility>

#include "cli/cancellation.h"
#include "cli/output_names.h"
#include "cli/read_ahead.h"
#include "cli/rs_inputs.h"
#include "cli/write_behind.h"
#include "stabilizer/pipeline/analyzer.h"
#include "stabilizer/pipeline/renderer.h"

namespace rsstab::cli {
namespace {

tl::unexpected<Error> Stopped() {
  return Fail(ErrorCode::kCancelled, "stopped as asked for; nothing was written");
}

media::WriterOptions ToWriterOptions(const EncodeOptions& encode,
                                     const pipeline::StabilizeOptions& options,
                                     const Logger& logger) {
  media::WriterOptions writer;
  writer.codec = encode.codec;
  writer.crf = encode.crf;
  writer.preset = encode.preset;
  writer.pix_fmt = encode.pix_fmt;
  writer.encoder_options = encode.encoder_options;
  writer.num_threads = options.num_threads;
  writer.overwrite = encode.overwrite;
  writer.logger = logger;
  return writer;
}

pipeline::ClipGeometry GeometryOf(const media::VideoInfo& clip) {
  pipeline::ClipGeometry geometry{clip.width, clip.height};
  if (clip.frame_rate.Value() > 0.0) {
    geometry.frames_per_second = clip.frame_rate.Value();
  }
  return geometry;
}

// Shows `look` every frame of the clip in order, and the user how far that has come, within a pass
// that the caller begins and ends. `pass`: its name in the list of times.
Status ForEachFrame(ReadAhead& frames, const std::string& pass, const CommandContext& context,
                    const std::function<Status(media::VideoFrame& frame)>& look) {
  const std::string waiting = pass + ": wait for the decoder";
  while (true) {
    auto frame = context.times->Measure(waiting, [&] { return frames.Next(); });
    if (CancelRequested()) {
      return Stopped();
    }
    if (!frame) {
      return Propagate(frame.error(), frames.info().path);
    }
    if (!*frame) {
      return {};
    }
    if (Status status = look(**frame); !status) {
      return status;
    }
    context.reporter->Update((*frame)->index + 1);
  }
}

}  // namespace

Result<std::unique_ptr<media::VideoReader>> OpenClip(const std::string& input,
                                                     const pipeline::StabilizeOptions& options,
                                                     const Logger& logger) {
  if (input == "-") {
    return Fail(ErrorCode::kUnsupported,
                "standard input cannot be read twice, once to look and once to render; save the "
                "clip to a file first");
  }
  return media::VideoReader::Open(input, {options.num_threads, logger});
}

Result<SteadyClip> OpenOutput(const EncodeOptions& encode,
                              const pipeline::StabilizeOptions& options, media::VideoReader& clip,
                              const Logger& logger) {
  const std::string input = clip.info().path;
  const auto open = [&](const std::string& output) -> Result<SteadyClip> {
    if (Status status = CheckOutput(input, output, encode.overwrite); !status) {
      return Propagate(status.error());
    }
    auto writer = media::VideoWriter::Open(output, clip, ToWriterOptions(encode, options, logger));
    if (!writer) {
      return Propagate(writer.error());
    }
    return SteadyClip{output, std::move(*writer)};
  };
  if (!encode.output.empty()) {
    return open(encode.output);
  }
  const std::string output = DefaultOutput(input);
  auto opened = open(output);
  if (!opened && opened.error().code == ErrorCode::kUnsupported) {
    return open(std::filesystem::path(output).replace_extension(".mkv").string());
  }
  return opened;
}

Result<stabilizer::ClipAnalysis> AnalyzeClip(std::unique_ptr<media::VideoReader> clip,
                                             const pipeline::StabilizeOptions& options,
                                             const std::string& analysis_file, PassNumber number,
                                             const CommandContext& context) {
  const media::VideoInfo info = clip->info();
  auto inputs = ReadRsInputs(options, info, context.logger);
  if (!inputs) {
    return Propagate(inputs.error());
  }
  auto analyzer = pipeline::Analyzer::Create(options, GeometryOf(info), std::move(*inputs),
                                             analysis_file, context.logger);
  if (!analyzer) {
    return Propagate(analyzer.error());
  }
  context.reporter->BeginPass(number.pass, number.passes, "analyze", info.frame_count);
  StageTimes& times = *context.times;
  ReadAhead frames(std::move(clip));
  Status status = ForEachFrame(frames, "Pass 1", context, [&](media::VideoFrame& picture) {
    return times.Measure("Pass 1: look at the frames", [&] {
      return (*analyzer)->PushFrame(picture.frame.View(), picture.pts, picture.time_s);
    });
  });
  if (!status) {
    return Propagate(std::move(status.error()));
  }
  auto analysis = times.Measure("Pass 1: motion and path of the clip", [&] {
    return (*analyzer)->Finish([] { return CancelRequested(); });
  });
  if (!analysis && analysis.error().code == ErrorCode::kCancelled) {
    return Stopped();
  }
  context.reporter->EndPass();
  return analysis;
}

Result<pipeline::CalibrationReport> CalibrateClip(std::unique_ptr<media::VideoReader> clip,
                                                  const pipeline::StabilizeOptions& options,
                                                  const CommandContext& context) {
  const media::VideoInfo info = clip->info();
  auto inputs = ReadRsInputs(options, info, context.logger);
  if (!inputs) {
    return Propagate(inputs.error());
  }
  auto calibrator =
      pipeline::Calibrator::Create(options, GeometryOf(info), std::move(*inputs), context.logger);
  if (!calibrator) {
    return Propagate(calibrator.error());
  }
  context.reporter->BeginPass(1, 1, "calibrate", info.frame_count);
  ReadAhead frames(std::move(clip));
  Status status = ForEachFrame(frames, "Pass 1", context, [&](media::VideoFrame& picture) {
    return (*calibrator)->PushFrame(picture.frame.View(), picture.time_s);
  });
  if (!status) {
    return Propagate(std::move(status.error()));
  }
  auto report = (*calibrator)->Finish();
  context.reporter->EndPass();
  return report;
}

Status RenderClip(std::unique_ptr<media::VideoReader> clip, SteadyClip output,
                  const pipeline::StabilizeOptions& options, const std::string& analysis_file,
                  PassNumber number, const CommandContext& context,
                  const RenderObserver& observer) {
  const media::VideoInfo info = clip->info();
  auto renderer =
      pipeline::Renderer::Create(options, analysis_file, info.width, info.height, context.logger);
  if (!renderer) {
    return Propagate(renderer.error());
  }

  context.reporter->BeginPass(number.pass, number.passes, "render", (*renderer)->clip().num_frames);
  ReadAhead frames(std::move(clip));
  WriteBehind steady_clip(std::move(output.writer));
  StageTimes& times = *context.times;
  Status rendered =
      ForEachFrame(frames, "Pass 2", context, [&](media::VideoFrame& picture) -> Status {
        auto steady = times.Measure(
            "Pass 2: render", [&] { return (*renderer)->Render(picture.frame, picture.pts); });
        if (!steady) {
          return Propagate(steady.error());
        }
        if (observer) {
          if (Status status = times.Measure("Pass 2: measure for this report",
                                            [&] { return observer(picture, *steady); });
              !status) {
            return status;
          }
        }
        return times.Measure("Pass 2: wait for the encoder",
                             [&] { return steady_clip.Write(std::move(*steady)); });
      });
  if (!rendered) {
    return rendered;
  }
  if (Status status = (*renderer)->Finish(); !status) {
    return status;
  }
  if (Status status =
          times.Measure("Pass 2: finish the file", [&] { return steady_clip.Finish(); });
      !status) {
    return status;
  }
  context.reporter->EndPass();
  const stabilizer::ClipAnalysis& analysis = (*renderer)->clip();
  context.logger->info("{}: {} frames, at least {:.1f} % of each side kept", output.path,
                       analysis.num_frames, 100.0 * analysis.smallest_kept_ratio);
  return {};
}

}  // namespace rsstab::cli
