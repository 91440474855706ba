// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_REPORT_FIELD_PANELS_H_
#define RSSTAB_CLI_REPORT_FIELD_PANELS_H_

#include <string>

#include "cli/report/html_page.h"
#include "igf/base/motion_field.h"
#include "igf/base/result.h"

namespace rsstab::report {

// A motion field in the colours of Baker et al. (images/flow_colors.h), small. A displacement of
// `full_px`, in px of the field, or more has the strongest colour; 0: the field's own longest.
[[nodiscard]] Result<Panel> FieldPanel(const MotionField& field, double full_px,
                                       const std::string& title, const std::string& note,
                                       int quarter_turns = 0);

// The wheel those colours come from: a disc on which each colour stands where its displacement
// points, the strongest at the rim, which is `full_px`.
[[nodiscard]] Result<ColorKey> FieldKey(double full_px, int quarter_turns = 0);

}  // namespace rsstab::report

#endif  // RSSTAB_CLI_REPORT_FIELD_PANELS_H_
