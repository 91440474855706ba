// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/compare_options.h"

namespace rsstab::cli {
namespace {

pipeline::OptionTable<CompareOptions> BuildTable() {
  pipeline::OptionTableBuilder<CompareOptions> table;
  using O = CompareOptions;
  table.Group("Measuring");
  table.Add(
      pipeline::TextOption("truth", "FILE", &O::truth),
      "What simulate wrote (its folder, or the truth.json in it): the clips are then measured "
      "against the exact global-shutter picture of each instant as well.");

  table.Group("Output");
  table.Add(pipeline::SwitchOption("json", &O::json), "Print one JSON object instead of a table.");
  table.Add(
      pipeline::TextOption("report", "FILE", &O::report),
      "Also write an HTML page, all in one file, with pictures before and after, the camera path "
      "and every figure.");
  table.Add(pipeline::SwitchOption("overwrite", &O::overwrite), "Replace the report if it exists.");

  table.Group("Running");
  table.Add(pipeline::IntegerOption("threads", "N", &O::threads, 0, 1024),
            "Threads to decode and measure with; 0 takes one for each processor.");
  return table.Take();
}

}  // namespace

const pipeline::OptionTable<CompareOptions>& CompareOptionTable() {
  static const pipeline::OptionTable<CompareOptions> table = BuildTable();
  return table;
}

}  // namespace rsstab::cli
