// SPDX-License-Identifier: Apache-2.0
#include "cli/pages/evaluation_page.h"

#include <spdlog/fmt/fmt.h>

#include <array>
#include <functional>
#include <utility>

#include "cli/commands/clip_figures.h"
#include "cli/pages/clip_charts.h"
#include "cli/pages/evaluation_tables.h"
#include "cli/pages/page_parts.h"
#include "cli/pages/picture_exhibits.h"
#include "cli/pages/synthetic_exhibits.h"

namespace rsstab::cli {
namespace {

using report::HtmlPage;

const char* const kMethodNote =
    "EPE: how far, on average, the estimated motion of a pixel is from the true one; px of the "
    "picture. The best figure of each column stands out.";

std::string SettingOf(const EvaluationHeader& header, const std::string& name) {
  for (const EvaluationSetting& setting : header.settings) {
    if (setting.name == name) {
      return setting.value;
    }
  }
  return "";
}

HtmlPage BeginPage(const std::string& protocol, const EvaluationHeader& header,
                   const std::string& subtitle) {
  const std::string data = SettingOf(header, "dataset");
  return {ProgramName() + ", evaluation", data.empty() ? protocol : data, subtitle};
}

std::string EndPage(const EvaluationHeader& header, const std::vector<StageTime>& stages,
                    std::size_t items, const char* unit, HtmlPage& html) {
  html.BeginSection("How it was made");
  std::vector<report::Fact> facts = {{"Program", ProgramName()}};
  std::string defaults;
  for (const EvaluationSetting& setting : header.settings) {
    if (setting.is_default) {
      defaults += (defaults.empty() ? "--" : " --") + setting.name + " " + setting.value;
    } else {
      facts.push_back({"--" + setting.name, setting.value});
    }
  }
  html.Add(facts);
  html.AddCode("Options at their defaults", defaults);
  if (!header.failures.empty()) {
    html.AddHeading("Left out");
    std::vector<report::Fact> failures;
    for (const auto& [name, error] : header.failures) {
      failures.push_back({name, error.message});
    }
    html.Add(failures);
  }
  AddStages(stages, static_cast<std::int64_t>(items), unit, html);
  return html.Finish(PageFooter());
}

void AddTables(const std::vector<report::Table>& tables, HtmlPage& html) {
  for (const report::Table& table : tables) {
    html.Add(table);
  }
}

// The paths of a clip as each method left it.
std::vector<report::LineChart> ClipPaths(const ClipRecord& clip) {
  std::vector<report::LineChart> charts;
  for (const bool is_sideways : {true, false}) {
    report::LineChart chart;
    chart.title = is_sideways ? "Sideways" : "Up and down";
    chart.description = "How the picture's content moved since the first frame, for each method.";
    chart.x_label = "time, s";
    chart.y_label = is_sideways ? "px to the right" : "px down";
    for (const ClipRun& run : clip.runs) {
      report::ChartSeries series;
      series.name = run.method;
      for (std::size_t n = 0; n < run.clip.poses.size(); ++n) {
        const Eigen::Vector2d& position = run.clip.poses[n].position;
        series.points.emplace_back(static_cast<double>(n) / run.clip.frames_per_second,
                                   is_sideways ? position.x() : position.y());
      }
      chart.series.push_back(std::move(series));
    }
    charts.push_back(std::move(chart));
  }
  return charts;
}

Status AddShowcases(const ClipsReport& report, HtmlPage& html) {
  bool has_section = false;
  for (const ClipRecord& clip : report.clips) {
    if (!clip.showcase || clip.showcase->pictures().empty()) {
      continue;
    }
    if (!has_section) {
      html.BeginSection(
          "Pictures",
          "One frame of a clip as each method left it. Where the truth is known, below: each minus "
          "what a global shutter would have seen, turned and zoomed to its view, and its camera "
          "residual; darker is closer to the truth, grey cannot be compared.");
      has_section = true;
    }
    html.AddHeading(fmt::format("{}, frame {}", clip.name, clip.showcase->frame().index),
                    "Chosen because " + clip.showcase->frame().reason + ".");
    if (Status status = clip.showcase->Show(html); !status) {
      return status;
    }
  }
  return {};
}

}  // namespace

Result<std::string> MakeEvaluationPage(const SyntheticReport& report,
                                       const EvaluateOptions& options,
                                       const evaluation::MethodFactory& factory,
                                       const std::vector<StageTime>& stages) {
  HtmlPage html =
      BeginPage("synthetic-val", report.header,
                fmt::format("{} photographs, {} pictures", report.photos, report.samples.size()));
  html.BeginSection("Methods", kMethodNote);
  AddTables(FigureTables(report), html);
  std::vector<report::LineChart> charts = ErrorCharts(report);
  for (report::LineChart& chart : SkewCharts(report)) {
    charts.push_back(std::move(chart));
  }
  html.Add(charts);
  if (Status status = AddPictures(report, options, factory, html); !status) {
    return Propagate(status.error());
  }
  return EndPage(report.header, stages, report.samples.size(), "picture", html);
}

Result<std::string> MakeEvaluationPage(const ClipsReport& report,
                                       const std::vector<StageTime>& stages) {
  HtmlPage html = BeginPage("clips", report.header,
                            fmt::format("{} clip{}, {} method{}", report.clips.size(),
                                        report.clips.size() == 1 ? "" : "s", report.methods.size(),
                                        report.methods.size() == 1 ? "" : "s"));
  html.BeginSection("Figures", std::string(kClipFigureNote) + ".");
  AddTables(FigureTables(report), html);
  if (Status status = AddShowcases(report, html); !status) {
    return Propagate(status.error());
  }
  html.BeginSection("Paths",
                    "How the picture's content moved since the first frame; px at 640 px width.");
  for (const ClipRecord& clip : report.clips) {
    html.AddHeading(clip.name);
    html.Add(ClipPaths(clip));
  }
  return EndPage(report.header, stages, 0, "clip", html);
}

Result<std::string> MakeEvaluationPage(const PictureReport& report, const EvaluateOptions& options,
                                       const evaluation::MethodFactory& factory,
                                       const std::vector<StageTime>& stages) {
  HtmlPage html =
      BeginPage(report.protocol, report.header, fmt::format("{} pictures", report.records.size()));
  html.BeginSection("Methods", std::string(kMethodNote) +
                                   " Flicker: change of the error "
                                   "between frames of a clip.");
  AddTables(FigureTables(report), html);
  if (const std::string missing = NotAskedText(report); !missing.empty()) {
    html.AddText(missing);
  }
  html.Add(ErrorCharts(report));
  if (!report.records.empty() && !report.groups.empty()) {
    const auto set = OpenPictureSet(options);
    if (!set) {
      return Propagate(set.error());
    }
    if (Status status = AddPictures(report, **set, options, factory, html); !status) {
      return Propagate(status.error());
    }
  }
  return EndPage(report.header, stages, report.records.size(), "picture", html);
}

}  // namespace rsstab::cli
