// SPDX-License-Identifier: Apache-2.0
#include "cli/pages/clip_page.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <utility>

#include "cli/pages/clip_charts.h"
#include "cli/pages/page_parts.h"
#include "cli/report/difference_map.h"
#include "cli/report/field_panels.h"
#include "cli/report/preview.h"

namespace rsstab::cli {
namespace {

using report::HtmlPage;
using report::PictureFormat;

constexpr double kReferenceWidth = 640.0;
constexpr double kPercent = 100.0;

std::string FrameNote(const Exhibit& exhibit) {
  std::string note = fmt::format("frame {} at {:.2f} s", exhibit.index, exhibit.time_s);
  if (exhibit.rs_px) {
    note += fmt::format("; rolling shutter {:.2f} px", *exhibit.rs_px);
  }
  if (exhibit.shake_px) {
    note += fmt::format("; motion changed by {:.1f} px", *exhibit.shake_px);
  }
  return note;
}

// "most shake" -> "Most shake"
std::string Capitalized(std::string text) {
  if (!text.empty() && text[0] >= 'a' && text[0] <= 'z') {
    text[0] = static_cast<char>(text[0] - 'a' + 'A');
  }
  return text;
}

std::vector<report::Highlight> Highlights(const ClipPage& page) {
  const CompareReport& figures = page.figures;
  std::vector<report::Highlight> highlights;
  const auto add = [&](const char* label, const std::optional<double>& before,
                       const std::optional<double>& after, int digits) {
    if (before && after) {
      highlights.push_back({label, fmt::format("{:.{}f}", *before, digits),
                            fmt::format("{:.{}f}", *after, digits), "px"});
    }
  };
  add("Shake", figures.input.metrics.shake, figures.output.metrics.shake, 2);
  add("Jitter", figures.input.metrics.jitter, figures.output.metrics.jitter, 2);
  add("Row wobble", figures.input.metrics.row_wobble, figures.output.metrics.row_wobble, 2);
  if (figures.input.truth && figures.output.truth) {
    add("Camera residual", figures.input.truth->camera_residual,
        figures.output.truth->camera_residual, 2);
  }
  if (page.analysis) {
    highlights.push_back(
        {"Kept of each side", "", fmt::format("{:.0f}", kPercent * page.analysis->mean_kept_ratio),
         fmt::format("%, at least {:.0f}", kPercent * page.analysis->smallest_kept_ratio)});
  } else if (figures.pair.crop) {
    highlights.push_back(
        {"Kept of each side", "", fmt::format("{:.0f}", kPercent * *figures.pair.crop), "%"});
  }
  return highlights;
}

Status AddSliders(const ClipPage& page, HtmlPage& html) {
  std::vector<report::BeforeAfter> sliders;
  const bool on_its_side = page.quarter_turns % 2 != 0;
  for (const Exhibit& exhibit : page.exhibits) {
    auto before = DataUri(exhibit.input.View(), PictureFormat::kWebp, page.quarter_turns);
    auto after = DataUri(exhibit.output.View(), PictureFormat::kWebp, page.quarter_turns);
    if (!before || !after) {
      return Propagate(before ? after.error() : before.error());
    }
    report::BeforeAfter slider;
    slider.title = Capitalized(exhibit.reason);
    slider.note = FrameNote(exhibit);
    slider.before_uri = std::move(*before);
    slider.after_uri = std::move(*after);
    slider.width = on_its_side ? exhibit.input.height : exhibit.input.width;
    slider.height = on_its_side ? exhibit.input.width : exhibit.input.height;
    sliders.push_back(std::move(slider));
  }
  if (sliders.empty()) {
    return {};
  }
  html.BeginSection("Before and after",
                    "Drag the line, or use the arrow keys. The steady picture shows a little less, "
                    "so that no border ever comes into view.");
  html.Add(sliders);
  return {};
}

Status AddRollingShutter(const ClipPage& page, HtmlPage& html) {
  if (page.moments.empty() || !page.analysis) {
    return {};
  }
  const stabilizer::ClipAnalysis& analysis = *page.analysis;
  html.BeginSection(
      "Motion within the frames",
      "While a frame is read out, the camera goes on moving, so the last row is recorded from "
      "another view than the first. This is what was found and undone, frame by frame; px at 640 "
      "px width.");
  std::vector<report::Fact> facts = {
      {"Found by",
       analysis.rs_source + (analysis.rs_reason.empty() ? "" : ": ") + analysis.rs_reason}};
  if (analysis.readout_s != 0.0) {
    facts.push_back({"Readout", ReadoutText(analysis.readout_s, analysis.readout_sigma_s)});
  }
  html.Add(facts);
  html.Add(RsCharts(page.moments, analysis));

  double longest = 0.0;
  for (const Exhibit& exhibit : page.exhibits) {
    longest = std::max(longest, exhibit.rs_field.columns() > 0 ? exhibit.rs_field.MaxLength() : 0);
  }
  if (!(longest > 0.0)) {
    return {};
  }
  std::vector<report::Panel> panels;
  for (const Exhibit& exhibit : page.exhibits) {
    if (exhibit.rs_field.columns() == 0) {
      continue;
    }
    auto panel = report::FieldPanel(
        exhibit.rs_field, longest, fmt::format("Frame {}", exhibit.index),
        fmt::format("{}; up to {:.1f} px", exhibit.reason, exhibit.rs_field.MaxLength()),
        page.quarter_turns);
    if (!panel) {
      return Propagate(panel.error());
    }
    panels.push_back(std::move(*panel));
  }
  const auto key = report::FieldKey(longest, page.quarter_turns);
  if (!key) {
    return Propagate(key.error());
  }
  html.Add(panels);
  html.Add(std::array{*key});
  return {};
}

// The map of one picture against its twin; of the input it needs no alignment.
Result<std::optional<report::Panel>> TruthPanel(const Exhibit& exhibit, bool is_output,
                                                const ClipPage& page) {
  const Frame& picture = is_output ? exhibit.output : exhibit.input;
  auto map = report::AlignedDifferenceMap(picture.View(), exhibit.twin->View(), *page.truth_camera);
  if (!map) {
    return Propagate(map.error());
  }
  if (!*map) {
    return std::nullopt;
  }
  auto uri = DataUri((*map)->View(), PictureFormat::kWebp, page.quarter_turns);
  if (!uri) {
    return Propagate(uri.error());
  }
  return report::Panel{fmt::format("Frame {}, {}", exhibit.index, is_output ? "after" : "before"),
                       exhibit.reason, std::move(*uri), picture.width, picture.height};
}

Status AddTruth(const ClipPage& page, HtmlPage& html) {
  const auto charts = TruthCharts(page.figures);
  if (charts.empty()) {
    return {};
  }
  html.BeginSection("Against the truth",
                    "What a global shutter would have seen, turned and zoomed to the frame's own "
                    "view, and subtracted: darker is closer to the truth. A steadied frame looks "
                    "elsewhere on purpose, which is no error; skew and bending are.");
  std::vector<report::Panel> panels;
  for (const Exhibit& exhibit : page.exhibits) {
    if (!exhibit.twin || !page.truth_camera) {
      continue;
    }
    for (const bool is_output : {false, true}) {
      auto panel = TruthPanel(exhibit, is_output, page);
      if (!panel) {
        return Propagate(panel.error());
      }
      if (*panel) {
        panels.push_back(std::move(**panel));
      }
    }
  }
  if (!panels.empty()) {
    const auto key = DifferenceColorKey();
    if (!key) {
      return Propagate(key.error());
    }
    html.AddPairs(panels);
    html.Add(std::array{*key});
  }
  html.Add(charts);
  return {};
}

}  // namespace

RsMoment DescribeField(const MotionField& field, double time_s, double kept_ratio) {
  RsMoment moment;
  moment.time_s = time_s;
  moment.kept_ratio = kept_ratio;
  if (field.columns() == 0) {
    return moment;
  }
  const int last_row = field.rows() - 1;
  const int last_column = field.columns() - 1;
  Eigen::Vector2d difference = Eigen::Vector2d::Zero();
  for (int column = 0; column <= last_column; ++column) {
    difference += (field.At(column, last_row) - field.At(column, 0)).cast<double>();
  }
  difference *= kReferenceWidth / field.width() / field.columns();
  moment.sideways_px = difference.x();
  moment.upright_px = difference.y();
  const auto slope = [&](int row) {
    return static_cast<double>(field.At(last_column, row).y() - field.At(0, row).y()) /
           std::max(1, field.width() - 1);
  };
  moment.turn_deg = (std::atan(slope(last_row)) - std::atan(slope(0))) * 180.0 / std::numbers::pi;
  return moment;
}

Result<std::string> MakeClipPage(const ClipPage& page) {
  const CompareReport& figures = page.figures;
  HtmlPage html(page.kind, std::filesystem::path(figures.input.path).filename().string(),
                fmt::format("{} \u00d7 {}, {:.5g} frames/s, {} frames \u2192 {}",
                            figures.input.width, figures.input.height,
                            figures.input.frames_per_second, figures.input.metrics.frames,
                            std::filesystem::path(figures.output.path).filename().string()));
  html.Add(Highlights(page));
  if (Status status = AddSliders(page, html); !status) {
    return Propagate(status.error());
  }
  html.BeginSection("Camera path",
                    "How the picture's content moved since the first frame, measured in both clips "
                    "by following points from frame to frame; px at 640 px width.");
  html.Add(PathCharts(figures));
  if (Status status = AddRollingShutter(page, html); !status) {
    return Propagate(status.error());
  }
  if (Status status = AddTruth(page, html); !status) {
    return Propagate(status.error());
  }
  html.BeginSection("Figures", "px at 640 px width; the better one of each pair stands out.");
  html.Add(FiguresTable(figures));
  html.BeginSection("How it was made");
  html.Add(page.facts);
  if (!page.command.empty()) {
    html.AddCode("Options as given", page.command);
  }
  AddStages(page.stages, figures.input.metrics.frames, "frame", html);
  return html.Finish(PageFooter());
}

}  // namespace rsstab::cli
