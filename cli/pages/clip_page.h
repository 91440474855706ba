// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_PAGES_CLIP_PAGE_H_
#define RSSTAB_CLI_PAGES_CLIP_PAGE_H_

#include <optional>
#include <string>
#include <vector>

#include "cli/commands/compare.h"
#include "cli/pages/exhibit_picker.h"
#include "cli/report/html_page.h"
#include "cli/stage_times.h"
#include "igf/base/camera.h"
#include "igf/base/motion_field.h"
#include "stabilizer/analysis_file.h"

namespace rsstab::cli {

// What was corrected in one frame, and how much of it was kept. px at 640 px width.
struct RsMoment {
  double time_s = 0.0;       // from the clip's first frame
  double sideways_px = 0.0;  // how much further right the last row was recorded than the first
  double upright_px = 0.0;   // how much further down: above 0 the picture was stretched
  double turn_deg = 0.0;     // how far the last row is turned against the first, x towards y
  double kept_ratio = 1.0;   // share of a side that the output shows
};

// From a field of any size (default-made: no motion). The field is a backward displacement, so it
// points from where something belongs to where it was recorded.
[[nodiscard]] RsMoment DescribeField(const MotionField& field, double time_s, double kept_ratio);

// All that the report of a clip before and after shows.
struct ClipPage {
  std::string kind;       // what sort of report, for its head
  CompareReport figures;  // paths must be in it; `pair` may be empty
  std::vector<Exhibit> exhibits;
  int quarter_turns = 0;  // counter-clockwise, to show pictures as players do
  // Where the rolling shutter was corrected by this program: frame by frame.
  std::vector<RsMoment> moments;
  std::optional<stabilizer::ClipAnalysis> analysis;
  std::optional<Camera> truth_camera;  // of the twins in the exhibits
  std::vector<report::Fact> facts;     // what was used
  std::string command;                 // options as given
  std::vector<StageTime> stages;
};

// The page, complete. Errors: those of making its pictures.
[[nodiscard]] Result<std::string> MakeClipPage(const ClipPage& page);

}  // namespace rsstab::cli

#endif  // RSSTAB_CLI_PAGES_CLIP_PAGE_H_
