// SPDX-License-Identifier: Apache-2.0
#include "cli/report/field_panels.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include "cli/images/flow_colors.h"
#include "cli/report/preview.h"
#include "igf/base/parallel_for.h"

namespace rsstab::report {
namespace {

// Fields are smooth: more pixels show no more.
constexpr int kPanelWidth = 320;
constexpr int kKeySize = 96;

Result<std::string> Colored(const MotionField& field, double full_px, int quarter_turns) {
  WorkerPool workers(1);
  const auto colors = images::FlowColors(field, workers, full_px);
  if (!colors) {
    return Propagate(colors.error());
  }
  return DataUri(colors->View(), PictureFormat::kPng, quarter_turns);
}

}  // namespace

Result<Panel> FieldPanel(const MotionField& field, double full_px, const std::string& title,
                         const std::string& note, int quarter_turns) {
  const int width = std::min(field.width(), kPanelWidth);
  const double shrink = static_cast<double>(width) / field.width();
  const int height = std::max(1, static_cast<int>(std::lround(field.height() * shrink)));
  auto uri = Colored(field.Rescaled(width, height), full_px * shrink, quarter_turns);
  if (!uri) {
    return Propagate(uri.error());
  }
  const bool on_its_side = quarter_turns % 2 != 0;
  return Panel{title, note, std::move(*uri), on_its_side ? height : width,
               on_its_side ? width : height};
}

Result<ColorKey> FieldKey(double full_px, int quarter_turns) {
  // Displacement proportional to the place, so two vertices a side describe it exactly.
  MotionField disc(kKeySize, kKeySize, 2, 2);
  for (int row = 0; row < 2; ++row) {
    for (int column = 0; column < 2; ++column) {
      disc.At(column, row) = {column == 0 ? -1.0F : 1.0F, row == 0 ? -1.0F : 1.0F};
    }
  }
  auto uri = Colored(disc, 1.0, quarter_turns);
  if (!uri) {
    return Propagate(uri.error());
  }
  return ColorKey{std::move(*uri), true, "",
                  fmt::format("the colour tells where a pixel was taken from, seen from the middle "
                              "of the disc; its rim is {:.1f} px away",
                              full_px)};
}

}  // namespace rsstab::report
