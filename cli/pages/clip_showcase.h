// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_PAGES_CLIP_SHOWCASE_H_
#define RSSTAB_CLI_PAGES_CLIP_SHOWCASE_H_

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "cli/commands/compare.h"
#include "cli/report/html_page.h"
#include "igf/base/camera.h"
#include "igf/base/frame.h"
#include "igf/base/result.h"

namespace rsstab::cli {

// The frame of a clip that a report shows, and why.
struct ChosenFrame {
  std::int64_t index = 0;
  std::string reason;  // for people, with the figure
};

// The frame that the clip itself is furthest from what a global shutter would have seen in; without
// a truth, the one whose motion differs most from the one before. The first of a clip of which
// nothing is known. `input` must have its poses.
[[nodiscard]] ChosenFrame ChooseFrame(const CompareReport::Clip& input);

// One frame of a clip as each method left it, and how it lies on the truth. In order of the calls.
class ClipShowcase {
 public:
  // `input`: of the clip as it is, measured. `twin`: path of what a global shutter would have seen,
  // empty where nobody knows; then `camera` is not needed.
  // Errors: those of media::VideoReader; kCorruptData when the clip has no such frame.
  [[nodiscard]] static Result<ClipShowcase> Create(const CompareReport::Clip& input,
                                                   const std::string& twin,
                                                   const std::optional<Camera>& camera);

  // The frame of the clip at `path`, which `method` made. Errors: as above.
  [[nodiscard]] Status Add(const std::string& method, const std::string& path,
                           const CompareReport::Clip& measured);

  // To the page, with the truth last: the pictures, then the maps.
  [[nodiscard]] Status Show(report::HtmlPage& html) const;

  [[nodiscard]] const ChosenFrame& frame() const { return frame_; }
  [[nodiscard]] const std::vector<report::Panel>& pictures() const { return pictures_; }
  [[nodiscard]] const std::vector<report::Panel>& maps() const { return maps_; }

 private:
  explicit ClipShowcase(ChosenFrame frame) : frame_(std::move(frame)) {}

  ChosenFrame frame_;
  std::optional<Camera> camera_;
  std::optional<Frame> twin_;
  std::vector<report::Panel> pictures_;
  std::vector<report::Panel> maps_;
  std::optional<report::Panel> truth_;
};

}  // namespace rsstab::cli

#endif  // RSSTAB_CLI_PAGES_CLIP_SHOWCASE_H_
