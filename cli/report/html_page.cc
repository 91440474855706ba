// SPDX-License-Identifier: Apache-2.0
#include "cli/report/html_page.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <utility>

#include "cli/report/base64.h"
#include "cli/report/markup.h"
#include "cli/report/page_style.h"

namespace rsstab::report {
namespace {

// A picture by its place in the page; its address is made here and needs no escaping.
std::string Image(std::string_view uri, std::string_view alt, std::string_view more = {}) {
  return fmt::format("<img src=\"{}\" alt=\"{}\"{}>", Escape(uri), Escape(alt), more);
}

std::string Caption(std::string_view title, std::string_view note) {
  std::string text = "<figcaption>";
  if (!title.empty()) {
    text += fmt::format("<b>{}</b>{}", EscapeName(title), note.empty() ? "" : " \u2014 ");
  }
  return text + Escape(note) + "</figcaption>";
}

}  // namespace

HtmlPage::HtmlPage(std::string_view kind, std::string_view title, std::string_view subtitle)
    : title_(title) {
  body_ = fmt::format("<header><p class=\"kind\">{}</p><h1>{}</h1>", Escape(kind), Escape(title));
  if (!subtitle.empty()) {
    body_ += fmt::format("<p class=\"sub\">{}</p>", Escape(subtitle));
  }
  body_ += "</header>\n";
}

void HtmlPage::BeginSection(std::string_view heading, std::string_view explanation) {
  body_ +=
      fmt::format("{}<section><h2>{}</h2>\n", in_section_ ? "</section>\n" : "", Escape(heading));
  in_section_ = true;
  if (!explanation.empty()) {
    AddText(explanation);
  }
}

void HtmlPage::AddHeading(std::string_view heading, std::string_view explanation) {
  body_ += fmt::format("<h3>{}</h3>\n", Escape(heading));
  if (!explanation.empty()) {
    AddText(explanation);
  }
}

void HtmlPage::AddText(std::string_view paragraph) {
  body_ += "<p>" + Escape(paragraph) + "</p>\n";
}

void HtmlPage::AddCode(std::string_view heading, std::string_view text) {
  body_ += fmt::format("<details><summary>{}</summary><p><code>{}</code></p></details>\n",
                       Escape(heading), Escape(text));
}

void HtmlPage::Add(std::span<const Highlight> highlights) {
  body_ += "<dl class=\"big\">\n";
  for (const Highlight& figure : highlights) {
    body_ += fmt::format("<div><dt>{}</dt><dd>", Escape(figure.label));
    if (!figure.before.empty()) {
      body_ += fmt::format("<span class=\"was\">{}</span> \u2192 ", Escape(figure.before));
    }
    body_ += Escape(figure.after);
    if (!figure.unit.empty()) {
      body_ += fmt::format(" <small>{}</small>", Escape(figure.unit));
    }
    body_ += "</dd></div>\n";
  }
  body_ += "</dl>\n";
}

void HtmlPage::Add(const Table& table) {
  body_ += "<div class=\"wide\" tabindex=\"0\"><table>";
  if (!table.caption.empty()) {
    body_ += "<caption><span>" + Escape(table.caption) + "</span></caption>";
  }
  const auto css_class = [&table](std::size_t column) {
    return table.has_notes && column + 1 == table.headings.size() ? "note" : "n";
  };
  body_ += "<thead><tr>";
  for (std::size_t i = 0; i < table.headings.size(); ++i) {
    body_ += fmt::format("<th scope=\"col\"{}>{}</th>",
                         i == 0 ? "" : fmt::format(" class=\"{}\"", css_class(i)),
                         Escape(table.headings[i]));
  }
  body_ += "</tr></thead><tbody>\n";
  for (const auto& row : table.rows) {
    body_ += "<tr>";
    for (std::size_t i = 0; i < row.size(); ++i) {
      body_ += i == 0 ? fmt::format("<th scope=\"row\">{}</th>", EscapeName(row[i].text))
                      : fmt::format("<td class=\"{}{}\">{}</td>", css_class(i),
                                    row[i].best ? " best" : "", Escape(row[i].text));
    }
    body_ += "</tr>\n";
  }
  body_ += "</tbody></table></div>\n";
}

void HtmlPage::Add(std::span<const Fact> facts) {
  body_ += "<dl class=\"facts\">\n";
  for (const Fact& fact : facts) {
    body_ += fmt::format("<dt>{}</dt><dd>{}</dd>\n", Escape(fact.label), Escape(fact.value));
  }
  body_ += "</dl>\n";
}

void HtmlPage::Add(std::span<const LineChart> charts) {
  body_ += "<div class=\"charts\">\n";
  for (const LineChart& chart : charts) {
    body_ += ChartElement(chart, fmt::format("chart-{}", ++charts_));
  }
  body_ += "</div>\n";
}

void HtmlPage::Add(std::span<const BeforeAfter> pictures) {
  body_ += "<div class=\"slides\">\n";
  for (const BeforeAfter& pair : pictures) {
    body_ += fmt::format(
        "<figure><div class=\"stage\" style=\"aspect-ratio:{}/{}\">{}\n{}\n"
        "<input type=\"range\" min=\"0\" max=\"100\" step=\"0.5\" value=\"50\" aria-label=\"{}\">"
        "<i></i><span>{}</span><span>{}</span></div>{}</figure>\n",
        pair.width, pair.height, Image(pair.after_uri, pair.after_label + ": " + pair.title),
        Image(pair.before_uri, pair.before_label + ": " + pair.title, " class=\"over\""),
        Escape("Share of the picture that shows " + pair.before_label), Escape(pair.before_label),
        Escape(pair.after_label), Caption(pair.title, pair.note));
  }
  body_ += "</div>\n";
}

void HtmlPage::Add(std::span<const Panel> panels) { AddPanels(panels, "panels"); }

void HtmlPage::AddPairs(std::span<const Panel> panels) { AddPanels(panels, "panels pairs"); }

void HtmlPage::AddGallery(std::span<const Panel> panels) { AddPanels(panels, "panels gallery"); }

void HtmlPage::AddPanels(std::span<const Panel> panels, std::string_view css_class) {
  body_ += fmt::format("<div class=\"{}\">\n", css_class);
  for (const Panel& panel : panels) {
    body_ += "<figure>" +
             Image(panel.uri, panel.title,
                   fmt::format(" width=\"{}\" height=\"{}\"", panel.width, panel.height)) +
             Caption(panel.title, panel.note) + "</figure>\n";
  }
  body_ += "</div>\n";
}

void HtmlPage::Add(std::span<const ColorKey> keys) {
  body_ += "<div class=\"keys\">\n";
  for (const ColorKey& key : keys) {
    body_ += fmt::format(
        "<div>{}{}<span>{}</span></div>\n",
        key.low.empty() ? "" : "<span>" + Escape(key.low) + "</span>",
        Image(key.uri, "key of the colours", key.is_wheel ? " class=\"wheel\"" : " class=\"ramp\""),
        Escape(key.high));
  }
  body_ += "</div>\n";
}

void HtmlPage::Add(std::span<const Share> shares) {
  double largest = 0.0;
  for (const Share& share : shares) {
    largest = std::max(largest, share.value);
  }
  body_ += "<div class=\"bars\">\n";
  for (const Share& share : shares) {
    const double percent = largest > 0.0 ? 100.0 * share.value / largest : 0.0;
    body_ += fmt::format("<div><span>{}</span><b style=\"width:{:.1f}%\"></b><em>{}</em></div>\n",
                         Escape(share.label), percent, Escape(share.text));
  }
  body_ += "</div>\n";
}

std::string HtmlPage::Finish(std::string_view footer) {
  // Inline styles set sizes and the slider's place; scripts run only if they are the one below.
  const std::string policy = fmt::format(
      "default-src 'none'; img-src data:; style-src 'unsafe-inline'; script-src {}; "
      "base-uri 'none'; form-action 'none'",
      CspHash(PageScript()));
  std::string page = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"{}\">\n"
      "<meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\n"
      "<meta name=\"referrer\" content=\"no-referrer\">\n"
      "<title>{}</title>\n<link rel=\"icon\" href=\"data:,\">\n<style>\n{}{}{}</style></head>\n"
      "<body><main>\n",
      policy, Escape(title_), ColorStyle(), ChartStyle(), PageStyle());
  page += std::exchange(body_, {});
  page += fmt::format("{}<footer>{}</footer>\n</main>\n<script>{}</script></body></html>\n",
                      in_section_ ? "</section>\n" : "", Escape(footer), PageScript());
  in_section_ = false;
  return page;
}

}  // namespace rsstab::report
