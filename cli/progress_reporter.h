// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_PROGRESS_REPORTER_H_
#define RSSTAB_CLI_PROGRESS_REPORTER_H_

#include <cstdint>
#include <functional>
#include <mutex>
#include <string>
#include <string_view>

#include "cli/run_options.h"

namespace rsstab::cli {

// Where and how progress is shown. `write` gets raw text, `now_s` a clock that never runs back.
struct ProgressSink {
  ProgressStyle style = ProgressStyle::kNone;  // kAuto is resolved before
  int columns = 80;                            // width of the terminal, for the bar
  std::function<void(std::string_view text)> write;
  std::function<double()> now_s;
};

// Standard error and the steady clock; kAuto becomes a bar on a terminal, plain lines elsewhere.
[[nodiscard]] ProgressSink StandardErrorSink(ProgressStyle style);

// Tells the user how far a job of one or more passes over the same clip has come. Any thread.
class ProgressReporter {
 public:
  explicit ProgressReporter(ProgressSink sink);

  // `pass` counts from 1 to `passes`; `frames` of the whole pass, 0 when unknown. `unit` is what
  // people call them.
  void BeginPass(int pass, int passes, std::string_view name, std::int64_t frames,
                 std::string_view unit = "frames");
  // Frames of this pass that are done. Cheap: most calls print nothing.
  void Update(std::int64_t frames_done);
  // Closes the pass; its frames are done. Erases the bar.
  void EndPass();
  // The pass will not be completed: erases the bar, prints nothing.
  void Abandon();

  // Prints a line of text (a log message) above the bar.
  void WriteLine(std::string_view line);

 private:
  struct Estimate {
    double elapsed_s = 0.0;
    double fps = 0.0;
    double eta_s = -1.0;  // of the whole job; negative: unknown
  };
  [[nodiscard]] Estimate EstimateNow(double now_s) const;
  void Print(double now_s, bool closing);
  void EraseBar();
  [[nodiscard]] std::string Rate(const Estimate& estimate) const;
  [[nodiscard]] std::string BarText(const Estimate& estimate) const;
  [[nodiscard]] std::string PlainText(const Estimate& estimate) const;
  [[nodiscard]] std::string JsonText(const Estimate& estimate, bool closing) const;

  ProgressSink sink_;
  std::mutex mutex_;
  std::string bar_;  // what stands on the terminal's last line
  int pass_ = 0;
  int passes_ = 0;
  std::string name_;
  std::string unit_;
  std::int64_t frames_ = 0;
  std::int64_t done_ = 0;
  double start_s_ = 0.0;  // of this pass
  double last_print_s_ = 0.0;
  int last_tenth_ = 0;  // tenths of the pass told already (plain lines)
};

}  // namespace rsstab::cli

#endif  // RSSTAB_CLI_PROGRESS_REPORTER_H_
