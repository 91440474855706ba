// SPDX-License-Identifier: Apache-2.0
#include "igf/sample_clock.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>

namespace rsstab::igf {
namespace {

// Marks farther from the line than this many robust standard deviations are left out; jitter of
// packets is bounded, so honest marks stay well inside.
constexpr double kOutlierSigmas = 4.0;
constexpr double kSigmaPerMad = 1.4826;  // of a normal distribution

struct Line {
  double origin = 0.0;  // sample at which the line passes through time_s
  double time_s = 0.0;
  double interval_s = 0.0;

  [[nodiscard]] double TimeOf(double sample) const {
    return time_s + (sample - origin) * interval_s;
  }
};

double Median(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Theil-Sen, then least squares over the inliers. Empty when time does not increase.
std::optional<Line> FitLine(std::span<const ClockMark> marks) {
  std::vector<double> slopes;
  slopes.reserve(marks.size() * (marks.size() - 1) / 2);
  for (std::size_t i = 0; i < marks.size(); ++i) {
    for (std::size_t j = i + 1; j < marks.size(); ++j) {
      slopes.push_back((marks[j].time_s - marks[i].time_s) / (marks[j].sample - marks[i].sample));
    }
  }
  Line line;
  line.interval_s = Median(slopes);
  line.origin = marks.front().sample;
  std::vector<double> residuals(marks.size());
  for (std::size_t i = 0; i < marks.size(); ++i) {
    residuals[i] = marks[i].time_s - (marks[i].sample - line.origin) * line.interval_s;
  }
  std::vector<double> scratch = residuals;
  line.time_s = Median(scratch);
  for (std::size_t i = 0; i < marks.size(); ++i) {
    residuals[i] -= line.time_s;
    scratch[i] = std::abs(residuals[i]);
  }
  const double limit_s =
      std::max(kOutlierSigmas * kSigmaPerMad * Median(scratch), std::abs(line.interval_s));

  double count = 0.0;
  double mean_sample = 0.0;
  double mean_time = 0.0;
  for (std::size_t i = 0; i < marks.size(); ++i) {
    if (std::abs(residuals[i]) <= limit_s) {
      count += 1.0;
      mean_sample += (marks[i].sample - mean_sample) / count;
      mean_time += (marks[i].time_s - mean_time) / count;
    }
  }
  double covariance = 0.0;
  double variance = 0.0;
  for (std::size_t i = 0; i < marks.size(); ++i) {
    if (std::abs(residuals[i]) <= limit_s) {
      const double d = marks[i].sample - mean_sample;
      covariance += d * (marks[i].time_s - mean_time);
      variance += d * d;
    }
  }
  if (variance > 0.0) {
    line = {mean_sample, mean_time, covariance / variance};
  }
  if (!(std::isfinite(line.interval_s) && std::isfinite(line.time_s) && line.interval_s > 0.0)) {
    return std::nullopt;
  }
  return line;
}

}  // namespace

Result<SampleClock> SampleClock::Fit(std::span<const ClockMark> marks) {
  if (marks.size() < 2) {
    return Fail(ErrorCode::kCorruptData, "{} time marks; two are needed to tell a sampling rate",
                marks.size());
  }
  for (std::size_t i = 0; i < marks.size(); ++i) {
    if (!std::isfinite(marks[i].time_s) || !std::isfinite(marks[i].sample) ||
        (i > 0 && marks[i].sample <= marks[i - 1].sample)) {
      return Fail(ErrorCode::kCorruptData,
                  "time mark {} is not a finite number or its sample count does not increase", i);
    }
  }
  SampleClock clock;
  const std::size_t count = marks.size();
  const std::size_t window = kWindow;
  if (count <= 2 * window + 1) {
    const std::optional<Line> line = FitLine(marks);
    if (!line) {
      return Fail(ErrorCode::kCorruptData, "the times of the {} marks do not increase", count);
    }
    return Even(line->TimeOf(0.0), line->interval_s);
  }
  // A knot every half window is enough: the rate changes over minutes.
  for (std::size_t i = 0;; i = std::min(i + window / 2, count - 1)) {
    const std::size_t begin = std::min(i > window ? i - window : 0, count - 2 * window - 1);
    const std::optional<Line> line = FitLine(marks.subspan(begin, 2 * window + 1));
    if (!line) {
      return Fail(ErrorCode::kCorruptData, "the times near mark {} do not increase", i);
    }
    const ClockMark knot{marks[i].sample, line->TimeOf(marks[i].sample)};
    if (!clock.knots_.empty() && knot.time_s <= clock.knots_.back().time_s) {
      return Fail(ErrorCode::kCorruptData, "the times near mark {} run backwards", i);
    }
    clock.knots_.push_back(knot);
    if (i == count - 1) {
      return clock;
    }
  }
}

SampleClock SampleClock::Even(double start_s, double interval_s) {
  SampleClock clock;
  clock.knots_ = {{0.0, start_s}, {1.0, start_s + interval_s}};
  return clock;
}

double SampleClock::TimeOf(double sample) const {
  auto right = std::upper_bound(knots_.begin() + 1, knots_.end() - 1, sample,
                                [](double s, const ClockMark& knot) { return s < knot.sample; });
  const ClockMark& b = *right;
  const ClockMark& a = *(right - 1);
  return a.time_s + (sample - a.sample) * ((b.time_s - a.time_s) / (b.sample - a.sample));
}

void SampleClock::Shift(double offset_s) {
  for (ClockMark& knot : knots_) {
    knot.time_s += offset_s;
  }
}

}  // namespace rsstab::igf
