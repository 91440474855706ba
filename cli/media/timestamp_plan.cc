// SPDX-License-Identifier: Apache-2.0
#include "cli/media/timestamp_plan.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>

namespace rsstab::media {
namespace {

// A gap at an end of the clip is absurd when it is longer than all the rest of the clip and than
// this many frames: no camera pauses after its first picture for longer than it then films.
constexpr double kAbsurdGapFrames = 300.0;
// How many stamps at either end, as a share of all, are examined for that.
constexpr double kEndShare = 0.02;
// Fewer frames do not tell a constant rate.
constexpr std::size_t kFewestForLine = 8;

struct Entry {
  std::int64_t value = 0;
  bool is_known = false;   // false: `value` is only a place to sort it to
  bool has_stamp = false;  // the frame will carry `value` as its stamp
};

struct Line {
  double start = 0.0;
  double period = 0.0;
  double tolerance = 0.0;

  [[nodiscard]] double At(std::size_t index) const {
    return start + period * static_cast<double>(index);
  }
  [[nodiscard]] bool Holds(std::size_t index, std::int64_t value) const {
    return std::abs(static_cast<double>(value) - At(index)) <= tolerance;
  }
};

double Median(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Robust line through (index, value): medians, so that a tenth of wild values does not matter.
Line FitLine(const std::vector<Entry>& sorted) {
  const std::size_t half = sorted.size() / 2;
  std::vector<double> values;
  values.reserve(sorted.size());
  for (std::size_t k = 0; k + half < sorted.size(); ++k) {
    values.push_back(static_cast<double>(sorted[k + half].value - sorted[k].value) /
                     static_cast<double>(half));
  }
  Line line;
  line.period = Median(values);
  values.clear();
  for (std::size_t k = 0; k < sorted.size(); ++k) {
    values.push_back(static_cast<double>(sorted[k].value) - line.period * static_cast<double>(k));
  }
  line.start = Median(values);
  // Stamps are rounded to ticks, cameras are steady to about a hundredth of a frame; never so wide
  // that neighbours could be mistaken for each other.
  line.tolerance = std::min(std::max(1.5, 0.02 * line.period), 0.4 * line.period);
  return line;
}

// Median step between different values.
double MedianGap(const std::vector<std::int64_t>& sorted, double fallback) {
  std::vector<double> gaps;
  for (std::size_t k = 1; k < sorted.size(); ++k) {
    if (sorted[k] > sorted[k - 1]) {
      gaps.push_back(static_cast<double>(sorted[k] - sorted[k - 1]));
    }
  }
  return gaps.empty() ? fallback : Median(gaps);
}

std::vector<std::int64_t> ValuesOf(const std::vector<Entry>& entries) {
  std::vector<std::int64_t> values;
  values.reserve(entries.size());
  for (const Entry& entry : entries) {
    values.push_back(entry.value);
  }
  return values;
}

void SortByTime(std::vector<Entry>& entries) {
  std::stable_sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) {
    return a.value != b.value ? a.value < b.value : (a.is_known && !b.is_known);
  });
}

// Containers may leave out the presentation times of some packets (AVI, MPEG program streams). In
// a regular stream frames are shown at the times at which frames are decoded, later by a delay, so
// a missing time is the next decoding time that no other frame is shown at.
void FillFromDts(const std::vector<TimestampPlan::Packet>& packets, double fallback_period,
                 std::vector<Entry>& entries) {
  std::vector<std::int64_t> decoded;
  for (const TimestampPlan::Packet& packet : packets) {
    if (IsUsableStamp(packet.dts)) {
      decoded.push_back(*packet.dts);
    }
  }
  if (decoded.empty()) {
    return;
  }
  std::vector<std::int64_t> shown;
  for (const Entry& entry : entries) {
    if (entry.is_known) {
      shown.push_back(entry.value);
    }
  }
  std::sort(decoded.begin(), decoded.end());
  std::sort(shown.begin(), shown.end());
  std::vector<std::int64_t> unclaimed;
  std::set_difference(decoded.begin(), decoded.end(), shown.begin(), shown.end(),
                      std::back_inserter(unclaimed));
  // The delay lets the last frames be shown after the last is decoded.
  std::int64_t last = shown.empty() ? decoded.back() : std::max(decoded.back(), shown.back());
  const double period = MedianGap(decoded, fallback_period);
  auto next = unclaimed.begin();
  for (std::size_t k = 0; k < entries.size(); ++k) {
    if (entries[k].is_known || packets[k].pts || !IsUsableStamp(packets[k].dts)) {
      continue;
    }
    next = std::lower_bound(next, unclaimed.end(), *packets[k].dts);
    if (next == unclaimed.end()) {
      last += std::llround(period);
      entries[k] = {last, true, false};
    } else {
      entries[k] = {*next++, true, false};
    }
  }
}

// Gives entries without a value that of their predecessor in file order, which puts them next to
// it when sorted.
void FillUnknown(std::vector<Entry>& in_file_order) {
  const auto first = std::find_if(in_file_order.begin(), in_file_order.end(),
                                  [](const Entry& entry) { return entry.is_known; });
  std::int64_t value = first == in_file_order.end() ? 0 : first->value;
  for (Entry& entry : in_file_order) {
    if (entry.is_known) {
      value = entry.value;
    } else {
      entry.value = value;
    }
  }
}

// Forgets stamps that lie absurdly far before or after all others.
void ForgetAbsurd(std::vector<Entry>& entries, double fallback_period) {
  std::vector<std::int64_t> values;
  for (const Entry& entry : entries) {
    if (entry.is_known) {
      values.push_back(entry.value);
    }
  }
  if (values.size() < 3) {
    return;
  }
  std::sort(values.begin(), values.end());
  std::vector<double> gaps;
  for (std::size_t k = 1; k < values.size(); ++k) {
    gaps.push_back(static_cast<double>(values[k] - values[k - 1]));
  }
  const double typical = std::max(Median(gaps), fallback_period);
  const auto examined = std::max<std::size_t>(
      1, static_cast<std::size_t>(kEndShare * static_cast<double>(values.size())));
  std::size_t begin = 0;
  std::size_t end = values.size();
  for (std::size_t k = 1; k <= examined && k < values.size() / 2; ++k) {
    const auto rest = static_cast<double>(values[values.size() - 1 - examined] - values[k]);
    if (static_cast<double>(values[k] - values[k - 1]) >
        std::max(kAbsurdGapFrames * typical, rest)) {
      begin = k;
    }
  }
  for (std::size_t k = 1; k <= examined && k < values.size() / 2; ++k) {
    const std::size_t last = values.size() - k;  // first of the k last
    const auto rest = static_cast<double>(values[last - 1] - values[begin]);
    if (static_cast<double>(values[last] - values[last - 1]) >
        std::max(kAbsurdGapFrames * typical, rest)) {
      end = last;
    }
  }
  for (Entry& entry : entries) {
    if (entry.is_known && (entry.value < values[begin] || entry.value > values[end - 1])) {
      entry.is_known = false;
    }
  }
}

bool IsRepeated(const std::vector<Entry>& sorted, std::size_t k) {
  return (k > 0 && sorted[k].value == sorted[k - 1].value) ||
         (k + 1 < sorted.size() && sorted[k].value == sorted[k + 1].value);
}

// Puts what is not known, or not on the line, onto it.
void PutOnLine(const Line& line, std::vector<Entry>& sorted) {
  std::vector<bool> is_sound(sorted.size());
  for (std::size_t k = 0; k < sorted.size(); ++k) {
    is_sound[k] = sorted[k].is_known && !IsRepeated(sorted, k) && line.Holds(k, sorted[k].value);
  }
  for (std::size_t k = 0; k < sorted.size(); ++k) {
    if (!is_sound[k]) {
      sorted[k] = {std::llround(line.At(k)), false, false};
    }
  }
}

// Replaces what is not known by even steps between its known neighbours. A known time that leaves
// no room for its predecessors is given up.
void Interpolate(double period, std::vector<Entry>& sorted) {
  constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();
  std::size_t previous = kNone;  // last known
  for (std::size_t k = 0; k < sorted.size(); ++k) {
    if (!sorted[k].is_known) {
      continue;
    }
    if (previous == kNone) {
      for (std::size_t j = 0; j < k; ++j) {
        sorted[j].value = sorted[k].value - std::llround(period * static_cast<double>(k - j));
      }
    } else {
      const std::int64_t room = sorted[k].value - sorted[previous].value;
      const auto steps = static_cast<std::int64_t>(k - previous);
      if (room < steps) {
        sorted[k].is_known = false;
        continue;
      }
      for (std::int64_t j = 1; j < steps; ++j) {
        const double share = static_cast<double>(j) / static_cast<double>(steps);
        sorted[previous + static_cast<std::size_t>(j)].value =
            sorted[previous].value + std::llround(static_cast<double>(room) * share);
      }
    }
    previous = k;
  }
  const std::size_t anchor = previous == kNone ? 0 : previous;
  for (std::size_t k = anchor + 1; k < sorted.size(); ++k) {
    sorted[k].value = sorted[anchor].value + std::llround(period * static_cast<double>(k - anchor));
  }
}

std::size_t CountOnLine(const Line& line, const std::vector<Entry>& sorted) {
  std::size_t count = 0;
  for (std::size_t k = 0; k < sorted.size(); ++k) {
    count += line.Holds(k, sorted[k].value) ? 1 : 0;
  }
  return count;
}

}  // namespace

TimestampPlan::TimestampPlan(const std::vector<Packet>& packets, double fallback_period)
    : period_(std::max(1.0, fallback_period)) {
  if (packets.empty()) {
    return;
  }
  std::vector<Entry> entries(packets.size());
  for (std::size_t k = 0; k < packets.size(); ++k) {
    const bool is_usable = IsUsableStamp(packets[k].pts);
    entries[k] = {is_usable ? *packets[k].pts : 0, is_usable, is_usable};
  }
  ForgetAbsurd(entries, period_);
  FillFromDts(packets, period_, entries);
  const bool knows_any = std::any_of(entries.begin(), entries.end(),
                                     [](const Entry& entry) { return entry.is_known; });
  FillUnknown(entries);
  SortByTime(entries);
  for (std::size_t k = 0; k < entries.size(); ++k) {
    // No stamps at all is how bare streams are, not damage.
    is_damaged_ = is_damaged_ || (knows_any && (!entries[k].is_known || IsRepeated(entries, k)));
  }
  period_ = std::max(1.0, MedianGap(ValuesOf(entries), period_));

  const bool tells_rate = entries.size() >= kFewestForLine;
  const Line line = tells_rate ? FitLine(entries) : Line{};
  const bool is_plainly_constant = tells_rate && line.period >= 1.0 &&
                                   static_cast<double>(CountOnLine(line, entries)) >=
                                       kConstantShare * static_cast<double>(entries.size());
  if (is_damaged_ && is_plainly_constant) {
    period_ = line.period;
    PutOnLine(line, entries);
  } else if (is_damaged_ || !knows_any) {
    for (std::size_t k = entries.size(); k-- > 1;) {
      entries[k].is_known = entries[k].is_known && entries[k].value != entries[k - 1].value;
    }
    Interpolate(period_, entries);
  }
  is_constant_rate_ =
      entries.size() < 2 || CountOnLine(FitLine(entries), entries) == entries.size();
  slots_.reserve(entries.size());
  for (const Entry& entry : entries) {
    slots_.push_back({entry.value, entry.is_known && entry.has_stamp});
  }
}

}  // namespace rsstab::media
