// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/metrics/field_metrics.h"

#include <cmath>
#include <cstddef>

namespace rsstab::stabilizer {
namespace {

// Reference rows of the same instant, stated for different grids, agree within this share of the
// height.
constexpr double kSameRow = 1e-3;

bool Counts(PixelMask valid, std::size_t index) { return valid.empty() || valid[index] != 0; }

tl::unexpected<Error> NothingValid() {
  return Fail(ErrorCode::kInvalidArgument, "No valid pixel is left to compare.");
}

}  // namespace

Result<FieldError> CompareFields(std::span<const Eigen::Vector2f> estimate,
                                 std::span<const Eigen::Vector2f> truth, PixelMask valid) {
  if (estimate.size() != truth.size() || (!valid.empty() && valid.size() != truth.size())) {
    return Fail(ErrorCode::kInvalidArgument,
                "Fields of {} and {} pixels with a mask of {} cannot be compared.", estimate.size(),
                truth.size(), valid.size());
  }
  FieldError error;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    if (Counts(valid, i)) {
      const Eigen::Vector2d difference = (estimate[i] - truth[i]).cast<double>();
      error.length += difference.norm();
      error.horizontal += std::abs(difference.x());
      error.vertical += std::abs(difference.y());
      error.valid_pixels += 1.0;
    }
  }
  if (error.valid_pixels == 0.0) {
    return NothingValid();
  }
  error.length /= error.valid_pixels;
  error.horizontal /= error.valid_pixels;
  error.vertical /= error.valid_pixels;
  return error;
}

Result<double> EndPointError(std::span<const Eigen::Vector2f> estimate,
                             std::span<const Eigen::Vector2f> truth, PixelMask valid) {
  const auto error = CompareFields(estimate, truth, valid);
  if (!error) {
    return Propagate(error.error());
  }
  return error->length;
}

Result<double> EndPointError(const MotionField& estimate, const MotionField& truth,
                             PixelMask valid) {
  const int width = truth.width();
  const int height = truth.height();
  if (width < 1 || height < 1 || estimate.width() < 1 || estimate.height() < 1) {
    return Fail(ErrorCode::kInvalidArgument, "An empty motion field cannot be compared.");
  }
  const auto pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  if (!valid.empty() && valid.size() != pixels) {
    return Fail(ErrorCode::kInvalidArgument, "A mask of {} pixels does not fit a {}x{} field.",
                valid.size(), width, height);
  }
  const bool same_size = estimate.width() == width && estimate.height() == height;
  const MotionField scaled = same_size ? estimate : estimate.Rescaled(width, height);
  if (std::abs(scaled.reference_row() - truth.reference_row()) > kSameRow * height) {
    return Fail(ErrorCode::kInvalidArgument,
                "Motion fields with reference rows {} and {} must be brought to one row first.",
                scaled.reference_row(), truth.reference_row());
  }
  double sum = 0.0;
  std::size_t count = 0;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const auto index = static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                         static_cast<std::size_t>(x);
      if (Counts(valid, index)) {
        const Eigen::Vector2d pixel(x, y);
        sum += (scaled.Sample(pixel) - truth.Sample(pixel)).norm();
        ++count;
      }
    }
  }
  if (count == 0) {
    return NothingValid();
  }
  return sum / static_cast<double>(count);
}

}  // namespace rsstab::stabilizer
