// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/simulate_rs_real.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cstring>
#include <exception>
#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "cli/datasets/rs_real_writer.h"
#include "evaluation/hand_motion.h"
#include "evaluation/photo.h"
#include "igf/base/parallel_for.h"
#include "igf/base/seeded_random.h"
#include "igf/scene_painter.h"

namespace rsstab::cli {
namespace {

namespace fs = std::filesystem;

using datasets::RsRealClip;
using evaluation::kMotionStrengths;

// Phones: 45 to 71 degrees across, 15 to 30 ms of readout.
constexpr double kLeastFocalWidths = 0.7;
constexpr double kMostFocalWidths = 1.2;
constexpr double kLeastReadoutS = 0.015;
constexpr double kMostReadoutS = 0.030;
constexpr double kUsualNoise = 2.0;  // 8-bit levels

struct Size {
  int width = 0;
  int height = 0;
};

Result<Size> ParseSize(const std::string& text) {
  const std::size_t cross = text.find('x');
  const auto side = [](const std::string& digits) {
    return static_cast<int>(
        std::clamp<std::int64_t>(pipeline::ParseInteger(digits).value_or(0), 0, 65536));
  };
  const Size size = {side(text.substr(0, cross)),
                     cross == std::string::npos ? 0 : side(text.substr(cross + 1))};
  if (std::min(size.width, size.height) < 16 || std::max(size.width, size.height) > 8192) {
    return pipeline::BadOption("size", text, "WIDTHxHEIGHT, each from 16 to 8192");
  }
  return size;
}

// The middle of a painted street, at eye level.
Result<Frame> PaintPhoto(std::uint64_t seed) {
  constexpr int kPainted = 3600;  // over 180 degrees
  constexpr int kShown = 1280;
  constexpr int kHeight = 960;
  const auto street = igf::PaintStreet(kPainted, kHeight, seed);
  if (!street) {
    return Propagate(street.error());
  }
  auto photo = AllocateFrame(evaluation::RgbLayout(), kShown, kHeight);
  for (int y = 0; photo && y < kHeight; ++y) {
    const auto at = static_cast<std::size_t>(3 * (y * kPainted + (kPainted - kShown) / 2));
    std::memcpy(photo->planes[0].data + y * photo->planes[0].stride, street->pixels.data() + at,
                3 * static_cast<std::size_t>(kShown));
  }
  return photo;
}

// Everything about a clip that does not depend on its photograph.
RsRealClip MakeClip(const SimulateOptions& options, Size size, int index) {
  RsRealClip clip;
  const bool is_sequence = options.frames > 1;
  clip.frames = options.frames;
  clip.name = fmt::format("{}{:04}", is_sequence ? "seq_" : "", index + 1);
  const auto of_train = [&](int clips) { return static_cast<int>(clips * options.train_share); };
  clip.split = of_train(index + 1) > of_train(index) ? "train" : "test";
  clip.strength = &kMotionStrengths[static_cast<std::size_t>(index) % kMotionStrengths.size()];
  clip.seed = MixBits(static_cast<std::uint64_t>(options.seed) ^
                      MixBits(static_cast<std::uint64_t>(index)));
  SeededRandom random(clip.seed, 2);
  const double focal_px = random.Uniform(kLeastFocalWidths, kMostFocalWidths) * size.width;
  const double readout_s = random.Uniform(kLeastReadoutS, kMostReadoutS);
  clip.camera = Camera::Pinhole(size.width, size.height, options.focal_px.value_or(focal_px));
  clip.camera.readout_s = options.readout_s.value_or(readout_s);
  clip.frame_interval_s = 1.0 / options.fps;
  clip.image_noise = options.image_noise.value_or(kUsualNoise);
  clip.gyro_rate_hz = options.gyro_rate_hz;
  clip.gyro_noise_rad_s = options.gyro_noise_rad_s;
  clip.gyro_bias_rad_s = options.gyro_bias_rad_s;
  return clip;
}

Status CheckFolder(const SimulateOptions& options) {
  for (const char* split : {"train", "test"}) {
    std::error_code ignored;
    if (!options.overwrite && fs::exists(fs::path(options.output) / split, ignored)) {
      return Fail(ErrorCode::kInvalidArgument,
                  "{} exists; choose another folder or give --overwrite.",
                  (fs::path(options.output) / split).string());
    }
  }
  return {};
}

// The photographs that can be read, found once, so that which one a clip gets depends on no thread.
Result<std::vector<fs::path>> UsablePhotos(const SimulateOptions& options, int wanted,
                                           const Logger& logger) {
  auto photos = evaluation::ListPhotos(options.photos);
  if (!photos) {
    return photos;
  }
  std::vector<fs::path> usable;
  for (const fs::path& path : *photos) {
    if (static_cast<int>(usable.size()) == wanted) {
      break;
    }
    if (const auto photo = evaluation::LoadPhoto(path); photo) {
      usable.push_back(path);
    } else {
      logger->warn("simulate: {}", photo.error().message);
    }
  }
  if (usable.empty()) {
    return Fail(ErrorCode::kCorruptData, "{}: no photograph in it can be read.", options.photos);
  }
  return usable;
}

Status WriteClip(const SimulateOptions& options, Size size, int index,
                 const std::vector<fs::path>& photos) {
  RsRealClip clip = MakeClip(options, size, index);
  const auto scene = static_cast<std::size_t>(index) / kMotionStrengths.size();
  if (photos.empty()) {
    clip.source = fmt::format("street {}", scene);
    const auto photo = PaintPhoto(MixBits(static_cast<std::uint64_t>(options.seed) + scene));
    return photo ? WriteRsRealClip(options.output, photo->View(), clip) : Propagate(photo.error());
  }
  const fs::path& path = photos[scene % photos.size()];
  clip.source = path.filename().string();
  const auto photo = evaluation::LoadPhoto(path);
  return photo ? WriteRsRealClip(options.output, photo->View(), clip) : Propagate(photo.error());
}

}  // namespace

Status RunSimulateRsReal(const SimulateOptions& options, const Logger& logger,
                         const SimulateProgress& progress) {
  const auto size = ParseSize(options.size);
  if (!size) {
    return Propagate(size.error());
  }
  if (options.readout_s && !(*options.readout_s > 0.0)) {
    return Fail(ErrorCode::kInvalidArgument,
                "--readout: in RS-Real the first row is exposed first; give a positive time.");
  }
  if (Status status = CheckFolder(options); !status) {
    return status;
  }
  const int clips = (options.samples + options.frames - 1) / options.frames;
  std::vector<fs::path> photos;
  if (!options.photos.empty()) {
    const int wanted = (clips + 2) / static_cast<int>(kMotionStrengths.size());
    auto usable = UsablePhotos(options, std::max(wanted, 1), logger);
    if (!usable) {
      return Propagate(usable.error());
    }
    photos = std::move(*usable);
  }
  std::mutex mutex;  // guards `failure`, `done` and calls to `progress`
  std::optional<Error> failure;
  std::int64_t done = 0;
  WorkerPool pool(ResolveThreadCount(options.threads));
  pool.ForBlocks(clips, 1, [&](int index, int) {
    {
      const std::scoped_lock lock(mutex);
      if (failure) {
        return;
      }
    }
    Status status;
    try {
      status = WriteClip(options, *size, index, photos);
    } catch (const std::exception& error) {
      status = Fail(ErrorCode::kInternal, "{}", error.what());
    }
    const std::scoped_lock lock(mutex);
    ++done;
    if (!status && !failure) {
      failure = status.error();
    }
    if (progress && !progress(done * options.frames, std::int64_t{clips} * options.frames) &&
        !failure) {
      failure = Error{ErrorCode::kCancelled, "Stopped; some of the samples are written."};
    }
  });
  if (failure) {
    return Propagate(*failure);
  }
  const int train = static_cast<int>(clips * options.train_share) * options.frames;
  logger->info(
      "simulate: {} pictures of {} x {} ({} of train, {} of test) with truth, motion field, "
      "camera and gyro log, in {}",
      clips * options.frames, size->width, size->height, train, clips * options.frames - train,
      options.output);
  return {};
}

}  // namespace rsstab::cli
