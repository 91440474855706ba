// SPDX-License-Identifier: Apache-2.0
#include "plugin/capi/log_bridge.h"

#include <spdlog/sinks/base_sink.h>

#include <memory>
#include <mutex>
#include <string>

namespace rsstab::capi {
namespace {

rsstab_log_level LevelOf(spdlog::level::level_enum level) {
  switch (level) {
    case spdlog::level::err:
    case spdlog::level::critical:
      return RSSTAB_LOG_ERROR;
    case spdlog::level::warn:
      return RSSTAB_LOG_WARNING;
    case spdlog::level::info:
      return RSSTAB_LOG_INFO;
    default:
      return RSSTAB_LOG_DEBUG;
  }
}

spdlog::level::level_enum LevelFrom(rsstab_log_level level) {
  switch (level) {
    case RSSTAB_LOG_ERROR:
      return spdlog::level::err;
    case RSSTAB_LOG_WARNING:
      return spdlog::level::warn;
    case RSSTAB_LOG_INFO:
      return spdlog::level::info;
    case RSSTAB_LOG_DEBUG:
      break;
  }
  return spdlog::level::debug;
}

class HostSink final : public spdlog::sinks::base_sink<std::mutex> {
 public:
  explicit HostSink(const LogTarget& target) : target_(target) {}

 protected:
  void sink_it_(const spdlog::details::log_msg& message) override {
    const std::string text(message.payload.data(), message.payload.size());
    target_.function(target_.user, LevelOf(message.level), text.c_str());
  }
  void flush_() override {}

 private:
  LogTarget target_;
};

}  // namespace

Logger MakeHostLogger(const LogTarget& target) {
  if (target.function == nullptr) {
    return SilentLogger();
  }
  auto logger = std::make_shared<spdlog::logger>("rsstab", std::make_shared<HostSink>(target));
  logger->set_level(LevelFrom(target.most_detailed));
  // spdlog's own failures would be printed.
  logger->set_error_handler([](const std::string& /*message*/) {});
  return logger;
}

}  // namespace rsstab::capi
