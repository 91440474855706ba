// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_REPORT_BASE64_H_
#define RSSTAB_CLI_REPORT_BASE64_H_

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace rsstab::report {

// Standard alphabet, padded (RFC 4648).
[[nodiscard]] std::string Base64(std::span<const std::uint8_t> bytes);

// What a Content-Security-Policy calls an inline script: 'sha256-...' of its text, quotes included.
[[nodiscard]] std::string CspHash(std::string_view script);

}  // namespace rsstab::report

#endif  // RSSTAB_CLI_REPORT_BASE64_H_
