// SPDX-License-Identifier: Apache-2.0
// What a look-ahead is worth: steadies clips live with several of them and in two passes, and
// prints a row of a table for each.
//
//   lookahead_table CLIP... [--option VALUE]... [--lookahead N,N,...] [--max-frames N]
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "cli/media/video_reader.h"
#include "stabilizer/metrics/pair_metrics.h"
#include "stabilizer/pipeline/analyzer.h"
#include "stabilizer/pipeline/online_stabilizer.h"
#include "stabilizer/pipeline/renderer.h"
#include "stabilizer/quality_metrics.h"

namespace {

using namespace rsstab;
using Clock = std::chrono::steady_clock;

struct Settings {
  pipeline::OnlineOptions options;
  std::vector<int> lookaheads = {0, 5, 15, 30, 60};
  std::int64_t max_frames = 1'000'000;
};

// Figures of one way to steady a clip.
class Judge {
 public:
  Status Take(const Frame& input, const Frame& output) {
    if (Status ok = clip_.Push(output.View()); !ok) {
      return ok;
    }
    return pair_.Push(input.View(), output.View());
  }
  void Print(const std::string& clip, const std::string& row, double fps, double own_ms,
             double worst_ms) const {
    const auto metrics = clip_.Measure(fps);
    const auto pair = pair_.Measure();
    std::printf("| %s | %s | %.3f | %.3f | %.3f | %.3f | %.1f | %.0f |\n", clip.c_str(),
                row.c_str(), metrics.jitter.value_or(-1.0), metrics.shake.value_or(-1.0),
                pair.crop.value_or(-1.0), pair.smallest_crop.value_or(-1.0),
                own_ms / static_cast<double>(metrics.frames), worst_ms);
    std::fflush(stdout);
  }

 private:
  stabilizer::ClipMeter clip_;
  stabilizer::PairMeter pair_;
};

struct OpenClip {
  std::unique_ptr<media::VideoReader> reader;
  pipeline::ClipGeometry geometry;
};

Result<OpenClip> Open(const std::string& path) {
  auto reader = media::VideoReader::Open(path, {});
  if (!reader) {
    return Propagate(reader.error());
  }
  const media::VideoInfo& info = (*reader)->info();
  pipeline::ClipGeometry geometry{info.width, info.height};
  if (info.frame_rate.Value() > 0.0) {
    geometry.frames_per_second = info.frame_rate.Value();
  }
  return OpenClip{std::move(*reader), geometry};
}

// Milliseconds of a piece of work: the sum, and the longest one.
struct Stopwatch {
  double total_ms = 0.0;
  double worst_ms = 0.0;
  template <typename Work>
  auto Run(const Work& work) {
    const auto begin = Clock::now();
    auto result = work();
    const double ms = std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
    total_ms += ms;
    worst_ms = std::max(worst_ms, ms);
    return result;
  }
};

Status RunLive(const std::string& path, const Settings& settings, int lookahead) {
  auto clip = Open(path);
  if (!clip) {
    return Propagate(clip.error());
  }
  pipeline::OnlineOptions options = settings.options;
  options.lookahead_frames = lookahead;
  auto online = pipeline::OnlineStabilizer::Create(options, clip->geometry, {}, SilentLogger());
  if (!online) {
    return Propagate(online.error());
  }
  Judge judge;
  Stopwatch own;
  const auto take = [&]() -> Status {
    while (true) {
      const auto ready = own.Run([&] { return (*online)->Peek(); });
      if (!ready || !*ready) {
        return ready ? Status{} : Propagate(ready.error());
      }
      const Frame input = *(*ready)->frame;
      auto output = AllocateFrame(input.layout, input.width, input.height);
      if (Status ok = own.Run([&] { return (*online)->Render(*output); }); !ok) {
        return ok;
      }
      if (Status ok = judge.Take(input, *output); !ok) {
        return ok;
      }
    }
  };
  for (std::int64_t i = 0; i < settings.max_frames; ++i) {
    const auto frame = clip->reader->Read();
    if (!frame || !*frame) {
      break;
    }
    if (Status ok = own.Run(
            [&] { return (*online)->Push((*frame)->frame, (*frame)->pts, (*frame)->time_s); });
        !ok) {
      return ok;
    }
    if (Status ok = take(); !ok) {
      return ok;
    }
  }
  if (Status ok = (*online)->Flush(); !ok) {
    return ok;
  }
  if (Status ok = take(); !ok) {
    return ok;
  }
  judge.Print(std::filesystem::path(path).stem().string(), std::to_string(lookahead),
              clip->geometry.frames_per_second, own.total_ms, own.worst_ms);
  return {};
}

Status RunTwoPass(const std::string& path, const Settings& settings) {
  const std::string file = (std::filesystem::temp_directory_path() / "lookahead.rsstab").string();
  auto clip = Open(path);
  if (!clip) {
    return Propagate(clip.error());
  }
  auto analyzer = pipeline::Analyzer::Create(settings.options.stabilize, clip->geometry, {}, file,
                                             SilentLogger());
  if (!analyzer) {
    return Propagate(analyzer.error());
  }
  Stopwatch own;
  for (std::int64_t i = 0; i < settings.max_frames; ++i) {
    const auto frame = clip->reader->Read();
    if (!frame || !*frame) {
      break;
    }
    if (Status ok = own.Run([&] {
          return (*analyzer)->PushFrame((*frame)->frame.View(), (*frame)->pts, (*frame)->time_s);
        });
        !ok) {
      return ok;
    }
  }
  if (const auto done = own.Run([&] { return (*analyzer)->Finish(); }); !done) {
    return Propagate(done.error());
  }
  clip = Open(path);
  auto renderer = pipeline::Renderer::Create(settings.options.stabilize, file, clip->geometry.width,
                                             clip->geometry.height, SilentLogger());
  if (!renderer) {
    return Propagate(renderer.error());
  }
  Judge judge;
  for (std::int64_t i = 0; i < settings.max_frames; ++i) {
    const auto frame = clip->reader->Read();
    if (!frame || !*frame) {
      break;
    }
    const auto output =
        own.Run([&] { return (*renderer)->Render((*frame)->frame, (*frame)->pts); });
    if (!output) {
      return Propagate(output.error());
    }
    if (Status ok = judge.Take((*frame)->frame, *output); !ok) {
      return ok;
    }
  }
  std::filesystem::remove(file);
  judge.Print(std::filesystem::path(path).stem().string(), "two passes",
              clip->geometry.frames_per_second, own.total_ms, own.worst_ms);
  return {};
}

bool Set(Settings& settings, const std::string& name, const std::string& value) {
  if (name == "lookahead") {
    settings.lookaheads.clear();
    for (std::size_t at = 0; at < value.size();) {
      std::size_t used = 0;
      settings.lookaheads.push_back(std::stoi(value.substr(at), &used));
      at += used + 1;
    }
    return true;
  }
  if (name == "max-frames") {
    settings.max_frames = std::stoll(value);
    return true;
  }
  for (const auto& spec : pipeline::OnlineOptionTable()) {
    if (spec.name == name) {
      return spec.set(settings.options, value).has_value();
    }
  }
  return false;
}

}  // namespace

int main(int argc, char** argv) {
  Settings settings;
  settings.options.stabilize.rs = pipeline::RsChoice::kOff;
  std::vector<std::string> clips;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (!argument.starts_with("--")) {
      clips.push_back(argument);
    } else if (++i == argc || !Set(settings, argument.substr(2), argv[i])) {
      std::fprintf(stderr, "%s: unknown, or its value is wrong\n", argument.c_str());
      return 2;
    }
  }
  std::printf(
      "| clip | look-ahead | jitter | shake | crop | smallest crop | ms/frame | worst ms |\n");
  std::printf("|---|---|--:|--:|--:|--:|--:|--:|\n");
  for (const std::string& clip : clips) {
    for (const int lookahead : settings.lookaheads) {
      if (const Status ok = RunLive(clip, settings, lookahead); !ok) {
        std::fprintf(stderr, "%s\n", ok.error().message.c_str());
        return 1;
      }
    }
    if (const Status ok = RunTwoPass(clip, settings); !ok) {
      std::fprintf(stderr, "%s\n", ok.error().message.c_str());
      return 1;
    }
  }
  return 0;
}
