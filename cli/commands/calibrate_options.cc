// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/calibrate_options.h"

namespace rsstab::cli {
namespace {

pipeline::OptionTable<CalibrateOptions> BuildTable() {
  pipeline::OptionTableBuilder<CalibrateOptions> table;
  table.Group("Output");
  using O = CalibrateOptions;
  table.Add(
      pipeline::TextOption("output", "FILE", &O::output, 'o'),
      "Camera JSON to write, for --camera: what was found, how sure it is, and whether it is to be "
      "trusted (what is not counts as unknown there).");
  table.Add(pipeline::TextOption("curves", "FILE", &O::curves),
            "SVG to write: how well each readout time explains the clip.");
  table.Add(pipeline::SwitchOption("json", &O::json), "Print one JSON object instead of text.");
  table.Add(pipeline::SwitchOption("overwrite", &O::overwrite), "Replace the files if they exist.");
  return table.Take();
}

}  // namespace

const pipeline::OptionTable<CalibrateOptions>& CalibrateOptionTable() {
  static const pipeline::OptionTable<CalibrateOptions> table = BuildTable();
  return table;
}

}  // namespace rsstab::cli
