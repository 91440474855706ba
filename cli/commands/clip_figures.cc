// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/clip_figures.h"

#include <algorithm>
#include <limits>
#include <optional>

namespace rsstab::cli {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr double kPercent = 100.0;
constexpr double kMilli = 1e3;

template <typename Part, typename Value>
std::function<double(const ClipRun&)> Of(Part ClipRun::*part, Value member, double scale = 1.0) {
  return [=](const ClipRun& run) {
    if (!(run.*part)) {
      return kNone;
    }
    const std::optional<double> value = (*(run.*part)).*member;
    return value ? scale * *value : kNone;
  };
}

std::function<double(const ClipRun&)> OfClip(
    std::optional<double> stabilizer::ClipMetrics::*member) {
  return [=](const ClipRun& run) { return (run.clip.metrics.*member).value_or(kNone); };
}

std::function<double(const ClipRun&)> OfTruth(
    std::optional<double> stabilizer::TruthMetrics::*member) {
  return [=](const ClipRun& run) {
    return run.clip.truth ? ((*run.clip.truth).*member).value_or(kNone) : kNone;
  };
}

std::function<double(const ClipRun&)> OfRun(std::optional<double> ClipRun::*member,
                                            double scale = 1.0) {
  return [=](const ClipRun& run) { return run.*member ? scale * *(run.*member) : kNone; };
}

}  // namespace

const std::vector<ClipFigure>& ClipFigures() {
  using Clip = stabilizer::ClipMetrics;
  using Pair = stabilizer::PairMetrics;
  using Truth = stabilizer::TruthMetrics;
  using Score = evaluation::RsFieldScore;
  using Angle = evaluation::PathAngleScore;
  using enum ClipFigure::Shown;
  static const std::vector<ClipFigure> figures = {
      {"wobble_px", "wobble", 8, 3, kAlways, OfClip(&Clip::wobble)},
      {"row_wobble_px", "row w.", 8, 3, kAlways, OfClip(&Clip::row_wobble)},
      {"jitter_px", "jitter", 7, 2, kAlways, OfClip(&Clip::jitter)},
      {"shake_px", "shake", 7, 2, kAlways, OfClip(&Clip::shake)},
      {"stability", "stability", 0, 3, kInFiles, OfClip(&Clip::stability)},
      {"stability_translation", "stab t", 8, 3, kAlways, OfClip(&Clip::stability_move)},
      {"stability_rotation", "stab r", 7, 3, kAlways, OfClip(&Clip::stability_turn)},
      {"crop_ratio", "crop", 7, 3, kAlways, Of(&ClipRun::pair, &Pair::crop)},
      {"smallest_crop_ratio", "smallest crop", 0, 3, kInFiles,
       Of(&ClipRun::pair, &Pair::smallest_crop)},
      {"distortion_value", "distort", 8, 3, kAlways, Of(&ClipRun::pair, &Pair::distortion)},
      {"undefined_percent", "undef%", 7, 2, kAlways,
       Of(&ClipRun::pair, &Pair::undefined, kPercent)},
      {"worst_undefined_percent", "worst undef%", 0, 2, kInFiles,
       Of(&ClipRun::pair, &Pair::worst_undefined, kPercent)},
      {"itf_db", "ITF", 7, 2, kAlways, OfClip(&Clip::itf_db)},
      {"rs_field_px", "RS", 7, 2, kAlways, Of(&ClipRun::field, &Score::applied_px)},
      {"readout_ms", "readout", 8, 1, kAlways, OfRun(&ClipRun::readout_s, kMilli)},
      {"camera_residual_px", "residual", 9, 3, kWhereKnown, OfTruth(&Truth::camera_residual)},
      {"worst_frame_px", "worst", 7, 2, kWhereKnown, OfTruth(&Truth::worst_frame)},
      {"bend_px", "bend", 7, 3, kWhereKnown, OfTruth(&Truth::bend)},
      {"rs_epe_px", "EPE", 7, 3, kWhereKnown, Of(&ClipRun::field, &Score::epe_px)},
      {"rs_epe_uncorrected_px", "EPE in", 7, 3, kWhereKnown,
       Of(&ClipRun::field, &Score::uncorrected_epe_px)},
      {"path_angle_deg", "angle", 8, 3, kWhereKnown, Of(&ClipRun::angle, &Angle::angle_deg)},
      {"path_angle_uncorrected_deg", "angle in", 9, 2, kWhereKnown,
       Of(&ClipRun::angle, &Angle::uncorrected_angle_deg)},
      {"path_rate_deg_s", "rate", 7, 2, kWhereKnown, Of(&ClipRun::angle, &Angle::rate_deg_s)},
      {"path_rate_uncorrected_deg_s", "rate in", 8, 2, kWhereKnown,
       Of(&ClipRun::angle, &Angle::uncorrected_rate_deg_s)},
      {"path_known_percent", "path known%", 0, 1, kInFiles,
       Of(&ClipRun::angle, &Angle::known_share, kPercent)},
      {"analysis_ms", "analysis", 9, 1, kAlways, OfRun(&ClipRun::analysis_ms)},
      {"render_ms", "render", 7, 1, kAlways, OfRun(&ClipRun::render_ms)},
      {"total_ms", "total", 7, 1, kAlways, OfRun(&ClipRun::total_ms)},
      {"own_ms", "own ms", 8, 1, kAlways, OfRun(&ClipRun::own_ms)},
  };
  return figures;
}

std::vector<const ClipFigure*> TableFigures(ClipKind kind,
                                            const std::vector<const ClipRun*>& runs) {
  const auto is_known = [&runs](const ClipFigure& figure) {
    return std::any_of(runs.begin(), runs.end(), [&figure](const ClipRun* run) {
      const double value = figure.get(*run);
      return value == value;
    });
  };
  std::vector<const ClipFigure*> shown;
  for (const ClipFigure& figure : ClipFigures()) {
    if (figure.shown == ClipFigure::Shown::kAlways ||
        (figure.shown == ClipFigure::Shown::kWhereKnown &&
         (kind != ClipKind::kReal || is_known(figure)))) {
      shown.push_back(&figure);
    }
  }
  return shown;
}

}  // namespace rsstab::cli
