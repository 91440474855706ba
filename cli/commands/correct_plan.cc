// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/correct_plan.h"

#include <sys/stat.h>

#include <filesystem>
#include <map>
#include <set>
#include <system_error>
#include <utility>

namespace rsstab::cli {
namespace {

namespace fs = std::filesystem;

// What makes two names the same file, whatever links lie between.
using FileIdentity = std::pair<dev_t, ino_t>;

std::optional<FileIdentity> IdentityOf(const std::string& path) {
  struct stat status {};
  if (stat(path.c_str(), &status) != 0) {
    return std::nullopt;
  }
  return FileIdentity{status.st_dev, status.st_ino};
}

// Keeps account of the names that are taken.
class OutputNames {
 public:
  OutputNames(const std::vector<std::string>& inputs, bool overwrite) : overwrite_(overwrite) {
    for (const std::string& input : inputs) {
      if (const auto identity = IdentityOf(input)) {
        inputs_.insert(*identity);
      }
    }
  }

  // Takes `output` for `input`, or says why it cannot be had.
  Status Take(const std::string& input, const std::string& output) {
    if (const auto [taken, is_new] = taken_.emplace(output, input); !is_new) {
      return Fail(ErrorCode::kInvalidArgument,
                  "{}: it would be written as {}, like {}; correct them in separate runs", input,
                  output, taken->second);
    }
    const auto identity = IdentityOf(output);
    if (!identity) {
      return {};
    }
    if (inputs_.contains(*identity)) {
      return Fail(ErrorCode::kInvalidArgument,
                  "{}: {} is an input itself, name another place to write", input, output);
    }
    if (!overwrite_) {
      return Fail(ErrorCode::kInvalidArgument, "{}: {} exists; --overwrite replaces it", input,
                  output);
    }
    return {};
  }

 private:
  bool overwrite_;
  std::set<FileIdentity> inputs_;
  std::map<std::string, std::string> taken_;  // output -> its input
};

// True when the pictures go into a folder of that name. Errors: as PlanCorrections.
Result<bool> IsFolder(const CorrectOptions& options, const images::ImageList& list) {
  std::error_code ignored;
  if (fs::is_directory(options.output, ignored) || options.output.ends_with('/')) {
    return true;
  }
  if (list.is_plural && fs::exists(options.output, ignored)) {
    return Fail(ErrorCode::kInvalidArgument,
                "{}: several pictures need a folder to go to, and this is a file", options.output);
  }
  return list.is_plural;
}

}  // namespace

Result<CorrectionPlan> PlanCorrections(const CorrectOptions& options, images::ImageList list) {
  CorrectionPlan plan;
  plan.problems = std::move(list.problems);
  const auto into_folder = IsFolder(options, list);
  if (!into_folder) {
    return Propagate(into_folder.error());
  }
  if (!options.output.empty() && *into_folder) {
    plan.folders.push_back(options.output);
  }
  if (!options.field_folder.empty()) {
    plan.folders.push_back(options.field_folder);
  }
  OutputNames names(list.paths, options.overwrite);
  for (const std::string& input : list.paths) {
    CorrectionJob job;
    job.input = input;
    Status taken;
    if (!options.output.empty()) {
      job.output = *into_folder ? (fs::path(options.output) / fs::path(input).filename()).string()
                                : options.output;
      taken = names.Take(input, job.output);
    }
    if (!options.field_folder.empty()) {
      job.field.emplace(options.field_folder, fs::path(input).stem().string());
      for (const std::string& file : job.field->All()) {
        taken = taken ? names.Take(input, file) : taken;
      }
    }
    if (taken) {
      plan.jobs.push_back(std::move(job));
    } else {
      plan.problems.push_back(std::move(taken.error()));
    }
  }
  return plan;
}

}  // namespace rsstab::cli
