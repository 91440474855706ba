// SPDX-License-Identifier: Apache-2.0
#include "igf/texture_scene.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <utility>

namespace rsstab::igf {
namespace {

// Walls of the room, each 2 units of tangent wide (-45 to 45 degrees).
constexpr double kWallsTan = 8.0;
// Texels a view pixel at the centre of a wall, and the resulting standard deviation of the B-spline
// (sqrt(4 / 12) texels) in view pixels: sharp, yet its content at the view's Nyquist limit is
// damped to a third, so that point sampling does not alias visibly.
constexpr double kTexelsPerPixel = 1.25;
constexpr double kSplineVariance = 1.0 / 3.0;
constexpr double kSharpnessPx = 0.5773502691896258 / kTexelsPerPixel;
// Chroma is drawn at half the luma's density, as video carries it.
constexpr int kChromaReduction = 2;
constexpr int kMargin = 2;
constexpr double kMaxTexels = 0x1p28;
// Number of samples whose positions are worked out before any is interpolated.
constexpr std::size_t kBatch = 256;

// Standard deviation, in texels, that a point at tangent a of its wall still lacks. There a view
// pixel spans (1 + a^2) as many texels across, and sqrt(1 + a^2) as many down, as at the centre.
double MissingBlur(double texels_per_pixel) {
  const double wanted = kSharpnessPx * texels_per_pixel;
  return std::sqrt(std::max(0.0, wanted * wanted - kSplineVariance));
}

constexpr int kBlurReach = 4;
constexpr int kBlurTaps = 2 * kBlurReach + 1;
using BlurKernel = std::array<float, kBlurTaps>;

BlurKernel GaussianKernel(double sigma) {
  BlurKernel kernel{};
  double sum = 0.0;
  for (std::size_t i = 0; i < kBlurTaps; ++i) {
    const double k = static_cast<double>(i) - kBlurReach;
    const double weight =
        sigma > 0.0 ? std::exp(-0.5 * k * k / (sigma * sigma)) : (k == 0.0 ? 1.0 : 0.0);
    kernel[i] = static_cast<float>(weight);
    sum += weight;
  }
  for (float& weight : kernel) {
    weight = static_cast<float>(weight / sum);
  }
  return kernel;
}

// Texel index -> the same index reflected into [0, size); reflection about the outer texel edges.
int FoldIndex(int index, int size) {
  const int period = 2 * size;
  int folded = index % period;
  folded = folded < 0 ? folded + period : folded;
  return folded < size ? folded : period - 1 - folded;
}

// The same for a position; texel centres at integers, result in [-0.5, size - 0.5].
double FoldPosition(double position, double size) {
  const double from_edge = position + 0.5;
  if (from_edge >= 0.0 && from_edge < size) {
    return position;
  }
  const double period = 2.0 * size;
  const double folded = from_edge - period * std::floor(from_edge / period);
  return (folded < size ? folded : period - folded) - 0.5;
}

// Blurs each column by what its place on the wall asks for. Both passes, reflected at the edges.
cv::Mat BlurTowardsCorners(const cv::Mat& image, double focal) {
  const int width = image.cols;
  const int height = image.rows;
  std::vector<BlurKernel> across(static_cast<std::size_t>(width));
  // Stored tap by tap, so that the pass down the columns runs along the rows.
  cv::Mat down(kBlurTaps, width, CV_32F);
  for (int x = 0; x < width; ++x) {
    const double u = (x + 0.5 - width / 2.0) / focal;
    const double a = u - 2.0 * std::round(u / 2.0);
    const double density = kTexelsPerPixel * (1.0 + a * a);
    across[static_cast<std::size_t>(x)] = GaussianKernel(MissingBlur(density));
    const BlurKernel column = GaussianKernel(MissingBlur(kTexelsPerPixel * std::sqrt(1.0 + a * a)));
    for (int k = 0; k < kBlurTaps; ++k) {
      down.at<float>(k, x) = column[static_cast<std::size_t>(k)];
    }
  }
  cv::Mat rows_done(height, width, CV_32F);
  std::vector<float> padded(static_cast<std::size_t>(width + 2 * kBlurReach));
  for (int y = 0; y < height; ++y) {
    const auto* in = image.ptr<float>(y);
    for (int x = 0; x < width + 2 * kBlurReach; ++x) {
      padded[static_cast<std::size_t>(x)] = in[FoldIndex(x - kBlurReach, width)];
    }
    auto* out = rows_done.ptr<float>(y);
    for (int x = 0; x < width; ++x) {
      const BlurKernel& kernel = across[static_cast<std::size_t>(x)];
      const float* in_x = padded.data() + x;
      float sum = 0.0F;
      for (std::size_t k = 0; k < kBlurTaps; ++k) {
        sum += kernel[k] * in_x[k];
      }
      out[x] = sum;
    }
  }
  cv::Mat result = cv::Mat::zeros(height, width, CV_32F);
  for (int y = 0; y < height; ++y) {
    auto* out = result.ptr<float>(y);
    for (int k = 0; k < kBlurTaps; ++k) {
      const auto* in = rows_done.ptr<float>(FoldIndex(y + k - kBlurReach, height));
      const auto* weight = down.ptr<float>(k);
      for (int x = 0; x < width; ++x) {
        out[x] += weight[x] * in[x];
      }
    }
  }
  return result;
}

// One plane of the picture, full range, unit scale; BT.709.
cv::Mat PlaneOf(const RgbPicture& picture, std::size_t plane) {
  constexpr std::array<std::array<float, 3>, 3> kYccFromRgb = {{{0.2126F, 0.7152F, 0.0722F},
                                                                {-0.114572F, -0.385428F, 0.5F},
                                                                {0.5F, -0.454153F, -0.045847F}}};
  const std::array<float, 3>& weights = kYccFromRgb[plane];
  cv::Mat image(picture.height, picture.width, CV_32F);
  const std::uint8_t* rgb = picture.pixels.data();
  for (int y = 0; y < picture.height; ++y) {
    auto* row = image.ptr<float>(y);
    for (int x = 0; x < picture.width; ++x, rgb += 3) {
      row[x] = (weights[0] * static_cast<float>(rgb[0]) + weights[1] * static_cast<float>(rgb[1]) +
                weights[2] * static_cast<float>(rgb[2])) /
               255.0F;
    }
  }
  return image;
}

// Position of a direction on the unrolled walls, units of tangent: x = 0 straight ahead, growing to
// the right, one wall every 2; y grows downwards.
Eigen::Vector2d UnrolledWallPosition(const Eigen::Vector3d& d) {
  // Straight up or down there is no wall; any texel is as good as another.
  constexpr double kNearest = 1e-9;
  if (std::abs(d.x()) <= std::abs(d.z())) {
    const double depth = 1.0 / std::max(std::abs(d.z()), kNearest);
    return d.z() > 0.0 ? Eigen::Vector2d(d.x() * depth, d.y() * depth)         // ahead
                       : Eigen::Vector2d(4.0 - d.x() * depth, d.y() * depth);  // behind
  }
  const double depth = 1.0 / std::max(std::abs(d.x()), kNearest);
  return d.x() > 0.0 ? Eigen::Vector2d(2.0 - d.z() * depth, d.y() * depth)   // right
                     : Eigen::Vector2d(d.z() * depth - 2.0, d.y() * depth);  // left
}

// Value of a uniform cubic B-spline; `corner` is the upper left of the 4x4 control points, tx and
// ty in [0, 1) the place between the middle ones.
float SplineValue(const float* corner, std::ptrdiff_t stride, float tx, float ty) {
  const auto weights = [](float t) {
    const float s = 1.0F - t;
    return std::array<float, 4>{s * s * s / 6.0F, 2.0F / 3.0F - t * t * (1.0F - 0.5F * t),
                                2.0F / 3.0F - s * s * (1.0F - 0.5F * s), t * t * t / 6.0F};
  };
  const std::array<float, 4> wx = weights(tx);
  const std::array<float, 4> wy = weights(ty);
  std::array<float, 4> columns{};
  for (std::size_t j = 0; j < 4; ++j) {
    const float* row = corner + static_cast<std::ptrdiff_t>(j) * stride;
    for (std::size_t i = 0; i < 4; ++i) {
      columns[i] += wy[j] * row[i];
    }
  }
  return (columns[0] * wx[0] + columns[1] * wx[1]) + (columns[2] * wx[2] + columns[3] * wx[3]);
}

}  // namespace

Result<TextureScene> TextureScene::FromPicture(const RgbPicture& picture, double picture_width_tan,
                                               double view_focal_px) {
  if (picture.width < 1 || picture.height < 1 ||
      picture.pixels.size() !=
          3 * static_cast<std::size_t>(picture.width) * static_cast<std::size_t>(picture.height)) {
    return Fail(ErrorCode::kInvalidArgument,
                "The scene's picture of {} x {} pixels holds {} bytes; 3 bytes a pixel are needed.",
                picture.width, picture.height, picture.pixels.size());
  }
  if (!(picture_width_tan > 0.0 && picture_width_tan <= kWallsTan)) {
    return Fail(ErrorCode::kInvalidArgument,
                "The scene's picture must be between 0 and {} wall distances wide, not {}.",
                kWallsTan, picture_width_tan);
  }
  if (!(view_focal_px > 0.0 && std::isfinite(view_focal_px))) {
    return Fail(ErrorCode::kInvalidArgument, "The focal length must be positive, not {} px.",
                view_focal_px);
  }
  const double pictures = 2.0 * std::max(1.0, std::round(kWallsTan / picture_width_tan / 2.0));
  // Even, so that the halved chroma planes cover exactly the same directions.
  const double width =
      std::max(4.0, 2.0 * std::round(kWallsTan / pictures * kTexelsPerPixel * view_focal_px / 2.0));
  const double height =
      std::max(4.0, 2.0 * std::round(width * picture.height / picture.width / 2.0));
  if (!(width * height <= kMaxTexels)) {
    return Fail(ErrorCode::kInvalidArgument,
                "A scene for a focal length of {} px would need {:.0f} x {:.0f} texels; ask for a "
                "smaller video or a wider view.",
                view_focal_px, width, height);
  }

  TextureScene scene;
  for (int p = 0; p < 3; ++p) {
    const cv::Mat image = PlaneOf(picture, static_cast<std::size_t>(p));
    const int reduction = p == 0 ? 1 : kChromaReduction;
    Plane& plane = scene.planes_[static_cast<std::size_t>(p)];
    plane.width = static_cast<int>(width) / reduction;
    plane.height = static_cast<int>(height) / reduction;
    plane.focal = plane.width * pictures / kWallsTan;
    const bool shrinks = plane.width < picture.width;
    cv::Mat texels;
    if (plane.width == picture.width && plane.height == picture.height) {
      texels = image;
    } else {
      cv::resize(image, texels, cv::Size(plane.width, plane.height), 0.0, 0.0,
                 shrinks ? cv::INTER_AREA : cv::INTER_CUBIC);
    }
    texels = BlurTowardsCorners(texels, plane.focal);
    plane.stride = plane.width + 2 * kMargin;
    plane.values.resize(static_cast<std::size_t>(plane.stride) *
                        static_cast<std::size_t>(plane.height + 2 * kMargin));
    for (int y = 0; y < plane.height + 2 * kMargin; ++y) {
      const auto* in = texels.ptr<float>(FoldIndex(y - kMargin, plane.height));
      float* out = plane.values.data() + static_cast<std::ptrdiff_t>(y) * plane.stride;
      for (int x = 0; x < plane.stride; ++x) {
        out[x] = in[FoldIndex(x - kMargin, plane.width)];
      }
    }
  }
  return scene;
}

void TextureScene::SampleLine(ScenePlane which, const Eigen::Vector3d& first,
                              const Eigen::Vector3d& step, std::span<float> out) const {
  std::array<Eigen::Vector3d, kBatch> directions;
  for (std::size_t begin = 0; begin < out.size(); begin += kBatch) {
    const std::size_t count = std::min(kBatch, out.size() - begin);
    for (std::size_t i = 0; i < count; ++i) {
      directions[i] = first + static_cast<double>(begin + i) * step;
    }
    SampleDirections(which, std::span(directions).first(count), out.subspan(begin, count));
  }
}

void TextureScene::SampleDirections(ScenePlane which, std::span<const Eigen::Vector3d> directions,
                                    std::span<float> out) const {
  const Plane& p = plane(which);
  const double centre_x = p.width / 2.0 - 0.5;
  const double centre_y = p.height / 2.0 - 0.5;
  for (std::size_t i = 0; i < out.size(); ++i) {
    const Eigen::Vector2d wall = UnrolledWallPosition(directions[i]);
    const double x = FoldPosition(centre_x + p.focal * wall.x(), p.width);
    const double y = FoldPosition(centre_y + p.focal * wall.y(), p.height);
    const double left = std::floor(x);
    const double top = std::floor(y);
    // The margin of 2 makes texel (left - 1, top - 1) element (left + 1, top + 1).
    const float* corner = p.values.data() + (static_cast<std::ptrdiff_t>(top) + 1) * p.stride +
                          static_cast<std::ptrdiff_t>(left) + 1;
    out[i] =
        SplineValue(corner, p.stride, static_cast<float>(x - left), static_cast<float>(y - top));
  }
}

}  // namespace rsstab::igf
