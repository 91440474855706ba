// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_IGF_BASE_WHOLE_FILE_H_
#define RSSTAB_IGF_BASE_WHOLE_FILE_H_

#include <cstdint>
#include <functional>
#include <iosfwd>
#include <string>

#include "igf/base/result.h"

namespace rsstab {

// All bytes of a regular file of at most `max_bytes`. Every error names the file.
// Errors: kNotFound, kIo (not readable, not a regular file), kUnsupported (too large),
// kCorruptData (empty).
[[nodiscard]] Result<std::string> ReadWholeFile(const std::string& path, std::uint64_t max_bytes);

// Writes a file that appears under its name only when it is complete (StagedFile). Replaces an
// existing file. Errors: those of StagedFile, kIo (disk full).
[[nodiscard]] Status WriteWholeFile(const std::string& path, const std::string& content);

// The same for content that is made piece by piece: `write` puts it into the stream, and what it
// puts there after the stream has failed is lost without harm.
[[nodiscard]] Status WriteWholeFile(const std::string& path,
                                    const std::function<void(std::ostream& out)>& write);

}  // namespace rsstab

#endif  // RSSTAB_IGF_BASE_WHOLE_FILE_H_
