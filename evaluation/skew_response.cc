// SPDX-License-Identifier: Apache-2.0
#include "evaluation/skew_response.h"

#include <cstddef>
#include <utility>

#include "evaluation/correction_score.h"
#include "evaluation/exposure.h"
#include "evaluation/synthetic_sample.h"

namespace rsstab::evaluation {
namespace {

// A tenth more than the 800x600 that the method sees: the largest displacement is 20 px.
constexpr int kMarginX = kSyntheticWidth / 20;
constexpr int kMarginY = kSyntheticHeight / 20;
constexpr double kFocalPx = kSyntheticWidth;

Camera SeenCamera() { return Camera::Pinhole(kSyntheticWidth, kSyntheticHeight, kFocalPx); }

Camera RecordedCamera() {
  return Camera::Pinhole(kSyntheticWidth + 2 * kMarginX, kSyntheticHeight + 2 * kMarginY, kFocalPx);
}

// The middle of a packed RGB picture, without copying.
FrameView Middle(const Frame& picture) {
  FrameView view = picture.View();
  PlaneView& plane = view.planes[0];
  plane.data += kMarginY * plane.stride + std::ptrdiff_t{3} * kMarginX;
  plane.width = view.width = kSyntheticWidth;
  plane.height = view.height = kSyntheticHeight;
  return view;
}

Result<double> PredictedSkew(const FrameView& picture, const Camera& camera,
                             const ReadoutCurve& motion, std::uint64_t seed, MotionMethod& method) {
  MethodInput input;
  input.rs = picture;
  input.seed = seed;
  input.camera = &camera;
  input.motion = &motion;
  const auto answer = method.Estimate(input);
  if (!answer) {
    return Propagate(answer.error());
  }
  return SkewOf(answer->field);
}

Result<SkewAnswer> AskOnce(const FrameView& photo, const ReadoutCurve& curve, double factor,
                           MotionMethod& method, std::uint64_t seed, WorkerPool& workers) {
  const Camera seen = SeenCamera();
  const Camera recorded = RecordedCamera();
  ExposureOptions exposure;
  exposure.noise_seed = seed;
  // A steady turn moves by the same angle from row to row, however many rows there are.
  const auto pair = Expose(photo, recorded, curve, exposure);
  const auto recorded_field = TruthField(curve, recorded);
  const auto seen_field = TruthField(curve, seen);
  if (!pair || !recorded_field || !seen_field) {
    return Propagate(!pair             ? pair.error()
                     : !recorded_field ? recorded_field.error()
                                       : seen_field.error());
  }
  const auto corrected = CorrectPicture(pair->rs.View(), *recorded_field, workers);
  if (!corrected) {
    return Propagate(corrected.error());
  }
  const auto predicted = PredictedSkew(Middle(pair->rs), seen, curve, seed, method);
  if (!predicted) {
    return Propagate(predicted.error());
  }
  const auto remainder =
      PredictedSkew(Middle(corrected->picture), seen, ReadoutCurve(), seed, method);
  if (!remainder) {
    return Propagate(remainder.error());
  }
  return SkewAnswer{factor, SkewOf(*seen_field), *predicted, *remainder};
}

// Slopes of the photographs that were drawn.
struct Slopes {
  LineFit predicted;
  LineFit remainder;

  [[nodiscard]] double ZeroCrossing() const { return 1.0 + remainder.slope / predicted.slope; }
};

Slopes FitSlopes(std::span<const std::vector<SkewAnswer>> by_photo,
                 std::span<const std::size_t> photos) {
  std::vector<double> truth;
  std::vector<double> predicted;
  std::vector<double> remainder;
  for (const std::size_t photo : photos) {
    for (const SkewAnswer& answer : by_photo[photo]) {
      truth.push_back(answer.true_px);
      predicted.push_back(answer.predicted_px);
      remainder.push_back(answer.remainder_px);
    }
  }
  return {FitLine(truth, predicted), FitLine(truth, remainder)};
}

template <typename Value>
std::vector<double> Gather(std::span<const std::vector<SkewAnswer>> by_photo, std::size_t level,
                           Value value) {
  std::vector<double> values;
  for (const std::vector<SkewAnswer>& answers : by_photo) {
    values.push_back(answers[level].*value);
  }
  return values;
}

}  // namespace

double SkewOf(const MotionField& field) {
  std::vector<double> row;
  std::vector<double> across;
  for (int j = 0; j < field.rows(); ++j) {
    for (int i = 0; i < field.columns(); ++i) {
      row.push_back(field.VertexPosition(i, j).y());
      across.push_back(static_cast<double>(field.At(i, j).x()));
    }
  }
  return FitLine(row, across).slope * (field.height() - 1);
}

Result<std::vector<SkewAnswer>> AskForSkew(const FrameView& photo, MotionMethod& method,
                                           std::uint64_t seed, WorkerPool& workers) {
  ReadoutCurve unit;
  unit.steady.x() = 1.0;
  if (Status status = ScaleToMeanLength(unit, SeenCamera(), kUnitSkewMeanPx); !status) {
    return Propagate(status.error());
  }
  std::vector<SkewAnswer> answers;
  for (const double factor : kSkewFactors) {
    ReadoutCurve curve = unit;
    curve.strength *= factor;
    auto answer = AskOnce(photo, curve, factor, method, seed, workers);
    if (!answer) {
      return Propagate(answer.error());
    }
    answers.push_back(*answer);
  }
  return answers;
}

SkewResponse SummariseSkew(std::span<const std::vector<SkewAnswer>> by_photo, std::uint64_t seed) {
  SkewResponse response;
  response.photos = static_cast<int>(by_photo.size());
  if (by_photo.empty()) {
    return response;
  }
  std::vector<double> level_truth;
  std::vector<double> level_predicted;
  for (std::size_t level = 0; level < by_photo.front().size(); ++level) {
    const auto predicted = Gather(by_photo, level, &SkewAnswer::predicted_px);
    const auto remainder = Gather(by_photo, level, &SkewAnswer::remainder_px);
    SkewLevel summary;
    summary.factor = by_photo.front()[level].factor;
    summary.true_px = Mean(Gather(by_photo, level, &SkewAnswer::true_px));
    summary.predicted_px = Mean(predicted);
    summary.predicted_error_px = StandardError(predicted);
    summary.remainder_px = Mean(remainder);
    summary.remainder_error_px = StandardError(remainder);
    level_truth.push_back(summary.true_px);
    level_predicted.push_back(summary.predicted_px);
    response.levels.push_back(summary);
  }
  response.linearity = FitLine(level_truth, level_predicted).r_squared;

  std::vector<std::size_t> all(by_photo.size());
  std::vector<double> photo_remainders;
  for (std::size_t photo = 0; photo < by_photo.size(); ++photo) {
    all[photo] = photo;
    double sum = 0.0;
    for (const SkewAnswer& answer : by_photo[photo]) {
      sum += answer.remainder_px;
    }
    photo_remainders.push_back(sum / static_cast<double>(by_photo[photo].size()));
  }
  response.remainder_px = Mean(photo_remainders);
  response.remainder_error_px = StandardError(photo_remainders);
  const Slopes slopes = FitSlopes(by_photo, all);
  response.fit = slopes.predicted;
  response.remainder_slope = slopes.remainder.slope;
  response.zero_crossing = slopes.ZeroCrossing();
  response.slope_interval = BootstrapInterval(
      by_photo.size(),
      [&](std::span<const std::size_t> drawn) {
        return FitSlopes(by_photo, drawn).predicted.slope;
      },
      seed);
  response.zero_crossing_interval = BootstrapInterval(
      by_photo.size(),
      [&](std::span<const std::size_t> drawn) { return FitSlopes(by_photo, drawn).ZeroCrossing(); },
      seed);
  return response;
}

}  // namespace rsstab::evaluation
