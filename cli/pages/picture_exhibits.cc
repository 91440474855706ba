// SPDX-License-Identifier: Apache-2.0
#include "cli/pages/picture_exhibits.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "cli/pages/page_parts.h"
#include "cli/report/difference_map.h"
#include "cli/report/field_panels.h"
#include "cli/report/preview.h"
#include "evaluation/correction_score.h"
#include "evaluation/picture_protocol.h"
#include "igf/base/parallel_for.h"

namespace rsstab::cli {
namespace {

using evaluation::LabelledPicture;
using evaluation::MethodFigures;
using evaluation::PictureAnswer;
using evaluation::PictureRecord;

// More pictures side by side than this would be too small to see anything.
constexpr std::size_t kMostPanels = 6;
// Vertices of a true field that is known at every pixel: a field is smooth.
constexpr int kFieldColumns = 33;
constexpr int kFieldRows = 65;

bool IsTold(const std::string& method) { return method == "none" || method.starts_with("gyro"); }

// How much a method gained on a picture: px of error where the truth is known, else dB.
std::optional<double> GainOf(const PictureRecord& record, std::size_t method) {
  const MethodFigures& figures = record.methods[method];
  const MethodFigures& untouched = record.methods.front();
  const double px = untouched.epe_px - figures.epe_px;
  if (std::isfinite(px)) {
    return px;
  }
  const double db = figures.psnr_db - figures.untouched_psnr_db;
  return std::isfinite(db) ? std::optional(db) : std::nullopt;
}

MotionField TruthField(const LabelledPicture& picture) {
  MotionField field(picture.rs.width, picture.rs.height, kFieldColumns, kFieldRows);
  field.set_reference_row(picture.reference_row);
  for (int row = 0; row < kFieldRows; ++row) {
    for (int column = 0; column < kFieldColumns; ++column) {
      const Eigen::Vector2d at = field.VertexPosition(column, row);
      const auto x = static_cast<std::size_t>(std::lround(at.x()));
      const auto y = static_cast<std::size_t>(std::lround(at.y()));
      field.At(column, row) = picture.truth[y * static_cast<std::size_t>(picture.rs.width) + x];
    }
  }
  return field;
}

std::string Figures(const MethodFigures& figures) {
  std::string text;
  if (std::isfinite(figures.epe_px)) {
    text += fmt::format("error {:.2f} px", figures.epe_px);
  }
  if (std::isfinite(figures.psnr_db)) {
    text += fmt::format("{}PSNR {:.2f} dB", text.empty() ? "" : ", ", figures.psnr_db);
  }
  return text + (figures.declined ? ", left as it is" : "");
}

// What is shown of one picture, gathered method by method.
struct Showing {
  std::vector<report::BeforeAfter> slider;
  std::vector<report::Panel> maps;
  std::vector<report::Panel> fields;
};

Result<report::Panel> MapPanel(const LabelledPicture& picture,
                               const evaluation::CorrectedPicture& corrected,
                               const MethodFigures& figures) {
  std::vector<std::uint8_t> valid = corrected.valid;
  for (std::size_t i = 0; i < valid.size() && !picture.valid.empty(); ++i) {
    valid[i] = valid[i] != 0 && picture.valid[i] != 0 ? 1 : 0;
  }
  const auto map = report::DifferenceMap(corrected.picture.View(), picture.gs.View(), valid);
  if (!map) {
    return Propagate(map.error());
  }
  auto uri = DataUri(map->View(), report::PictureFormat::kWebp);
  if (!uri) {
    return Propagate(uri.error());
  }
  return report::Panel{figures.method, Figures(figures), std::move(*uri), map->width, map->height};
}

Status ShowAnswer(const LabelledPicture& picture, const PictureAnswer& answer,
                  const MethodFigures& figures, bool in_slider, double full_px, Showing& showing) {
  WorkerPool workers(1);
  const auto corrected = evaluation::CorrectPicture(picture.rs.View(), answer.field, workers);
  if (!corrected) {
    return Propagate(corrected.error());
  }
  if (showing.maps.size() < kMostPanels) {
    auto map = MapPanel(picture, *corrected, figures);
    if (!map) {
      return Propagate(map.error());
    }
    showing.maps.push_back(std::move(*map));
  }
  if (answer.field.MaxLength() > 0.0 && showing.fields.size() < kMostPanels) {
    auto panel = report::FieldPanel(answer.field, full_px, figures.method, "");
    if (!panel) {
      return Propagate(panel.error());
    }
    showing.fields.push_back(std::move(*panel));
  }
  if (!in_slider) {
    return {};
  }
  auto before = DataUri(picture.rs.View(), report::PictureFormat::kWebp);
  auto after = DataUri(corrected->picture.View(), report::PictureFormat::kWebp);
  if (!before || !after) {
    return Propagate(before ? after.error() : before.error());
  }
  report::BeforeAfter slider;
  slider.title = "As recorded, and corrected by " + figures.method;
  slider.note = Figures(figures);
  slider.before_uri = std::move(*before);
  slider.after_uri = std::move(*after);
  slider.width = picture.rs.width;
  slider.height = picture.rs.height;
  showing.slider.push_back(std::move(slider));
  return {};
}

Result<Showing> Show(const evaluation::PictureInspection& inspection, const PictureRecord& record,
                     std::size_t method, double& full_px) {
  const LabelledPicture& picture = inspection.picture;
  Showing showing;
  full_px = 0.0;
  for (const PictureAnswer& answer : inspection.answers) {
    full_px = std::max(full_px, answer.field.MaxLength());
  }
  if (!picture.truth.empty()) {
    const MotionField truth = TruthField(picture);
    full_px = std::max(full_px, truth.MaxLength());
    auto panel = report::FieldPanel(truth, full_px, "truth", "");
    if (!panel) {
      return Propagate(panel.error());
    }
    showing.fields.push_back(std::move(*panel));
  }
  for (std::size_t m = 0; m < record.methods.size(); ++m) {
    const auto answer =
        std::find_if(inspection.answers.begin(), inspection.answers.end(),
                     [&](const PictureAnswer& a) { return a.method == record.methods[m].method; });
    if (answer == inspection.answers.end()) {
      continue;
    }
    if (Status shown =
            ShowAnswer(picture, *answer, record.methods[m], m == method, full_px, showing);
        !shown) {
      return Propagate(shown.error());
    }
  }
  return showing;
}

}  // namespace

std::size_t ShownMethod(const PictureReport& report) {
  std::size_t best = 0;
  double best_score = std::nan("");
  bool best_is_told = true;
  const auto& methods = report.groups.front().methods;
  for (std::size_t m = 1; m < methods.size(); ++m) {
    const double epe = methods[m].epe_px.mean;
    const double score = std::isfinite(epe) ? -epe : methods[m].psnr_db.mean;
    const bool told = IsTold(methods[m].method);
    if (!std::isfinite(score) || (told && !best_is_told)) {
      continue;
    }
    if (best == 0 || (best_is_told && !told) || score > best_score) {
      best = m;
      best_score = score;
      best_is_told = told;
    }
  }
  return best;
}

std::vector<ChosenPicture> ChoosePictures(const PictureReport& report, std::size_t method) {
  std::vector<std::pair<double, std::size_t>> gains;
  for (std::size_t i = 0; i < report.records.size(); ++i) {
    if (const auto gain = GainOf(report.records[i], method)) {
      gains.emplace_back(*gain, i);
    }
  }
  std::sort(gains.begin(), gains.end());
  std::vector<ChosenPicture> chosen;
  if (gains.empty()) {
    return chosen;
  }
  chosen.push_back({gains.back().second, "gains most"});
  if (gains.size() > 2) {
    chosen.push_back({gains[gains.size() / 2].second, "gains as much as on average"});
  }
  if (gains.size() > 1) {
    chosen.push_back({gains.front().second, "gains least"});
  }
  return chosen;
}

Status AddPictures(const PictureReport& report, const evaluation::PictureSet& set,
                   const EvaluateOptions& options, const evaluation::MethodFactory& factory,
                   report::HtmlPage& html) {
  const std::size_t method = ShownMethod(report);
  const auto chosen = ChoosePictures(report, method);
  if (chosen.empty()) {
    return {};
  }
  auto methods = factory();
  if (!methods) {
    return Propagate(methods.error());
  }
  html.BeginSection(
      "Pictures",
      "Each result minus the truth: darker is closer to it, and grey does not count. Below, the "
      "motion fields: where each pixel of the corrected picture was taken from.");
  for (const ChosenPicture& choice : chosen) {
    const PictureRecord& record = report.records[choice.record];
    const auto inspection = evaluation::InspectPicture(
        set, record.clip, record.name, static_cast<std::uint64_t>(options.seed), *methods);
    if (!inspection) {
      return Propagate(inspection.error());
    }
    double full_px = 0.0;
    const auto showing = Show(*inspection, record, method, full_px);
    if (!showing) {
      return Propagate(showing.error());
    }
    html.AddHeading(record.name + ", where " + record.methods[method].method + " " + choice.reason);
    html.Add(showing->slider);
    html.Add(showing->maps);
    html.Add(showing->fields);
    const auto wheel = report::FieldKey(full_px);
    const auto ramp = DifferenceColorKey();
    if (!wheel || !ramp) {
      return Propagate(wheel ? ramp.error() : wheel.error());
    }
    html.Add(std::array{*ramp, *wheel});
  }
  return {};
}

}  // namespace rsstab::cli
