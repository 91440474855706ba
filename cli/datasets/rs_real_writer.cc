// SPDX-License-Identifier: Apache-2.0
#include "cli/datasets/rs_real_writer.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <sstream>
#include <system_error>
#include <utility>
#include <vector>

#include "cli/images/npz_file.h"
#include "cli/images/picture_file.h"
#include "evaluation/photo.h"
#include "evaluation/photo_scene.h"
#include "evaluation/synthetic_sample.h"
#include "igf/base/readout_motion.h"
#include "igf/base/rolling_shutter.h"
#include "igf/base/seeded_random.h"
#include "igf/base/whole_file.h"
#include "igf/camera_profile_reader.h"
#include "igf/csv_parser.h"
#include "igf/gyro_simulator.h"
#include "igf/intra_gyro_field.h"

namespace rsstab::datasets {
namespace {

namespace fs = std::filesystem;

using evaluation::PhotoScene;
using evaluation::RowOrientation;

// The log begins this long before the frame's first row and ends this long after its last one.
constexpr double kGyroMarginS = 0.05;
constexpr int kJpegQuality = 95;

// RS and GS of every frame: which way the camera looks at each row, told from the instant of the
// middle frame's middle row.
std::vector<RowOrientation> Exposures(const RsRealClip& clip, const igf::OrientationTrack& track) {
  std::vector<RowOrientation> exposures;
  const double middle_s = clip.frames / 2 * clip.frame_interval_s;
  const Eigen::Quaterniond world_from_scene = track.CameraFromWorld(middle_s)->conjugate();
  for (int frame = 0; frame < clip.frames; ++frame) {
    const auto at = [frame, &clip, &track, world_from_scene](double row) {
      const double time_s = RowExposureTime(frame * clip.frame_interval_s, row, clip.camera.height,
                                            *clip.camera.readout_s);
      return Eigen::Quaterniond(*track.CameraFromWorld(time_s) * world_from_scene);
    };
    exposures.emplace_back([at](int row) { return at(row); });
    exposures.emplace_back([at](int) { return at(0.0); });
  }
  return exposures;
}

std::vector<std::uint8_t> PackedBytes(const Frame& picture) {
  std::vector<std::uint8_t> bytes;
  const auto row_bytes = 3 * static_cast<std::size_t>(picture.width);
  bytes.reserve(row_bytes * static_cast<std::size_t>(picture.height));
  for (int y = 0; y < picture.height; ++y) {
    const std::uint8_t* row = picture.planes[0].data + y * picture.planes[0].stride;
    bytes.insert(bytes.end(), row, row + row_bytes);
  }
  return bytes;
}

// The exact label of every pixel.
Result<std::vector<Eigen::Vector2f>> Labels(const Camera& camera,
                                            const igf::OrientationTrack& track) {
  const auto motion = igf::ComputeReadoutMotion(camera, track, 0.0, *camera.readout_s, 0.0);
  if (!motion) {
    return Propagate(motion.error());
  }
  std::vector<Eigen::Vector2f> labels;
  labels.reserve(static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height));
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      const Eigen::Vector2d pixel(x, y);
      labels.emplace_back((motion->RsFromGs(pixel).value_or(pixel) - pixel).cast<float>());
    }
  }
  return labels;
}

void BlackenWithoutSource(const std::vector<std::uint8_t>& valid, Frame& gs) {
  std::size_t i = 0;
  for (int y = 0; y < gs.height; ++y) {
    std::uint8_t* row = gs.planes[0].data + y * gs.planes[0].stride;
    for (int x = 0; x < gs.width; ++x, ++i) {
      if (valid[i] == 0) {
        std::fill(row + 3 * x, row + 3 * x + 3, std::uint8_t{0});
      }
    }
  }
}

Status WriteArrays(const fs::path& path, const Frame& rs, const Frame& gs,
                   const std::vector<Eigen::Vector2f>& labels) {
  const auto width = static_cast<std::size_t>(rs.width);
  const auto height = static_cast<std::size_t>(rs.height);
  const std::size_t pixels = width * height;
  std::vector<float> flow(2 * pixels);
  for (std::size_t i = 0; i < pixels; ++i) {
    flow[i] = labels[i].x();
    flow[pixels + i] = labels[i].y();
  }
  const std::vector<std::uint8_t> condition = PackedBytes(rs);
  const std::vector<std::uint8_t> corrected = PackedBytes(gs);
  return images::WriteNpz(
      path.string(), std::vector<images::NpzArray>{{"condition", {height, width, 3}, condition},
                                                   {"gs", {height, width, 3}, corrected},
                                                   {"out_flow", {2, height, width}, flow}});
}

Status WriteBeside(const fs::path& path, const Frame& rs, const Frame& gs) {
  auto both = AllocateFrame(evaluation::RgbLayout(), 2 * rs.width, rs.height);
  if (!both) {
    return Propagate(both.error());
  }
  const auto half = 3 * static_cast<std::size_t>(rs.width);
  for (int y = 0; y < rs.height; ++y) {
    std::uint8_t* row = both->planes[0].data + y * both->planes[0].stride;
    std::memcpy(row, rs.planes[0].data + y * rs.planes[0].stride, half);
    std::memcpy(row + half, gs.planes[0].data + y * gs.planes[0].stride, half);
  }
  const auto encoded = images::EncodePicture(path.string(), both->View(), kJpegQuality);
  if (!encoded) {
    return Propagate(encoded.error());
  }
  return WriteWholeFile(path.string(), std::string(encoded->bytes.begin(), encoded->bytes.end()));
}

// `track`: time 0 is the frame's middle row.
Status WriteSideFiles(const fs::path& npz, const RsRealClip& clip, const std::string& preset,
                      const igf::OrientationTrack& track, std::uint64_t frame_seed) {
  nlohmann::ordered_json json;
  json["camera"] = nlohmann::ordered_json::parse(igf::FormatCameraJson(clip.camera));
  if (clip.frames > 1) {
    json["frame_interval_s"] = clip.frame_interval_s;
  }
  json["strength"] = clip.strength->name;
  json["source"] = clip.source;
  json["motion"] = preset;
  if (Status status =
          WriteWholeFile(fs::path(npz).replace_extension(".json").string(),
                         json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
      !status) {
    return status;
  }
  igf::GyroSimulatorOptions gyro;
  gyro.sampling_hz = clip.gyro_rate_hz;
  gyro.averaging_s = std::min(gyro.averaging_s, 1.0 / clip.gyro_rate_hz);
  gyro.noise_rad_s = clip.gyro_noise_rad_s;
  gyro.noise_seed = frame_seed;
  SeededRandom random(clip.seed, 1);  // one bias for the whole clip
  gyro.bias_rad_s = clip.gyro_bias_rad_s *
                    Eigen::Vector3d(random.Normal(), random.Normal(), random.Normal()).normalized();
  const double reach_s = std::abs(*clip.camera.readout_s) / 2.0 + kGyroMarginS;
  const auto log = igf::SimulateGyro(track, -reach_s, reach_s, gyro);
  if (!log) {
    return Propagate(log.error());
  }
  std::ostringstream text;
  igf::WriteGyroCsv(*log, text);
  return WriteWholeFile(fs::path(npz).replace_extension(".gyro.csv").string(), text.str());
}

}  // namespace

Status WriteRsRealClip(const fs::path& folder, const FrameView& photo, const RsRealClip& clip) {
  const auto motion =
      evaluation::MakeHandMotion(*clip.strength, clip.camera, clip.frames, clip.frame_interval_s,
                                 2.0 * kGyroMarginS, clip.seed);
  if (!motion) {
    return Propagate(motion.error(), clip.source);
  }
  const std::vector<RowOrientation> exposures = Exposures(clip, motion->track);
  const auto scene = PhotoScene::Create(photo, clip.camera, exposures);
  if (!scene) {
    return Propagate(scene.error(), clip.source);
  }
  const bool is_sequence = clip.frames > 1;
  const fs::path place = is_sequence ? fs::path(clip.name) : fs::path();
  std::error_code error;
  for (const char* form : {"npz", "jpg"}) {
    fs::create_directories(folder / clip.split / form / place, error);
    if (error) {
      return Fail(ErrorCode::kIo, "{}: the folder cannot be made: {}.", folder.string(),
                  error.message());
    }
    if (clip.split != "test") {
      break;
    }
  }
  for (int frame = 0; frame < clip.frames; ++frame) {
    const std::string name = is_sequence ? fmt::format("{:04}", frame + 1) : clip.name;
    const fs::path npz = folder / clip.split / "npz" / place / (name + ".npz");
    const std::uint64_t seed = MixBits(clip.seed ^ MixBits(static_cast<std::uint64_t>(frame)));
    const igf::OrientationTrack track = motion->track.WithOffset(-frame * clip.frame_interval_s);
    const auto index = 2 * static_cast<std::size_t>(frame);
    const auto rs = scene->Record(exposures[index], {clip.image_noise, seed});
    auto gs = scene->Record(exposures[index + 1], {0.0, 0});
    const auto labels = Labels(clip.camera, track);
    if (!rs || !gs || !labels) {
      return Propagate(!rs ? rs.error() : !gs ? gs.error() : labels.error(), clip.source);
    }
    BlackenWithoutSource(evaluation::SourcesInside(*labels, clip.camera.width, clip.camera.height),
                         *gs);
    Status status = WriteArrays(npz, *rs, *gs, *labels);
    if (status && clip.split == "test") {
      status = WriteBeside(folder / clip.split / "jpg" / place / (name + ".jpg"), *rs, *gs);
    }
    if (status) {
      status = WriteSideFiles(npz, clip, motion->preset, track, seed);
    }
    if (!status) {
      return status;
    }
  }
  return {};
}

}  // namespace rsstab::datasets
