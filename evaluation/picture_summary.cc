// SPDX-License-Identifier: Apache-2.0
#include "evaluation/picture_summary.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <map>
#include <utility>

namespace rsstab::evaluation {
namespace {

using Group = std::vector<const PictureRecord*>;
using Figure = std::function<double(const PictureRecord& record)>;

// The figures that exist, and which source each belongs to.
struct Column {
  std::vector<double> values;
  std::vector<std::size_t> sources;
};

Column Gather(const Group& group, const Figure& figure) {
  Column column;
  std::map<std::string, std::size_t> numbers;
  for (const PictureRecord* record : group) {
    if (const double value = figure(*record); std::isfinite(value)) {
      const std::string& source = record->source.empty() ? record->clip : record->source;
      column.values.push_back(value);
      column.sources.push_back(numbers.emplace(source, numbers.size()).first->second);
    }
  }
  return column;
}

MeanFigure MeanOf(const Column& column, std::uint64_t seed) {
  return {Mean(column.values), BootstrapMean(column.values, column.sources, seed)};
}

PictureMethodSummary SummariseMethod(const Group& group, std::size_t method, std::uint64_t seed) {
  const auto column = [&](double MethodFigures::*figure) {
    return Gather(group, [&](const PictureRecord& r) { return r.methods[method].*figure; });
  };
  const auto mean = [&](double MethodFigures::*figure) { return Mean(column(figure).values); };
  PictureMethodSummary summary;
  summary.method = group.front()->methods[method].method;
  for (const PictureRecord* record : group) {
    summary.pictures += record->methods[method].Answered() ? 1 : 0;
    summary.declined += record->methods[method].declined ? 1 : 0;
  }
  const Column epe = column(&MethodFigures::epe_px);
  summary.psnr_db = MeanOf(column(&MethodFigures::psnr_db), seed);
  summary.ssim = MeanOf(column(&MethodFigures::ssim), seed);
  summary.epe_px = MeanOf(epe, seed);
  summary.epe_change_px = MeanOf(Gather(group,
                                        [&](const PictureRecord& r) {
                                          return r.methods[method].epe_px - r.methods[0].epe_px;
                                        }),
                                 seed);
  summary.flicker_px = MeanOf(column(&MethodFigures::flicker_px), seed);
  summary.epe_median_px = Quantile(epe.values, 0.5);
  summary.epe_p90_px = Quantile(epe.values, 0.9);
  summary.horizontal_px = mean(&MethodFigures::horizontal_px);
  summary.vertical_px = mean(&MethodFigures::vertical_px);
  summary.untouched_psnr_db = mean(&MethodFigures::untouched_psnr_db);
  summary.untouched_ssim = mean(&MethodFigures::untouched_ssim);
  summary.valid_share = mean(&MethodFigures::valid_share);
  summary.moved_px = mean(&MethodFigures::moved_px);
  summary.ms = mean(&MethodFigures::ms);
  return summary;
}

PictureGroup SummariseGroup(const std::string& title, const Group& group, std::uint64_t seed) {
  PictureGroup summary;
  summary.title = title;
  summary.pictures = group.size();
  for (std::size_t method = 0; method < group.front()->methods.size(); ++method) {
    summary.methods.push_back(SummariseMethod(group, method, seed));
  }
  return summary;
}

}  // namespace

std::vector<PictureMethodSummary> PictureGroup::Asked() const {
  std::vector<PictureMethodSummary> asked;
  std::copy_if(methods.begin(), methods.end(), std::back_inserter(asked),
               [](const PictureMethodSummary& method) { return method.pictures > 0; });
  return asked;
}

std::vector<std::string> PictureGroup::NotAsked() const {
  std::vector<std::string> names;
  for (const PictureMethodSummary& method : methods) {
    if (method.pictures == 0) {
      names.push_back(method.method);
    }
  }
  return names;
}

std::vector<PictureGroup> SummarisePictures(std::span<const PictureRecord> records,
                                            std::uint64_t seed) {
  std::vector<PictureGroup> summaries;
  if (records.empty()) {
    return summaries;
  }
  Group all;
  for (const PictureRecord& record : records) {
    all.push_back(&record);
  }
  summaries.push_back(SummariseGroup("all", all, seed));
  const auto add_kinds = [&](const char* kind, std::string PictureRecord::*value) {
    std::vector<std::pair<std::string, Group>> groups;  // in the order in which they come
    for (const PictureRecord* record : all) {
      const auto same = [&](const auto& group) { return group.first == record->*value; };
      auto group = std::find_if(groups.begin(), groups.end(), same);
      if (group == groups.end()) {
        group = groups.insert(groups.end(), {record->*value, {}});
      }
      group->second.push_back(record);
    }
    if (groups.size() > 1) {
      for (const auto& [name, group] : groups) {
        summaries.push_back(
            SummariseGroup(std::string(kind) + " " + (name.empty() ? "?" : name), group, seed));
      }
    }
  };
  add_kinds("split", &PictureRecord::split);
  add_kinds("strength", &PictureRecord::strength);
  return summaries;
}

}  // namespace rsstab::evaluation
