// SPDX-License-Identifier: Apache-2.0
#include "igf/base/log.h"

namespace rsstab {

Logger SilentLogger() {
  auto logger = std::make_shared<spdlog::logger>("rsstab");
  logger->set_level(spdlog::level::off);
  return logger;
}

}  // namespace rsstab
