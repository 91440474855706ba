// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_REPORT_MARKUP_H_
#define RSSTAB_CLI_REPORT_MARKUP_H_

#include <string>
#include <string_view>

namespace rsstab::report {

// Any bytes as text of an HTML or SVG element or of a quoted attribute: the five characters with a
// meaning are escaped, bytes that are not UTF-8 and control characters become U+FFFD (a file name
// may hold both). Tab and line feed stay.
[[nodiscard]] std::string Escape(std::string_view text);

// The same for HTML that names a thing: a long name ("diffusion@steps=1,samples=8") breaks behind
// '@' and ',' rather than anywhere.
[[nodiscard]] std::string EscapeName(std::string_view text);

}  // namespace rsstab::report

#endif  // RSSTAB_CLI_REPORT_MARKUP_H_
