// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_IGF_GYRO_LOG_READER_H_
#define RSSTAB_IGF_GYRO_LOG_READER_H_

#include <cstdint>
#include <span>
#include <string>

#include "igf/base/result.h"
#include "igf/gyro_recording.h"

namespace rsstab::igf {

enum class GyroFormat {
  kUnknown,
  kGpmf,          // GPMF payloads without container
  kGcsv,          // Gyroflow's text log
  kGyroflowJson,  // project of the first Gyroflow
  kCsv,           // any other text
  kVideo,         // a media container; demux its telemetry track and call ParseGpmf
};

// Tells a format by the first bytes of a file (a few KiB are enough), never by its name.
[[nodiscard]] GyroFormat RecogniseGyroFormat(std::span<const std::uint8_t> head);

// Parses a whole file of any format but kVideo. GPMF without container is timed nominally
// (1.001 s a payload), with a note.
// Errors: kUnsupported for a video, kCorruptData for what is no gyro log, and the parser's own.
[[nodiscard]] Result<GyroRecording> ParseGyroFile(std::span<const std::uint8_t> bytes,
                                                  const GyroParseOptions& options = {});

// Largest file that ReadGyroLog takes: hours of text at several kHz.
inline constexpr std::uint64_t kMaxGyroFileBytes = 1ULL << 30U;

// Reads a gyro log file. Every error names the file.
// Errors: kNotFound, kIo (not readable, not a regular file), kUnsupported (too large), and those of
// ParseGyroFile. Any thread.
[[nodiscard]] Result<GyroRecording> ReadGyroLog(const std::string& path,
                                                const GyroParseOptions& options = {});

}  // namespace rsstab::igf

#endif  // RSSTAB_IGF_GYRO_LOG_READER_H_
