// SPDX-License-Identifier: Apache-2.0
#include "cli/pages/compare_page.h"

#include <utility>

#include "cli/pages/clip_page.h"
#include "cli/pages/page_parts.h"

namespace rsstab::cli {

Status ComparePage::Observe(const ComparedFrames& frames) {
  const std::optional<double> shake = shake_.Next(frames.input_meter->LastStep());
  if (frames.input == nullptr || frames.output == nullptr) {
    return {};
  }
  if (!picker_) {
    picker_.emplace(
        report::ColorMatrixOf(frames.input_info->color.matrix, frames.input_info->height));
    start_s_ = frames.input->time_s;
    quarter_turns_ = QuarterTurns(*frames.input_info);
    facts_ = {{"Before", ClipText(*frames.input_info)}, {"After", ClipText(*frames.output_info)}};
    if (frames.camera != nullptr) {
      camera_ = *frames.camera;
      facts_.push_back({"True camera", CameraText(*camera_)});
    }
  }
  const FrameView twin = frames.twin != nullptr ? frames.twin->frame.View() : FrameView();
  ExhibitCandidate candidate;
  candidate.index = frames.index;
  candidate.time_s = frames.input->time_s - start_s_;
  candidate.shake_px = shake;
  candidate.rs_px = frames.input_residual;
  candidate.input = frames.input->frame.View();
  candidate.output = frames.output->frame.View();
  candidate.twin = frames.twin != nullptr ? &twin : nullptr;
  return picker_->Push(candidate);
}

Result<std::string> ComparePage::Make(const CompareReport& figures, const CompareOptions& options,
                                      const std::vector<StageTime>& stages) {
  ClipPage page;
  page.kind = ProgramName() + ", two clips compared";
  page.figures = figures;
  if (picker_) {
    page.exhibits = picker_->Finish();
  }
  page.quarter_turns = quarter_turns_;
  page.truth_camera = camera_;
  page.facts = std::move(facts_);
  if (!options.truth.empty()) {
    page.facts.push_back({"Truth", options.truth});
  }
  page.facts.push_back({"Program", ProgramName()});
  page.stages = stages;
  return MakeClipPage(page);
}

}  // namespace rsstab::cli
