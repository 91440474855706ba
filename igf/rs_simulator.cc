// SPDX-License-Identifier: Apache-2.0
#include "igf/rs_simulator.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <utility>

#include "igf/base/rolling_shutter.h"
#include "igf/base/rotation.h"
#include "igf/base/seeded_random.h"

namespace rsstab::igf {
namespace {

constexpr int kRowsPerBlock = 8;

// How a sample of unit scale becomes an integer of the layout (BT.709 / BT.2100 quantisation).
struct Quantisation {
  float scale = 0.0F;
  float offset = 0.0F;
  float largest = 0.0F;
};

Quantisation QuantisationOf(const PixelLayout& layout, bool is_chroma) {
  const auto step = static_cast<float>(1 << (layout.bit_depth - 8));
  const auto largest = static_cast<float>((1 << layout.bit_depth) - 1);
  const float middle = 128.0F * step;
  if (layout.full_range) {
    return {largest, is_chroma ? middle : 0.0F, largest};
  }
  return is_chroma ? Quantisation{224.0F * step, middle, largest}
                   : Quantisation{219.0F * step, 16.0F * step, largest};
}

// Nearly Gaussian noise of unit variance: the sum of four 16-bit uniforms.
float NoiseAt(std::uint64_t stream, std::uint64_t position) {
  const std::uint64_t bits = MixBits(stream ^ MixBits(position));
  const auto sum = static_cast<float>((bits & 0xffff) + ((bits >> 16) & 0xffff) +
                                      ((bits >> 32) & 0xffff) + (bits >> 48));
  constexpr float kMean = 4.0F * 32767.5F;
  constexpr float kDeviation = 37837.2F;  // 65536 sqrt(4 / 12)
  return (sum - kMean) / kDeviation;
}

template <typename Sample>
void StoreRow(std::span<const float> values, const Quantisation& q, std::uint8_t* row) {
  auto* out = reinterpret_cast<Sample*>(row);
  for (std::size_t x = 0; x < values.size(); ++x) {
    const float level = values[x] * q.scale + q.offset;
    out[x] = static_cast<Sample>(std::clamp(level + 0.5F, 0.0F, q.largest));
  }
}

// The foreground object at one instant, in one plane.
class ObjectAtInstant {
 public:
  ObjectAtInstant(const ForegroundObject& object, double time_s, ScenePlane plane)
      : object_from_world_(
            (ExpSo3(Eigen::Vector3d(-object.elevation_rad, 0.0, 0.0)) *
             ExpSo3(Eigen::Vector3d(0.0, -object.azimuth_rad - object.rate_rad_s * time_s, 0.0)))
                .toRotationMatrix()),
        radius_tan_(std::tan(object.radius_rad)) {
    // Waves of three directions over a base colour: corners for a tracker, smooth in between.
    SeededRandom random(object.seed);
    const std::array<double, 3> base = {random.Uniform(0.4, 0.6), random.Uniform(-0.25, 0.25),
                                        random.Uniform(-0.25, 0.25)};
    base_ = base[static_cast<std::size_t>(plane)];
    swing_ = plane == ScenePlane::kLuma ? 0.13 : 0.02;
    for (std::size_t i = 0; i < waves_.size(); ++i) {
      const double angle = std::numbers::pi * (static_cast<double>(i) + random.Uniform()) / 3.0;
      const double waves_across = random.Uniform(1.5, 3.0);
      waves_[i] =
          2.0 * std::numbers::pi * waves_across * Eigen::Vector2d(std::cos(angle), std::sin(angle));
    }
  }

  // Overwrites `value` where the direction (world axes) meets the object.
  void Cover(const Eigen::Vector3d& direction, float& value) const {
    const Eigen::Vector3d d = object_from_world_ * direction;
    const Eigen::Vector2d place = d.head<2>() / (d.z() * radius_tan_);
    if (d.z() <= 0.0 || !(place.squaredNorm() <= 1.0)) {
      return;
    }
    double level = base_;
    for (const Eigen::Vector2d& wave : waves_) {
      level += swing_ * std::sin(wave.dot(place));
    }
    value = static_cast<float>(level);
  }

 private:
  Eigen::Matrix3d object_from_world_;
  double radius_tan_ = 0.0;
  double base_ = 0.0;
  double swing_ = 0.0;
  std::array<Eigen::Vector2d, 3> waves_;
};

}  // namespace

// One plane of one frame.
struct RsSimulator::RowJob {
  ScenePlane plane = ScenePlane::kLuma;
  MutablePlaneView out;
  PixelLayout layout;
  double frame_time_s = 0.0;
  double readout_s = 0.0;
  double step_x = 1.0;  // luma pixels a sample
  double step_y = 1.0;
  double offset_x = 0.0;  // luma pixel of sample 0
  double offset_y = 0.0;
  std::uint64_t noise_stream = 0;
};

RsSimulator::RsSimulator(std::shared_ptr<const TextureScene> scene, Camera camera,
                         OrientationTrack orientation, const RsSimulatorOptions& options)
    : scene_(std::move(scene)),
      camera_(std::move(camera)),
      orientation_(std::move(orientation)),
      options_(options) {}

Result<RsSimulator> RsSimulator::Create(std::shared_ptr<const TextureScene> scene,
                                        const Camera& camera, OrientationTrack orientation,
                                        const RsSimulatorOptions& options) {
  if (scene == nullptr) {
    return Fail(ErrorCode::kInvalidArgument, "The simulator needs a scene to look at.");
  }
  if (Status status = camera.Validate(); !status) {
    return Propagate(status.error(), "The simulated camera");
  }
  if (!(std::abs(options.readout_s) < 1.0)) {
    return Fail(ErrorCode::kInvalidArgument,
                "The readout time must be between -1 and 1 s, not {} s.", options.readout_s);
  }
  if (!(options.exposure_s >= 0.0 && options.exposure_s < 1.0) || options.exposure_samples < 1 ||
      options.exposure_samples > 64) {
    return Fail(ErrorCode::kInvalidArgument,
                "The exposure must be 0 to 1 s in 1 to 64 samples, not {} s in {} samples.",
                options.exposure_s, options.exposure_samples);
  }
  if (!(options.noise_sigma >= 0.0 && options.noise_sigma <= 50.0)) {
    return Fail(ErrorCode::kInvalidArgument, "The image noise must be 0 to 50 levels, not {}.",
                options.noise_sigma);
  }
  if (options.foreground &&
      !(options.foreground->radius_rad > 0.0 && options.foreground->radius_rad <= 0.5)) {
    return Fail(ErrorCode::kInvalidArgument,
                "The foreground object's radius must be 0 to 0.5 rad, not {}.",
                options.foreground->radius_rad);
  }
  if (camera.model != LensModel::kPinhole) {
    for (int y = 0; y < camera.height; ++y) {
      for (int x = 0; x < camera.width; ++x) {
        if (!camera.UnprojectPixel({x, y})) {
          return Fail(ErrorCode::kInvalidArgument,
                      "The lens model has no ray for pixel ({}, {}); crop the image or choose "
                      "other coefficients.",
                      x, y);
        }
      }
    }
  }
  return RsSimulator(std::move(scene), camera, std::move(orientation), options);
}

Result<Frame> RsSimulator::RenderRs(double frame_time_s, const PixelLayout& layout,
                                    WorkerPool& pool, std::int64_t noise_index) const {
  return Render(frame_time_s, options_.readout_s, layout, pool,
                MixBits(options_.noise_seed) + 2 * static_cast<std::uint64_t>(noise_index));
}

Result<Frame> RsSimulator::RenderGs(double frame_time_s, const PixelLayout& layout,
                                    WorkerPool& pool, std::int64_t noise_index) const {
  return Render(frame_time_s, 0.0, layout, pool,
                MixBits(options_.noise_seed) + 2 * static_cast<std::uint64_t>(noise_index) + 1);
}

Result<Frame> RsSimulator::Render(double frame_time_s, double readout_s, const PixelLayout& layout,
                                  WorkerPool& pool, std::uint64_t noise_stream) const {
  const bool is_planar = std::all_of(layout.channels.begin(),
                                     layout.channels.begin() + std::clamp(layout.num_planes, 0, 3),
                                     [](int channels) { return channels == 1; });
  if (layout.is_rgb || !is_planar || (layout.num_planes != 1 && layout.num_planes != 3)) {
    return Fail(ErrorCode::kInvalidArgument,
                "The simulator renders gray and planar YUV pictures only.");
  }
  // Chroma samples of the last row may sit half a luma row below the image.
  const double half_span = std::abs(readout_s) * (0.5 + 1.0 / camera_.height) +
                           (options_.exposure_samples > 1 ? options_.exposure_s / 2.0 : 0.0);
  if (!std::isfinite(frame_time_s) ||
      !orientation_.Covers(frame_time_s - half_span, frame_time_s + half_span)) {
    return Fail(ErrorCode::kInvalidArgument,
                "The motion covers {:.4f} to {:.4f} s, but the frame at {:.4f} s needs {:.4f} s on "
                "both sides; give a longer motion or a shorter clip.",
                orientation_.start_s(), orientation_.end_s(), frame_time_s, half_span);
  }
  Result<Frame> frame = AllocateFrame(layout, camera_.width, camera_.height);
  if (!frame) {
    return frame;
  }
  for (int p = 0; p < layout.num_planes; ++p) {
    RowJob job;
    job.plane = static_cast<ScenePlane>(p);
    job.out = frame->planes[static_cast<std::size_t>(p)];
    job.layout = layout;
    job.frame_time_s = frame_time_s;
    job.readout_s = readout_s;
    job.noise_stream = MixBits(noise_stream) + static_cast<std::uint64_t>(p);
    if (layout.IsChroma(p)) {
      job.step_x = 1 << layout.chroma_shift_x;
      job.step_y = 1 << layout.chroma_shift_y;
      job.offset_x = layout.chroma_offset_x;
      job.offset_y = layout.chroma_offset_y;
    }
    pool.ForBlocks(job.out.height, kRowsPerBlock, [&](int begin, int end) {
      for (int row = begin; row < end; ++row) {
        RenderRow(job, row);
      }
    });
  }
  return frame;
}

void RsSimulator::RenderRow(const RowJob& job, int row) const {
  const auto width = static_cast<std::size_t>(job.out.width);
  const double y = row * job.step_y + job.offset_y;
  const double row_time_s = RowExposureTime(job.frame_time_s, y, camera_.height, job.readout_s);
  const Eigen::Vector3d first_ray((job.offset_x - camera_.cx) / camera_.fx,
                                  (y - camera_.cy) / camera_.fy, 1.0);
  const Eigen::Vector3d ray_step(job.step_x / camera_.fx, 0.0, 0.0);
  const bool needs_rays = camera_.model != LensModel::kPinhole || options_.foreground.has_value();
  std::vector<Eigen::Vector3d> rays(needs_rays ? width : 0);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    // A chroma sample half a pixel outside the image may have no ray; it then takes the centre's.
    rays[i] = camera_.UnprojectPixel({static_cast<double>(i) * job.step_x + job.offset_x, y})
                  .value_or(Eigen::Vector3d::UnitZ());
  }

  std::vector<float> sum(width, 0.0F);
  std::vector<float> values(width);
  std::vector<Eigen::Vector3d> directions(rays.size());
  const int samples = options_.exposure_samples;
  for (int s = 0; s < samples; ++s) {
    const double time_s = row_time_s + options_.exposure_s * ((s + 0.5) / samples - 0.5);
    // Render has checked that the track covers every row.
    const Eigen::Matrix3d world_from_camera =
        orientation_.CameraFromWorld(time_s)->conjugate().toRotationMatrix();
    for (std::size_t i = 0; i < rays.size(); ++i) {
      directions[i] = world_from_camera * rays[i];
    }
    if (camera_.model == LensModel::kPinhole) {
      scene_->SampleLine(job.plane, world_from_camera * first_ray, world_from_camera * ray_step,
                         values);
    } else {
      scene_->SampleDirections(job.plane, directions, values);
    }
    if (options_.foreground) {
      const ObjectAtInstant object(*options_.foreground, time_s, job.plane);
      for (std::size_t i = 0; i < width; ++i) {
        object.Cover(directions[i], values[i]);
      }
    }
    for (std::size_t i = 0; i < width; ++i) {
      sum[i] += values[i];
    }
  }

  const auto scale = 1.0F / static_cast<float>(samples);
  const auto noise = static_cast<float>(options_.noise_sigma / 255.0);
  for (std::size_t i = 0; i < width; ++i) {
    sum[i] *= scale;
    if (noise > 0.0F) {
      sum[i] += noise * NoiseAt(job.noise_stream, static_cast<std::uint64_t>(row) * 65536 + i);
    }
  }
  const Quantisation q = QuantisationOf(job.layout, job.plane != ScenePlane::kLuma);
  std::uint8_t* out = job.out.data + row * job.out.stride;
  if (job.layout.BytesPerSample() == 2) {
    StoreRow<std::uint16_t>(sum, q, out);
  } else {
    StoreRow<std::uint8_t>(sum, q, out);
  }
}

}  // namespace rsstab::igf
