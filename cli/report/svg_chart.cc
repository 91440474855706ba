// SPDX-License-Identifier: Apache-2.0
#include "cli/report/svg_chart.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>

#include "cli/report/axis_scale.h"
#include "cli/report/markup.h"

namespace rsstab::report {
namespace {

constexpr double kLabelWidth = 6.2;  // of an average character at the charts' 11 units
constexpr double kRowHeight = 18.0;
constexpr double kTitleHeight = 24.0;
constexpr double kFootHeight = 34.0;
constexpr double kRightMargin = 12.0;
constexpr int kNumColors = 6;

// Characters of UTF-8, near enough for the width of a label.
double TextWidth(std::string_view text) {
  const auto characters = std::count_if(text.begin(), text.end(), [](char c) {
    return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U;
  });
  return kLabelWidth * static_cast<double>(characters);
}

struct Range {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();

  void Add(double value) {
    if (std::isfinite(value)) {
      low = std::min(low, value);
      high = std::max(high, value);
    }
  }
};

bool IsFinite(const Eigen::Vector2d& point) { return point.allFinite(); }

// Keeps at most the first, lowest, highest and last point of each of `buckets` stretches of x.
std::vector<Eigen::Vector2d> Thinned(const std::vector<Eigen::Vector2d>& points,
                                     const AxisScale& x_axis, int buckets) {
  if (points.size() <= 4U * static_cast<std::size_t>(buckets)) {
    return points;
  }
  const auto bucket_of = [&](const Eigen::Vector2d& point) {
    return IsFinite(point) ? static_cast<int>(x_axis.Place(point.x()) * buckets) : -1;
  };
  std::vector<Eigen::Vector2d> kept;
  for (std::size_t begin = 0; begin < points.size();) {
    std::size_t end = begin + 1;
    while (end < points.size() && bucket_of(points[end]) == bucket_of(points[begin])) {
      ++end;
    }
    const auto below = [](const auto& a, const auto& b) { return a.y() < b.y(); };
    const auto first = points.begin() + static_cast<std::ptrdiff_t>(begin);
    const auto last = points.begin() + static_cast<std::ptrdiff_t>(end);
    if (bucket_of(*first) < 0) {
      kept.push_back(*first);  // one gap is as good as many
    } else {
      auto [lowest, highest] = std::minmax_element(first, last, below);
      if (highest < lowest) {
        std::swap(lowest, highest);
      }
      for (auto point : {first, lowest, highest, last - 1}) {
        if (kept.empty() || kept.back() != *point) {
          kept.push_back(*point);
        }
      }
    }
    begin = end;
  }
  return kept;
}

// One chart being drawn.
class Drawing {
 public:
  Drawing(const LineChart& chart, std::string_view id) : chart_(chart), id_(id) {}

  std::string Run(std::string_view head) {
    FitAxes();
    const double legend_end = PlaceLegend();
    const auto y_ticks = y_axis_.Ticks();
    double widest = 0.0;
    for (const double tick : y_ticks) {
      widest = std::max(widest, TextWidth(y_axis_.Label(tick)));
    }
    left_ = widest + 10.0;
    right_ = chart_.width - kRightMargin;
    top_ = legend_end + 8.0;
    bottom_ = chart_.height - kFootHeight;

    out_ = fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"chart\" viewBox=\"0 0 {0} {1}\" "
        "width=\"{0}\" height=\"{1}\" role=\"img\" aria-labelledby=\"{2}-t {2}-d\">\n{3}"
        "<title id=\"{2}-t\">{4}</title><desc id=\"{2}-d\">{5}</desc>\n",
        chart_.width, chart_.height, id_, head, Escape(chart_.title), Escape(chart_.description));
    DrawFrame(y_ticks);
    out_ += legend_;
    if (has_data_) {
      DrawBand();
      DrawMarks();
      for (std::size_t i = 0; i < chart_.series.size(); ++i) {
        DrawSeries(chart_.series[i], static_cast<int>(i) % kNumColors + 1);
      }
    } else {
      Text("note", 0.5 * (left_ + right_), 0.5 * (top_ + bottom_), "middle",
           "nothing was measured");
    }
    out_ += "</svg>\n";
    return std::move(out_);
  }

 private:
  void FitAxes() {
    Range x;
    Range y;
    for (const ChartSeries& series : chart_.series) {
      for (const Eigen::Vector2d& point : series.points) {
        if (IsFinite(point)) {
          x.Add(point.x());
          y.Add(point.y());
        }
      }
    }
    if (chart_.band) {
      std::for_each(chart_.band->x.begin(), chart_.band->x.end(), [&](double v) { x.Add(v); });
      std::for_each(chart_.band->low.begin(), chart_.band->low.end(), [&](double v) { y.Add(v); });
      std::for_each(chart_.band->high.begin(), chart_.band->high.end(),
                    [&](double v) { y.Add(v); });
    }
    has_data_ = x.low <= x.high;
    if (has_data_ && chart_.include_zero) {
      y.Add(0.0);
    }
    const int x_ticks = std::max(3, chart_.width / 70);
    const int y_ticks = std::max(3, chart_.height / 45);
    x_axis_ = MakeAxisScale(x.low, x.high, x_ticks, false);
    y_axis_ = MakeAxisScale(y.low, y.high, y_ticks, true);
  }

  // The legend's rows below the title; returns where they end.
  double PlaceLegend() {
    double x = 0.0;
    double row = chart_.title.empty() ? 12.0 : kTitleHeight + 12.0;
    bool any = false;
    const auto entry = [&](const std::string& name, const std::string& sample) {
      if (name.empty()) {
        return;
      }
      const double width = 22.0 + TextWidth(name) + 14.0;
      if (any && x + width > chart_.width) {
        x = 0.0;
        row += kRowHeight;
      }
      any = true;
      legend_ += fmt::format(
          "<g transform=\"translate({:.1f} {:.1f})\">{}<text x=\"22\" y=\"4\">{}"
          "</text></g>\n",
          x, row, sample, Escape(name));
      x += width;
    };
    for (std::size_t i = 0; i < chart_.series.size(); ++i) {
      entry(chart_.series[i].name, fmt::format("<path class=\"line c{}{}\" d=\"M0 0H16\"/>",
                                               static_cast<int>(i) % kNumColors + 1,
                                               chart_.series[i].dashed ? " dashed" : ""));
    }
    if (chart_.band) {
      entry(chart_.band->name,
            "<rect class=\"band\" x=\"0\" y=\"-5\" width=\"16\" height=\"10\"/>");
    }
    return row + (any ? 12.0 : -2.0);
  }

  void DrawFrame(std::span<const double> y_ticks) {
    if (!chart_.title.empty()) {
      Text("head", 0.0, 15.0, "start", chart_.title);
    }
    for (const double tick : y_ticks) {
      const double y = Y(tick);
      out_ += fmt::format("<path class=\"{}\" d=\"M{:.1f} {:.1f}H{:.1f}\"/>\n",
                          std::abs(tick) < 0.5 * y_axis_.step ? "zero" : "grid", left_, y, right_);
      Text("tick", left_ - 6.0, y + 4.0, "end", y_axis_.Label(tick));
    }
    for (const double tick : x_axis_.Ticks()) {
      const double x = X(tick);
      out_ += fmt::format("<path class=\"notch\" d=\"M{:.1f} {:.1f}v4\"/>\n", x, bottom_);
      // Nothing may stick out at the right.
      const bool at_end = x + 0.5 * TextWidth(x_axis_.Label(tick)) > chart_.width;
      Text("tick", at_end ? chart_.width : x, bottom_ + 16.0, at_end ? "end" : "middle",
           x_axis_.Label(tick));
    }
    Text("axis", right_, chart_.height - 3.0, "end", chart_.x_label);
    Text("axis", 0.0, chart_.height - 3.0, "start",
         chart_.y_label.empty() ? "" : "\u2191 " + chart_.y_label);
  }

  void DrawBand() {
    if (!chart_.band) {
      return;
    }
    const ChartBand& band = *chart_.band;
    const std::size_t size = std::min({band.x.size(), band.low.size(), band.high.size()});
    std::vector<Eigen::Vector2d> low;
    std::vector<Eigen::Vector2d> high;
    for (std::size_t i = 0; i < size; ++i) {
      if (std::isfinite(band.x[i]) && std::isfinite(band.low[i]) && std::isfinite(band.high[i])) {
        low.emplace_back(band.x[i], band.low[i]);
        high.emplace_back(band.x[i], band.high[i]);
      }
    }
    if (low.empty()) {
      return;
    }
    high = Thinned(high, x_axis_, Buckets());
    low = Thinned(low, x_axis_, Buckets());
    std::reverse(low.begin(), low.end());
    std::string path = "M";
    AppendPoints(high, path);
    path += 'L';
    AppendPoints(low, path);
    out_ += "<path class=\"band\" d=\"" + path + "Z\"/>\n";
  }

  void DrawMarks() {
    for (const ChartMark& mark : chart_.marks) {
      if (!std::isfinite(mark.x) || mark.x < x_axis_.low || mark.x > x_axis_.high) {
        continue;
      }
      const double x = X(mark.x);
      out_ += fmt::format("<path class=\"mark\" d=\"M{:.1f} {:.1f}V{:.1f}\"/>\n", x, top_, bottom_);
      const bool to_left = x + 4.0 + TextWidth(mark.label) > right_;
      Text("tick", x + (to_left ? -4.0 : 4.0), top_ + 9.0, to_left ? "end" : "start", mark.label);
    }
  }

  void DrawSeries(const ChartSeries& series, int color) {
    const auto points = Thinned(series.points, x_axis_, Buckets());
    std::string path;
    for (std::size_t begin = 0; begin < points.size();) {
      std::size_t end = begin;
      while (end < points.size() && IsFinite(points[end])) {
        ++end;
      }
      if (end > begin) {
        path += 'M';
        AppendPoints(std::span(points).subspan(begin, end - begin), path);
        path += end == begin + 1 ? "h0" : "";  // a lone point: a dot by its round cap
      }
      begin = end + 1;
    }
    if (path.empty()) {
      return;
    }
    out_ += fmt::format("<path class=\"line c{}{}\" d=\"{}\"/>\n", color,
                        series.dashed ? " dashed" : "", path);
    if (series.markers) {
      for (const Eigen::Vector2d& point : points) {
        if (IsFinite(point)) {
          out_ += fmt::format("<circle class=\"dot c{}\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"2.5\"/>\n",
                              color, X(point.x()), Y(point.y()));
        }
      }
    }
  }

  void AppendPoints(std::span<const Eigen::Vector2d> points, std::string& path) const {
    for (std::size_t i = 0; i < points.size(); ++i) {
      path += fmt::format("{}{:.1f} {:.1f}", i == 0 ? "" : " ", X(points[i].x()), Y(points[i].y()));
    }
  }

  void Text(std::string_view kind, double x, double y, std::string_view anchor,
            std::string_view text) {
    if (!text.empty()) {
      out_ +=
          fmt::format("<text class=\"{}\" x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\">{}</text>\n",
                      kind, x, y, anchor, Escape(text));
    }
  }

  [[nodiscard]] int Buckets() const { return std::max(1, static_cast<int>(right_ - left_)); }
  [[nodiscard]] double X(double value) const {
    return left_ + x_axis_.Place(value) * (right_ - left_);
  }
  [[nodiscard]] double Y(double value) const {
    return bottom_ - y_axis_.Place(value) * (bottom_ - top_);
  }

  const LineChart& chart_;
  std::string_view id_;
  AxisScale x_axis_;
  AxisScale y_axis_;
  bool has_data_ = false;
  double left_ = 0.0;
  double right_ = 0.0;
  double top_ = 0.0;
  double bottom_ = 0.0;
  std::string legend_;
  std::string out_;
};

}  // namespace

std::string_view ColorStyle() {
  // The colours differ in lightness as well, and for colour-blind eyes (after Okabe and Ito).
  return R"(:root{color-scheme:light dark;--paper:#fff;--ink:#1b1f24;--faint:#5b636d;--grid:#e3e6ea;
--line-1:#b4530a;--line-2:#0b62b8;--line-3:#0a7d58;--line-4:#a13d8c;--line-5:#6b6f00;--line-6:#555c66}
@media(prefers-color-scheme:dark){:root{--paper:#14171b;--ink:#e6e9ed;--faint:#9aa3ae;--grid:#2a3038;
--line-1:#f0a35e;--line-2:#6cb6ff;--line-3:#4fd0a2;--line-4:#e59ad3;--line-5:#d2d563;--line-6:#aab2bd}}
)";
}

std::string_view ChartStyle() {
  return R"(.chart{font:11px system-ui,-apple-system,"Segoe UI",Roboto,"DejaVu Sans",sans-serif;
font-variant-numeric:tabular-nums;max-width:100%;height:auto;overflow:visible}
.chart text{fill:var(--ink)}.chart .head{font-size:13px;font-weight:600}
.chart .tick,.chart .axis,.chart .note{fill:var(--faint)}
.chart path{fill:none}.chart .grid{stroke:var(--grid)}.chart .zero,.chart .notch{stroke:var(--faint)}
.chart .zero{stroke-width:.7}.chart .mark{stroke:var(--faint);stroke-dasharray:3 3}
.chart .line{stroke:var(--c);stroke-width:1.6;stroke-linejoin:round;stroke-linecap:round}
.chart .dashed{stroke-dasharray:5 4}.chart .dot{fill:var(--c)}
.chart path.band,.chart rect.band{fill:var(--line-2);opacity:.2}
.chart .c1{--c:var(--line-1)}.chart .c2{--c:var(--line-2)}.chart .c3{--c:var(--line-3)}
.chart .c4{--c:var(--line-4)}.chart .c5{--c:var(--line-5)}.chart .c6{--c:var(--line-6)}
)";
}

std::string ChartElement(const LineChart& chart, std::string_view id) {
  return Drawing(chart, id).Run("");
}

std::string ChartFile(const LineChart& chart) {
  return Drawing(chart, "chart")
      .Run(fmt::format("<style>{}{}svg{{background:var(--paper)}}</style>\n", ColorStyle(),
                       ChartStyle()));
}

}  // namespace rsstab::report
