// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/compare_options.h"

#include <utility>

namespace rsstab::cli {
namespace {

pipeline::OptionTable<CompareOptions> BuildTable() {
  pipeline::OptionTable<CompareOptions> table;
  const auto add = [&](pipeline::OptionSpec<CompareOptions> spec, std::string group,
                       std::string help) {
    spec.group = std::move(group);
    spec.help = std::move(help);
    table.push_back(std::move(spec));
  };
  using O = CompareOptions;
  add(pipeline::TextOption("truth", "FILE", &O::truth), "Measuring",
      "What simulate wrote (its folder, or the truth.json in it): the clips are then measured "
      "against the exact global-shutter picture of each instant as well.");
  add(pipeline::SwitchOption("json", &O::json), "Output",
      "Print one JSON object instead of a table.");
  add(pipeline::TextOption("report", "FILE", &O::report), "Output",
      "Also write an HTML page, all in one file, with pictures before and after, the camera path "
      "and every figure.");
  add(pipeline::SwitchOption("overwrite", &O::overwrite), "Output",
      "Replace the report if it exists.");
  add(pipeline::IntegerOption("threads", "N", &O::threads, 0, 1024), "Running",
      "Threads to decode and measure with; 0 takes one for each processor.");
  return table;
}

}  // namespace

const pipeline::OptionTable<CompareOptions>& CompareOptionTable() {
  static const pipeline::OptionTable<CompareOptions> table = BuildTable();
  return table;
}

}  // namespace rsstab::cli
