// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/pipeline/readout_from_pictures.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "igf/base/frame.h"

namespace rsstab::pipeline {
namespace {

constexpr std::size_t kMaxPictures = 48;
// Nearer frames show the same scene at the same speed.
constexpr std::int64_t kMinSpacing = 4;
// Slower pictures are not skewed enough to be worth a question, px per frame at 640 px width.
constexpr double kMinSpeed = 2.0 / 640.0;
constexpr std::size_t kMinPictures = 6;
// Candidates, frame intervals: the answers are a straight line in them.
constexpr std::array<double, 2> kCandidates = {-0.5, 1.0};
// One step and an antithetic pair of samples give the best mean for the time.
constexpr int kSteps = 1;
constexpr int kSamples = 2;
// What leaning things pretend in a whole clip, as a true skew in picture widths (5 px at 640). A
// clip in which the camera turns both ways tells it from the readout; a steady pan does not.
constexpr double kContentSkew = 0.008;
// Of which the model sees about this share, until it is known better.
constexpr double kUsualResponse = 0.07;

// The picture as if its rows had been read out with the opposite skew: every row is moved by its
// share of the motion in one readout, so that a readout of `intervals` frame intervals is undone.
stabilizer::GrayImage Unskewed(const stabilizer::GrayImage& picture,
                               const Eigen::Vector2d& velocity, double intervals) {
  stabilizer::GrayImage out = picture;
  const Eigen::Vector2d motion_px = velocity * picture.width * intervals;
  const auto at = [&](int x, int y) {
    const int cx = std::clamp(x, 0, picture.width - 1);
    const int cy = std::clamp(y, 0, picture.height - 1);
    return static_cast<double>(
        picture.pixels[static_cast<std::size_t>(cy) * static_cast<std::size_t>(picture.width) +
                       static_cast<std::size_t>(cx)]);
  };
  for (int y = 0; y < picture.height; ++y) {
    // Backward displacement G = motion * share(row of the source); one fixed-point step is exact
    // for a steady motion.
    const double share = (y + 0.5) / picture.height - 0.5;
    const double source_share = share / (1.0 - motion_px.y() / picture.height);
    const Eigen::Vector2d shift = motion_px * source_share;
    const double source_y = y + shift.y();
    const int y0 = static_cast<int>(std::floor(source_y));
    const double fy = source_y - y0;
    const int dx = static_cast<int>(std::floor(shift.x()));
    const double fx = shift.x() - dx;
    for (int x = 0; x < picture.width; ++x) {
      const double upper = (1.0 - fx) * at(x + dx, y0) + fx * at(x + dx + 1, y0);
      const double lower = (1.0 - fx) * at(x + dx, y0 + 1) + fx * at(x + dx + 1, y0 + 1);
      out.pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(picture.width) +
                 static_cast<std::size_t>(x)] =
          static_cast<std::uint8_t>(std::lround((1.0 - fy) * upper + fy * lower));
    }
  }
  return out;
}

FrameView ViewOf(const stabilizer::GrayImage& picture) {
  FrameView view;
  view.layout = GrayLayout();
  view.layout.full_range = true;
  view.width = picture.width;
  view.height = picture.height;
  view.planes[0] = {picture.pixels.data(), picture.width, picture.width, picture.height};
  return view;
}

// Motion of the picture's centre from the first row to the last, picture widths, by the
// least-squares line through the bands.
Eigen::Vector2d SkewOf(const rsdiff::RotationCurve& curve, double aspect) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  double weight = 0.0;
  const auto bands = static_cast<double>(curve.size());
  for (std::size_t b = 0; b < curve.size(); ++b) {
    const double share = (static_cast<double>(b) + 0.5) / bands - 0.5;
    sum += share * curve[b].head<2>() * aspect;
    weight += share * share;
  }
  return sum / weight;
}

// Sums of a regression of skew on velocity with a common content term, per picture, so that
// pictures can be left out.
struct Sums {
  double vv = 0.0;
  Eigen::Vector2d v = Eigen::Vector2d::Zero();
  double n = 0.0;
  std::array<double, kCandidates.size()> vs{};
  std::array<Eigen::Vector2d, kCandidates.size()> s;

  Sums() { s.fill(Eigen::Vector2d::Zero()); }

  void Add(const Sums& other, double sign) {
    vv += sign * other.vv;
    v += sign * other.v;
    n += sign * other.n;
    for (std::size_t c = 0; c < vs.size(); ++c) {
      vs[c] += sign * other.vs[c];
      s[c] += sign * other.s[c];
    }
  }

  // Sum of squared velocity that the content term leaves to the slope; that term has a Gaussian
  // prior of standard deviation `content`, `noise` is one picture's variance.
  [[nodiscard]] double Shrinkage(double noise, double content) const {
    return 1.0 / (n + noise / (content * content));
  }
  [[nodiscard]] double Leverage(double noise, double content) const {
    return std::max(vv - Shrinkage(noise, content) * v.squaredNorm(), 1e-12);
  }
  // Skew per velocity.
  [[nodiscard]] double Slope(std::size_t c, double noise, double content) const {
    return (vs[c] - Shrinkage(noise, content) * v.dot(s[c])) / Leverage(noise, content);
  }
};

struct Line {
  double response = 0.0;  // minus the slope
  double zero = 0.0;      // frame intervals
};
Line LineThrough(const std::array<double, kCandidates.size()>& slopes) {
  const auto n = static_cast<double>(kCandidates.size());
  double mean_c = 0.0;
  double mean_s = 0.0;
  for (std::size_t c = 0; c < kCandidates.size(); ++c) {
    mean_c += kCandidates[c] / n;
    mean_s += slopes[c] / n;
  }
  double cc = 0.0;
  double cs = 0.0;
  for (std::size_t c = 0; c < kCandidates.size(); ++c) {
    cc += (kCandidates[c] - mean_c) * (kCandidates[c] - mean_c);
    cs += (kCandidates[c] - mean_c) * (slopes[c] - mean_s);
  }
  const double response = -cs / cc;
  return {response, mean_c + mean_s / response};
}

}  // namespace

void ReadoutPictures::Push(stabilizer::GrayImage picture,
                           const std::optional<Eigen::Vector2d>& shift) {
  // While a frame is read out the scene moves at the mean of the speeds before and after it.
  if (last_ && shift) {
    last_->velocity = 0.5 * (last_->velocity + *shift);
    Offer(std::move(*last_));
  }
  last_.reset();
  if (shift) {
    last_ = Kept{num_frames_, *shift, std::move(picture)};
  }
  ++num_frames_;
}

void ReadoutPictures::Offer(Kept candidate) {
  const double speed = candidate.velocity.norm();
  if (!(speed >= kMinSpeed)) {
    return;
  }
  const auto near = std::find_if(kept_.begin(), kept_.end(), [&](const Kept& kept) {
    return candidate.frame - kept.frame < kMinSpacing;
  });
  const auto replaced = near != kept_.end()            ? near
                        : kept_.size() == kMaxPictures ? kept_.end() - 1
                                                       : kept_.end();
  if (replaced != kept_.end()) {
    if (replaced->velocity.norm() >= speed) {
      return;
    }
    kept_.erase(replaced);
  }
  const auto place = std::find_if(kept_.begin(), kept_.end(),
                                  [&](const Kept& kept) { return kept.velocity.norm() < speed; });
  kept_.insert(place, std::move(candidate));
}

Result<PictureReadout> ReadoutPictures::Ask(rsdiff::SingleImageEstimator& estimator,
                                            double frame_interval_s) const {
  PictureReadout result;
  result.num_pictures = kept_.size();
  result.sigma_s = std::numeric_limits<double>::infinity();
  if (kept_.size() < kMinPictures) {
    return result;
  }
  rsdiff::SamplingOptions sampling;
  sampling.steps = kSteps;
  sampling.samples = kSamples;
  std::vector<Sums> parts;
  Sums total;
  double noise = 0.0;
  for (const Kept& kept : kept_) {
    Sums part;
    part.vv = kept.velocity.squaredNorm();
    part.v = kept.velocity;
    part.n = 1.0;
    for (std::size_t c = 0; c < kCandidates.size(); ++c) {
      const stabilizer::GrayImage picture = Unskewed(kept.picture, kept.velocity, kCandidates[c]);
      const auto motion = estimator.Estimate(ViewOf(picture), sampling);
      if (!motion) {
        return Propagate(motion.error());
      }
      part.s[c] = SkewOf(motion->curve_mean, static_cast<double>(picture.height) / picture.width);
      part.vs[c] = kept.velocity.dot(part.s[c]);
      noise += part.s[c].squaredNorm() / static_cast<double>(2 * kept_.size() * kCandidates.size());
    }
    total.Add(part, 1.0);
    parts.push_back(part);
  }

  const auto slopes_of = [&](const Sums& sums) {
    std::array<double, kCandidates.size()> slopes{};
    for (std::size_t c = 0; c < kCandidates.size(); ++c) {
      slopes[c] = sums.Slope(c, noise, kContentSkew * kUsualResponse);
    }
    return slopes;
  };
  const auto slopes = slopes_of(total);
  const Line line = LineThrough(slopes);
  // Leave one picture out in turn (jackknife): pictures differ in what they show.
  const auto n = static_cast<double>(parts.size());
  double zero_variance = 0.0;
  double response_variance = 0.0;
  std::array<double, kCandidates.size()> slope_variance{};
  for (const Sums& part : parts) {
    Sums rest = total;
    rest.Add(part, -1.0);
    const auto rest_slopes = slopes_of(rest);
    const Line rest_line = LineThrough(rest_slopes);
    zero_variance += (n - 1.0) / n * std::pow(rest_line.zero - line.zero, 2);
    response_variance += (n - 1.0) / n * std::pow(rest_line.response - line.response, 2);
    for (std::size_t c = 0; c < kCandidates.size(); ++c) {
      slope_variance[c] += (n - 1.0) / n * std::pow(rest_slopes[c] - slopes[c], 2);
    }
  }
  result.response = line.response;
  result.readout_s = line.zero * frame_interval_s;
  // A response that may as well be none has no zero to speak of.
  if (line.response > 3.0 * std::sqrt(response_variance)) {
    // What all pictures share does not show when one is left out.
    double unexplained = noise;
    for (std::size_t c = 0; c < kCandidates.size(); ++c) {
      unexplained -= slopes[c] * total.vs[c] / (2.0 * n * static_cast<double>(kCandidates.size()));
    }
    unexplained = std::max(unexplained, 0.0);
    const double shared_variance = unexplained /
                                   total.Leverage(unexplained, kContentSkew * line.response) /
                                   (line.response * line.response);
    result.sigma_s = std::sqrt(std::max(zero_variance, shared_variance)) * frame_interval_s;
  }
  for (std::size_t c = 0; c < kCandidates.size(); ++c) {
    result.curve.push_back(
        {kCandidates[c] * frame_interval_s, slopes[c], std::sqrt(slope_variance[c])});
  }
  return result;
}

}  // namespace rsstab::pipeline
