// SPDX-License-Identifier: Apache-2.0
#include "evaluation/score_summary.h"

#include <algorithm>
#include <limits>

namespace rsstab::evaluation {
namespace {

// Below this a part of the motion is hardly there (the horizontal part of a stretch is about 0.6
// px), and shares of it say nothing.
constexpr double kNoMotion_px = 1.0;

using Group = std::vector<const SampleRecord*>;

double Ratio(double left, double uncorrected) {
  return uncorrected > kNoMotion_px ? left / uncorrected : std::numeric_limits<double>::quiet_NaN();
}

std::vector<double> Gather(const Group& group, std::size_t method, double MethodScore::*figure) {
  std::vector<double> values;
  values.reserve(group.size());
  for (const SampleRecord* sample : group) {
    values.push_back(sample->methods[method].*figure);
  }
  return values;
}

MethodSummary SummariseMethod(const Group& group, std::size_t method, std::uint64_t seed) {
  const auto mean = [&](std::size_t m, double MethodScore::*figure) {
    return Mean(Gather(group, m, figure));
  };
  const std::vector<double> epe = Gather(group, method, &MethodScore::epe_px);
  std::vector<double> difference = Gather(group, 0, &MethodScore::epe_px);
  std::vector<std::size_t> photo;
  for (std::size_t i = 0; i < group.size(); ++i) {
    difference[i] = epe[i] - difference[i];
    photo.push_back(group[i]->photo_index);
  }
  MethodSummary summary;
  summary.method = group.front()->methods[method].method;
  for (const SampleRecord* sample : group) {
    summary.declined += sample->methods[method].declined ? 1 : 0;
  }
  summary.epe_px = Mean(epe);
  summary.epe_median_px = Quantile(epe, 0.5);
  summary.epe_p90_px = Quantile(epe, 0.9);
  summary.horizontal_px = mean(method, &MethodScore::horizontal_px);
  summary.vertical_px = mean(method, &MethodScore::vertical_px);
  summary.epe_ratio = Ratio(summary.epe_px, mean(0, &MethodScore::epe_px));
  summary.horizontal_ratio = Ratio(summary.horizontal_px, mean(0, &MethodScore::horizontal_px));
  summary.vertical_ratio = Ratio(summary.vertical_px, mean(0, &MethodScore::vertical_px));
  summary.difference_px = Mean(difference);
  summary.difference_interval = BootstrapMean(difference, photo, seed);
  summary.psnr_db = mean(method, &MethodScore::psnr_db);
  summary.ssim = mean(method, &MethodScore::ssim);
  summary.valid_share = mean(method, &MethodScore::valid_share);
  summary.ms = mean(method, &MethodScore::ms);
  return summary;
}

GroupSummary SummariseGroup(const Group& group, std::string motion, bool structured_only,
                            std::uint64_t seed) {
  GroupSummary summary;
  summary.structured_only = structured_only;
  summary.motion = std::move(motion);
  summary.pictures = group.size();
  for (std::size_t method = 0; method < group.front()->methods.size(); ++method) {
    summary.methods.push_back(SummariseMethod(group, method, seed));
  }
  for (const SampleRecord* sample : group) {
    if (sample->coverage) {
      AxisCoverage& all = summary.coverage ? *summary.coverage : summary.coverage.emplace();
      for (std::size_t axis = 0; axis < all.size(); ++axis) {
        all[axis] += (*sample->coverage)[axis];
      }
    }
  }
  return summary;
}

}  // namespace

std::vector<GroupSummary> SummariseSamples(std::span<const SampleRecord> samples,
                                           std::uint64_t seed) {
  std::vector<GroupSummary> summaries;
  for (const bool structured_only : {false, true}) {
    const auto add = [&](std::string motion, const auto& belongs) {
      Group group;
      for (const SampleRecord& sample : samples) {
        if ((sample.structured || !structured_only) && belongs(sample)) {
          group.push_back(&sample);
        }
      }
      if (!group.empty()) {
        summaries.push_back(SummariseGroup(group, std::move(motion), structured_only, seed));
      }
    };
    const auto add_class = [&](MotionClass motion_class) {
      add(std::string(MotionClassName(motion_class)), [motion_class](const SampleRecord& sample) {
        return sample.motion_class == motion_class;
      });
    };
    std::for_each(kMovingClasses.begin(), kMovingClasses.end(), add_class);
    add("all", [](const SampleRecord& s) { return s.motion_class != MotionClass::kStill; });
    add_class(MotionClass::kStill);
  }
  return summaries;
}

}  // namespace rsstab::evaluation
