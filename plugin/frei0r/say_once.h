// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_PLUGIN_FREI0R_SAY_ONCE_H_
#define RSSTAB_PLUGIN_FREI0R_SAY_ONCE_H_

#include <string>

namespace rsstab::frei0r {

// Prints a line to standard error: frei0r has no other way to tell the user. Each text once for the
// whole process, since MLT makes an instance for every thread. Any thread.
void SayOnce(const std::string& text);

}  // namespace rsstab::frei0r

#endif  // RSSTAB_PLUGIN_FREI0R_SAY_ONCE_H_
