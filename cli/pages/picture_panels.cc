// SPDX-License-Identifier: Apache-2.0
#include "cli/pages/picture_panels.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "cli/pages/page_parts.h"
#include "cli/report/difference_map.h"
#include "cli/report/field_panels.h"
#include "cli/report/preview.h"
#include "evaluation/correction_score.h"
#include "igf/base/parallel_for.h"

namespace rsstab::cli {
namespace {

using evaluation::LabelledPicture;
using evaluation::MethodFigures;
using evaluation::PictureAnswer;

// More pictures side by side than this would be too small to see anything.
constexpr std::size_t kMostPanels = 6;
// Vertices of a true field that is known at every pixel: a field is smooth.
constexpr int kFieldColumns = 33;
constexpr int kFieldRows = 65;

bool IsTold(const std::string& method) { return method == "none" || method.starts_with("gyro"); }

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
  std::vector<report::BeforeAfter> sliders;
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
  const auto recorded = DataUri(picture.rs.View(), report::PictureFormat::kWebp);
  const auto result = DataUri(corrected->picture.View(), report::PictureFormat::kWebp);
  const auto truth = DataUri(picture.gs.View(), report::PictureFormat::kWebp);
  for (const auto* uri : {&recorded, &result, &truth}) {
    if (!*uri) {
      return Propagate(uri->error());
    }
  }
  report::BeforeAfter slider;
  slider.title = "As recorded, and corrected by " + figures.method;
  slider.note = Figures(figures);
  slider.before_uri = *recorded;
  slider.after_uri = *result;
  slider.width = picture.rs.width;
  slider.height = picture.rs.height;
  showing.sliders.push_back(slider);
  slider.title = "Corrected by " + figures.method + ", and the truth";
  slider.note = "";
  slider.before_uri = *result;
  slider.after_uri = *truth;
  slider.before_label = "corrected";
  slider.after_label = "truth";
  showing.sliders.push_back(std::move(slider));
  return {};
}

Result<Showing> Show(const evaluation::PictureInspection& inspection,
                     std::span<const MethodFigures> figures, std::size_t method, double& full_px) {
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
  for (std::size_t m = 0; m < figures.size(); ++m) {
    const auto answer =
        std::find_if(inspection.answers.begin(), inspection.answers.end(),
                     [&](const PictureAnswer& a) { return a.method == figures[m].method; });
    if (answer == inspection.answers.end()) {
      continue;
    }
    if (Status shown = ShowAnswer(picture, *answer, figures[m], m == method, full_px, showing);
        !shown) {
      return Propagate(shown.error());
    }
  }
  return showing;
}

Status ShowPicture(const evaluation::PictureInspection& inspection,
                   std::span<const MethodFigures> figures, std::size_t method,
                   const std::string& heading, report::HtmlPage& html) {
  double full_px = 0.0;
  const auto showing = Show(inspection, figures, method, full_px);
  if (!showing) {
    return Propagate(showing.error());
  }
  html.AddHeading(heading);
  html.Add(showing->sliders);
  html.Add(showing->maps);
  html.Add(showing->fields);
  const auto wheel = report::FieldKey(full_px);
  const auto ramp = DifferenceColorKey();
  if (!wheel || !ramp) {
    return Propagate(wheel ? ramp.error() : wheel.error());
  }
  html.Add(std::array{*ramp, *wheel});
  return {};
}

}  // namespace

std::size_t MethodToShow(std::span<const MethodStanding> methods) {
  std::size_t best = 0;
  for (std::size_t m = 1; m < methods.size(); ++m) {
    const bool told = IsTold(methods[m].method);
    const bool best_is_told = best == 0 || IsTold(methods[best].method);
    if (!std::isfinite(methods[m].score) || (told && !best_is_told)) {
      continue;
    }
    if (best == 0 || (best_is_told && !told) || methods[m].score > methods[best].score) {
      best = m;
    }
  }
  return best;
}

std::vector<ChosenPicture> ChooseByGain(std::span<const std::optional<double>> gains) {
  std::vector<std::pair<double, std::size_t>> known;
  for (std::size_t i = 0; i < gains.size(); ++i) {
    if (gains[i]) {
      known.emplace_back(*gains[i], i);
    }
  }
  std::sort(known.begin(), known.end());
  std::vector<ChosenPicture> chosen;
  if (known.empty()) {
    return chosen;
  }
  chosen.push_back({known.back().second, "gains most"});
  if (known.size() > 2) {
    chosen.push_back({known[known.size() / 2].second, "gains as much as on average"});
  }
  if (known.size() > 1) {
    chosen.push_back({known.front().second, "gains least"});
  }
  return chosen;
}

Status ShowPictures(std::span<const ChosenPicture> chosen, std::size_t method,
                    const evaluation::MethodFactory& factory, const InspectRecord& inspect,
                    report::HtmlPage& html) {
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
    const auto record = inspect(choice.record, *methods);
    if (!record) {
      return Propagate(record.error());
    }
    const std::string heading =
        record->name + ", where " + record->figures[method].method + " " + choice.reason;
    if (Status shown = ShowPicture(record->inspection, record->figures, method, heading, html);
        !shown) {
      return shown;
    }
  }
  return {};
}

}  // namespace rsstab::cli
