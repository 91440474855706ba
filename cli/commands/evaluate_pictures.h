// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_COMMANDS_EVALUATE_PICTURES_H_
#define RSSTAB_CLI_COMMANDS_EVALUATE_PICTURES_H_

#include <string>
#include <vector>

#include "cli/commands/evaluate_options.h"
#include "cli/commands/evaluation_header.h"
#include "evaluation/picture_protocol.h"
#include "evaluation/picture_summary.h"
#include "igf/base/log.h"
#include "igf/base/result.h"

namespace rsstab::cli {

// What came of a data set of labelled pictures.
struct PictureReport {
  EvaluationHeader header;
  std::string protocol;                            // "rs-real", "pairs"
  std::vector<evaluation::PictureRecord> records;  // in the order of their clips and names
  std::vector<evaluation::PictureGroup> groups;
};

// The report as a table for people, as one JSON object (figures that do not exist are null) and as
// CSV with a head line, one line for each picture and method. All end with a line feed.
[[nodiscard]] std::string FormatText(const PictureReport& report);
[[nodiscard]] std::string FormatJson(const PictureReport& report);
[[nodiscard]] std::string FormatCsv(const PictureReport& report);

// A sentence on the methods that could be asked about no picture; empty when there is none.
[[nodiscard]] std::string NotAskedText(const PictureReport& report);

// The data set that the options name. Errors: kInvalidArgument without a folder; those of the data
// set.
[[nodiscard]] Result<std::unique_ptr<evaluation::PictureSet>> OpenPictureSet(
    const EvaluateOptions& options);

// Runs the methods that `factory` makes on RS-Real or pairs, as the options say. Pictures that
// cannot be used are named by a warning and left out. With a state file, or with CSV or JSON beside
// which one may lie meanwhile, a stopped run goes on where it was; when that file can no longer be
// written, a warning says so. Errors: kInvalidArgument without a folder or for a state of other
// settings; those of the data set and of RunPictureProtocol; the first picture's when every one
// failed.
[[nodiscard]] Result<PictureReport> EvaluatePictures(
    const EvaluateOptions& options, const evaluation::MethodFactory& factory, const Logger& logger,
    const evaluation::EvaluationProgress& progress = {});

// Removes the state that EvaluatePictures kept without being told where, once its figures are
// written.
void RemoveOwnState(const EvaluateOptions& options);

}  // namespace rsstab::cli

#endif  // RSSTAB_CLI_COMMANDS_EVALUATE_PICTURES_H_
