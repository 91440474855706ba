// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/pipeline/online_options.h"

#include <string>
#include <utility>

namespace rsstab::pipeline {
namespace {

OptionSpec<OnlineOptions> Adapt(const OptionSpec<StabilizeOptions>& spec) {
  OptionSpec<OnlineOptions> adapted;
  adapted.name = spec.name;
  adapted.short_name = spec.short_name;
  adapted.value_name = spec.value_name;
  adapted.range = spec.range;
  adapted.help = spec.help;
  adapted.group = spec.group;
  adapted.stage = spec.stage;
  adapted.repeatable = spec.repeatable;
  adapted.set = [set = spec.set](OnlineOptions& options, const std::string& text) {
    return set(options.stabilize, text);
  };
  adapted.get = [get = spec.get](const OnlineOptions& options) { return get(options.stabilize); };
  return adapted;
}

OptionTable<OnlineOptions> BuildTable() {
  OptionTable<OnlineOptions> table;
  for (const auto& spec : StabilizeOptionTable()) {
    table.push_back(Adapt(spec));
  }
  auto lookahead =
      IntegerOption("lookahead", "N", &OnlineOptions::lookahead_frames, 0, kMaxLookahead);
  lookahead.group = "Live";
  lookahead.help =
      "Frames that live mode looks ahead, and by which the steady ones come later; 0 smooths by "
      "the "
      "past alone.";
  table.push_back(std::move(lookahead));
  return table;
}

}  // namespace

const OptionTable<OnlineOptions>& OnlineOptionTable() {
  static const OptionTable<OnlineOptions> table = BuildTable();
  return table;
}

Status Validate(const OnlineOptions& options) {
  if (Status ok = Validate(options.stabilize); !ok) {
    return ok;
  }
  return ValidateOptions(OnlineOptionTable(), options);
}

}  // namespace rsstab::pipeline
