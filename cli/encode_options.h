// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_ENCODE_OPTIONS_H_
#define RSSTAB_CLI_ENCODE_OPTIONS_H_

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "stabilizer/pipeline/option_table.h"

namespace rsstab::cli {

// How and where the steady clip is written. Defaults are the member initialisers.
struct EncodeOptions {
  std::string output;  // empty: beside the input; "-": standard output
  bool overwrite = false;
  std::string report;         // file for an HTML page; empty: none
  std::string codec;          // empty: what fits the container, H.264 where it can
  std::optional<double> crf;  // empty: 18 for H.264, similar elsewhere
  std::string preset;         // empty: medium
  std::string pix_fmt;        // empty: the clip's own, or the nearest the encoder takes
  std::vector<std::pair<std::string, std::string>> encoder_options;  // passed on unseen
};

[[nodiscard]] const pipeline::OptionTable<EncodeOptions>& EncodeOptionTable();

}  // namespace rsstab::cli

#endif  // RSSTAB_CLI_ENCODE_OPTIONS_H_
