// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_IGF_BASE_LOG_H_
#define RSSTAB_IGF_BASE_LOG_H_

#include <spdlog/logger.h>

#include <memory>

namespace rsstab {

// Modules log through the logger they are handed; nothing prints by itself. Never null.
using Logger = std::shared_ptr<spdlog::logger>;

// A logger without a sink, for hosts that do not want to hear anything. Any thread.
[[nodiscard]] Logger SilentLogger();

}  // namespace rsstab

#endif  // RSSTAB_IGF_BASE_LOG_H_
