// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_IGF_BASE_WHOLE_FILE_H_
#define RSSTAB_IGF_BASE_WHOLE_FILE_H_

#include <cstdint>
#include <string>

#include "igf/base/result.h"

namespace rsstab {

// All bytes of a regular file of at most `max_bytes`. Every error names the file.
// Errors: kNotFound, kIo (not readable, not a regular file), kUnsupported (too large),
// kCorruptData (empty).
[[nodiscard]] Result<std::string> ReadWholeFile(const std::string& path, std::uint64_t max_bytes);

// Writes a file beside `path` and renames it when it is complete, so that no half-written file ever
// has the final name. Replaces an existing file.
// Errors: kIo.
[[nodiscard]] Status WriteWholeFile(const std::string& path, const std::string& content);

}  // namespace rsstab

#endif  // RSSTAB_IGF_BASE_WHOLE_FILE_H_
