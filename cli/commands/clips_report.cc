// SPDX-License-Identifier: Apache-2.0
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "cli/commands/clip_figures.h"
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
constexpr double kMilli = 1e3;
constexpr std::array<ClipKind, 3> kKinds = {ClipKind::kReal, ClipKind::kSimulated, ClipKind::kTwin};

// What one line of a table shows: a run, or the means over several.
using Values = std::function<double(const ClipFigure& figure)>;

// A table, before it has a form.
struct Grid {
  std::string title;    // of the table for people
  std::string caption;  // of the page's
  std::vector<const ClipFigure*> columns;
  std::vector<std::pair<std::string, Values>> rows;
};

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
double MeanOf(const std::vector<const ClipRun*>& runs, const ClipFigure& figure) {
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

std::string ClipTitle(const ClipRecord& clip) {
  std::string text = fmt::format("{}: {}", clip.name, ClipKindName(clip.kind));
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
  return text;
}

Grid ClipGrid(const ClipRecord& clip) {
  std::vector<const ClipRun*> runs;
  Grid grid;
  for (const ClipRun& run : clip.runs) {
    runs.push_back(&run);
    grid.rows.emplace_back(run.method,
                           [&run](const ClipFigure& figure) { return figure.get(run); });
  }
  grid.title = ClipTitle(clip);
  grid.caption = fmt::format("{}, {}", clip.name, ClipKindName(clip.kind));
  grid.columns = TableFigures(clip.kind, runs);
  return grid;
}

// Of each kind of which there is more than one clip.
std::vector<Grid> MeanGrids(const ClipsReport& report) {
  std::vector<Grid> grids;
  for (const ClipKind kind : kKinds) {
    const auto clips = std::count_if(report.clips.begin(), report.clips.end(),
                                     [&](const ClipRecord& clip) { return clip.kind == kind; });
    if (clips < 2) {
      continue;
    }
    Grid& grid = grids.emplace_back();
    grid.title = fmt::format("mean of {} {} clips", clips, ClipKindName(kind));
    grid.caption = "M" + grid.title.substr(1);
    std::vector<const ClipRun*> all;
    for (const std::string& method : report.methods) {
      const auto runs = RunsOf(report, method, kind);
      if (!runs.empty()) {
        all.insert(all.end(), runs.begin(), runs.end());
        grid.rows.emplace_back(method,
                               [runs](const ClipFigure& figure) { return MeanOf(runs, figure); });
      }
    }
    grid.columns = TableFigures(kind, all);
  }
  return grids;
}

std::string ToText(const Grid& grid, int name_width) {
  std::string text = fmt::format("\n{}\n{:<{}}", grid.title, "method", name_width);
  for (const ClipFigure* figure : grid.columns) {
    text += fmt::format("{:>{}}", figure->title, figure->width);
  }
  text += "\n";
  for (const auto& [name, value] : grid.rows) {
    text += fmt::format("{:<{}}", name, name_width);
    for (const ClipFigure* figure : grid.columns) {
      text += Cell(value(*figure), figure->width, figure->digits);
    }
    text += "\n";
  }
  return text;
}

report::Table ToTable(const Grid& grid) {
  report::Table table;
  table.caption = grid.caption;
  table.headings = {"method"};
  for (const ClipFigure* figure : grid.columns) {
    table.headings.emplace_back(figure->title);
  }
  for (const auto& [name, value] : grid.rows) {
    std::vector<report::TableCell> row = {{name}};
    for (const ClipFigure* figure : grid.columns) {
      row.push_back({Cell(value(*figure), 0, figure->digits)});
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

Json FiguresJson(const Values& value) {
  Json json = Json::object();
  for (const ClipFigure& figure : ClipFigures()) {
    json[figure.key] = OrNull(value(figure));
  }
  return json;
}

Json RunJson(const ClipRun& run) {
  Json json = FiguresJson([&](const ClipFigure& figure) { return figure.get(run); });
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
  if (run.angle && run.angle->rate_axes_deg_s) {
    const auto list = [](const Eigen::Vector3d& v) { return Json{v.x(), v.y(), v.z()}; };
    json["path_rate_axes_deg_s"] = list(*run.angle->rate_axes_deg_s);
    json["path_drift_axes_deg_s"] = list(*run.angle->drift_axes_deg_s);
  }
  return json;
}

}  // namespace

std::vector<report::Table> FigureTables(const ClipsReport& report) {
  std::vector<report::Table> tables;
  for (const Grid& grid : MeanGrids(report)) {
    tables.push_back(ToTable(grid));
  }
  for (const ClipRecord& clip : report.clips) {
    tables.push_back(ToTable(ClipGrid(clip)));
  }
  return tables;
}

std::string FormatText(const ClipsReport& report) {
  std::size_t name_width = 8;
  for (const std::string& method : report.methods) {
    name_width = std::max(name_width, method.size());
  }
  std::string text = HeaderText(report.header);
  for (const ClipRecord& clip : report.clips) {
    text += ToText(ClipGrid(clip), static_cast<int>(name_width));
  }
  for (const Grid& grid : MeanGrids(report)) {
    text += ToText(grid, static_cast<int>(name_width));
  }
  return text + "\n" + kClipFigureNote + "\n";
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
        Json means = FiguresJson([&](const ClipFigure& figure) { return MeanOf(runs, figure); });
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
  for (const ClipFigure& figure : ClipFigures()) {
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
      for (const ClipFigure& figure : ClipFigures()) {
        text += "," + number(figure.get(run));
      }
      text += "\n";
    }
  }
  return text;
}

}  // namespace rsstab::cli
