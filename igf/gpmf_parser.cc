// SPDX-License-Identifier: Apache-2.0
#include "igf/gpmf_parser.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "igf/gpmf_klv.h"
#include "igf/gpmf_streams.h"
#include "igf/gyro_text_rows.h"
#include "igf/imu_axes.h"
#include "igf/sample_clock.h"

namespace rsstab::igf {
namespace {

constexpr std::uint32_t kCameraId = 1;
// A readout outside these limits is no readout of a video frame.
constexpr double kMinReadout_ms = 0.1;
constexpr double kMaxReadout_ms = 100.0;
// Stamps and payload times may disagree by the sensor clock's error, not by more.
constexpr double kMaxRateDisagreement = 0.05;

// Channel order of cameras whose streams lack ORIN and carry the HERO5's stream name although their
// sensor is mounted another way. HERO6 and Fusion: gopro/gpmf-parser, docs/README.md ("Data
// order").
struct KnownDevice {
  std::string_view name;
  std::string_view orin;
};
constexpr std::array<KnownDevice, 2> kKnownDevices = {{{"hero6", "YxZ"}, {"fusion", "yXZ"}}};

// "Gyroscope (z,x,y)" -> "ZXY"; "-y" -> "y". Empty when the name tells no order.
std::string OrderFromStreamName(const std::string& name) {
  const std::size_t open = name.find('(');
  const std::size_t close = name.find(')', open == std::string::npos ? 0 : open);
  if (open == std::string::npos || close == std::string::npos) {
    return {};
  }
  std::string order;
  bool is_negative = false;
  for (const char c : ToLower(name.substr(open + 1, close - open - 1))) {
    if (c == '-') {
      is_negative = true;
    } else if (c >= 'x' && c <= 'z') {
      order += is_negative ? c : static_cast<char>(c - 'x' + 'X');
      is_negative = false;
    } else if (c != ',' && c != ' ') {
      return {};
    }
  }
  return ParseAxisString(order) ? order : std::string();
}

struct Axes {
  Eigen::Matrix3d camera_from_channels;
  std::string note;
};

Axes ChooseAxes(const GpmfDevice& device, const GyroParseOptions& options) {
  if (options.camera_from_sensor) {
    return {*options.camera_from_sensor, {}};
  }
  constexpr std::string_view kUsualOutput = "ZXY";
  const GpmfGyroPacket& packet = device.gyro.front();
  if (packet.mtrx) {
    const std::string_view orio = packet.orio.empty() ? kUsualOutput : packet.orio;
    if (const Result<Eigen::Matrix3d> axes = CameraFromGoProMatrix(*packet.mtrx, orio)) {
      return {*axes, {}};
    }
  }
  if (const Result<Eigen::Matrix3d> axes = CameraFromGoProChannels(packet.orin)) {
    return {*axes, {}};
  }
  const std::string name = ToLower(device.name);
  for (const KnownDevice& known : kKnownDevices) {
    if (name.find(known.name) != std::string::npos) {
      return {*CameraFromGoProChannels(known.orin),
              fmt::format("gyro axes taken as {}, which GoPro documents for this device ({})",
                          known.orin, device.name)};
    }
  }
  if (const std::string order = OrderFromStreamName(packet.stream_name); !order.empty()) {
    return {*CameraFromGoProChannels(order), {}};
  }
  return {*CameraFromGoProChannels(kUsualOutput),
          "the telemetry does not say how the gyro's axes lie; GoPro's usual order Z, X, Y is "
          "assumed"};
}

const GpmfDevice* ChooseDevice(const std::vector<GpmfDevice>& devices) {
  const auto has_gyro = [](const GpmfDevice& d) { return !d.gyro.empty(); };
  const auto camera = std::find_if(devices.begin(), devices.end(), [&](const GpmfDevice& d) {
    return has_gyro(d) && d.id == kCameraId;
  });
  const auto chosen =
      camera != devices.end() ? camera : std::find_if(devices.begin(), devices.end(), has_gyro);
  return chosen != devices.end() ? &*chosen : nullptr;
}

double MedianOf(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Running number of each packet's first sample. TSMP tells of samples that were lost with their
// payload; it is believed where the payload times agree that something is missing, so that a reset
// or false count opens no gap.
std::vector<double> NumberSamples(const std::vector<GpmfGyroPacket>& packets,
                                  std::span<const GpmfPayload> payloads) {
  const auto count_of = [&](std::size_t i) {
    return static_cast<double>(packets[i].channels.size());
  };
  std::vector<double> elapsed_s(packets.size(), 0.0);  // since the packet before
  std::vector<double> intervals_s;
  for (std::size_t i = 1; i < packets.size(); ++i) {
    elapsed_s[i] = payloads[packets[i].payload].start_s - payloads[packets[i - 1].payload].start_s;
    intervals_s.push_back(elapsed_s[i] / count_of(i - 1));
  }
  const double interval_s = intervals_s.empty() ? 0.0 : MedianOf(std::move(intervals_s));

  std::vector<double> first(packets.size(), 0.0);
  std::optional<double> origin;  // TSMP of sample 0
  double next = 0.0;
  for (std::size_t i = 0; i < packets.size(); ++i) {
    if (packets[i].total_samples) {
      const double before = *packets[i].total_samples - count_of(i);
      const double lost = before - origin.value_or(before - next) - next;
      const double missing = i > 0 ? elapsed_s[i] / interval_s - count_of(i - 1) : 0.0;
      if (lost > 0.0 && std::abs(missing - lost) < std::abs(missing)) {
        next += lost;
      }
      origin = before - next;
    }
    first[i] = next;
    next += count_of(i);
  }
  return first;
}

struct Timing {
  SampleClock clock;
  std::string note;
};

Result<Timing> FitTiming(const std::vector<GpmfGyroPacket>& packets,
                         const std::vector<double>& first_sample,
                         std::span<const GpmfPayload> payloads) {
  std::vector<ClockMark> by_track;
  std::vector<ClockMark> by_stamp;
  for (std::size_t i = 0; i < packets.size(); ++i) {
    const GpmfGyroPacket& packet = packets[i];
    by_track.push_back({first_sample[i], payloads[packet.payload].start_s - packet.delay_s});
    if (packet.stamp_s) {
      by_stamp.push_back({first_sample[i], *packet.stamp_s});
    }
  }
  if (packets.size() == 1) {
    const double claimed_s = payloads[packets[0].payload].duration_s;
    const double duration_s = claimed_s == 0.0 ? kGpmfNominalPayload_s : claimed_s;
    const double interval_s = duration_s / static_cast<double>(packets[0].channels.size());
    if (!(duration_s > 0.0) || !std::isfinite(by_track[0].time_s) || !std::isfinite(interval_s)) {
      return Fail(ErrorCode::kCorruptData,
                  "the only GPMF payload with gyro data has no usable duration ({} s)", duration_s);
    }
    return Timing{SampleClock::Even(by_track[0].time_s, interval_s),
                  "a single telemetry payload: the gyro's rate is known from its duration only"};
  }
  Result<SampleClock> track = SampleClock::Fit(by_track);
  if (!track) {
    return Propagate(std::move(track).error(), "timestamps of the telemetry track");
  }
  if (by_stamp.size() != packets.size()) {
    return Timing{*std::move(track), {}};
  }
  Result<SampleClock> stamped = SampleClock::Fit(by_stamp);
  const double last = first_sample.back();
  const double ratio = stamped ? (stamped->TimeOf(last) - stamped->TimeOf(0.0)) /
                                     (track->TimeOf(last) - track->TimeOf(0.0))
                               : 0.0;
  if (!(std::abs(ratio - 1.0) < kMaxRateDisagreement)) {
    return Timing{*std::move(track),
                  "the gyro's time stamps contradict the telemetry track's and were not used"};
  }
  std::vector<double> offsets;
  offsets.reserve(by_track.size());
  for (const ClockMark& mark : by_track) {
    offsets.push_back(mark.time_s - stamped->TimeOf(mark.sample));
  }
  stamped->Shift(MedianOf(std::move(offsets)));
  return Timing{*std::move(stamped), {}};
}

std::optional<double> ReadoutTime(const GpmfDevice& device) {
  std::vector<double> plausible;
  std::copy_if(device.readouts_ms.begin(), device.readouts_ms.end(), std::back_inserter(plausible),
               [](double ms) { return ms >= kMinReadout_ms && ms <= kMaxReadout_ms; });
  if (plausible.empty()) {
    return std::nullopt;
  }
  return MedianOf(std::move(plausible)) * 1e-3;
}

}  // namespace

std::vector<GpmfPayload> SplitGpmfPayloads(std::span<const std::uint8_t> bytes) {
  std::vector<std::size_t> starts;
  std::vector<std::optional<std::uint32_t>> seen;  // devices of the payload being collected
  std::size_t offset = FindGpmfDevice(bytes, 0);
  while (offset < bytes.size()) {
    std::optional<std::uint32_t> id;
    if (const std::optional<KlvItem> child = ReadKlv(bytes, offset + 8);
        child && child->key == "DVID") {
      if (const std::optional<KlvTable> table = KlvNumbers(*child);
          table && !table->values.empty()) {
        id = static_cast<std::uint32_t>(std::clamp(table->values[0], 0.0, 4294967295.0));
      }
    }
    if (starts.empty() || std::find(seen.begin(), seen.end(), id) != seen.end()) {
      starts.push_back(offset);
      seen.clear();
    }
    seen.push_back(id);
    offset = FindGpmfDevice(bytes, offset + 1);
  }
  std::vector<GpmfPayload> payloads(starts.size());
  for (std::size_t i = 0; i < starts.size(); ++i) {
    const std::size_t end = i + 1 < starts.size() ? starts[i + 1] : bytes.size();
    payloads[i] = {bytes.subspan(starts[i], end - starts[i]),
                   static_cast<double>(i) * kGpmfNominalPayload_s, kGpmfNominalPayload_s};
  }
  return payloads;
}

Result<GyroRecording> ParseGpmf(std::span<const GpmfPayload> payloads,
                                const GyroParseOptions& options) {
  GpmfStreamCollector streams;
  for (std::size_t i = 0; i < payloads.size(); ++i) {
    if (!std::isfinite(payloads[i].start_s)) {
      return Fail(ErrorCode::kCorruptData, "GPMF payload {} has no finite start time", i);
    }
    streams.Add(i, payloads[i].bytes);
  }
  const GpmfDevice* device = ChooseDevice(streams.devices());
  if (device == nullptr) {
    const bool lacks_scale = std::any_of(streams.devices().begin(), streams.devices().end(),
                                         [](const GpmfDevice& d) { return d.scale_missing > 0.0; });
    return lacks_scale
               ? Fail(ErrorCode::kCorruptData,
                      "the GPMF telemetry's gyro has no usable scale (SCAL); its unit is unknown")
               : Fail(ErrorCode::kCorruptData,
                      "no gyro (GYRO) found in {} GPMF payloads; was the camera's stabilization "
                      "data recorded?",
                      payloads.size());
  }

  const Axes axes = ChooseAxes(*device, options);
  const std::vector<double> first_sample = NumberSamples(device->gyro, payloads);
  Result<Timing> timing = FitTiming(device->gyro, first_sample, payloads);
  if (!timing) {
    return Propagate(std::move(timing).error());
  }

  const auto is_readable = [&](const Eigen::Vector3d& channels) {
    return channels.allFinite() && channels.cwiseAbs().maxCoeff() <= options.limits.max_rate_rad_s;
  };
  std::vector<GyroSample> samples;
  std::size_t dropped = 0;
  for (std::size_t i = 0; i < device->gyro.size(); ++i) {
    const std::vector<Eigen::Vector3d>& channels = device->gyro[i].channels;
    for (std::size_t j = 0; j < channels.size(); ++j) {
      // A sensor that is still starting up.
      if (samples.empty() && !is_readable(channels[j])) {
        ++dropped;
        continue;
      }
      samples.push_back({timing->clock.TimeOf(first_sample[i] + static_cast<double>(j)),
                         axes.camera_from_channels * channels[j]});
    }
  }
  Result<GyroLog> log = GyroLog::Create(std::move(samples), options.limits);
  if (!log) {
    return Propagate(std::move(log).error(), "GPMF telemetry");
  }

  GyroRecording recording{*std::move(log), "GPMF", device->name, ReadoutTime(*device), {}};
  const auto note = [&](std::string text) {
    if (!text.empty()) {
      recording.notes.push_back(std::move(text));
    }
  };
  note(axes.note);
  note(timing->note);
  if (dropped > 0) {
    note(fmt::format("{} unreadable gyro samples at the start were left out", dropped));
  }
  if (streams.skipped_bytes() > 0) {
    note(fmt::format("{} bytes of the telemetry are not GPMF and were skipped",
                     streams.skipped_bytes()));
  }
  if (streams.damaged_items() > 0) {
    note(fmt::format("{} damaged or cut-off telemetry items", streams.damaged_items()));
  }
  if (device->scale_missing > 0.0) {
    note(fmt::format("{} gyro samples without a scale were left out", device->scale_missing));
  }
  return recording;
}

}  // namespace rsstab::igf
