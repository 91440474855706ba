// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/simulate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <memory>
#include <numbers>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <sstream>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "cli/commands/simulate_rs_real.h"
#include "cli/media/video_writer.h"
#include "igf/base/parallel_for.h"
#include "igf/base/seeded_random.h"
#include "igf/base/whole_file.h"
#include "igf/camera_profile_reader.h"
#include "igf/csv_parser.h"
#include "igf/gyro_integrator.h"
#include "igf/gyro_log_reader.h"
#include "igf/gyro_simulator.h"
#include "igf/scene_painter.h"

namespace rsstab::cli {
namespace {

constexpr double kUsualDurationS = 10.0;
constexpr double kReadoutOfGyroLogS = 0.020;
// The written log begins this long before the clip and ends this long after it, and the motion
// reaches a little farther still.
constexpr double kGyroMarginS = 0.25;
constexpr double kMotionMarginS = 0.3;
constexpr int kBlurSamples = 16;

// A picture file as packed RGB.
Result<igf::RgbPicture> LoadPicture(const std::string& path) {
  constexpr std::uint64_t kMaxBytes = 1ULL << 30U;
  const Result<std::string> bytes = ReadWholeFile(path, kMaxBytes);
  if (!bytes) {
    return Propagate(bytes.error());
  }
  cv::Mat image;
  try {
    const std::vector<std::uint8_t> encoded(bytes->begin(), bytes->end());
    image = cv::imdecode(encoded, cv::IMREAD_COLOR);
    if (!image.empty()) {
      cv::cvtColor(image, image, cv::COLOR_BGR2RGB);
    }
  } catch (const cv::Exception& error) {
    return Fail(ErrorCode::kCorruptData, "{}: {}", path, error.err);
  }
  if (image.empty()) {
    return Fail(ErrorCode::kCorruptData,
                "{}: this is no picture that can be read; give a PNG, JPEG or TIFF file.", path);
  }
  igf::RgbPicture picture;
  picture.width = image.cols;
  picture.height = image.rows;
  picture.pixels.assign(image.datastart, image.dataend);
  return picture;
}

Result<igf::TextureScene> MakeScene(const SimulateOptions& options, double focal_px) {
  // What the resting camera sees, in wall distances.
  const double view_width = options.width / focal_px;
  const double view_height = options.height / focal_px;
  if (options.image.empty()) {
    // As many pixels as the scene has texels; half a view of room for the motion above and below.
    const double unit = 1.25 * focal_px;
    const int width = std::clamp(
        2 * static_cast<int>(std::lround(igf::kPaintedWidthTan * unit / 2.0)), 256, 32768);
    const int height = std::clamp(
        static_cast<int>(std::lround(width / igf::kPaintedWidthTan * (1.3 * view_height + 0.4))),
        64, width / 2);
    const auto picture = igf::PaintStreet(width, height, static_cast<std::uint64_t>(options.seed));
    if (!picture) {
      return Propagate(picture.error());
    }
    return igf::TextureScene::FromPicture(*picture, igf::kPaintedWidthTan, focal_px);
  }
  const auto picture = LoadPicture(options.image);
  if (!picture) {
    return Propagate(picture.error());
  }
  // The picture fills the view with some room for the motion; its mirror images follow.
  constexpr double kRoom = 1.15;
  const double aspect = static_cast<double>(picture->width) / picture->height;
  const double width_tan = std::min(8.0, kRoom * std::max(view_width, view_height * aspect));
  auto scene = igf::TextureScene::FromPicture(*picture, width_tan, focal_px);
  if (!scene) {
    return Propagate(scene.error(), options.image);
  }
  return scene;
}

struct Motion {
  igf::OrientationTrack orientation;
  double duration_s = 0.0;
};

// The motion of a gyro log; the clip's time 0 is a margin after the log's first sample.
Result<Motion> MotionFromGyroLog(const SimulateOptions& options, const Logger& logger) {
  const auto recording = igf::ReadGyroLog(options.motion_gyro);
  if (!recording) {
    return Propagate(recording.error());
  }
  for (const std::string& note : recording->notes) {
    logger->warn("simulate: {}: {}", options.motion_gyro, note);
  }
  auto track = igf::IntegrateGyro(recording->gyro);
  if (!track) {
    return Propagate(track.error(), options.motion_gyro);
  }
  const double available_s = track->end_s() - track->start_s() - 2.0 * kMotionMarginS;
  const double duration_s = options.duration_s.value_or(std::min(kUsualDurationS, available_s));
  if (!(available_s > 0.0 && duration_s <= available_s)) {
    return Fail(
        ErrorCode::kInvalidArgument,
        "{}: a log of {:.2f} s is enough for a clip of {:.2f} s; ask for a shorter one with "
        "--duration.",
        options.motion_gyro, track->end_s() - track->start_s(), std::max(0.0, available_s));
  }
  Motion motion{track->WithOffset(-kMotionMarginS - track->start_s()), duration_s};
  if (!motion.orientation.Covers(0.0, duration_s)) {
    return Fail(ErrorCode::kInvalidArgument,
                "{}: there is a gap in the first {:.2f} s of the log, so the motion is not known; "
                "ask for a shorter clip with --duration.",
                options.motion_gyro, duration_s);
  }
  return motion;
}

Result<Motion> MakeMotion(const SimulateOptions& options, const Logger& logger) {
  if (!options.motion_gyro.empty()) {
    return MotionFromGyroLog(options, logger);
  }
  const double duration_s = options.duration_s.value_or(kUsualDurationS);
  auto track = igf::MakePresetOrientation(options.motion, static_cast<std::uint64_t>(options.seed),
                                          duration_s);
  if (!track) {
    return Propagate(track.error());
  }
  return Motion{*std::move(track), duration_s};
}

igf::GyroSimulatorOptions GyroOptionsFrom(const SimulateOptions& options) {
  igf::GyroSimulatorOptions gyro;
  gyro.sampling_hz = options.gyro_rate_hz;
  gyro.averaging_s = std::min(gyro.averaging_s, 1.0 / options.gyro_rate_hz);
  gyro.offset_s = options.gyro_offset_s;
  gyro.noise_rad_s = options.gyro_noise_rad_s;
  gyro.noise_seed = static_cast<std::uint64_t>(options.seed);
  if (options.gyro_bias_rad_s > 0.0) {
    constexpr std::uint64_t kBiasStream = 99;
    SeededRandom random(gyro.noise_seed, kBiasStream);
    const Eigen::Vector3d direction(random.Normal(), random.Normal(), random.Normal());
    gyro.bias_rad_s = options.gyro_bias_rad_s * direction.normalized();
  }
  return gyro;
}

igf::RsSimulatorOptions SimulatorOptionsFrom(const SimulateOptions& options, double focal_px,
                                             double readout_s, double duration_s) {
  igf::RsSimulatorOptions result;
  result.readout_s = readout_s;
  result.exposure_s = options.exposure_s;
  result.exposure_samples = options.exposure_s > 0.0 ? kBlurSamples : 1;
  result.noise_sigma = options.image_noise.value_or(0.0);
  result.noise_seed = static_cast<std::uint64_t>(options.seed);
  if (options.foreground) {
    // Crosses the view once, and the place straight ahead at half time.
    igf::ForegroundObject object;
    object.rate_rad_s = 2.0 * std::atan(options.width / 2.0 / focal_px) / duration_s;
    object.azimuth_rad = -object.rate_rad_s * duration_s / 2.0;
    object.seed = static_cast<std::uint64_t>(options.seed);
    result.foreground = object;
  }
  return result;
}

// 4:2:0, which plays everywhere; encoders want even sizes for it, so odd ones keep all chroma.
PixelLayout LayoutOf(const Camera& camera) {
  PixelLayout layout = Yuv420Layout();
  if (camera.width % 2 != 0 || camera.height % 2 != 0) {
    layout.chroma_shift_x = 0;
    layout.chroma_shift_y = 0;
    layout.chroma_offset_y = 0.0;
  }
  return layout;
}

// The writer of one of the two clips.
Result<std::unique_ptr<media::VideoWriter>> CreateClip(const std::string& path,
                                                       const Simulation& simulation,
                                                       const PixelLayout& layout,
                                                       const SimulateOptions& options,
                                                       const Logger& logger) {
  media::VideoDescription description;
  description.width = simulation.truth.camera.width;
  description.height = simulation.truth.camera.height;
  description.layout = layout;
  description.frame_rate = simulation.frame_rate;
  description.color = {"tv", "bt709", "bt709", "bt709", "left"};
  media::WriterOptions writer;
  writer.crf = options.crf;
  writer.preset = "veryfast";  // size does not matter, quality is set by crf
  writer.num_threads = options.threads;
  writer.overwrite = options.overwrite;
  writer.logger = logger;
  return media::VideoWriter::Create(path, description, writer);
}

Status WriteClips(const Simulation& simulation, const SimulateOptions& options,
                  const std::string& rs_path, const std::string& gs_path, const Logger& logger,
                  const SimulateProgress& progress) {
  const PixelLayout layout = LayoutOf(simulation.truth.camera);
  auto rs_clip = CreateClip(rs_path, simulation, layout, options, logger);
  if (!rs_clip) {
    return Propagate(rs_clip.error());
  }
  auto gs_clip = CreateClip(gs_path, simulation, layout, options, logger);
  if (!gs_clip) {
    return Propagate(gs_clip.error());
  }
  WorkerPool pool(ResolveThreadCount(options.threads));
  const auto frames = static_cast<std::int64_t>(simulation.truth.frame_times_s.size());
  for (std::int64_t n = 0; n < frames; ++n) {
    const double time_s = simulation.truth.frame_times_s[static_cast<std::size_t>(n)];
    const Result<Frame> rs = simulation.simulator.RenderRs(time_s, layout, pool, n);
    const Result<Frame> gs = simulation.simulator.RenderGs(time_s, layout, pool, n);
    if (!rs || !gs) {
      return Propagate(rs ? gs.error() : rs.error(), "Frame " + std::to_string(n));
    }
    if (Status status = (*rs_clip)->Write(*rs); !status) {
      return status;
    }
    if (Status status = (*gs_clip)->Write(*gs); !status) {
      return status;
    }
    if (progress && !progress(n + 1, frames)) {
      return Fail(ErrorCode::kCancelled, "Stopped; nothing was written.");
    }
  }
  if (Status status = (*rs_clip)->Finish(); !status) {
    return status;
  }
  return (*gs_clip)->Finish();
}

}  // namespace

media::Rational FrameRateFromNumber(double fps) {
  const double ntsc = fps * 1.001;
  constexpr double kAsPeopleWriteIt = 0.006;  // 29.97 and 23.98 stand for 29.97003 and 23.97602
  const bool is_whole = std::abs(fps - std::round(fps)) < 1e-9;
  if (!is_whole && std::abs(ntsc - std::round(ntsc)) < kAsPeopleWriteIt) {
    return {static_cast<int>(std::lround(ntsc)) * 1000, 1001};
  }
  return is_whole ? media::Rational{static_cast<int>(std::lround(fps)), 1}
                  : media::Rational{static_cast<int>(std::lround(fps * 1000.0)), 1000};
}

Result<Simulation> PrepareSimulation(const SimulateOptions& options, const Logger& logger) {
  if (Status status = pipeline::ValidateOptions(SimulateOptionTable(), options); !status) {
    return Propagate(status.error());
  }
  auto motion = MakeMotion(options, logger);
  if (!motion) {
    return Propagate(motion.error());
  }
  const double focal_px = options.focal_px.value_or(
      options.width / 2.0 / std::tan(options.fov_deg / 2.0 * std::numbers::pi / 180.0));
  Camera camera = Camera::Pinhole(options.width, options.height, focal_px);
  const double usual_readout_s =
      options.motion_gyro.empty() ? igf::UsualReadout(options.motion) : kReadoutOfGyroLogS;
  camera.readout_s = options.readout_s.value_or(usual_readout_s);

  auto scene = MakeScene(options, focal_px);
  if (!scene) {
    return Propagate(scene.error());
  }
  auto simulator = igf::RsSimulator::Create(
      std::make_shared<const igf::TextureScene>(*std::move(scene)), camera, motion->orientation,
      SimulatorOptionsFrom(options, focal_px, *camera.readout_s, motion->duration_s));
  if (!simulator) {
    return Propagate(simulator.error());
  }
  auto gyro = igf::SimulateGyro(motion->orientation, -kGyroMarginS,
                                motion->duration_s + kGyroMarginS, GyroOptionsFrom(options));
  if (!gyro) {
    return Propagate(gyro.error());
  }
  const media::Rational rate = FrameRateFromNumber(options.fps);
  igf::SimulationTruth truth{
      camera, options.exposure_s, options.gyro_offset_s, {}, motion->orientation};
  const auto frames =
      std::max<std::int64_t>(1, std::llround(std::floor(motion->duration_s * rate.Value() + 1e-6)));
  for (std::int64_t n = 0; n < frames; ++n) {
    truth.frame_times_s.push_back(static_cast<double>(n) * rate.den / rate.num);
  }
  return Simulation{*std::move(simulator), *std::move(gyro), std::move(truth), rate};
}

Status RunSimulate(const SimulateOptions& options, const Logger& logger,
                   const SimulateProgress& progress) {
  if (options.rs_real) {
    return RunSimulateRsReal(options, logger, progress);
  }
  const std::filesystem::path folder =
      options.output.empty() ? std::filesystem::path(".") : std::filesystem::path(options.output);
  const auto path_of = [&](const char* name) { return (folder / name).string(); };
  if (!options.overwrite) {
    for (const char* name : {"rs.mp4", "gs.mp4", "gyro.csv", "camera.json", "truth.json"}) {
      std::error_code ignored;
      if (std::filesystem::exists(folder / name, ignored)) {
        return Fail(ErrorCode::kInvalidArgument,
                    "{} exists; choose another folder or give --overwrite.", path_of(name));
      }
    }
  }
  const Result<Simulation> simulation = PrepareSimulation(options, logger);
  if (!simulation) {
    return Propagate(simulation.error());
  }
  const Result<std::string> truth = igf::FormatSimulationTruth(simulation->truth);
  if (!truth) {
    return Propagate(truth.error());
  }
  std::error_code error;
  const bool folder_is_new = std::filesystem::create_directories(folder, error);
  if (error) {
    return Fail(ErrorCode::kIo, "{}: the folder cannot be made: {}.", folder.string(),
                error.message());
  }
  logger->info("simulate: {} frames of {} x {} at {:.3f} frames/s, readout {:.1f} ms, into {}",
               simulation->truth.frame_times_s.size(), options.width, options.height,
               simulation->frame_rate.Value(), 1e3 * *simulation->truth.camera.readout_s,
               folder.string());
  if (Status status =
          WriteClips(*simulation, options, path_of("rs.mp4"), path_of("gs.mp4"), logger, progress);
      !status) {
    if (folder_is_new) {
      std::filesystem::remove(folder, error);  // only if it is empty
    }
    return status;
  }
  std::ostringstream gyro;
  igf::WriteGyroCsv(simulation->gyro, gyro);
  const std::array<std::pair<const char*, std::string>, 3> texts = {
      {{"gyro.csv", gyro.str()},
       {"camera.json", igf::FormatCameraJson(simulation->truth.camera)},
       {"truth.json", *truth}}};
  for (const auto& [name, text] : texts) {
    if (Status status = WriteWholeFile(path_of(name), text); !status) {
      return status;
    }
  }
  return {};
}

}  // namespace rsstab::cli
