// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_PLUGIN_FREI0R_HOST_CLOCK_H_
#define RSSTAB_PLUGIN_FREI0R_HOST_CLOCK_H_

#include <optional>

#include "plugin/frei0r/host.h"

namespace rsstab::frei0r {

// Turns the times a host hands over into seconds. Frames in the order of the host's calls; not
// thread safe.
class HostClock {
 public:
  explicit HostClock(TimeUnit unit) : unit_(unit) {}

  // Seconds, or nothing when the host hands over no time (FFmpeg loses it where it has to copy the
  // picture first; what then arrives is its "no timestamp" times the time base). An unknown unit
  // counts as seconds until two steps in a row are a second or longer: video has no such frames,
  // so these are milliseconds.
  [[nodiscard]] std::optional<double> Seconds(double host_time);

 private:
  TimeUnit unit_;
  std::optional<double> last_;
  int long_steps_ = 0;
};

}  // namespace rsstab::frei0r

#endif  // RSSTAB_PLUGIN_FREI0R_HOST_CLOCK_H_
