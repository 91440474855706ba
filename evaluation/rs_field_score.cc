// SPDX-License-Identifier: Apache-2.0
#include "evaluation/rs_field_score.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "igf/intra_gyro_field.h"
#include "stabilizer/analysis_file.h"
#include "stabilizer/metrics/field_metrics.h"

namespace rsstab::evaluation {
namespace {

constexpr double kStatedWidth = 640.0;
// Fields are smooth between their vertices (17 x 65 of the truth): as many pixels tell the mean.
constexpr int kJudgedWidth = 160;

// Which pixels of the corrected picture were recorded at all.
std::vector<std::uint8_t> RecordedPixels(const MotionField& truth) {
  std::vector<std::uint8_t> recorded;
  recorded.reserve(static_cast<std::size_t>(truth.width()) *
                   static_cast<std::size_t>(truth.height()));
  for (int y = 0; y < truth.height(); ++y) {
    for (int x = 0; x < truth.width(); ++x) {
      const Eigen::Vector2d pixel(x, y);
      const Eigen::Vector2d source = pixel + truth.Sample(pixel);
      recorded.push_back(source.x() >= 0.0 && source.x() <= truth.width() - 1 &&
                                 source.y() >= 0.0 && source.y() <= truth.height() - 1
                             ? 1
                             : 0);
    }
  }
  return recorded;
}

struct FrameErrors {
  double epe_px = 0.0;
  double uncorrected_px = 0.0;
};

// px of kJudgedWidth.
Result<FrameErrors> CompareWithTruth(const MotionField& field, const MotionField& exact) {
  const int height = std::max(2, static_cast<int>(std::lround(static_cast<double>(kJudgedWidth) *
                                                              exact.height() / exact.width())));
  const MotionField truth = exact.Rescaled(kJudgedWidth, height);
  const MotionField zero(kJudgedWidth, height, 2, 2);
  const std::vector<std::uint8_t> recorded = RecordedPixels(truth);
  const auto left = stabilizer::EndPointError(field.width() > 0 ? field : zero, truth, recorded);
  const auto uncorrected = stabilizer::EndPointError(zero, truth, recorded);
  if (!left || !uncorrected) {
    return Propagate(left ? uncorrected.error() : left.error());
  }
  return FrameErrors{*left, *uncorrected};
}

}  // namespace

Result<RsFieldScore> ScoreRsFields(const std::string& analysis_file,
                                   const igf::SimulationTruth* truth) {
  const auto reader = stabilizer::AnalysisReader::Open(analysis_file);
  if (!reader) {
    return Propagate(reader.error());
  }
  const stabilizer::ClipAnalysis& clip = (*reader)->clip();
  if (truth != nullptr &&
      static_cast<std::int64_t>(truth->frame_times_s.size()) != clip.num_frames) {
    return Fail(ErrorCode::kInvalidArgument,
                "{}: {} frames were analysed, but the truth tells of {}: it belongs to another "
                "clip.",
                analysis_file, clip.num_frames, truth->frame_times_s.size());
  }
  RsFieldScore score;
  double squares = 0.0;
  FrameErrors sum;
  while (true) {
    const auto frame = (*reader)->Next();
    if (!frame) {
      return Propagate(frame.error());
    }
    if (!*frame) {
      break;
    }
    const MotionField& field = (*frame)->rs_field;
    if (field.width() > 0) {
      const double rms = field.RmsLength() * kStatedWidth / field.width();
      squares += rms * rms;
    }
    if (truth != nullptr) {
      const auto exact = igf::ComputeIntraGyroField(
          truth->camera.Rescaled(clip.width, clip.height), truth->orientation,
          truth->frame_times_s[static_cast<std::size_t>(score.frames)],
          truth->camera.readout_s.value_or(0.0));
      if (!exact) {
        return Propagate(exact.error());
      }
      const auto errors = CompareWithTruth(field, *exact);
      if (!errors) {
        return Propagate(errors.error());
      }
      sum.epe_px += errors->epe_px;
      sum.uncorrected_px += errors->uncorrected_px;
    }
    ++score.frames;
  }
  if (score.frames == 0) {
    return score;
  }
  const double frames = static_cast<double>(score.frames);
  score.applied_px = std::sqrt(squares / frames);
  if (truth != nullptr) {
    const double scale = kStatedWidth / kJudgedWidth / frames;
    score.epe_px = sum.epe_px * scale;
    score.uncorrected_epe_px = sum.uncorrected_px * scale;
  }
  return score;
}

}  // namespace rsstab::evaluation
