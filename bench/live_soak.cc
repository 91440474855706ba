// SPDX-License-Identifier: Apache-2.0
// Many frames through live mode of the C interface: speed, and whether memory stays constant.
//
//   live_soak [FRAMES [WIDTH HEIGHT [LOOKAHEAD [THREADS]]]]      20000 640 360 30 0 by default
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <string>
#include <vector>

#include "plugin/capi/rsstab.h"

namespace {

// Largest shift of the picture, px.
constexpr int kReach = 32;

double ResidentMiB() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with("VmRSS:")) {
      return std::atof(line.c_str() + 6) / 1024.0;
    }
  }
  return 0.0;
}

// A picture larger than the frames, over which the frames wander.
std::vector<unsigned char> PaintScene(int width, int height) {
  std::vector<unsigned char> scene(static_cast<std::size_t>(width) *
                                   static_cast<std::size_t>(height));
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const double wave = std::sin(0.31 * x) * std::sin(0.23 * y) + std::sin(0.05 * x + 0.03 * y) +
                          std::sin(0.013 * x * std::sin(0.004 * y)) + std::cos(0.19 * x - 0.11 * y);
      scene[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
            static_cast<std::size_t>(x)] = static_cast<unsigned char>(128.0 + 28.0 * wave);
    }
  }
  return scene;
}

}  // namespace

int main(int argc, char** argv) {
  const auto argument = [&](int i, int otherwise) {
    return argc > i ? std::atoi(argv[i]) : otherwise;
  };
  const int frames = argument(1, 20000);
  const int width = argument(2, 640);
  const int height = argument(3, 360);
  const int lookahead = argument(4, 30);
  const int threads = argument(5, 0);

  rsstab_video video = RSSTAB_VIDEO_INIT;
  video.width = width;
  video.height = height;
  video.format = RSSTAB_PIXEL_NV12;
  video.time_base_num = 1;
  video.time_base_den = 30;
  rsstab_options* options = rsstab_options_create();
  rsstab_options_set(options, "lookahead", std::to_string(lookahead).c_str());
  rsstab_options_set(options, "threads", std::to_string(threads).c_str());
  rsstab_instance* instance = nullptr;
  if (rsstab_create_live(options, &video, &instance) != RSSTAB_OK) {
    std::fprintf(stderr, "%s\n", rsstab_options_error(options));
    return 1;
  }
  rsstab_options_destroy(options);

  const int scene_width = width + 2 * kReach;
  const std::vector<unsigned char> scene = PaintScene(scene_width, height + 2 * kReach);
  const std::vector<unsigned char> chroma(scene.size(), 128);
  std::vector<unsigned char> output(scene.size() * 2);
  const rsstab_buffer buffer = {{output.data(), output.data() + scene.size(), nullptr, nullptr},
                                {width, width + 1, 0, 0}};
  long pulled = 0;
  const auto pull = [&] {
    rsstab_status status = RSSTAB_OK;
    while (status == RSSTAB_OK) {
      status = rsstab_pull(instance, &buffer, nullptr, nullptr);
      pulled += status == RSSTAB_OK ? 1 : 0;
    }
    return status == RSSTAB_AGAIN || status == RSSTAB_END;
  };
  const auto begin = std::chrono::steady_clock::now();
  const std::clock_t cpu_begin = std::clock();
  double early_mib = 0.0;
  bool ok = true;
  for (int i = 0; ok && i < frames; ++i) {
    const int x = kReach + static_cast<int>(
                               std::lround(12.0 * std::sin(0.9 * i) + 18.0 * std::sin(0.013 * i)));
    const int y = kReach + static_cast<int>(std::lround(9.0 * std::cos(1.3 * i)));
    const rsstab_picture picture = {
        {scene.data() + y * scene_width + x, chroma.data(), nullptr, nullptr},
        {scene_width, width + 1, 0, 0}};
    ok = rsstab_push(instance, &picture, i, nullptr, nullptr) == RSSTAB_OK && pull();
    if (i + 1 == std::min(frames, 1000)) {
      early_mib = ResidentMiB();
    }
    if ((i + 1) % 2000 == 0) {
      std::printf("%6d frames: %.1f MiB resident\n", i + 1, ResidentMiB());
      std::fflush(stdout);
    }
  }
  ok = ok && rsstab_flush(instance) == RSSTAB_OK && pull();
  const double wall_s =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  const double cpu_s = static_cast<double>(std::clock() - cpu_begin) / CLOCKS_PER_SEC;
  if (!ok || pulled != frames) {
    std::fprintf(stderr, "failed after %ld frames: %s\n", pulled, rsstab_error(instance));
    return 1;
  }
  std::printf(
      "%ld frames of %dx%d, look-ahead %d: %.1f ms a frame (%.1f ms of processor), %.1f MiB "
      "resident, %+.1f MiB since frame 1000\n",
      pulled, width, height, lookahead, 1e3 * wall_s / frames, 1e3 * cpu_s / frames, ResidentMiB(),
      ResidentMiB() - early_mib);
  rsstab_destroy(instance);
  return 0;
}
