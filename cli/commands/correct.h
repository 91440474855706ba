// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_COMMANDS_CORRECT_H_
#define RSSTAB_CLI_COMMANDS_CORRECT_H_

#include <cstdint>
#include <functional>

#include "cli/commands/correct_options.h"
#include "igf/base/log.h"
#include "igf/base/result.h"

namespace rsstab::cli {

// Called before the first and after each picture, corrected or not; false stops.
using CorrectProgress = std::function<bool(std::int64_t pictures_done, std::int64_t pictures)>;

// Takes the rolling shutter out of photographs. A picture that fails is told as an error, and the
// others go on; every file gets its name when it is complete.
// Errors: those of rsdiff::FindModel and rsdiff::SingleImageEstimator::Load; kCancelled; that of
// the picture when there was only one, else kIo when any failed.
[[nodiscard]] Status RunCorrect(const CorrectOptions& options, const Logger& logger,
                                const CorrectProgress& progress = {});

}  // namespace rsstab::cli

#endif  // RSSTAB_CLI_COMMANDS_CORRECT_H_
