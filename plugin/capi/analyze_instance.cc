// SPDX-License-Identifier: Apache-2.0
#include <utility>

#include "plugin/capi/instance.h"
#include "stabilizer/pipeline/analyzer.h"
#include "stabilizer/pipeline/rs_input_files.h"

namespace rsstab::capi {
namespace {

class AnalyzeInstance final : public Instance {
 public:
  AnalyzeInstance(const VideoFormat& format, std::unique_ptr<pipeline::Analyzer> analyzer,
                  Logger logger)
      : format_(format), analyzer_(std::move(analyzer)), logger_(std::move(logger)) {}

  Reply Push(const PushedFrame& pushed) override {
    if (!analyzer_) {
      return {RSSTAB_ERROR_BAD_STATE, "the analysis is complete: no frame can follow"};
    }
    const auto view = ToFrameView(*pushed.picture, format_);
    if (!view) {
      return view.error();
    }
    const double time_s = static_cast<double>(pushed.pts) * format_.seconds_per_tick;
    Reply reply = analyzer_->PushFrame(*view, pushed.pts, time_s);
    // Nothing is kept of the picture.
    if (reply.status == RSSTAB_OK && pushed.release != nullptr) {
      pushed.release(pushed.frame_data);
    }
    return reply;
  }

  Reply Flush() override {
    if (!analyzer_) {
      return {RSSTAB_ERROR_BAD_STATE, "the analysis is complete already"};
    }
    const auto analysis = analyzer_->Finish();
    analyzer_.reset();
    if (!analysis) {
      return analysis.error();
    }
    logger_->info("{} frames analysed, at least {:.1f} % of each side kept", analysis->num_frames,
                  100.0 * analysis->smallest_kept_ratio);
    return RSSTAB_OK;
  }

 private:
  VideoFormat format_;
  std::unique_ptr<pipeline::Analyzer> analyzer_;  // null once complete
  Logger logger_;
};

}  // namespace

Result<std::unique_ptr<Instance>> MakeAnalyzeInstance(const InstanceSetup& setup) {
  const VideoFormat& format = setup.format;
  const pipeline::StabilizeOptions& options = setup.options.stabilize;
  auto inputs = pipeline::ReadRsInputFiles(options, format.width, format.height, setup.logger);
  if (!inputs) {
    return Propagate(std::move(inputs.error()));
  }
  auto analyzer =
      pipeline::Analyzer::Create(options, {format.width, format.height, format.frames_per_second},
                                 std::move(*inputs), setup.path, setup.logger);
  if (!analyzer) {
    return Propagate(std::move(analyzer.error()));
  }
  return std::make_unique<AnalyzeInstance>(format, std::move(*analyzer), setup.logger);
}

}  // namespace rsstab::capi
