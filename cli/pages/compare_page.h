// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_PAGES_COMPARE_PAGE_H_
#define RSSTAB_CLI_PAGES_COMPARE_PAGE_H_

#include <optional>
#include <string>
#include <vector>

#include "cli/commands/compare.h"
#include "cli/commands/compare_options.h"
#include "cli/pages/exhibit_picker.h"
#include "cli/pages/shake_scale.h"
#include "cli/report/html_page.h"
#include "cli/stage_times.h"

namespace rsstab::cli {

// The report of `compare`, gathered while the clips go by. Not thread safe.
class ComparePage {
 public:
  // To be called with each pair of frames, in order.
  [[nodiscard]] Status Observe(const ComparedFrames& frames);

  // The page. Errors: those of MakeClipPage.
  [[nodiscard]] Result<std::string> Make(const CompareReport& figures,
                                         const CompareOptions& options,
                                         const std::vector<StageTime>& stages);

 private:
  std::optional<ExhibitPicker> picker_;
  ShakeScale shake_;
  double start_s_ = 0.0;
  int quarter_turns_ = 0;
  std::optional<Camera> camera_;
  std::vector<report::Fact> facts_;
};

}  // namespace rsstab::cli

#endif  // RSSTAB_CLI_PAGES_COMPARE_PAGE_H_
