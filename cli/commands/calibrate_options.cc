// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/calibrate_options.h"

#include <utility>

namespace rsstab::cli {
namespace {

pipeline::OptionTable<CalibrateOptions> BuildTable() {
  pipeline::OptionTable<CalibrateOptions> table;
  const auto add = [&](pipeline::OptionSpec<CalibrateOptions> spec, std::string help) {
    spec.group = "Output";
    spec.help = std::move(help);
    table.push_back(std::move(spec));
  };
  using O = CalibrateOptions;
  auto output = pipeline::TextOption("output", "FILE", &O::output);
  output.short_name = 'o';
  add(std::move(output),
      "Camera JSON to write, for --camera: what was found, how sure it is, and whether it is to be "
      "trusted (what is not counts as unknown there).");
  add(pipeline::TextOption("curves", "FILE", &O::curves),
      "SVG to write: how well each readout time explains the clip.");
  add(pipeline::SwitchOption("json", &O::json), "Print one JSON object instead of text.");
  add(pipeline::SwitchOption("overwrite", &O::overwrite), "Replace the files if they exist.");
  return table;
}

}  // namespace

const pipeline::OptionTable<CalibrateOptions>& CalibrateOptionTable() {
  static const pipeline::OptionTable<CalibrateOptions> table = BuildTable();
  return table;
}

}  // namespace rsstab::cli
