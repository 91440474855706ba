// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/evaluation_state.h"

#include <array>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>
#include <system_error>
#include <utility>

#include "cli/commands/evaluate_report_detail.h"
#include "igf/base/whole_file.h"

namespace rsstab::cli {
namespace {

using detail::Json;
using evaluation::kUnknown;
using evaluation::MethodFigures;
using evaluation::PictureRecord;

constexpr const char* kFormat = "rs-stabilize evaluation state 1";
constexpr std::uint64_t kMostBytes = 4ULL << 30U;

constexpr std::array<std::pair<const char*, double MethodFigures::*>, 11> kFigures = {
    {{"psnr", &MethodFigures::psnr_db},
     {"ssim", &MethodFigures::ssim},
     {"psnr_untouched", &MethodFigures::untouched_psnr_db},
     {"ssim_untouched", &MethodFigures::untouched_ssim},
     {"epe", &MethodFigures::epe_px},
     {"u", &MethodFigures::horizontal_px},
     {"v", &MethodFigures::vertical_px},
     {"flicker", &MethodFigures::flicker_px},
     {"valid", &MethodFigures::valid_share},
     {"moved", &MethodFigures::moved_px},
     {"ms", &MethodFigures::ms}}};

constexpr std::array<std::pair<const char*, std::string PictureRecord::*>, 5> kTexts = {
    {{"name", &PictureRecord::name},
     {"clip", &PictureRecord::clip},
     {"split", &PictureRecord::split},
     {"strength", &PictureRecord::strength},
     {"source", &PictureRecord::source}}};

Json ToJson(const PictureRecord& record) {
  Json json;
  for (const auto& [name, text] : kTexts) {
    json[name] = record.*text;
  }
  json["width"] = record.width;
  json["height"] = record.height;
  for (const MethodFigures& method : record.methods) {
    Json figures = {{"method", method.method}, {"declined", method.declined}};
    for (const auto& [name, figure] : kFigures) {
      figures[name] = detail::OrNull(method.*figure);
    }
    json["methods"].push_back(std::move(figures));
  }
  return json;
}

PictureRecord FromJson(const Json& json) {
  PictureRecord record;
  for (const auto& [name, text] : kTexts) {
    record.*text = json.at(name).get<std::string>();
  }
  record.width = json.at("width").get<int>();
  record.height = json.at("height").get<int>();
  for (const Json& figures : json.at("methods")) {
    MethodFigures method;
    method.method = figures.at("method").get<std::string>();
    method.declined = figures.at("declined").get<bool>();
    for (const auto& [name, figure] : kFigures) {
      const Json& value = figures.at(name);
      method.*figure = value.is_null() ? kUnknown : value.get<double>();
    }
    record.methods.push_back(std::move(method));
  }
  return record;
}

std::string Line(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace

Result<EvaluationState> EvaluationState::Open(const std::string& path,
                                              const std::string& settings) {
  EvaluationState state;
  state.path_ = path;
  const std::string head = Line({{"format", kFormat}, {"settings", settings}});
  std::string whole = head;
  std::error_code ignored;
  if (std::filesystem::exists(path, ignored)) {
    const auto text = ReadWholeFile(path, kMostBytes);
    if (!text) {
      return Propagate(text.error());
    }
    std::istringstream lines(*text);
    std::string line;
    std::getline(lines, line);
    if (line + "\n" != head) {
      return Fail(ErrorCode::kInvalidArgument,
                  "{}: this file is of an evaluation with other settings; remove it, or name "
                  "another with --state.",
                  path);
    }
    while (std::getline(lines, line)) {
      try {
        const Json json = Json::parse(line);
        std::vector<PictureRecord> records;
        for (const Json& record : json.at("records")) {
          records.push_back(FromJson(record));
        }
        state.done_.insert(json.at("clip").get<std::string>());
        state.records_.insert(state.records_.end(), records.begin(), records.end());
      } catch (const Json::exception&) {
        break;  // what a stop cut off
      }
      whole += line + "\n";
    }
  }
  if (Status status = WriteWholeFile(path, whole); !status) {
    return Propagate(status.error());
  }
  state.file_.open(path, std::ios::app);
  if (!state.file_) {
    return Fail(ErrorCode::kIo, "{}: the file cannot be written.", path);
  }
  return state;
}

Status EvaluationState::Add(const evaluation::ClipResult& clip) {
  if (path_.empty() || clip.records.empty() || !clip.failures.empty()) {
    return {};
  }
  Json json = {{"clip", clip.records.front().clip}};
  for (const PictureRecord& record : clip.records) {
    json["records"].push_back(ToJson(record));
  }
  file_ << Line(json) << std::flush;
  if (!file_) {
    return Fail(ErrorCode::kIo, "{}: the file cannot be written.", path_);
  }
  return {};
}

}  // namespace rsstab::cli
