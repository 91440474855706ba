// SPDX-License-Identifier: Apache-2.0
#include "cli/console_logger.h"

#include <spdlog/sinks/base_sink.h>

#include <mutex>
#include <string>
#include <utility>

namespace rsstab::cli {
namespace {

class ReporterSink final : public spdlog::sinks::base_sink<std::mutex> {
 public:
  explicit ReporterSink(std::shared_ptr<ProgressReporter> reporter)
      : reporter_(std::move(reporter)) {}

 protected:
  void sink_it_(const spdlog::details::log_msg& message) override {
    std::string line = "rs-stabilize: ";
    if (message.level >= spdlog::level::err) {
      line += "error: ";
    } else if (message.level == spdlog::level::warn) {
      line += "warning: ";
    } else if (message.level <= spdlog::level::debug) {
      line += "debug: ";
    }
    line.append(message.payload.data(), message.payload.size());
    line += '\n';
    reporter_->WriteLine(line);
  }
  void flush_() override {}

 private:
  std::shared_ptr<ProgressReporter> reporter_;
};

spdlog::level::level_enum SpdlogLevel(LogLevel level) {
  switch (level) {
    case LogLevel::kDebug:
      return spdlog::level::debug;
    case LogLevel::kInfo:
      return spdlog::level::info;
    case LogLevel::kWarn:
      return spdlog::level::warn;
    case LogLevel::kError:
      return spdlog::level::err;
    case LogLevel::kOff:
      return spdlog::level::off;
  }
  return spdlog::level::info;
}

}  // namespace

Logger MakeConsoleLogger(std::shared_ptr<ProgressReporter> reporter, LogLevel level) {
  auto logger = std::make_shared<spdlog::logger>(
      "rs-stabilize", std::make_shared<ReporterSink>(std::move(reporter)));
  logger->set_level(SpdlogLevel(level));
  return logger;
}

}  // namespace rsstab::cli
