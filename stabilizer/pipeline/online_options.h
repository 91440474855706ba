// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_STABILIZER_PIPELINE_ONLINE_OPTIONS_H_
#define RSSTAB_STABILIZER_PIPELINE_ONLINE_OPTIONS_H_

#include "igf/base/result.h"
#include "stabilizer/pipeline/option_table.h"
#include "stabilizer/pipeline/stabilize_options.h"

namespace rsstab::pipeline {

inline constexpr int kMaxLookahead = 600;

// What a host inside another program may choose: all of the stabilizer, and how far live mode looks
// ahead.
struct OnlineOptions {
  StabilizeOptions stabilize;
  int lookahead_frames = 30;  // 0..kMaxLookahead; the delay of the steady frames
};

// StabilizeOptionTable() and "lookahead". Any thread.
[[nodiscard]] const OptionTable<OnlineOptions>& OnlineOptionTable();

// Errors: kInvalidArgument naming the option.
[[nodiscard]] Status Validate(const OnlineOptions& options);

}  // namespace rsstab::pipeline

#endif  // RSSTAB_STABILIZER_PIPELINE_ONLINE_OPTIONS_H_
