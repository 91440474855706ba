// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/evaluate_check.h"

#include <array>
#include <vector>

#include "cli/commands/clip_method.h"
#include "cli/commands/evaluate_methods.h"

namespace rsstab::cli {
namespace {

// An option that names data of one kind.
struct Source {
  const char* option;
  const char* protocol;
  EvaluationProtocol kind;
};
constexpr std::array<Source, 3> kSources = {
    {{"photos", "synthetic-val", EvaluationProtocol::kSyntheticVal},
     {"pairs", "pairs", EvaluationProtocol::kPairs},
     {"clips", "clips", EvaluationProtocol::kClips}}};

const std::string& FolderOf(const EvaluateOptions& options) {
  switch (options.protocol) {
    case EvaluationProtocol::kPairs:
      return options.pairs;
    case EvaluationProtocol::kRsReal:
      return options.rs_real;
    case EvaluationProtocol::kClips:
      return options.clips;
    case EvaluationProtocol::kSyntheticVal:
      break;
  }
  return options.photos;
}

Status CheckData(const EvaluateOptions& options, const std::set<std::string>& given) {
  std::vector<std::string> named;
  for (const char* option : {"dataset", "photos", "pairs", "clips"}) {
    if (given.contains(option)) {
      named.push_back(std::string("--") + option);
    }
  }
  if (named.empty()) {
    return Fail(ErrorCode::kInvalidArgument,
                "there is nothing to evaluate on: name --dataset, --photos or --clips");
  }
  if (named.size() > 1) {
    return Fail(ErrorCode::kInvalidArgument,
                "{} and {} both name data; an evaluation is of one kind", named[0], named[1]);
  }
  if (given.contains("dataset") && FolderOf(options).empty()) {
    return Fail(ErrorCode::kInvalidArgument,
                "--protocol is another than that of --dataset; leave it out");
  }
  for (const Source& source : kSources) {
    // Clips imply their protocol.
    const bool is_told = given.contains("protocol") || source.kind != EvaluationProtocol::kClips;
    if (given.contains(source.option) && is_told && options.protocol != source.kind) {
      return Fail(ErrorCode::kInvalidArgument,
                  "--{0} goes with the protocol {1}: say --dataset {1}:FOLDER", source.option,
                  source.protocol);
    }
  }
  return {};
}

}  // namespace

Status Validate(const EvaluateOptions& options, const std::set<std::string>& given) {
  if (Status status = CheckData(options, given); !status) {
    return status;
  }
  const bool is_clips = options.protocol == EvaluationProtocol::kClips || !options.clips.empty();
  const bool keeps_state = !is_clips && options.protocol != EvaluationProtocol::kSyntheticVal;
  if (given.contains("state") && !keeps_state) {
    return Fail(ErrorCode::kInvalidArgument,
                "--state: only evaluations on rs-real and pairs keep what is done");
  }
  if (!is_clips) {
    return CheckPictureMethods(options);
  }
  if (!given.contains("methods")) {
    return {};
  }
  const auto methods = ParseClipMethods(options.methods);
  return methods ? Status() : Status(Propagate(methods.error()));
}

}  // namespace rsstab::cli
