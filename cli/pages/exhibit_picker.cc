// SPDX-License-Identifier: Apache-2.0
#include "cli/pages/exhibit_picker.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace rsstab::cli {
namespace {

constexpr int kPreviewWidth = 960;
// Evenly spaced frames among which the average one is looked for; halved when there are so many.
constexpr std::size_t kMostSamples = 8;

bool IsMore(const std::optional<double>& value, const std::optional<double>& than) {
  return value && (!than || *value > *than);
}

}  // namespace

Result<Exhibit> ExhibitPicker::Keep(const ExhibitCandidate& candidate) const {
  Exhibit exhibit;
  exhibit.index = candidate.index;
  exhibit.time_s = candidate.time_s;
  exhibit.shake_px = candidate.shake_px;
  exhibit.rs_px = candidate.rs_px;
  if (candidate.rs_field != nullptr) {
    exhibit.rs_field = *candidate.rs_field;
  }
  auto input = report::MakePreview(candidate.input, kPreviewWidth, matrix_);
  if (!input) {
    return Propagate(input.error());
  }
  auto output = report::MakePreview(candidate.output, kPreviewWidth, matrix_);
  if (!output) {
    return Propagate(output.error());
  }
  exhibit.input = std::move(*input);
  exhibit.output = std::move(*output);
  if (candidate.twin != nullptr) {
    auto twin = report::MakePreview(*candidate.twin, kPreviewWidth, matrix_);
    if (!twin) {
      return Propagate(twin.error());
    }
    exhibit.twin = std::move(*twin);
  }
  return exhibit;
}

Status ExhibitPicker::KeepSample(const ExhibitCandidate& candidate) {
  if (candidate.index % sample_step_ != 0) {
    return {};
  }
  if (samples_.size() == kMostSamples) {
    sample_step_ *= 2;
    std::erase_if(samples_, [this](const Exhibit& e) { return e.index % sample_step_ != 0; });
    if (candidate.index % sample_step_ != 0) {
      return {};
    }
  }
  auto kept = Keep(candidate);
  if (!kept) {
    return Propagate(kept.error());
  }
  samples_.push_back(std::move(*kept));
  return {};
}

Status ExhibitPicker::Push(const ExhibitCandidate& candidate) {
  const auto replace = [&](std::optional<Exhibit>& place) -> Status {
    auto kept = Keep(candidate);
    if (!kept) {
      return Propagate(kept.error());
    }
    place = std::move(*kept);
    return {};
  };
  if (IsMore(candidate.rs_px, most_rs_ ? most_rs_->rs_px : std::nullopt)) {
    if (Status status = replace(most_rs_); !status) {
      return status;
    }
  }
  if (candidate.shake_px) {
    shakes_.push_back(static_cast<float>(*candidate.shake_px));
    if (IsMore(candidate.shake_px, most_shake_ ? most_shake_->shake_px : std::nullopt)) {
      if (Status status = replace(most_shake_); !status) {
        return status;
      }
    }
  }
  return KeepSample(candidate);
}

std::vector<Exhibit> ExhibitPicker::Finish() {
  std::vector<Exhibit> exhibits;
  const auto show = [&exhibits](Exhibit exhibit, const char* reason) {
    for (Exhibit& shown : exhibits) {
      if (shown.index == exhibit.index) {
        shown.reason += std::string(", ") + reason;
        return;
      }
    }
    exhibit.reason = reason;
    exhibits.push_back(std::move(exhibit));
  };
  if (most_rs_) {
    show(std::move(*most_rs_), "most rolling shutter");
  }
  if (most_shake_) {
    show(std::move(*most_shake_), "most shake");
  }
  if (!samples_.empty()) {
    double median = 0.0;
    if (!shakes_.empty()) {
      const auto middle = shakes_.begin() + static_cast<std::ptrdiff_t>(shakes_.size() / 2);
      std::nth_element(shakes_.begin(), middle, shakes_.end());
      median = *middle;
    }
    const auto distance = [median](const Exhibit& e) {
      return e.shake_px ? std::abs(*e.shake_px - median) : 1e9;
    };
    const auto average = std::min_element(
        samples_.begin(), samples_.end(),
        [&](const Exhibit& a, const Exhibit& b) { return distance(a) < distance(b); });
    show(std::move(*average), "average shake");
  }
  *this = ExhibitPicker(matrix_);
  return exhibits;
}

}  // namespace rsstab::cli
