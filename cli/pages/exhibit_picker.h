// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_PAGES_EXHIBIT_PICKER_H_
#define RSSTAB_CLI_PAGES_EXHIBIT_PICKER_H_

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "cli/report/preview.h"
#include "igf/base/frame.h"
#include "igf/base/motion_field.h"
#include "igf/base/result.h"

namespace rsstab::cli {

// A frame that a report shows, small (report::MakePreview).
struct Exhibit {
  std::int64_t index = 0;
  double time_s = 0.0;             // from the clip's first frame
  std::string reason;              // why it was chosen, for people
  std::optional<double> shake_px;  // change of the motion from the frame before, at 640 px width
  std::optional<double> rs_px;     // how much rolling shutter it has, at 640 px width
  Frame input;
  Frame output;
  std::optional<Frame> twin;  // what a global shutter would have seen
  MotionField rs_field;       // that was corrected; default-made: none
};

struct ExhibitCandidate {
  std::int64_t index = 0;
  double time_s = 0.0;
  std::optional<double> shake_px;
  std::optional<double> rs_px;
  FrameView input;
  FrameView output;
  const FrameView* twin = nullptr;        // may be null
  const MotionField* rs_field = nullptr;  // may be null
};

// Chooses the frames worth looking at while a clip goes by: the one with most rolling shutter, the
// one with most shake, and one of average shake. Keeps at most a dozen small pictures, whatever the
// clip's length. In order, not thread safe.
class ExhibitPicker {
 public:
  explicit ExhibitPicker(report::ColorMatrix matrix) : matrix_(matrix) {}

  [[nodiscard]] Status Push(const ExhibitCandidate& candidate);

  // At most three, each another frame, in the order above. The picker is empty afterwards.
  [[nodiscard]] std::vector<Exhibit> Finish();

 private:
  [[nodiscard]] Result<Exhibit> Keep(const ExhibitCandidate& candidate) const;
  [[nodiscard]] Status KeepSample(const ExhibitCandidate& candidate);

  report::ColorMatrix matrix_;
  std::optional<Exhibit> most_rs_;
  std::optional<Exhibit> most_shake_;
  std::vector<Exhibit> samples_;  // evenly spaced over what went by
  std::int64_t sample_step_ = 1;
  std::vector<float> shakes_;  // of all frames, for the median
};

}  // namespace rsstab::cli

#endif  // RSSTAB_CLI_PAGES_EXHIBIT_PICKER_H_
