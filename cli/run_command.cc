// SPDX-License-Identifier: Apache-2.0
#include "cli/run_command.h"

#include <cstdint>
#include <exception>
#include <iostream>
#include <memory>
#include <new>
#include <sstream>

#include "cli/cancellation.h"
#include "cli/command_context.h"
#include "cli/commands/analyze.h"
#include "cli/commands/calibrate.h"
#include "cli/commands/compare.h"
#include "cli/commands/correct.h"
#include "cli/commands/evaluate.h"
#include "cli/commands/info.h"
#include "cli/commands/render.h"
#include "cli/commands/simulate.h"
#include "cli/commands/stabilize.h"
#include "cli/console_logger.h"
#include "cli/exit_codes.h"
#include "cli/media/av_log.h"

namespace rsstab::cli {
namespace {

// The one pass of a command, which begins with its first frame or picture.
class OnePass {
 public:
  OnePass(const CommandContext& context, const char* name, const char* unit)
      : reporter_(*context.reporter), name_(name), unit_(unit) {}

  // False once the user wants it to stop.
  bool Update(std::int64_t done, std::int64_t frames) {
    if (!begun_) {
      reporter_.BeginPass(1, 1, name_, frames, unit_);
      begun_ = true;
    }
    reporter_.Update(done);
    return !CancelRequested();
  }
  void End() {
    if (begun_) {
      reporter_.EndPass();
    }
  }

 private:
  ProgressReporter& reporter_;
  const char* name_;
  const char* unit_;
  bool begun_ = false;
};

// Runs `job`, which counts its frames or pictures, as the one pass of a command.
template <typename Job>
Status RunAsPass(const CommandContext& context, const char* name, const char* unit,
                 const Job& job) {
  OnePass pass(context, name, unit);
  Status status =
      job([&pass](std::int64_t done, std::int64_t frames) { return pass.Update(done, frames); });
  if (status) {
    pass.End();
  }
  return status;
}

Status Simulate(const Invocation& invocation, const CommandContext& context) {
  return RunAsPass(context, "simulate", "frames", [&](const SimulateProgress& progress) {
    return RunSimulate(invocation.simulate, context.logger, progress);
  });
}

Status Correct(const Invocation& invocation, const CommandContext& context) {
  return RunAsPass(context, "correct", "pictures", [&](const CorrectProgress& progress) {
    return RunCorrect(invocation.correct, context.logger, progress);
  });
}

Status Print(const std::string& text) {
  if (!(std::cout << text << std::flush)) {
    return Fail(ErrorCode::kIo, "standard output cannot be written");
  }
  return {};
}

Status Compare(const Invocation& invocation, const CommandContext& context) {
  std::ostringstream report;
  const Status status =
      RunAsPass(context, "compare", "frames", [&](const CompareProgress& progress) {
        return RunCompare(invocation.compare, context.logger, report, progress);
      });
  return status ? Print(report.str()) : status;
}

Status Evaluate(const Invocation& invocation, const CommandContext& context) {
  const bool of_clips = !invocation.evaluate.clips.empty();
  OnePass pass(context, "evaluate", of_clips ? "runs" : "pictures");
  return RunEvaluate(
      invocation.evaluate, context.logger,
      [&](const std::string& table) {
        pass.End();
        return Print(table);
      },
      [&](std::int64_t done, std::int64_t items) { return pass.Update(done, items); });
}

Status Dispatch(const Invocation& invocation, const CommandContext& context) {
  switch (invocation.command) {
    case CommandId::kStabilize:
      return RunStabilize(invocation, context);
    case CommandId::kAnalyze:
      return RunAnalyze(invocation, context);
    case CommandId::kCalibrate:
      return RunCalibrate(invocation, context);
    case CommandId::kRender:
      return RunRender(invocation, context);
    case CommandId::kInfo:
      return RunInfo(invocation, context);
    case CommandId::kCorrect:
      return Correct(invocation, context);
    case CommandId::kCompare:
      return Compare(invocation, context);
    case CommandId::kSimulate:
      return Simulate(invocation, context);
    case CommandId::kEvaluate:
      return Evaluate(invocation, context);
  }
  return Fail(ErrorCode::kInternal, "no such command");
}

Status DispatchSafely(const Invocation& invocation, const CommandContext& context) {
  try {
    return Dispatch(invocation, context);
  } catch (const std::bad_alloc&) {
    return Fail(ErrorCode::kIo, "out of memory");
  } catch (const std::exception& exception) {
    return Fail(ErrorCode::kInternal, "this should not happen, please report it: {}",
                exception.what());
  }
}

}  // namespace

int RunCommand(const Invocation& invocation) {
  media::RouteAvLog();
  CommandContext context;
  context.reporter = std::make_shared<ProgressReporter>(StandardErrorSink(invocation.run.progress));
  context.logger = MakeConsoleLogger(context.reporter, invocation.run.log_level);
  const Status status = DispatchSafely(invocation, context);
  if (status) {
    return kExitDone;
  }
  // What ended the program is told at every log level.
  context.reporter->Abandon();
  context.reporter->WriteLine("rs-stabilize: error: " + status.error().message + "\n");
  return kExitFailed;
}

}  // namespace rsstab::cli
