// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "igf/base/homography.h"
#include "stabilizer/path_crop_limit_detail.h"
#include "stabilizer/path_problem_detail.h"
#include "stabilizer/path_residuals.h"
#include "stabilizer/path_smoothness_detail.h"

namespace rsstab::stabilizer {
namespace {

// The crop limit is a penalty, raised tenfold until it is exceeded by no more than
// kMaxCropViolation.
constexpr double kCropWeight = 10.0;
constexpr int kMaxCropRaises = 4;
constexpr double kMaxCropViolation = 0.5 / kReferenceWidthPx;
// Where the crop limit can only be met by bending the picture (anisotropy of the update below
// kMinAnisotropy), or not at all, lambda falls as in Liu et al. 2013, 4.2: the temporal weights of
// the frames within half of smoothness_s are multiplied by kRelaxation and the window is solved
// anew. At a crop ratio of 0.97 on a walking shot without it 21% were cut off, not 3%.
constexpr double kMinAnisotropy = 0.95;
constexpr double kRelaxation = 0.03;
constexpr int kMaxRelaxations = 4;
constexpr int kBisections = 20;
// The zoom moves slowly, so that it may go a little deeper than one frame alone would need.
constexpr double kMaxZoomExcess = 0.03;
// Below this look-ahead the crop limit is a penalty of one weight: to hold it strictly, the path
// would have to jump after the camera, which shows more than a deeper zoom.
constexpr double kStrictLookaheadS = 0.3;
constexpr double kSoftCropWeight = 1000.0;

bool IsBent(const PathSmootherOptions& options, const UpdateParameters& theta) {
  return AffineAnisotropy(UpdateHomography(theta, options.focal_ratio)) < kMinAnisotropy;
}

// By its window without the zoom, or by a zoom deeper than hiding its borders takes; a zoom that is
// not asked for has to stay near one either way.
bool ExceedsCrop(const PathSmootherOptions& options, const UpdateParameters& theta) {
  const double zoom = std::exp(theta[kZoomIndex]);
  const double deepest = options.adaptive_zoom ? options.min_crop_ratio : 1.0;
  if (!(zoom > deepest - kMaxZoomExcess) || zoom > 1.0 + kMaxZoomExcess) {
    return true;
  }
  const CropResidual crop{options.focal_ratio, 1.0, options.min_crop_ratio, options.aspect, false};
  std::array<double, CropResidual::kSize> overhang_px{};
  crop(theta.data(), overhang_px.data());
  return std::any_of(overhang_px.begin(), overhang_px.end(), [](double d) {
    return !(std::abs(d) < kMaxCropViolation * kReferenceWidthPx);
  });
}

using Limit = bool (*)(const PathSmootherOptions&, const UpdateParameters&);

// True when any open frame that was seen is beyond `limit`.
bool AnyBeyond(Limit limit, const PathSmootherOptions& options, const PathWindow& window) {
  for (std::size_t i = window.first_open(); i < window.first_guessed(); ++i) {
    if (limit(options, window[i].theta)) {
      return true;
    }
  }
  return false;
}

// Lets the path follow the camera closer around the open frames that are beyond `limit`, and begins
// anew from the camera's own path, which is within.
void RelaxAround(Limit limit, const PathSmootherOptions& options, PathWindow& window) {
  const auto reach = static_cast<std::size_t>(std::lround(0.5 * SmoothnessFrames(options)));
  std::vector<bool> relax(window.size(), false);
  for (std::size_t i = window.first_open(); i < window.size(); ++i) {
    if (limit(options, window[i].theta)) {
      const std::size_t from = std::max(window.first_open(), i - std::min(i, reach));
      const std::size_t to = std::min(window.size() - 1, i + reach);
      std::fill(relax.begin() + static_cast<std::ptrdiff_t>(from),
                relax.begin() + static_cast<std::ptrdiff_t>(to + 1), true);
    }
  }
  for (std::size_t i = window.first_open(); i < window.size(); ++i) {
    window[i].relaxation *= relax[i] ? kRelaxation : 1.0;
    window[i].theta = {};
  }
}

UpdateParameters Scaled(UpdateParameters theta, double factor) {
  for (double& value : theta) {
    value *= factor;
  }
  return theta;
}

// The last resort: shrinks the updates of all open frames alike, towards the camera's own path,
// until none is beyond a limit.
void PullInside(const PathSmootherOptions& options, PathWindow& window) {
  double share = 1.0;
  for (std::size_t i = window.first_open(); i < window.size(); ++i) {
    const auto is_fine = [&](double factor) {
      const UpdateParameters shrunk = Scaled(window[i].theta, factor);
      return !IsBent(options, shrunk) && !ExceedsCrop(options, shrunk);
    };
    if (is_fine(share)) {
      continue;
    }
    double low = 0.0;
    for (int step = 0; step < kBisections; ++step) {
      const double middle = 0.5 * (low + share);
      (is_fine(middle) ? low : share) = middle;
    }
    share = low;
  }
  for (std::size_t i = window.first_open(); i < window.size(); ++i) {
    window[i].theta = Scaled(window[i].theta, share);
  }
}

}  // namespace

Status SolvePathWithinCrop(const PathSmootherOptions& options, PathWindow& window) {
  for (std::size_t i = window.first_open(); i < window.size(); ++i) {
    window[i].relaxation = 1.0;
  }
  if (LookaheadSeconds(options) < kStrictLookaheadS) {
    return SolvePath(options, kSoftCropWeight, window);
  }
  for (int relaxed = 0;; ++relaxed) {
    double crop_weight = kCropWeight;
    bool bent = false;
    for (int i = 0; i <= kMaxCropRaises && !bent; ++i, crop_weight *= 10.0) {
      if (Status ok = SolvePath(options, crop_weight, window); !ok) {
        return ok;
      }
      bent = AnyBeyond(IsBent, options, window);
      if (!bent && !AnyBeyond(ExceedsCrop, options, window)) {
        return {};
      }
    }
    if (relaxed == kMaxRelaxations) {
      PullInside(options, window);
      return {};
    }
    RelaxAround(bent ? IsBent : ExceedsCrop, options, window);
  }
}

}  // namespace rsstab::stabilizer
