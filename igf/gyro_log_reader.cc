// SPDX-License-Identifier: Apache-2.0
#include "igf/gyro_log_reader.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <string_view>
#include <utility>
#include <vector>

#include "igf/base/whole_file.h"
#include "igf/csv_parser.h"
#include "igf/gcsv_parser.h"
#include "igf/gpmf_parser.h"
#include "igf/gpmf_streams.h"
#include "igf/gyroflow_json_parser.h"

namespace rsstab::igf {
namespace {

constexpr std::size_t kHead = 4096;
constexpr std::size_t kMaxJsonBytes = std::size_t{64}
                                      << 20U;  // a parsed tree is ten times as large

std::string_view AsText(std::span<const std::uint8_t> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

bool IsVideo(std::string_view head) {
  constexpr std::array<std::string_view, 5> kBoxes = {"ftyp", "moov", "mdat", "wide", "free"};
  const std::string_view box = head.size() >= 8 ? head.substr(4, 4) : std::string_view();
  return std::find(kBoxes.begin(), kBoxes.end(), box) != kBoxes.end() ||
         head.starts_with("\x1a\x45\xdf\xa3") ||  // Matroska, WebM
         (head.starts_with("RIFF") && head.size() >= 12 && head.substr(8, 4) == "AVI ");
}

// Control characters do not occur in text of any single-byte or UTF-8 encoding.
bool IsText(std::string_view head) {
  return std::none_of(head.begin(), head.end(), [](unsigned char c) {
    return c < 0x20 && c != '\n' && c != '\r' && c != '\t' && c != '\f';
  });
}

}  // namespace

GyroFormat RecogniseGyroFormat(std::span<const std::uint8_t> head) {
  head = head.first(std::min(head.size(), kHead));
  const std::string_view text = AsText(head);
  if (IsVideo(text)) {
    return GyroFormat::kVideo;
  }
  if (IsGcsv(text)) {
    return GyroFormat::kGcsv;
  }
  if (FindGpmfDevice(head, 0) < head.size()) {
    return GyroFormat::kGpmf;
  }
  if (text.empty() || !IsText(text)) {
    return GyroFormat::kUnknown;
  }
  const std::size_t first = text.find_first_not_of(" \t\r\n\xef\xbb\xbf");
  const bool is_json = first != std::string_view::npos && text[first] == '{';
  return is_json ? GyroFormat::kGyroflowJson : GyroFormat::kCsv;
}

Result<GyroRecording> ParseGyroFile(std::span<const std::uint8_t> bytes,
                                    const GyroParseOptions& options) {
  GyroFormat format = RecogniseGyroFormat(bytes);
  if (format == GyroFormat::kUnknown && FindGpmfDevice(bytes, 0) < bytes.size()) {
    format = GyroFormat::kGpmf;  // behind much garbage
  }
  switch (format) {
    case GyroFormat::kGcsv:
      return ParseGcsv(AsText(bytes), options);
    case GyroFormat::kCsv:
      return ParseGyroCsv(AsText(bytes), options);
    case GyroFormat::kGyroflowJson:
      if (bytes.size() > kMaxJsonBytes) {
        return Fail(ErrorCode::kUnsupported, "{} MiB of JSON are more than the limit of {} MiB",
                    bytes.size() >> 20U, kMaxJsonBytes >> 20U);
      }
      return ParseGyroflowJson(AsText(bytes), options);
    case GyroFormat::kGpmf: {
      Result<GyroRecording> recording = ParseGpmf(SplitGpmfPayloads(bytes), options);
      if (recording) {
        recording->notes.push_back(
            "telemetry without its container has no timestamps; 1.001 s a payload is assumed");
      }
      return recording;
    }
    case GyroFormat::kVideo:
      return Fail(ErrorCode::kUnsupported,
                  "this is a video, not a gyro log; its telemetry track has to be read first");
    case GyroFormat::kUnknown:
      break;
  }
  return Fail(ErrorCode::kCorruptData,
              "not a gyro log; known are GPMF, .gcsv, CSV with the header t,gx,gy,gz (UTF-8), and "
              "the first Gyroflow's JSON");
}

Result<GyroRecording> ReadGyroLog(const std::string& path, const GyroParseOptions& options) {
  const Result<std::string> content = ReadWholeFile(path, kMaxGyroFileBytes);
  if (!content) {
    return Propagate(content.error());
  }
  Result<GyroRecording> recording = ParseGyroFile(
      {reinterpret_cast<const std::uint8_t*>(content->data()), content->size()}, options);
  if (!recording) {
    return Propagate(std::move(recording).error(), path);
  }
  return recording;
}

}  // namespace rsstab::igf
