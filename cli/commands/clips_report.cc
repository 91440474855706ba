// SPDX-License-Identifier: Apache-2.0
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "cli/commands/evaluate_clips.h"
#include "cli/commands/evaluate_report_detail.h"

namespace rsstab::cli {
namespace {

using detail::Cell;
using detail::Field;
using detail::HeaderJson;
using detail::HeaderText;
using detail::Json;
using detail::OrNull;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr double kPercent = 100.0;
constexpr double kMilli = 1e3;

enum class Shown {
  kAlways,     // in every table
  kWithTruth,  // in the tables of simulated clips and twins
  kInFiles,    // in JSON and CSV only
};

// A figure of a run, as all three forms of the report know it.
struct Figure {
  const char* key;    // of JSON and CSV, units last
  const char* title;  // of the table
  int width;
  int digits;
  Shown shown;
  std::function<double(const ClipRun& run)> get;
};

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

const std::vector<Figure>& Figures() {
  using Clip = stabilizer::ClipMetrics;
  using Pair = stabilizer::PairMetrics;
  using Truth = stabilizer::TruthMetrics;
  using Score = evaluation::RsFieldScore;
  using enum Shown;
  static const std::vector<Figure> figures = {
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
      {"camera_residual_px", "residual", 9, 3, kWithTruth, OfTruth(&Truth::camera_residual)},
      {"worst_frame_px", "worst", 7, 2, kWithTruth, OfTruth(&Truth::worst_frame)},
      {"bend_px", "bend", 7, 3, kWithTruth, OfTruth(&Truth::bend)},
      {"rs_epe_px", "EPE", 7, 3, kWithTruth, Of(&ClipRun::field, &Score::epe_px)},
      {"rs_epe_uncorrected_px", "EPE in", 7, 3, kWithTruth,
       Of(&ClipRun::field, &Score::uncorrected_epe_px)},
      {"analysis_ms", "analysis", 9, 1, kAlways, OfRun(&ClipRun::analysis_ms)},
      {"render_ms", "render", 7, 1, kAlways, OfRun(&ClipRun::render_ms)},
      {"total_ms", "total", 7, 1, kAlways, OfRun(&ClipRun::total_ms)},
      {"own_ms", "own ms", 8, 1, kAlways, OfRun(&ClipRun::own_ms)},
  };
  return figures;
}

// Column of the names.
int NameWidth(const ClipsReport& report) {
  std::size_t width = 8;
  for (const std::string& method : report.methods) {
    width = std::max(width, method.size());
  }
  return static_cast<int>(width);
}

bool IsInTable(const Figure& figure, ClipKind kind) {
  return figure.shown == Shown::kAlways ||
         (figure.shown == Shown::kWithTruth && kind != ClipKind::kReal);
}

std::string TableHead(ClipKind kind, int name_width) {
  std::string text = fmt::format("{:<{}}", "method", name_width);
  for (const Figure& figure : Figures()) {
    if (IsInTable(figure, kind)) {
      text += fmt::format("{:>{}}", figure.title, figure.width);
    }
  }
  return text + "\n";
}

std::string TableRow(const std::string& name, ClipKind kind, int name_width,
                     const std::function<double(const Figure&)>& value) {
  std::string text = fmt::format("{:<{}}", name, name_width);
  for (const Figure& figure : Figures()) {
    if (IsInTable(figure, kind)) {
      text += Cell(value(figure), figure.width, figure.digits);
    }
  }
  return text + "\n";
}

std::string ClipTitle(const ClipRecord& clip) {
  std::string text = fmt::format("\n{}: {}", clip.name, ClipKindName(clip.kind));
  if (clip.readout_s) {
    text += fmt::format(", readout {:.1f} ms", kMilli * *clip.readout_s);
  }
  if (!clip.runs.empty()) {
    const CompareReport::Clip& first = clip.runs.front().clip;
    text += fmt::format(", {}x{}, {} frames", first.width, first.height, first.metrics.frames);
  }
  if (clip.decode_ms && clip.recode_ms) {
    text += fmt::format(", decode {:.1f} ms, decode and encode {:.1f} ms", *clip.decode_ms,
                        *clip.recode_ms);
  }
  return text + "\n";
}

// The runs of one method on the clips of one kind.
std::vector<const ClipRun*> RunsOf(const ClipsReport& report, const std::string& method,
                                   ClipKind kind) {
  std::vector<const ClipRun*> runs;
  for (const ClipRecord& clip : report.clips) {
    for (const ClipRun& run : clip.runs) {
      if (clip.kind == kind && run.method == method) {
        runs.push_back(&run);
      }
    }
  }
  return runs;
}

// Over the runs that have the figure.
double MeanOf(const std::vector<const ClipRun*>& runs, const Figure& figure) {
  double sum = 0.0;
  int count = 0;
  for (const ClipRun* run : runs) {
    if (const double value = figure.get(*run); value == value) {
      sum += value;
      ++count;
    }
  }
  return count > 0 ? sum / count : kNone;
}

constexpr std::array<ClipKind, 3> kKinds = {ClipKind::kReal, ClipKind::kSimulated, ClipKind::kTwin};

std::string MeansText(const ClipsReport& report, int name_width) {
  std::string text;
  for (const ClipKind kind : kKinds) {
    const auto clips = std::count_if(report.clips.begin(), report.clips.end(),
                                     [&](const ClipRecord& clip) { return clip.kind == kind; });
    if (clips < 2) {
      continue;
    }
    text += fmt::format("\nmean of {} {} clips\n", clips, ClipKindName(kind)) +
            TableHead(kind, name_width);
    for (const std::string& method : report.methods) {
      if (const auto runs = RunsOf(report, method, kind); !runs.empty()) {
        text += TableRow(method, kind, name_width,
                         [&](const Figure& figure) { return MeanOf(runs, figure); });
      }
    }
  }
  return text;
}

report::Table EmptyTable(std::string caption, ClipKind kind) {
  report::Table table;
  table.caption = std::move(caption);
  table.headings = {"method"};
  for (const Figure& figure : Figures()) {
    if (IsInTable(figure, kind)) {
      table.headings.push_back(figure.title);
    }
  }
  return table;
}

void AddRow(const std::string& name, ClipKind kind,
            const std::function<double(const Figure&)>& value, report::Table& table) {
  std::vector<report::TableCell> row = {{name}};
  for (const Figure& figure : Figures()) {
    if (IsInTable(figure, kind)) {
      row.push_back({Cell(value(figure), 0, figure.digits)});
    }
  }
  table.rows.push_back(std::move(row));
}

Json FiguresJson(const std::function<double(const Figure&)>& value) {
  Json json = Json::object();
  for (const Figure& figure : Figures()) {
    json[figure.key] = OrNull(value(figure));
  }
  return json;
}

Json RunJson(const ClipRun& run) {
  Json json = FiguresJson([&](const Figure& figure) { return figure.get(run); });
  json["width"] = run.clip.width;
  json["height"] = run.clip.height;
  json["frames"] = run.clip.metrics.frames;
  json["frames_per_second"] = run.clip.frames_per_second;
  json["unmeasured_motions"] = run.clip.metrics.unmeasured_motions;
  if (run.pair) {
    json["unaligned"] = run.pair->unaligned;
  }
  if (run.field) {
    json["rs_source"] = run.rs_source;
    json["rs_reason"] = run.rs_reason;
  }
  return json;
}

}  // namespace

std::vector<report::Table> FigureTables(const ClipsReport& report) {
  std::vector<report::Table> tables;
  for (const ClipKind kind : kKinds) {
    const auto clips = std::count_if(report.clips.begin(), report.clips.end(),
                                     [&](const ClipRecord& clip) { return clip.kind == kind; });
    if (clips < 2) {
      continue;
    }
    report::Table table =
        EmptyTable(fmt::format("Mean of {} {} clips", clips, ClipKindName(kind)), kind);
    for (const std::string& method : report.methods) {
      if (const auto runs = RunsOf(report, method, kind); !runs.empty()) {
        AddRow(
            method, kind, [&](const Figure& figure) { return MeanOf(runs, figure); }, table);
      }
    }
    tables.push_back(std::move(table));
  }
  for (const ClipRecord& clip : report.clips) {
    report::Table table =
        EmptyTable(fmt::format("{}, {}", clip.name, ClipKindName(clip.kind)), clip.kind);
    for (const ClipRun& run : clip.runs) {
      AddRow(
          run.method, clip.kind, [&](const Figure& figure) { return figure.get(run); }, table);
    }
    tables.push_back(std::move(table));
  }
  return tables;
}

std::string FormatText(const ClipsReport& report) {
  const int name_width = NameWidth(report);
  std::string text = HeaderText(report.header);
  for (const ClipRecord& clip : report.clips) {
    text += ClipTitle(clip) + TableHead(clip.kind, name_width);
    for (const ClipRun& run : clip.runs) {
      text += TableRow(run.method, clip.kind, name_width,
                       [&](const Figure& figure) { return figure.get(run); });
    }
  }
  return text + MeansText(report, name_width) +
         "\npx at 640 px width; RS: root mean square of the rolling-shutter field applied; EPE of "
         "that field, in: of none; readout found, ms; ms a frame with whatever else was running, "
         "own: less decoding and encoding\n";
}

std::string FormatJson(const ClipsReport& report) {
  Json json;
  json["protocol"] = "clips";
  json.update(HeaderJson(report.header));
  json["samples"] = report.clips.size();
  json["means"] = Json::object();
  for (const ClipKind kind : kKinds) {
    for (const std::string& method : report.methods) {
      if (const auto runs = RunsOf(report, method, kind); !runs.empty()) {
        Json means = FiguresJson([&](const Figure& figure) { return MeanOf(runs, figure); });
        means["clips"] = runs.size();
        json["means"][std::string(ClipKindName(kind))][method] = std::move(means);
      }
    }
  }
  json["clips"] = Json::array();
  for (const ClipRecord& clip : report.clips) {
    Json entry = {{"name", clip.name}, {"kind", ClipKindName(clip.kind)}};
    if (clip.readout_s) {
      entry["true_readout_ms"] = kMilli * *clip.readout_s;
    }
    if (clip.decode_ms && clip.recode_ms) {
      entry["decode_ms"] = *clip.decode_ms;
      entry["recode_ms"] = *clip.recode_ms;
    }
    entry["methods"] = Json::object();
    for (const ClipRun& run : clip.runs) {
      entry["methods"][run.method] = RunJson(run);
    }
    json["clips"].push_back(std::move(entry));
  }
  return detail::Dump(json);
}

std::string FormatCsv(const ClipsReport& report) {
  std::string text = "clip,kind,method,frames,true_readout_ms";
  for (const Figure& figure : Figures()) {
    text += std::string(",") + figure.key;
  }
  text += "\n";
  const auto number = [](double value) {
    return value == value ? fmt::format("{:.6g}", value) : std::string();
  };
  for (const ClipRecord& clip : report.clips) {
    for (const ClipRun& run : clip.runs) {
      text += fmt::format("{},{},{},{},{}", Field(clip.name), ClipKindName(clip.kind),
                          Field(run.method), run.clip.metrics.frames,
                          clip.readout_s ? number(kMilli * *clip.readout_s) : "");
      for (const Figure& figure : Figures()) {
        text += "," + number(figure.get(run));
      }
      text += "\n";
    }
  }
  return text;
}

}  // namespace rsstab::cli
