// SPDX-License-Identifier: Apache-2.0
#include <spdlog/fmt/fmt.h>
#include <spdlog/fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "cli/commands/evaluate_pictures.h"
#include "cli/commands/evaluate_report_detail.h"

namespace rsstab::cli {
namespace {

using detail::Cell;
using detail::Field;
using detail::IntervalText;
using detail::Json;
using detail::kPercent;
using detail::OrNull;
using evaluation::MeanFigure;
using evaluation::MethodFigures;
using evaluation::PictureGroup;
using evaluation::PictureMethodSummary;
using evaluation::PictureRecord;

std::string WithInterval(const MeanFigure& figure, int width, int interval_width, int digits) {
  const std::string interval =
      std::isfinite(figure.mean) ? IntervalText(figure.interval, digits) : "";
  return Cell(figure.mean, width, digits) + fmt::format("{:>{}}", interval, interval_width);
}

std::string GroupText(const PictureGroup& group) {
  const std::vector<PictureMethodSummary> asked = group.Asked();
  std::size_t width = 12;
  for (const PictureMethodSummary& m : asked) {
    width = std::max(width, m.method.size() + 2);
  }
  std::string text = fmt::format(
      "\n{}, {} pictures\n{:<{}}{:>6}{:>5}{:>8}{:>18}{:>8}{:>8}{:>18}{:>8}{:>18}{:>8}{:>7}{:>7}"
      "{:>9}{:>8}{:>8}{:>9}\n",
      group.title, group.pictures, "method", width, "n", "left", "PSNR", "", "SSIM", "EPE", "",
      "change", "", "median", "u", "v", "flicker", "valid%", "PSNR in", "ms");
  for (const PictureMethodSummary& m : asked) {
    text += fmt::format("{:<{}}{:>6}{:>5}", m.method, width, m.pictures, m.declined) +
            WithInterval(m.psnr_db, 8, 18, 2) + Cell(m.ssim.mean, 8, 3) +
            WithInterval(m.epe_px, 8, 18, 2) + WithInterval(m.epe_change_px, 8, 18, 2) +
            Cell(m.epe_median_px, 8, 2) + Cell(m.horizontal_px, 7, 2) + Cell(m.vertical_px, 7, 2) +
            Cell(m.flicker_px.mean, 9, 2) + Cell(kPercent * m.valid_share, 8, 1) +
            Cell(m.untouched_psnr_db, 8, 2) + Cell(m.ms, 9, 1) + "\n";
  }
  return text;
}

void AddMean(const char* name, const MeanFigure& figure, Json& json) {
  json[name] = OrNull(figure.mean);
  json[std::string(name) + "_interval"] = detail::ToJson(figure.interval);
}

Json MethodJson(const PictureMethodSummary& m) {
  Json json;
  AddMean("psnr", m.psnr_db, json);
  AddMean("ssim", m.ssim, json);
  AddMean("epe", m.epe_px, json);
  AddMean("epe_change", m.epe_change_px, json);
  AddMean("flicker", m.flicker_px, json);
  json["epe_median"] = OrNull(m.epe_median_px);
  json["epe_p90"] = OrNull(m.epe_p90_px);
  json["u"] = OrNull(m.horizontal_px);
  json["v"] = OrNull(m.vertical_px);
  json["psnr_untouched"] = OrNull(m.untouched_psnr_db);
  json["ssim_untouched"] = OrNull(m.untouched_ssim);
  json["valid"] = OrNull(m.valid_share);
  json["moved"] = OrNull(m.moved_px);
  json["ms"] = OrNull(m.ms);
  json["pictures"] = m.pictures;
  json["declined"] = m.declined;
  return json;
}

Json GroupJson(const PictureGroup& group) {
  Json json = {{"title", group.title}, {"samples", group.pictures}, {"methods", Json::object()}};
  for (const PictureMethodSummary& method : group.methods) {
    json["methods"][method.method] = MethodJson(method);
  }
  return json;
}

std::string Number(double value, int digits) {
  return std::isfinite(value) ? fmt::format("{:.{}f}", value, digits) : "";
}

}  // namespace

std::string NotAskedText(const PictureReport& report) {
  const auto names =
      report.groups.empty() ? std::vector<std::string>() : report.groups.front().NotAsked();
  return names.empty() ? ""
                       : fmt::format("Not asked, since no picture comes with what they need: {}.",
                                     fmt::join(names, ", "));
}

std::string FormatText(const PictureReport& report) {
  std::string text = detail::HeaderText(report.header);
  for (const PictureGroup& group : report.groups) {
    text += GroupText(group);
  }
  if (const std::string missing = NotAskedText(report); !missing.empty()) {
    text += "\n" + missing + "\n";
  }
  return text +
         "\nn: pictures that the method could be asked about; left: of them, left as they are "
         "because they did not tell; [..]: 95% interval; EPE, u (horizontal part), v (vertical "
         "part), flicker (change of the error between frames) in px of the picture; change of the "
         "EPE against no correction; PSNR in: the untouched picture over the same pixels; ms with "
         "whatever else was running\n";
}

std::string FormatJson(const PictureReport& report) {
  Json json;
  json["protocol"] = report.protocol;
  json.update(detail::HeaderJson(report.header));
  json["samples"] = report.records.size();
  json["methods"] =
      report.groups.empty() ? Json::object() : GroupJson(report.groups.front())["methods"];
  json["groups"] = Json::array();
  for (const PictureGroup& group : report.groups) {
    json["groups"].push_back(GroupJson(group));
  }
  return detail::Dump(json);
}

std::string FormatCsv(const PictureReport& report) {
  std::string text =
      "name,clip,split,strength,source,width,height,method,declined,psnr,ssim,epe,u,v,flicker,"
      "psnr_untouched,ssim_untouched,valid,moved,ms\n";
  for (const PictureRecord& r : report.records) {
    for (const MethodFigures& m : r.methods) {
      text += fmt::format("{},{},{},{},{},{},{},{},{},", Field(r.name), Field(r.clip),
                          Field(r.split), Field(r.strength), Field(r.source), r.width, r.height,
                          Field(m.method), m.declined ? 1 : 0);
      text += Number(m.psnr_db, 3) + "," + Number(m.ssim, 5) + "," + Number(m.epe_px, 4) + "," +
              Number(m.horizontal_px, 4) + "," + Number(m.vertical_px, 4) + "," +
              Number(m.flicker_px, 4) + "," + Number(m.untouched_psnr_db, 3) + "," +
              Number(m.untouched_ssim, 5) + "," + Number(m.valid_share, 5) + "," +
              Number(m.moved_px, 4) + "," + Number(m.ms, 2) + "\n";
    }
  }
  return text;
}

}  // namespace rsstab::cli
