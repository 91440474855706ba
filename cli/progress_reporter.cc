// SPDX-License-Identifier: Apache-2.0
#include "cli/progress_reporter.h"

#include <spdlog/fmt/fmt.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <utility>

namespace rsstab::cli {
namespace {

constexpr double kBarInterval_s = 0.2;
constexpr double kPlainInterval_s = 10.0;  // plain lines come at each tenth, or this often
constexpr double kJsonInterval_s = 0.5;
constexpr double kMinElapsed_s = 0.2;  // no rate is told before

std::string Clock(double seconds) {
  const auto total = static_cast<std::int64_t>(seconds + 0.5);
  if (total >= 3600) {
    return fmt::format("{}:{:02}:{:02}", total / 3600, total / 60 % 60, total % 60);
  }
  return fmt::format("{}:{:02}", total / 60, total % 60);
}

}  // namespace

ProgressSink StandardErrorSink(ProgressStyle style) {
  ProgressSink sink;
  const bool terminal = isatty(STDERR_FILENO) == 1;
  sink.style = style;
  if (style == ProgressStyle::kAuto) {
    sink.style = terminal ? ProgressStyle::kBar : ProgressStyle::kPlain;
  }
  winsize size = {};
  if (terminal && ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0) {
    sink.columns = size.ws_col;
  }
  sink.write = [](std::string_view text) {
    std::fwrite(text.data(), 1, text.size(), stderr);
    std::fflush(stderr);
  };
  sink.now_s = [] {
    const auto now = std::chrono::steady_clock::now().time_since_epoch();
    return std::chrono::duration<double>(now).count();
  };
  return sink;
}

ProgressReporter::ProgressReporter(ProgressSink sink) : sink_(std::move(sink)) {}

void ProgressReporter::BeginPass(int pass, int passes, std::string_view name, std::int64_t frames,
                                 std::string_view unit) {
  const std::lock_guard lock(mutex_);
  pass_ = pass;
  passes_ = passes;
  name_ = name;
  unit_ = unit;
  frames_ = frames;
  done_ = 0;
  last_tenth_ = 0;
  start_s_ = sink_.now_s();
  last_print_s_ = start_s_;
  if (sink_.style == ProgressStyle::kBar || sink_.style == ProgressStyle::kJson) {
    Print(start_s_, false);
  }
}

void ProgressReporter::Update(std::int64_t frames_done) {
  const std::lock_guard lock(mutex_);
  done_ = frames_done;
  const double now = sink_.now_s();
  const double waited = now - last_print_s_;
  bool due = false;
  switch (sink_.style) {
    case ProgressStyle::kBar:
      due = waited >= kBarInterval_s;
      break;
    case ProgressStyle::kJson:
      due = waited >= kJsonInterval_s;
      break;
    case ProgressStyle::kPlain: {
      const int tenth = frames_ > 0 ? static_cast<int>(10 * done_ / frames_) : 0;
      due = waited >= kPlainInterval_s || (tenth > last_tenth_ && tenth < 10 && waited >= 1.0);
      last_tenth_ = std::max(last_tenth_, due ? tenth : 0);
      break;
    }
    case ProgressStyle::kAuto:
    case ProgressStyle::kNone:
      break;
  }
  if (due) {
    Print(now, false);
  }
}

void ProgressReporter::EndPass() {
  const std::lock_guard lock(mutex_);
  frames_ = done_;
  Print(sink_.now_s(), true);
  pass_ = 0;
}

void ProgressReporter::Abandon() {
  const std::lock_guard lock(mutex_);
  EraseBar();
}

void ProgressReporter::WriteLine(std::string_view line) {
  const std::lock_guard lock(mutex_);
  const std::string bar = bar_;
  EraseBar();
  sink_.write(line);
  if (!bar.empty()) {
    sink_.write(bar);
    bar_ = bar;
  }
}

ProgressReporter::Estimate ProgressReporter::EstimateNow(double now_s) const {
  Estimate estimate;
  estimate.elapsed_s = now_s - start_s_;
  if (done_ > 0 && estimate.elapsed_s >= kMinElapsed_s) {
    estimate.fps = static_cast<double>(done_) / estimate.elapsed_s;
    if (frames_ > 0) {
      // A later pass is taken to be as quick as this one: the best guess there is.
      const auto left = static_cast<double>(std::max<std::int64_t>(frames_ - done_, 0) +
                                            (passes_ - pass_) * frames_);
      estimate.eta_s = left / estimate.fps;
    }
  }
  return estimate;
}

void ProgressReporter::Print(double now_s, bool closing) {
  const Estimate estimate = EstimateNow(now_s);
  last_print_s_ = now_s;
  switch (sink_.style) {
    case ProgressStyle::kBar:
      EraseBar();
      if (!closing) {
        bar_ = BarText(estimate);
        sink_.write(bar_);
      }
      break;
    case ProgressStyle::kPlain:
      sink_.write(PlainText(estimate));
      break;
    case ProgressStyle::kJson:
      sink_.write(JsonText(estimate, closing));
      break;
    case ProgressStyle::kAuto:
    case ProgressStyle::kNone:
      break;
  }
}

void ProgressReporter::EraseBar() {
  if (!bar_.empty()) {
    sink_.write("\r" + std::string(bar_.size(), ' ') + "\r");
    bar_.clear();
  }
}

std::string ProgressReporter::Rate(const Estimate& estimate) const {
  return fmt::format("{:.1f} {}", estimate.fps, unit_ == "frames" ? "fps" : unit_ + "/s");
}

std::string ProgressReporter::BarText(const Estimate& estimate) const {
  std::string head = fmt::format("[{}/{}] {:<9}", pass_, passes_, name_);
  std::string tail =
      frames_ > 0 ? fmt::format(" {}/{}", done_, frames_) : fmt::format(" {}", done_);
  if (estimate.fps > 0.0) {
    tail += "  " + Rate(estimate);
  }
  if (estimate.eta_s >= 0.0) {
    tail += "  ETA " + Clock(estimate.eta_s);
  }
  // One column stays free: a full last line makes some terminals wrap.
  const int room = sink_.columns - 1 - static_cast<int>(head.size() + tail.size()) - 3;
  if (frames_ > 0 && room >= 10) {
    const int width = std::min(room, 40);
    const auto filled =
        static_cast<std::size_t>(std::clamp<std::int64_t>(width * done_ / frames_, 0, width));
    head += " [" + std::string(filled, '=') +
            std::string(static_cast<std::size_t>(width) - filled, ' ') + "]";
  }
  return (head + tail).substr(0, static_cast<std::size_t>(std::max(sink_.columns - 1, 1)));
}

std::string ProgressReporter::PlainText(const Estimate& estimate) const {
  std::string text = fmt::format("pass {}/{} {}: {}", pass_, passes_, name_, done_);
  if (frames_ > 0) {
    text += fmt::format(" of {} {} ({} %)", frames_, unit_, 100 * done_ / frames_);
  } else {
    text += " " + unit_;
  }
  if (estimate.fps > 0.0) {
    text += ", " + Rate(estimate);
  }
  if (estimate.eta_s > 0.0) {
    text += ", ETA " + Clock(estimate.eta_s);
  }
  return text + "\n";
}

std::string ProgressReporter::JsonText(const Estimate& estimate, bool closing) const {
  nlohmann::ordered_json line;
  line["event"] = closing ? "pass_done" : "progress";
  line["pass"] = pass_;
  line["passes"] = passes_;
  line["name"] = name_;
  line["frames_done"] = done_;
  line["frames"] = frames_ > 0 ? nlohmann::ordered_json(frames_) : nlohmann::ordered_json();
  line["elapsed_s"] = estimate.elapsed_s;
  line["fps"] = estimate.fps;
  line["eta_s"] =
      estimate.eta_s >= 0.0 ? nlohmann::ordered_json(estimate.eta_s) : nlohmann::ordered_json();
  return line.dump() + "\n";
}

}  // namespace rsstab::cli
