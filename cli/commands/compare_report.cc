// SPDX-License-Identifier: Apache-2.0
#include <spdlog/fmt/fmt.h>

#include <nlohmann/json.hpp>

#include "cli/commands/compare.h"

namespace rsstab::cli {
namespace {

using Json = nlohmann::ordered_json;
using Figure = std::optional<double>;

constexpr double kPercent = 100.0;

Json OrNull(const Figure& figure) { return figure ? Json(*figure) : Json(nullptr); }

Json ClipJson(const CompareReport::Clip& clip) {
  const stabilizer::ClipMetrics& m = clip.metrics;
  Json json;
  json["path"] = clip.path;
  json["width"] = clip.width;
  json["height"] = clip.height;
  json["frames_per_second"] = clip.frames_per_second;
  json["frames"] = m.frames;
  json["unmeasured_motions"] = m.unmeasured_motions;
  json["tracks_per_frame"] = m.tracks_per_frame;
  json["wobble_px"] = OrNull(m.wobble);
  json["row_wobble_px"] = OrNull(m.row_wobble);
  json["jitter_px"] = OrNull(m.jitter);
  json["shake_px"] = OrNull(m.shake);
  json["stability"] = OrNull(m.stability);
  json["stability_translation"] = OrNull(m.stability_move);
  json["stability_rotation"] = OrNull(m.stability_turn);
  json["itf_db"] = OrNull(m.itf_db);
  if (clip.truth) {
    json["truth"] = {{"frames", clip.truth->frames},
                     {"unaligned", clip.truth->unaligned},
                     {"matches_per_frame", clip.truth->matches_per_frame},
                     {"camera_residual_px", OrNull(clip.truth->camera_residual)},
                     {"worst_frame_px", OrNull(clip.truth->worst_frame)},
                     {"bend_px", OrNull(clip.truth->bend)}};
  }
  return json;
}

std::string Cell(const Figure& figure, int digits) {
  return figure ? fmt::format("{:>10.{}f}", *figure, digits) : fmt::format("{:>10}", "-");
}

std::string Row(const CompareFigure& figure) {
  return fmt::format("{:<24}{:<4}{}{}\n", figure.name, figure.unit,
                     Cell(figure.input, figure.digits), Cell(figure.output, figure.digits));
}

Figure Percent(const Figure& share) { return share ? Figure(*share * kPercent) : std::nullopt; }

}  // namespace

std::vector<CompareFigure> CompareFigures(const CompareReport& report) {
  const stabilizer::ClipMetrics& in = report.input.metrics;
  const stabilizer::ClipMetrics& out = report.output.metrics;
  const stabilizer::PairMetrics& pair = report.pair;
  std::vector<CompareFigure> figures = {
      {"wobble", "px", in.wobble, out.wobble, 3, Better::kLower,
       "what moves against the rest of the picture"},
      {"row wobble", "px", in.row_wobble, out.row_wobble, 3, Better::kLower,
       "its part common to rows: rolling shutter"},
      {"jitter", "px", in.jitter, out.jitter, 2, Better::kLower,
       "change of the motion from frame to frame"},
      {"shake", "px", in.shake, out.shake, 2, Better::kLower, "path less its mean over 0.25 s"},
      {"stability, translation", "", in.stability_move, out.stability_move, 3, Better::kHigher,
       "share of slow movement in the path, 1 = steady"},
      {"stability, rotation", "", in.stability_turn, out.stability_turn, 3, Better::kHigher,
       "the same of its rotation"},
      {"ITF", "dB", in.itf_db, out.itf_db, 2, Better::kHigher, "PSNR between consecutive frames"}};
  if (report.input.truth && report.output.truth) {
    const stabilizer::TruthMetrics& in_truth = *report.input.truth;
    const stabilizer::TruthMetrics& out_truth = *report.output.truth;
    figures.insert(figures.end(),
                   {{"camera residual", "px", in_truth.camera_residual, out_truth.camera_residual,
                     3, Better::kLower, "distance from what a global shutter would have seen"},
                    {"  its worst frame", "px", in_truth.worst_frame, out_truth.worst_frame, 3,
                     Better::kLower, ""},
                    {"bend", "px", in_truth.bend, out_truth.bend, 3, Better::kLower,
                     "the same after the best homography"}});
  }
  figures.insert(
      figures.end(),
      {{"crop ratio", "", 1.0, pair.crop, 3, Better::kNeither, "share of a side that was kept"},
       {"  its smallest", "", 1.0, pair.smallest_crop, 3, Better::kNeither, ""},
       {"distortion value", "", 1.0, pair.distortion, 3, Better::kNeither,
        "1 = no frame stretched or sheared"},
       {"undefined pixels", "%", 0.0, Percent(pair.undefined), 3, Better::kNeither,
        "without a source in the input"},
       {"  in the worst frame", "%", 0.0, Percent(pair.worst_undefined), 3, Better::kNeither, ""}});
  return figures;
}

std::string FormatCompareJson(const CompareReport& report) {
  const stabilizer::PairMetrics& pair = report.pair;
  Json json;
  json["input"] = ClipJson(report.input);
  json["output"] = ClipJson(report.output);
  json["pair"] = {{"frames", pair.frames},
                  {"unaligned", pair.unaligned},
                  {"crop_ratio", OrNull(pair.crop)},
                  {"smallest_crop_ratio", OrNull(pair.smallest_crop)},
                  {"distortion_value", OrNull(pair.distortion)},
                  {"undefined_share", OrNull(pair.undefined)},
                  {"worst_undefined_share", OrNull(pair.worst_undefined)}};
  // Paths need not be UTF-8.
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string FormatCompareText(const CompareReport& report) {
  const stabilizer::ClipMetrics& in = report.input.metrics;
  const stabilizer::ClipMetrics& out = report.output.metrics;
  const stabilizer::PairMetrics& pair = report.pair;
  std::string text =
      fmt::format("in   {}, {}x{}, {} frames\nout  {}, {}x{}, {} frames\n\n", report.input.path,
                  report.input.width, report.input.height, in.frames, report.output.path,
                  report.output.width, report.output.height, out.frames);
  text += fmt::format("{:<24}{:<4}{:>10}{:>10}\n", "", "", "in", "out");
  for (const CompareFigure& figure : CompareFigures(report)) {
    text += Row(figure);
  }
  text += "\npx at 640 px width";
  if (pair.unaligned > 0) {
    text += fmt::format("; {} of {} frames could not be matched between the clips and are left out",
                        pair.unaligned, pair.frames);
  }
  if (in.unmeasured_motions + out.unmeasured_motions > 0) {
    text += fmt::format("; motion could not be measured {} times in the input, {} in the output",
                        in.unmeasured_motions, out.unmeasured_motions);
  }
  return text + "\n";
}

}  // namespace rsstab::cli
