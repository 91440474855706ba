// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_IGF_GPMF_STREAMS_H_
#define RSSTAB_IGF_GPMF_STREAMS_H_

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "igf/gpmf_klv.h"

namespace rsstab::igf {

// Where the first device (a DEVC container) at or after `from` starts; bytes.size() if none.
[[nodiscard]] std::size_t FindGpmfDevice(std::span<const std::uint8_t> bytes, std::size_t from);

// What one gyro stream of one payload says, scaled but neither timed nor turned.
struct GpmfGyroPacket {
  std::size_t payload = 0;                // index of the payload it came in
  std::vector<Eigen::Vector3d> channels;  // rad/s, in stored order
  std::optional<double> total_samples;    // TSMP: samples since the start, these included
  std::optional<double> stamp_s;          // STMP: time of the first sample, arbitrary origin
  double delay_s = 0.0;                   // TIMO: the samples are older than the payload's time
  std::string stream_name;                // STNM
  std::string orin;
  std::string orio;
  std::optional<Eigen::Matrix3d> mtrx;
};

struct GpmfDevice {
  std::optional<std::uint32_t> id;  // DVID
  std::string name;                 // DVNM
  std::vector<GpmfGyroPacket> gyro;
  std::vector<double> readouts_ms;  // SROT
  double scale_missing = 0.0;       // gyro samples that had to be dropped for want of SCAL
};

// The stream (STRM) being read; its properties precede its data.
struct GpmfOpenStream {
  GpmfGyroPacket packet;
  std::vector<double> scale;
  std::string type_definition;
  double unit_factor = 1.0;  // to rad/s
  std::vector<double> readouts_ms;
};

// Collects the gyro and the readout time of every device of a sequence of payloads. The bytes are
// walked in one pass without recursion, so nesting cannot exhaust the stack.
class GpmfStreamCollector {
 public:
  // Reads one payload; damage is skipped and noted.
  void Add(std::size_t payload, std::span<const std::uint8_t> bytes);

  [[nodiscard]] const std::vector<GpmfDevice>& devices() const { return devices_; }
  [[nodiscard]] std::size_t skipped_bytes() const { return skipped_bytes_; }
  [[nodiscard]] std::size_t damaged_items() const { return damaged_items_; }

 private:
  void Visit(const KlvItem& item);
  void VisitStreamItem(const KlvItem& item);
  void ReadGyro(const KlvItem& item);
  void FinishStream();
  void FinishDevice();

  std::vector<GpmfDevice> devices_;
  std::size_t skipped_bytes_ = 0;
  std::size_t damaged_items_ = 0;

  std::size_t payload_ = 0;
  std::optional<GpmfDevice> device_;
  std::optional<GpmfOpenStream> stream_;
};

}  // namespace rsstab::igf

#endif  // RSSTAB_IGF_GPMF_STREAMS_H_
