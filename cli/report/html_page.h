// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_REPORT_HTML_PAGE_H_
#define RSSTAB_CLI_REPORT_HTML_PAGE_H_

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "cli/report/svg_chart.h"

namespace rsstab::report {

// All texts below are plain text of any bytes; the page escapes them. Pictures are "data:"
// addresses (preview.h).

// A figure before and after, for the head of a page.
struct Highlight {
  std::string label;
  std::string before;  // may be empty
  std::string after;
  std::string unit;
};

struct TableCell {
  std::string text;
  bool best = false;  // stands out in its group
};

struct Table {
  std::string caption;                // may be empty
  std::vector<std::string> headings;  // one for each column; the first column names the row
  std::vector<std::vector<TableCell>> rows;
  bool has_notes = false;  // the last column is a remark, left out on a narrow screen
};

struct Fact {
  std::string label;
  std::string value;
};

// Two pictures of one size on top of each other, with a slider.
struct BeforeAfter {
  std::string title;  // stands out in the caption
  std::string note;
  std::string before_uri;
  std::string after_uri;
  std::string before_label = "before";
  std::string after_label = "after";
  int width = 0;
  int height = 0;
};

struct Panel {
  std::string title;
  std::string note;
  std::string uri;
  int width = 0;
  int height = 0;
};

// A row of colours, or a wheel, and what its ends mean.
struct ColorKey {
  std::string uri;
  bool is_wheel = false;
  std::string low;   // text at the left of a row
  std::string high;  // text at the right
};

struct Share {
  std::string label;
  double value = 0.0;  // at least 0; the longest bar is the largest value
  std::string text;
};

// An HTML page in one piece: nothing in it is fetched, and its Content-Security-Policy forbids
// that. Readable on a phone, light and dark as the reader prefers. Sections stand in the order of
// the calls.
class HtmlPage {
 public:
  // `kind` says what sort of page it is, `title` what it is about.
  HtmlPage(std::string_view kind, std::string_view title, std::string_view subtitle);

  void BeginSection(std::string_view heading, std::string_view explanation = {});
  void Add(std::span<const Highlight> highlights);
  void Add(const Table& table);
  void Add(std::span<const Fact> facts);
  void Add(std::span<const LineChart> charts);
  void Add(std::span<const BeforeAfter> pictures);
  void Add(std::span<const Panel> panels);
  // The same, two and two beside each other, also on a phone.
  void AddPairs(std::span<const Panel> panels);
  // The same, several beside each other, two on a phone; all of one size.
  void AddGallery(std::span<const Panel> panels);
  void Add(std::span<const ColorKey> keys);
  void Add(std::span<const Share> shares);
  // A smaller heading within the section.
  void AddHeading(std::string_view heading, std::string_view explanation = {});
  void AddText(std::string_view paragraph);
  void AddCode(std::string_view heading, std::string_view text);

  // The whole document; the page is empty afterwards.
  [[nodiscard]] std::string Finish(std::string_view footer);

 private:
  void AddPanels(std::span<const Panel> panels, std::string_view css_class);

  std::string title_;
  std::string body_;
  int charts_ = 0;
  bool in_section_ = false;
};

}  // namespace rsstab::report

#endif  // RSSTAB_CLI_REPORT_HTML_PAGE_H_
