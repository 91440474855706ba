// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/pipeline/crop_stage.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "stabilizer/pipeline/warp_assembly.h"

namespace rsstab::pipeline {
namespace {

// The smoother's zoom hides most of every border; what is left is planned over this long to either
// side of a frame that needs it.
constexpr double kZoomReachS = 0.4;
// Where the look-ahead is too short for the planner, zooming out is held back for kZoomHoldS and
// then changes by no more than this a second.
constexpr double kZoomHoldS = 2.0;
constexpr double kMaxWideningPerS = 0.02;

std::variant<stabilizer::ZoomPlanner, stabilizer::OnlineZoomPlanner> MakeZoomPlanner(
    std::optional<std::size_t> lookahead, double frames_per_second) {
  if (!lookahead) {
    return stabilizer::ZoomPlanner(
        static_cast<std::size_t>(std::lround(kZoomReachS * frames_per_second)));
  }
  return stabilizer::OnlineZoomPlanner(
      *lookahead, static_cast<std::size_t>(std::lround(kZoomHoldS * frames_per_second)),
      kMaxWideningPerS / frames_per_second);
}

}  // namespace

CropStage::CropStage(const StabilizeOptions& options, const ClipGeometry& clip,
                     const RsSelection* selection, std::optional<std::size_t> lookahead)
    : clip_(clip),
      selection_(selection),
      planner_(MakeZoomPlanner(lookahead, clip.frames_per_second)) {
  Update(options);
}

int CropStage::WantedLookahead(double frames_per_second) {
  return 2 * static_cast<int>(std::lround(kZoomReachS * frames_per_second));
}

void CropStage::Push(stabilizer::FrameAnalysis frame) {
  const double allowed =
      std::min(largest_ratio_, stabilizer::LargestCropRatio(AssembleWarp(
                                   frame, clip_.width, clip_.height, selection_->camera)));
  std::visit([&](auto& planner) { planner.Push(allowed, frame.path_begins); }, planner_);
  waiting_.push_back(std::move(frame));
}

void CropStage::Finish() {
  std::visit([](auto& planner) { planner.Finish(); }, planner_);
}

void CropStage::Update(const StabilizeOptions& options) {
  largest_ratio_ =
      options.zoom == ZoomMode::kFixed && options.fixed_zoom ? 1.0 / *options.fixed_zoom : 1.0;
}

std::vector<stabilizer::FrameAnalysis> CropStage::TakeReady() {
  std::vector<stabilizer::FrameAnalysis> ready;
  for (const double ratio :
       std::visit([](auto& planner) { return planner.TakeReady(); }, planner_)) {
    waiting_.front().crop_ratio = ratio;
    ready.push_back(std::move(waiting_.front()));
    waiting_.pop_front();
  }
  return ready;
}

}  // namespace rsstab::pipeline
