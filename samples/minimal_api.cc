// SPDX-License-Identifier: Apache-2.0
// The smallest use of the library: a program that has pictures in memory (here it paints them) and
// wants them steady. Analyse all of them, then render them one by one.
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <string>

#include "igf/base/frame.h"
#include "igf/base/log.h"
#include "stabilizer/pipeline/analyzer.h"
#include "stabilizer/pipeline/renderer.h"

namespace {

constexpr int kWidth = 320;
constexpr int kHeight = 180;
constexpr int kFrames = 60;

// A chequered wall seen by a shaky camera.
rsstab::Frame PaintFrame(int index) {
  rsstab::Frame frame = rsstab::AllocateFrame(rsstab::Yuv420Layout(), kWidth, kHeight).value();
  const double dx = 6.0 * std::sin(1.9 * index);
  const double dy = 4.0 * std::cos(2.3 * index);
  for (int plane = 0; plane < frame.layout.num_planes; ++plane) {
    const rsstab::MutablePlaneView& view = frame.planes[static_cast<std::size_t>(plane)];
    for (int y = 0; y < view.height; ++y) {
      for (int x = 0; x < view.width; ++x) {
        const double wave = std::sin((x + dx) * 0.31) * std::sin((y + dy) * 0.23) +
                            0.5 * std::sin((x + dx) * 0.07 + (y + dy) * 0.11);
        view.data[y * view.stride + x] =
            plane == 0 ? static_cast<std::uint8_t>(128.0 + 60.0 * wave) : 128;
      }
    }
  }
  return frame;
}

int Fail(const rsstab::Error& error) {
  std::fprintf(stderr, "%s\n", error.message.c_str());
  return 1;
}

}  // namespace

int main() {
  using namespace rsstab;
  const std::string analysis =
      (std::filesystem::temp_directory_path() / "minimal_api.rsstab").string();
  const Logger logger = SilentLogger();
  pipeline::StabilizeOptions options;  // every default is the command line's
  options.smoothness_s = 2.0;

  auto analyzer =
      pipeline::Analyzer::Create(options, {kWidth, kHeight, 30.0}, {}, analysis, logger);
  if (!analyzer) {
    return Fail(analyzer.error());
  }
  for (int i = 0; i < kFrames; ++i) {
    if (const Status status = (*analyzer)->PushFrame(PaintFrame(i).View(), i, i / 30.0); !status) {
      return Fail(status.error());
    }
  }
  const auto found = (*analyzer)->Finish();
  if (!found) {
    return Fail(found.error());
  }

  auto renderer = pipeline::Renderer::Create(options, analysis, kWidth, kHeight, logger);
  if (!renderer) {
    return Fail(renderer.error());
  }
  for (int i = 0; i < kFrames; ++i) {
    const auto steady = (*renderer)->Render(PaintFrame(i), i);
    if (!steady) {
      return Fail(steady.error());
    }
    // steady->planes holds the picture: show it, encode it, ...
  }
  std::printf("%lld frames steadied, at least %.0f %% of each side kept\n",
              static_cast<long long>(found->num_frames), 100.0 * found->smallest_kept_ratio);
  std::filesystem::remove(analysis);
  return 0;
}
