// SPDX-License-Identifier: Apache-2.0
#include "cli/media/av_log.h"

#include <array>
#include <cstdarg>
#include <mutex>
#include <string>
#include <string_view>

#include "cli/media/av_handles.h"

namespace rsstab::media {
namespace {

const Logger* LoggerOf(void* context) {
  if (context == nullptr) {
    return nullptr;
  }
  // libav's rule: every object that logs begins with a pointer to its class.
  const AVClass* type = *static_cast<const AVClass**>(context);
  if (type == nullptr || type->class_name == nullptr) {
    return nullptr;
  }
  const std::string_view name = type->class_name;
  if (name == "AVCodecContext") {
    return static_cast<const Logger*>(static_cast<AVCodecContext*>(context)->opaque);
  }
  if (name == "AVFormatContext") {
    return static_cast<const Logger*>(static_cast<AVFormatContext*>(context)->opaque);
  }
  return nullptr;
}

void Callback(void* context, int level, const char* format, va_list arguments) {
  if (level > AV_LOG_INFO) {
    return;
  }
  const Logger* logger = LoggerOf(context);
  if (logger == nullptr || !(*logger)->should_log(spdlog::level::debug)) {
    return;
  }
  std::array<char, 1024> line{};
  int print_prefix = 1;
  av_log_format_line2(context, level, format, arguments, line.data(), static_cast<int>(line.size()),
                      &print_prefix);
  std::string_view text(line.data());
  while (!text.empty() && text.back() == '\n') {
    text.remove_suffix(1);
  }
  (*logger)->debug("libav: {}", text);
}

}  // namespace

void RouteAvLog() {
  static std::once_flag once;
  std::call_once(once, [] { av_log_set_callback(Callback); });
}

}  // namespace rsstab::media
