// SPDX-License-Identifier: Apache-2.0
#include "rsdiff/orientation_planes.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <opencv2/imgproc.hpp>
#include <vector>

namespace rsstab::rsdiff {
namespace {

// Bins of edges nearer to the vertical, and of those nearer to the horizontal.
struct Family {
  int first;
  int bins;
};
constexpr Family kUpright{0, 20};
constexpr Family kLevel{20, 12};
constexpr int kPlanes = kUpright.bins + kLevel.bins;
constexpr int kRows = kOrientationShape.rows;
constexpr int kColumns = kOrientationShape.columns;
constexpr int kCells = kRows * kColumns;
constexpr int kGrayRows = 2;  // of one cell
constexpr int kGrayColumns = 4;
static_assert(2 * kPlanes + kGrayRows * kGrayColumns + 1 == kOrientationShape.channels);

constexpr double kWorkingArea_px = 384.0 * 288.0;
constexpr int kMinWidth = kColumns * kGrayColumns;
constexpr int kMinHeight = kRows * kGrayRows;
constexpr float kFineSlope = 0.15F;       // bins are fine below this slope and grow beyond
constexpr float kLeastGradient = 3.0F;    // grey levels per px: below it a direction is noise
constexpr float kStrongGradient = 12.0F;  // contrast beyond which an edge counts no more
constexpr double kByteScale = 32.0;
constexpr int kBorder_px = 3;  // sees a mirrored border, where every edge looks upright or level
constexpr double kGrayFloor = 8.0;  // levels: keeps a picture without contrast without contrast

// Place of a cell in a channel.
std::size_t Index(int channel, int cell) {
  return static_cast<std::size_t>(channel) * kCells + static_cast<std::size_t>(cell);
}

// Structure tensor of the picture, smoothed: gx gx - gy gy and 2 gx gy.
struct DoubleAngle {
  cv::Mat difference;
  cv::Mat product;
};

DoubleAngle MeasureDirections(const cv::Mat& gray) {
  cv::Mat gx;
  cv::Mat gy;
  cv::Scharr(gray, gx, CV_32F, 1, 0, 1.0 / 32.0);
  cv::Scharr(gray, gy, CV_32F, 0, 1, 1.0 / 32.0);
  DoubleAngle angle{cv::Mat(gray.size(), CV_32F), cv::Mat(gray.size(), CV_32F)};
  for (int row = 0; row < gray.rows; ++row) {
    const float* x = gx.ptr<float>(row);
    const float* y = gy.ptr<float>(row);
    float* difference = angle.difference.ptr<float>(row);
    float* product = angle.product.ptr<float>(row);
    for (int column = 0; column < gray.cols; ++column) {
      difference[column] = x[column] * x[column] - y[column] * y[column];
      product[column] = x[column] * y[column];
    }
  }
  constexpr double kSmoothing_px = 1.2;
  const cv::Size window(5, 5);
  cv::GaussianBlur(angle.difference, angle.difference, window, kSmoothing_px);
  cv::GaussianBlur(angle.product, angle.product, window, kSmoothing_px);
  angle.product *= 2.0;
  return angle;
}

// Place of a slope in [-1, 1] among the bins, in [0, bins - 1).
class SoftBins {
 public:
  explicit SoftBins(int bins)
      : middle_(0.5F * static_cast<float>(bins - 1)),
        per_asinh_(middle_ / std::asinh(1.0F / kFineSlope)),
        last_(static_cast<float>(bins) - 1.001F) {}

  [[nodiscard]] float Place(float slope) const {
    const float place = std::asinh(slope * (1.0F / kFineSlope)) * per_asinh_ + middle_;
    return std::clamp(place, 0.0F, last_);
  }

 private:
  float middle_;
  float per_asinh_;
  float last_;
};

// Edge strength per bin and cell, summed over the cell's pixels: kPlanes x kCells.
std::vector<double> SumByDirection(const DoubleAngle& angle) {
  const SoftBins upright(kUpright.bins);
  const SoftBins level(kLevel.bins);
  const int width = angle.difference.cols;
  const int height = angle.difference.rows;
  std::vector<double> sums(static_cast<std::size_t>(kPlanes) * kCells, 0.0);
  for (int row = kBorder_px; row < height - kBorder_px; ++row) {
    const float* difference = angle.difference.ptr<float>(row);
    const float* product = angle.product.ptr<float>(row);
    const int first_cell = row * kRows / height * kColumns;
    for (int column = kBorder_px; column < width - kBorder_px; ++column) {
      const float d = difference[column];
      const float p = product[column];
      const float energy = std::sqrt(d * d + p * p);
      if (!(energy > kLeastGradient * kLeastGradient)) {
        continue;
      }
      const float slope = -p / (energy + std::abs(d));
      const float weight = std::min(std::sqrt(energy), kStrongGradient);
      const bool is_upright = d >= 0.0F;
      const float place = (is_upright ? upright : level).Place(slope);
      const int lower = static_cast<int>(place);
      const float share = place - static_cast<float>(lower);
      const int plane = (is_upright ? kUpright : kLevel).first + lower;
      double* sum = &sums[Index(plane, first_cell + column * kColumns / width)];
      sum[0] += static_cast<double>(weight * (1.0F - share));
      sum[kCells] += static_cast<double>(weight * share);
    }
  }
  return sums;
}

// Writes each strength's share of its family (upright or level) in its cell.
void WriteShares(std::span<const float> strengths, std::span<float> shares) {
  double energy = 0.0;
  for (const float strength : strengths) {
    energy += static_cast<double>(strength) * static_cast<double>(strength);
  }
  // A family that holds little of the picture's energy per cell is mostly noise.
  const double floor = 0.05 * energy / kCells + 1e-3;
  for (const Family& family : {kUpright, kLevel}) {
    for (int cell = 0; cell < kCells; ++cell) {
      const auto squared = [&](int bin) {
        const auto strength = static_cast<double>(strengths[Index(family.first + bin, cell)]);
        return strength * strength;
      };
      double sum = floor;
      for (int bin = 0; bin < family.bins; ++bin) {
        sum += squared(bin);
      }
      for (int bin = 0; bin < family.bins; ++bin) {
        shares[Index(family.first + bin, cell)] = static_cast<float>(std::sqrt(squared(bin) / sum));
      }
    }
  }
}

// The whole picture in kGrayRows x kGrayColumns pixels per cell, mean 0, deviation about 1; one
// channel per pixel of the cell.
void WriteSmallGray(const cv::Mat& gray, std::span<float> channels) {
  cv::Mat small;
  cv::resize(gray, small, cv::Size(kMinWidth, kMinHeight), 0.0, 0.0, cv::INTER_AREA);
  cv::Scalar mean;
  cv::Scalar deviation;
  cv::meanStdDev(small, mean, deviation);
  for (int y = 0; y < kMinHeight; ++y) {
    for (int x = 0; x < kMinWidth; ++x) {
      const int channel = y % kGrayRows * kGrayColumns + x % kGrayColumns;
      const int cell = y / kGrayRows * kColumns + x / kGrayColumns;
      channels[Index(channel, cell)] = static_cast<float>((small.at<std::uint8_t>(y, x) - mean[0]) /
                                                          (deviation[0] + kGrayFloor));
    }
  }
}

}  // namespace

PictureSize OrientationWorkingSize(int width, int height) {
  const double scale = std::sqrt(kWorkingArea_px / (static_cast<double>(width) * height));
  return {std::max(kMinWidth, static_cast<int>(std::nearbyint(width * scale))),
          std::max(kMinHeight, static_cast<int>(std::nearbyint(height * scale)))};
}

Result<Tensor> OrientationPlanes(std::span<const std::uint8_t> gray, const PictureSize& size) {
  if (size.width < kMinWidth || size.height < kMinHeight ||
      gray.size() != static_cast<std::size_t>(size.width) * static_cast<std::size_t>(size.height)) {
    return Fail(ErrorCode::kInvalidArgument,
                "a picture of {}x{} px in {} bytes cannot be searched for edges; it needs {}x{} at "
                "least",
                size.width, size.height, gray.size(), kMinWidth, kMinHeight);
  }
  Tensor planes(1, kOrientationShape);
  const std::span<float> values(planes.values);
  try {
    // cv::Mat has no const view; it is only read.
    const cv::Mat picture(
        size.height, size.width, CV_8U,
        const_cast<std::uint8_t*>(gray.data()));  // NOLINT(cppcoreguidelines-pro-type-const-cast)
    const std::vector<double> sums = SumByDirection(MeasureDirections(picture));
    const double pixels_per_cell = static_cast<double>(size.width) * size.height / kCells;
    for (std::size_t i = 0; i < sums.size(); ++i) {
      const double level = std::sqrt(sums[i] / pixels_per_cell) * (kByteScale * 2.0) + 0.5;
      values[i] = static_cast<float>(std::floor(std::min(level, 255.0)) / kByteScale);
    }
    WriteShares(values.first(sums.size()), values.subspan(sums.size(), sums.size()));
    WriteSmallGray(picture, values.subspan(2 * sums.size()));
  } catch (const cv::Exception& e) {
    return Fail(ErrorCode::kInternal, "measuring edges of {}x{} px failed: {}", size.width,
                size.height, e.what());
  }
  const std::span<float> across = values.last(kCells);
  const double aspect = static_cast<double>(size.width) / size.height;
  for (int cell = 0; cell < kCells; ++cell) {
    across[static_cast<std::size_t>(cell)] =
        static_cast<float>(aspect * ((cell % kColumns + 0.5) / kColumns - 0.5));
  }
  return planes;
}

}  // namespace rsstab::rsdiff
