// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_MANUAL_PAGE_H_
#define RSSTAB_CLI_MANUAL_PAGE_H_

#include <string>

namespace rsstab::cli {

// The manual page rs-stabilize(1) in man(7) markup, with every command and option.
[[nodiscard]] std::string ManualPage();

}  // namespace rsstab::cli

#endif  // RSSTAB_CLI_MANUAL_PAGE_H_
