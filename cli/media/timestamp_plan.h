// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_MEDIA_TIMESTAMP_PLAN_H_
#define RSSTAB_CLI_MEDIA_TIMESTAMP_PLAN_H_

#include <cstdint>
#include <optional>
#include <vector>

namespace rsstab::media {

// Whether a stamp can be one: beyond this it is garbage whatever its unit (2^53 nanoseconds are 104
// days), and doubles would no longer hold it exactly.
[[nodiscard]] inline bool IsUsableStamp(const std::optional<std::int64_t>& stamp) {
  constexpr std::int64_t kLargest = std::int64_t{1} << 53;
  return stamp && *stamp > -kLargest && *stamp < kLargest;
}

// The times at which the frames of a clip are shown, planned from the stamps of all its packets.
//
// Real files carry damaged stamps: missing, repeated, running backwards, with absurd gaps at either
// end. Variable frame rate, on the other hand, is no damage and must be kept to the tick. Looking
// at all stamps at once tells the two apart; looking at a few frames cannot.
//
// - No damage (every packet has a stamp of its own, no absurd gap): all stamps are kept.
// - Damage in a clip of plainly constant rate (at least kConstantShare of the sorted stamps lie on
//   one line over the frame index): stamps on the line are kept, all others are put onto it.
// - Damage elsewhere: the repeated, missing or absurd stamps are put evenly between their
//   neighbours.
// - Presentation times that the container leaves out by design are taken from the decoding times
//   (AVI, MPEG program streams), and without those from `fallback_period` (bare streams). This is
//   no damage.
class TimestampPlan {
 public:
  static constexpr double kConstantShare = 0.9;

  // One packet in file order. Ticks of any time base.
  struct Packet {
    std::optional<std::int64_t> pts;
    std::optional<std::int64_t> dts;
  };
  struct Slot {
    std::int64_t time = 0;
    bool is_original = true;  // some frame carries exactly this stamp
  };

  TimestampPlan() = default;
  // fallback_period: expected ticks per frame, at least 1; used where the stamps do not tell.
  TimestampPlan(const std::vector<Packet>& packets, double fallback_period);

  // Strictly increasing times, one per packet.
  [[nodiscard]] const std::vector<Slot>& slots() const { return slots_; }
  // Median ticks per frame; fallback_period when unknown.
  [[nodiscard]] double period() const { return period_; }
  [[nodiscard]] bool is_damaged() const { return is_damaged_; }
  // All gaps between slots equal within rounding.
  [[nodiscard]] bool is_constant_rate() const { return is_constant_rate_; }

 private:
  std::vector<Slot> slots_;
  double period_ = 1.0;
  bool is_damaged_ = false;
  bool is_constant_rate_ = false;
};

}  // namespace rsstab::media

#endif  // RSSTAB_CLI_MEDIA_TIMESTAMP_PLAN_H_
