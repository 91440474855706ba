// SPDX-License-Identifier: Apache-2.0
#include "cli/media/timestamp_repair.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace rsstab::media {

TimestampRepair::TimestampRepair(TimestampPlan plan, double fallback_period)
    : plan_(std::move(plan)),
      period_(plan_.slots().empty() ? std::max(1.0, fallback_period) : plan_.period()) {}

void TimestampRepair::Push(std::optional<std::int64_t> stamp) {
  Pending pending;
  if (IsUsableStamp(stamp)) {
    pending.stamp = stamp;
    const std::vector<TimestampPlan::Slot>& slots = plan_.slots();
    const auto found = std::lower_bound(
        slots.begin(), slots.end(), *stamp,
        [](const TimestampPlan::Slot& slot, std::int64_t time) { return slot.time < time; });
    if (found != slots.end() && found->time == *stamp && found->is_original) {
      const auto slot = static_cast<std::size_t>(found - slots.begin());
      const bool is_free =
          slot >= next_slot_ &&
          std::find(claimed_slots_.begin(), claimed_slots_.end(), slot) == claimed_slots_.end();
      if (is_free) {
        claimed_slots_.push_back(slot);
        pending.slot = slot;
      }
    }
  }
  if (!pending.slot) {
    ++unclaimed_frames_;
  }
  pending_.push_back(pending);
}

std::optional<std::int64_t> TimestampRepair::Pop() {
  if (pending_.empty()) {
    return std::nullopt;
  }
  return plan_.slots().empty() ? std::optional(PopUnplanned()) : PopPlanned();
}

std::int64_t TimestampRepair::Assign(std::int64_t time) {
  if (last_time_) {
    time = std::max(time, *last_time_ + 1);
  }
  if (pending_.front().stamp != time) {
    ++changed_count_;
  }
  last_time_ = time;
  pending_.pop_front();
  return time;
}

std::optional<std::size_t> TimestampRepair::DamagedSlotInReach() const {
  const std::vector<TimestampPlan::Slot>& slots = plan_.slots();
  const std::size_t end = std::min(slots.size(), next_slot_ + 2 * kLookAhead);
  for (std::size_t k = next_slot_; k < end; ++k) {
    if (!slots[k].is_original) {
      return k;
    }
  }
  return std::nullopt;
}

// A frame that no packet accounts for, between the last frame and the next planned one.
std::int64_t TimestampRepair::SurplusTime() const {
  const std::vector<TimestampPlan::Slot>& slots = plan_.slots();
  const std::optional<std::int64_t>& stamp = pending_.front().stamp;
  const auto claimed = std::min_element(claimed_slots_.begin(), claimed_slots_.end());
  if (stamp && (!last_time_ || *stamp > *last_time_) &&
      (claimed == claimed_slots_.end() || *stamp < slots[*claimed].time)) {
    return *stamp;
  }
  if (next_slot_ >= slots.size()) {
    return last_time_.value_or(0) + std::llround(period_);
  }
  const std::int64_t next = slots[next_slot_].time;
  return last_time_ ? *last_time_ + (next - *last_time_) / 2 : next - std::llround(period_);
}

std::optional<std::int64_t> TimestampRepair::PopPlanned() {
  const std::vector<TimestampPlan::Slot>& slots = plan_.slots();
  if (next_slot_ >= slots.size()) {
    --unclaimed_frames_;  // no slot is left that any could have claimed
    return Assign(SurplusTime());
  }
  // Two in a row mean that the decoder hands out no stamps: then slots are taken one by one.
  const bool is_surplus = unclaimed_frames_ > 0 && !pending_.front().slot &&
                          !DamagedSlotInReach() && !last_was_surplus_;
  if (is_surplus) {
    last_was_surplus_ = true;
    --unclaimed_frames_;
    return Assign(SurplusTime());
  }
  const auto first_claimed = std::min_element(claimed_slots_.begin(), claimed_slots_.end());
  const bool has_claimed = first_claimed != claimed_slots_.end();
  std::size_t slot = next_slot_;
  if (has_claimed && *first_claimed == slot) {
    claimed_slots_.erase(first_claimed);
    last_was_surplus_ = false;
  } else if (!slots[slot].is_original && unclaimed_frames_ > 0) {
    --unclaimed_frames_;
  } else if (!is_finished_ && pending_.size() <= kLookAhead) {
    return std::nullopt;  // the next frames will tell
  } else if (!has_claimed) {
    // Only frames without a stamp of their own: in order.
    slot = DamagedSlotInReach().value_or(next_slot_);
    --unclaimed_frames_;
  } else {
    // The frames of the slots in between were lost in decoding.
    const std::optional<std::size_t> damaged = DamagedSlotInReach();
    if (unclaimed_frames_ > 0 && damaged && *damaged < *first_claimed) {
      slot = *damaged;
      --unclaimed_frames_;
    } else {
      slot = *first_claimed;
      claimed_slots_.erase(first_claimed);
    }
  }
  next_slot_ = slot + 1;
  return Assign(slots[slot].time);
}

std::int64_t TimestampRepair::PopUnplanned() {
  const std::optional<std::int64_t> stamp = pending_.front().stamp;
  --unclaimed_frames_;
  if (stamp && (!last_time_ || *stamp > *last_time_)) {
    return Assign(*stamp);
  }
  return Assign(last_time_ ? *last_time_ + std::llround(period_) : 0);
}

}  // namespace rsstab::media
