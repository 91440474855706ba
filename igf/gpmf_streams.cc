// SPDX-License-Identifier: Apache-2.0
#include "igf/gpmf_streams.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numbers>
#include <utility>

namespace rsstab::igf {
namespace {

constexpr std::size_t kHeaderSize = 8;
constexpr std::uint8_t kDegreeSign = 0xb0;  // GPMF text is Latin-1

bool IsZero(std::span<const std::uint8_t> bytes) {
  return std::all_of(bytes.begin(), bytes.end(), [](std::uint8_t b) { return b == 0; });
}

std::optional<double> FirstNumber(const KlvItem& item) {
  const std::optional<KlvTable> table = KlvNumbers(item);
  if (!table || table->values.empty() || !std::isfinite(table->values.front())) {
    return std::nullopt;
  }
  return table->values.front();
}

// One 36-byte or nine 4-byte elements.
std::optional<Eigen::Matrix3d> Matrix(const KlvItem& item) {
  const std::optional<KlvTable> table = KlvNumbers(item);
  if (!table || table->values.size() != 9) {
    return std::nullopt;
  }
  Eigen::Matrix3d matrix;
  for (Eigen::Index i = 0; i < 9; ++i) {
    matrix(i / 3, i % 3) = table->values[static_cast<std::size_t>(i)];
  }
  return matrix;
}

bool IsDegrees(const KlvItem& unit) {
  return KlvText(unit).find("deg") != std::string::npos ||
         std::find(unit.value.begin(), unit.value.end(), kDegreeSign) != unit.value.end();
}

}  // namespace

std::size_t FindGpmfDevice(std::span<const std::uint8_t> bytes, std::size_t from) {
  // The type byte of a container is zero, which tells the key from a mention of it.
  constexpr std::array<std::uint8_t, 5> kKey = {'D', 'E', 'V', 'C', 0};
  from = std::min(from, bytes.size());
  const auto found = std::search(bytes.begin() + static_cast<std::ptrdiff_t>(from), bytes.end(),
                                 kKey.begin(), kKey.end());
  return static_cast<std::size_t>(std::distance(bytes.begin(), found));
}

void GpmfStreamCollector::Add(std::size_t payload, std::span<const std::uint8_t> bytes) {
  payload_ = payload;
  std::size_t device_end = 0;  // as claimed: beyond bytes.size() when the payload is cut off
  std::size_t stream_end = 0;
  std::size_t offset = 0;
  while (offset < bytes.size()) {
    if (stream_ && offset >= stream_end) {
      FinishStream();
    }
    if (device_ && offset >= device_end) {
      FinishDevice();
    }
    const std::size_t end = stream_ ? stream_end : device_end;
    const std::optional<KlvItem> item = ReadKlv(bytes, offset);
    const bool is_device = item && item->is_container() && item->key == "DEVC";

    // No item, or none that may stand here: go on with the next device, or where the container
    // ends. Zeros are legal padding.
    if (!item || (!device_ && !is_device)) {
      const std::size_t limit = device_ ? std::min(end, bytes.size()) : bytes.size();
      const std::size_t next = FindGpmfDevice(bytes.first(limit), offset + 1);
      if (!IsZero(bytes.subspan(offset, std::min<std::size_t>(4, next - offset)))) {
        skipped_bytes_ += next - offset;
      }
      offset = next;
      continue;
    }
    // A container that starts inside another one which should have held it all means that the outer
    // one's length is wrong; the inner one wins. Items below are never entered.
    if (is_device) {
      FinishStream();
      FinishDevice();
      device_.emplace();
      device_end = offset + kHeaderSize + item->claimed;
      offset += kHeaderSize;
      continue;
    }
    if (item->is_container() && item->key == "STRM") {
      FinishStream();
      stream_.emplace();
      stream_->packet.payload = payload_;
      stream_end = std::min(device_end, offset + kHeaderSize + item->claimed);
      offset += kHeaderSize;
      continue;
    }
    if (offset + kHeaderSize + item->claimed > end && end <= bytes.size()) {
      ++damaged_items_;  // longer than its container, which is all there
      offset = end;
      continue;
    }
    if (!item->is_whole()) {
      ++damaged_items_;  // cut off together with the payload; its whole rows are good
    }
    Visit(*item);
    offset += item->stored_size();
  }
  FinishStream();
  FinishDevice();
}

void GpmfStreamCollector::Visit(const KlvItem& item) {
  if (stream_) {
    VisitStreamItem(item);
  } else if (item.key == "DVID") {
    if (const std::optional<double> id = FirstNumber(item);
        id && *id >= 0.0 && *id <= 4294967295.0) {
      device_->id = static_cast<std::uint32_t>(*id);
    }
  } else if (item.key == "DVNM") {
    device_->name = KlvText(item);
  }
}

void GpmfStreamCollector::VisitStreamItem(const KlvItem& item) {
  GpmfGyroPacket& packet = stream_->packet;
  if (item.key == "GYRO") {
    ReadGyro(item);
  } else if (item.key == "SCAL") {
    const std::optional<KlvTable> table = KlvNumbers(item);
    stream_->scale = table ? table->values : std::vector<double>{};
  } else if (item.key == "SIUN" || item.key == "UNIT") {
    stream_->unit_factor = IsDegrees(item) ? std::numbers::pi / 180.0 : 1.0;
  } else if (item.key == "TYPE") {
    stream_->type_definition = KlvText(item);
  } else if (item.key == "TSMP") {
    packet.total_samples = FirstNumber(item);
  } else if (item.key == "STMP") {
    const std::optional<double> stamp_us = FirstNumber(item);
    packet.stamp_s = stamp_us ? std::optional(*stamp_us * 1e-6) : std::nullopt;
  } else if (item.key == "TIMO") {
    packet.delay_s = FirstNumber(item).value_or(0.0);
  } else if (item.key == "STNM") {
    packet.stream_name = KlvText(item);
  } else if (item.key == "ORIN") {
    packet.orin = KlvText(item);
  } else if (item.key == "ORIO") {
    packet.orio = KlvText(item);
  } else if (item.key == "MTRX") {
    packet.mtrx = Matrix(item);
  } else if (item.key == "SROT") {
    if (const std::optional<KlvTable> table = KlvNumbers(item)) {
      stream_->readouts_ms.insert(stream_->readouts_ms.end(), table->values.begin(),
                                  table->values.end());
    }
  }
}

void GpmfStreamCollector::ReadGyro(const KlvItem& item) {
  if (item.value.empty()) {
    return;  // a payload without samples
  }
  const std::optional<KlvTable> table = KlvNumbers(item, stream_->type_definition);
  if (!table || table->columns != 3) {
    ++damaged_items_;
    return;
  }
  const std::vector<double>& scale = stream_->scale;
  const bool is_usable = (scale.size() == 1 || scale.size() == 3) &&
                         std::all_of(scale.begin(), scale.end(),
                                     [](double s) { return std::isfinite(s) && s != 0.0; });
  if (!is_usable) {
    device_->scale_missing += static_cast<double>(table->rows());
    return;
  }
  const Eigen::Vector3d factor =
      stream_->unit_factor *
      Eigen::Vector3d(scale.front(), scale[scale.size() / 2], scale.back()).cwiseInverse();
  for (std::size_t row = 0; row < table->rows(); ++row) {
    stream_->packet.channels.emplace_back(
        Eigen::Map<const Eigen::Vector3d>(table->values.data() + 3 * row).cwiseProduct(factor));
  }
}

void GpmfStreamCollector::FinishStream() {
  if (!stream_) {
    return;
  }
  // Payloads hold one gyro stream per device; of several, the first is taken.
  if (!stream_->packet.channels.empty() && device_->gyro.empty()) {
    device_->gyro.push_back(std::move(stream_->packet));
  }
  device_->readouts_ms.insert(device_->readouts_ms.end(), stream_->readouts_ms.begin(),
                              stream_->readouts_ms.end());
  stream_.reset();
}

void GpmfStreamCollector::FinishDevice() {
  if (!device_) {
    return;
  }
  const auto known = std::find_if(devices_.begin(), devices_.end(), [&](const GpmfDevice& d) {
    return d.id == device_->id && (d.id || d.name == device_->name);
  });
  if (known == devices_.end()) {
    devices_.push_back(std::move(*device_));
  } else {
    std::move(device_->gyro.begin(), device_->gyro.end(), std::back_inserter(known->gyro));
    known->readouts_ms.insert(known->readouts_ms.end(), device_->readouts_ms.begin(),
                              device_->readouts_ms.end());
    known->scale_missing += device_->scale_missing;
    if (known->name.empty()) {
      known->name = device_->name;
    }
  }
  device_.reset();
}

}  // namespace rsstab::igf
