// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/evaluate_pictures.h"

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <map>
#include <memory>
#include <set>
#include <system_error>
#include <utility>

#include "cli/commands/evaluation_state.h"
#include "cli/datasets/pair_set.h"
#include "cli/datasets/rs_real_set.h"
#include "igf/base/parallel_for.h"

namespace rsstab::cli {
namespace {

using evaluation::ClipResult;
using evaluation::EvaluationProgress;
using evaluation::MethodFactory;
using evaluation::PictureClip;
using evaluation::PictureRecord;
using evaluation::PictureSet;

const char* SplitName(DatasetSplit split) {
  switch (split) {
    case DatasetSplit::kTrain:
      return "train";
    case DatasetSplit::kTest:
      return "test";
    case DatasetSplit::kAll:
      break;
  }
  return "all";
}

// The first clips of a data set, whole ones: as many as hold the first `limit` pictures.
class FirstPictures final : public PictureSet {
 public:
  FirstPictures(const PictureSet& set, std::int64_t limit) : set_(set) {
    std::int64_t left = limit;
    for (const PictureClip& clip : set.Clips()) {
      if (limit > 0 && left <= 0) {
        break;
      }
      clips_.push_back(clip);
      left -= static_cast<std::int64_t>(clip.pictures.size());
    }
  }
  [[nodiscard]] std::span<const PictureClip> Clips() const override { return clips_; }
  [[nodiscard]] Result<evaluation::LabelledPicture> Load(const std::string& name) const override {
    return set_.Load(name);
  }

 private:
  const PictureSet& set_;
  std::vector<PictureClip> clips_;
};

// Options that change the figures; what is done with other ones is of no use.
std::string SettingsText(const EvaluateOptions& options) {
  const std::set<std::string> decisive = {"dataset",
                                          "reference-row",
                                          "methods",
                                          "model",
                                          "regression-model",
                                          "reference-model",
                                          "device",
                                          "samples",
                                          "steps",
                                          "guidance",
                                          "eta",
                                          "know-focal",
                                          "seed"};
  std::string text;
  for (const auto& spec : EvaluateOptionTable()) {
    if (decisive.contains(spec.name)) {
      text += spec.name + "=" + spec.get(options) + "\n";
    }
  }
  return text;
}

// Where the state lies; empty where nothing is kept.
std::string StatePath(const EvaluateOptions& options) {
  if (!options.state.empty()) {
    return options.state;
  }
  const std::string& beside = options.csv.empty() ? options.json : options.csv;
  return beside.empty() ? "" : beside + ".state";
}

void SortAsSet(const PictureSet& set, std::vector<PictureRecord>& records) {
  std::map<std::string, std::size_t> place;
  for (const PictureClip& clip : set.Clips()) {
    for (const std::string& picture : clip.pictures) {
      place.emplace(picture, place.size());
    }
  }
  std::erase_if(records, [&](const PictureRecord& r) { return !place.contains(r.name); });
  std::sort(records.begin(), records.end(), [&](const PictureRecord& a, const PictureRecord& b) {
    return place[a.name] < place[b.name];
  });
}

}  // namespace

Result<std::unique_ptr<evaluation::PictureSet>> OpenPictureSet(const EvaluateOptions& options) {
  const bool is_pairs = options.protocol == EvaluationProtocol::kPairs;
  const std::string& folder = is_pairs ? options.pairs : options.rs_real;
  if (folder.empty()) {
    return Fail(ErrorCode::kInvalidArgument,
                "--dataset {0}:FOLDER (or --pairs): the protocol {0} needs a folder to look in.",
                is_pairs ? "pairs" : "rs-real");
  }
  return is_pairs ? datasets::OpenPairs(folder, options.reference_row == ReferenceRow::kFirst)
                  : datasets::OpenRsReal(folder, SplitName(options.split));
}

Result<PictureReport> EvaluatePictures(const EvaluateOptions& options, const MethodFactory& factory,
                                       const Logger& logger, const EvaluationProgress& progress) {
  auto whole = OpenPictureSet(options);
  if (!whole) {
    return Propagate(whole.error());
  }
  const FirstPictures set(**whole, options.limit);
  const std::string state_path = StatePath(options);
  EvaluationState state;
  if (!state_path.empty()) {
    auto opened = EvaluationState::Open(state_path, SettingsText(options));
    if (!opened) {
      return Propagate(opened.error());
    }
    state = std::move(*opened);
    if (!state.DoneClips().empty()) {
      logger->info("evaluate: {} clips or pictures are done already, as {} says",
                   state.DoneClips().size(), state_path);
    }
  }
  bool keeps_state = true;
  PictureReport report;
  report.protocol = options.protocol == EvaluationProtocol::kPairs ? "pairs" : "rs-real";
  report.records = state.Records();
  std::vector<std::pair<std::string, Error>> failures;
  const Status status = evaluation::RunPictureProtocol(
      set,
      {static_cast<std::uint64_t>(options.seed), ResolveThreadCount(options.jobs),
       state.DoneClips()},
      factory,
      [&](ClipResult clip) -> Status {
        // The figures are still good for the report.
        if (const Status added = state.Add(clip); !added && keeps_state) {
          logger->warn("evaluate: {} What is done from here on would be lost by a stop.",
                       added.error().message);
          keeps_state = false;
        }
        for (evaluation::PictureFailure& failure : clip.failures) {
          failures.emplace_back(failure.name, failure.error);
        }
        std::move(clip.records.begin(), clip.records.end(), std::back_inserter(report.records));
        return {};
      },
      progress);
  if (!status && status.error().code == ErrorCode::kCancelled && !state_path.empty()) {
    return Fail(ErrorCode::kCancelled, "Stopped; the same command goes on from {}.", state_path);
  }
  if (!status) {
    return Propagate(status.error());
  }
  std::sort(failures.begin(), failures.end(),
            [](const auto& a, const auto& b) { return a.first < b.first; });
  SortAsSet(set, report.records);
  report.header = MakeHeader(options, std::move(failures));
  WarnOfFailures(report.header, logger);
  if (report.records.empty() && !report.header.failures.empty()) {
    return Propagate(report.header.failures.front().second);
  }
  report.groups =
      evaluation::SummarisePictures(report.records, static_cast<std::uint64_t>(options.seed));
  return report;
}

void RemoveOwnState(const EvaluateOptions& options) {
  if (options.state.empty()) {
    std::error_code ignored;
    std::filesystem::remove(StatePath(options), ignored);
  }
}

}  // namespace rsstab::cli
