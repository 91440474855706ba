// SPDX-License-Identifier: Apache-2.0
#include "evaluation/photo_scene.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "evaluation/photo.h"
#include "igf/base/seeded_random.h"

namespace rsstab::evaluation {
namespace {

constexpr int kLeastSide = 16;
// Photo pixels left free at each edge: the filter reaches two pixels to a side.
constexpr double kEdge_px = 2.0;
// A photograph with pixels finer than this share of the view's is shrunk first, against aliasing.
constexpr double kFinest = 1.1;

// Scene pixel <- recorded pixel of one row.
Eigen::Matrix3d SceneFromRow(const RowOrientation& exposure, const Camera& camera, int row) {
  const Eigen::Matrix3d k = camera.K();
  return k * exposure(row).conjugate().toRotationMatrix() * k.inverse();
}

// Photo position = scale * (scene pixel) + offset.
struct View {
  double scale = 1.0;
  Eigen::Vector2d offset = Eigen::Vector2d::Zero();
};

// Grows `box` by what an exposure shows, in scene pixels.
Status ExtendBox(const RowOrientation& exposure, const Camera& camera, Eigen::AlignedBox2d& box) {
  for (int row = 0; row < camera.height; ++row) {
    const Eigen::Matrix3d scene_from_row = SceneFromRow(exposure, camera, row);
    // A homography is monotone along a line, so the ends of the row bound it.
    for (const double x : {0.0, camera.width - 1.0}) {
      const Eigen::Vector3d point = scene_from_row * Eigen::Vector3d(x, row, 1.0);
      if (!(point.z() > 0.1)) {
        return Fail(ErrorCode::kInvalidArgument,
                    "a motion turns row {} of the picture out of the photograph's plane", row);
      }
      box.extend(Eigen::Vector2d(point.hnormalized()));
    }
  }
  return {};
}

View FitView(const Eigen::AlignedBox2d& box, int photo_width, int photo_height) {
  const Eigen::Vector2d room(photo_width - 1.0 - 2.0 * kEdge_px,
                             photo_height - 1.0 - 2.0 * kEdge_px);
  View view;
  view.scale = room.cwiseQuotient(box.sizes()).minCoeff();
  view.offset =
      Eigen::Vector2d(photo_width - 1.0, photo_height - 1.0) / 2.0 - view.scale * box.center();
  return view;
}

// Keys' cubic convolution with a = -1/2 at fraction t: weights of the pixels -1, 0, 1, 2.
std::array<float, 4> CubicWeights(float t) {
  const float t2 = t * t;
  const float t3 = t2 * t;
  return {0.5F * (-t3 + 2.0F * t2 - t), 0.5F * (3.0F * t3 - 5.0F * t2 + 2.0F),
          0.5F * (-3.0F * t3 + 4.0F * t2 + t), 0.5F * (t3 - t2)};
}

using Rgb = std::array<float, 3>;

Rgb SamplePhoto(const FrameView& photo, double x, double y) {
  // FitView keeps x and y inside; clamping only guards rounding at the very edge.
  const double cx = std::clamp(x, 1.0, photo.width - 3.0);
  const double cy = std::clamp(y, 1.0, photo.height - 3.0);
  const int x0 = static_cast<int>(cx);
  const int y0 = static_cast<int>(cy);
  const std::array<float, 4> wx = CubicWeights(static_cast<float>(cx - x0));
  const std::array<float, 4> wy = CubicWeights(static_cast<float>(cy - y0));
  Rgb sum{};
  for (std::size_t j = 0; j < 4; ++j) {
    const std::uint8_t* in = photo.planes[0].data +
                             (y0 - 1 + static_cast<int>(j)) * photo.planes[0].stride + 3 * (x0 - 1);
    Rgb line{};
    for (std::size_t i = 0; i < 4; ++i, in += 3) {
      for (std::size_t c = 0; c < 3; ++c) {
        line[c] += wx[i] * static_cast<float>(in[c]);
      }
    }
    for (std::size_t c = 0; c < 3; ++c) {
      sum[c] += wy[j] * line[c];
    }
  }
  return sum;
}

// Nearly Gaussian noise of unit variance: the sum of four 16-bit uniforms.
float NoiseAt(std::uint64_t seed, std::uint64_t position) {
  const std::uint64_t bits = MixBits(seed ^ MixBits(position));
  const auto sum = static_cast<float>((bits & 0xffffU) + ((bits >> 16U) & 0xffffU) +
                                      ((bits >> 32U) & 0xffffU) + (bits >> 48U));
  constexpr float kMean = 4.0F * 32767.5F;
  constexpr float kDeviation = 37837.2F;  // 65536 sqrt(4 / 12)
  return (sum - kMean) / kDeviation;
}

// One row of a picture: photo position = (photo_from_pixel * (x, row, 1)) dehomogenised.
void RecordRow(const FrameView& photo, const Eigen::Matrix3d& photo_from_pixel, int row,
               const ExposureOptions& noise, Frame& picture) {
  std::uint8_t* out = picture.planes[0].data + row * picture.planes[0].stride;
  const auto sigma = static_cast<float>(noise.noise_sigma);
  const auto first = static_cast<std::uint64_t>(row) * static_cast<std::uint64_t>(picture.width);
  for (int x = 0; x < picture.width; ++x) {
    const Eigen::Vector2d place = (photo_from_pixel * Eigen::Vector3d(x, row, 1.0)).hnormalized();
    const Rgb value = SamplePhoto(photo, place.x(), place.y());
    for (std::size_t c = 0; c < 3; ++c) {
      float level = value[c];
      if (sigma > 0.0F) {
        level += sigma * NoiseAt(noise.noise_seed, 3 * (first + static_cast<unsigned>(x)) + c);
      }
      *out++ = static_cast<std::uint8_t>(std::clamp(level + 0.5F, 0.0F, 255.0F));
    }
  }
}

// A copy, so that the scene does not depend on the caller's picture; shrunk if `scale` asks for it.
Result<Frame> PreparePhoto(const FrameView& photo, double scale) {
  const cv::Mat source(photo.height, photo.width, CV_8UC3,
                       const_cast<std::uint8_t*>(photo.planes[0].data),  // only read
                       static_cast<std::size_t>(photo.planes[0].stride));
  cv::Size size = source.size();
  if (scale > kFinest) {
    size = {std::max(kLeastSide, static_cast<int>(std::lround(source.cols / scale))),
            std::max(kLeastSide, static_cast<int>(std::lround(source.rows / scale)))};
  }
  auto frame = AllocateFrame(RgbLayout(), size.width, size.height);
  if (!frame) {
    return frame;
  }
  cv::Mat target(size.height, size.width, CV_8UC3, frame->planes[0].data,
                 static_cast<std::size_t>(frame->planes[0].stride));
  if (size == source.size()) {
    source.copyTo(target);
  } else {
    cv::resize(source, target, size, 0.0, 0.0, cv::INTER_AREA);
  }
  return frame;
}

}  // namespace

Result<PhotoScene> PhotoScene::Create(const FrameView& photo, const Camera& camera,
                                      std::span<const RowOrientation> exposures) {
  if (const Status valid = camera.Validate(); !valid) {
    return Propagate(valid.error());
  }
  if (!(photo.layout == RgbLayout()) || photo.width < kLeastSide || photo.height < kLeastSide ||
      camera.width < 2 || camera.height < 2 || camera.model != LensModel::kPinhole ||
      exposures.empty()) {
    return Fail(ErrorCode::kInvalidArgument,
                "a photo of {}x{} cannot be exposed: it must be packed 8-bit RGB of at least {} "
                "pixels a side, and the camera a pinhole",
                photo.width, photo.height, kLeastSide);
  }
  Eigen::AlignedBox2d box;
  for (const RowOrientation& exposure : exposures) {
    if (Status status = ExtendBox(exposure, camera, box); !status) {
      return Propagate(status.error());
    }
  }
  PhotoScene scene;
  scene.camera_ = camera;
  scene.photo_per_pixel_ = FitView(box, photo.width, photo.height).scale;
  try {
    auto prepared = PreparePhoto(photo, scene.photo_per_pixel_);
    if (!prepared) {
      return Propagate(prepared.error());
    }
    scene.photo_ = std::move(*prepared);
  } catch (const cv::Exception& error) {
    return Fail(ErrorCode::kInternal, "exposing a photo failed: {}", error.err);
  }
  const View view = FitView(box, scene.photo_.width, scene.photo_.height);
  scene.photo_from_scene_.setIdentity();
  scene.photo_from_scene_.diagonal() = Eigen::Vector3d(view.scale, view.scale, 1.0);
  scene.photo_from_scene_.topRightCorner<2, 1>() = view.offset;
  return scene;
}

Result<Frame> PhotoScene::Record(const RowOrientation& exposure,
                                 const ExposureOptions& options) const {
  auto picture = AllocateFrame(RgbLayout(), camera_.width, camera_.height);
  const FrameView photo = photo_.View();
  for (int row = 0; picture && row < camera_.height; ++row) {
    RecordRow(photo, photo_from_scene_ * SceneFromRow(exposure, camera_, row), row, options,
              *picture);
  }
  return picture;
}

}  // namespace rsstab::evaluation
