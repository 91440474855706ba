// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_PAGES_PAGE_PARTS_H_
#define RSSTAB_CLI_PAGES_PAGE_PARTS_H_

#include <cstdint>
#include <string>
#include <vector>

#include "cli/commands/compare.h"
#include "cli/media/video_info.h"
#include "cli/report/html_page.h"
#include "cli/stage_times.h"
#include "igf/base/camera.h"

// What the reports of several commands have in common.
namespace rsstab::cli {

// "25.0 ms, first row to last"; with "+- 0.4" (as one sign) behind the number where it is not
// exact.
[[nodiscard]] std::string ReadoutText(double readout_s, double sigma_s = 0.0);

// "pinhole, focal length 1109 px at 1280 x 720"
[[nodiscard]] std::string CameraText(const Camera& camera);

// "video.mp4: h264, 1280 x 720, 30 frames/s, yuv420p", with what is odd about it.
[[nodiscard]] std::string ClipText(const media::VideoInfo& info);

// Quarter turns counter-clockwise by which players show the clip.
[[nodiscard]] int QuarterTurns(const media::VideoInfo& info);

// The figures of a comparison.
[[nodiscard]] report::Table FiguresTable(const CompareReport& report);

// The key of difference maps.
[[nodiscard]] Result<report::ColorKey> DifferenceColorKey();

// Bars, and what each comes to for one of `items` frames or pictures (`unit`; 0 items: not told).
void AddStages(const std::vector<StageTime>& stages, std::int64_t items, const std::string& unit,
               report::HtmlPage& html);

// "rs-stabilize 0.1.0"
[[nodiscard]] std::string ProgramName();
[[nodiscard]] std::string PageFooter();

}  // namespace rsstab::cli

#endif  // RSSTAB_CLI_PAGES_PAGE_PARTS_H_
