// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_PLUGIN_CAPI_LOG_BRIDGE_H_
#define RSSTAB_PLUGIN_CAPI_LOG_BRIDGE_H_

#include "igf/base/log.h"
#include "plugin/capi/rsstab.h"

namespace rsstab::capi {

struct LogTarget {
  rsstab_log_function function = nullptr;  // null: silence
  void* user = nullptr;
  rsstab_log_level most_detailed = RSSTAB_LOG_WARNING;
};

// A logger of its own, known to nobody else, whose messages go to the host one at a time.
[[nodiscard]] Logger MakeHostLogger(const LogTarget& target);

}  // namespace rsstab::capi

#endif  // RSSTAB_PLUGIN_CAPI_LOG_BRIDGE_H_
