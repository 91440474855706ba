// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_IGF_BASE_ROLLING_SHUTTER_H_
#define RSSTAB_IGF_BASE_ROLLING_SHUTTER_H_

namespace rsstab {

// When row `row` (0 = centre of the top row, may be fractional) of a frame of `height` rows was
// exposed, in seconds. `frame_time_s` is the time of the frame's MIDDLE row; `readout_s` is the
// time from the first row to the last: positive = top to bottom, negative = bottom to top, 0 =
// global shutter. Templated so that Ceres can differentiate through it.
//   t(v) = t_n + T_r ((v + 0.5) / H - 0.5)
template <typename T>
[[nodiscard]] T RowExposureTime(double frame_time_s, T row, int height, T readout_s) {
  return frame_time_s + readout_s * ((row + 0.5) / static_cast<double>(height) - 0.5);
}

}  // namespace rsstab

#endif  // RSSTAB_IGF_BASE_ROLLING_SHUTTER_H_
