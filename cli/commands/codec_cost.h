// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_COMMANDS_CODEC_COST_H_
#define RSSTAB_CLI_COMMANDS_CODEC_COST_H_

#include <string>

#include "cli/encode_options.h"
#include "igf/base/result.h"

namespace rsstab::cli {

// Wall time that a clip takes without any work on it, s: what every stabilizer pays for its passes.
struct CodecCost {
  double decode_s = 0.0;
  double recode_s = 0.0;  // decode and encode, side by side
};

// Reads the clip once, then once more while writing it to encode.output, in the threads that the
// stabilizer's own passes use.
// Errors: those of reader and writer; kCancelled when the user asked to stop.
[[nodiscard]] Result<CodecCost> MeasureCodecCost(const std::string& clip,
                                                 const EncodeOptions& encode);

}  // namespace rsstab::cli

#endif  // RSSTAB_CLI_COMMANDS_CODEC_COST_H_
