// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_MEDIA_TIMESTAMP_REPAIR_H_
#define RSSTAB_CLI_MEDIA_TIMESTAMP_REPAIR_H_

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "cli/media/timestamp_plan.h"

namespace rsstab::media {

// Gives decoded frames, in the order in which the decoder shows them, their times from a plan.
// Strictly increasing, whatever the stamps.
//
// A frame whose stamp is the next planned one gets it at once. Otherwise frames may have been lost
// in decoding (a slot stays empty) or stamps swapped (the slot's stamp comes with one of the next
// frames): this is decided after at most kLookAhead more frames, which is how many the caller must
// be ready to hold.
//
// Without a plan (input from a pipe) stamps are kept as long as they increase, and otherwise
// replaced by the last time plus the usual period.
class TimestampRepair {
 public:
  static constexpr std::size_t kLookAhead = 4;

  TimestampRepair(TimestampPlan plan, double fallback_period);

  // The stamp of the next shown frame.
  void Push(std::optional<std::int64_t> stamp);
  // No more frames.
  void Finish() { is_finished_ = true; }
  // The time of the oldest frame pushed and not yet popped, once it is decided.
  [[nodiscard]] std::optional<std::int64_t> Pop();
  // Frames whose time is not the stamp they came with.
  [[nodiscard]] std::int64_t changed_count() const { return changed_count_; }

 private:
  struct Pending {
    std::optional<std::int64_t> stamp;
    std::optional<std::size_t> slot;  // of the plan; none: the stamp is not one of the plan's good
  };

  [[nodiscard]] std::int64_t Assign(std::int64_t time);
  [[nodiscard]] std::optional<std::int64_t> PopPlanned();
  [[nodiscard]] std::int64_t PopUnplanned();
  [[nodiscard]] std::optional<std::size_t> DamagedSlotInReach() const;
  [[nodiscard]] std::int64_t SurplusTime() const;

  TimestampPlan plan_;
  std::deque<Pending> pending_;
  // Slots claimed by pending frames, and frames without a slot, apart from the order of frames.
  std::vector<std::size_t> claimed_slots_;
  std::size_t unclaimed_frames_ = 0;
  std::size_t next_slot_ = 0;
  std::optional<std::int64_t> last_time_;
  double period_ = 1.0;
  bool is_finished_ = false;
  bool last_was_surplus_ = false;
  std::int64_t changed_count_ = 0;
};

}  // namespace rsstab::media

#endif  // RSSTAB_CLI_MEDIA_TIMESTAMP_REPAIR_H_
