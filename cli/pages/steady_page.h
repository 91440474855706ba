// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_PAGES_STEADY_PAGE_H_
#define RSSTAB_CLI_PAGES_STEADY_PAGE_H_

#include <memory>
#include <string>
#include <vector>

#include "cli/media/video_info.h"
#include "cli/media/video_reader.h"
#include "cli/pages/clip_page.h"
#include "cli/pages/exhibit_picker.h"
#include "cli/pages/shake_scale.h"
#include "cli/stage_times.h"
#include "igf/base/parallel_for.h"
#include "stabilizer/analysis_file.h"
#include "stabilizer/quality_metrics.h"

namespace rsstab::cli {

// The report of a clip while it is rendered: what `compare` measures of each clip by itself, and
// what the analysis file tells. Memory: a dozen small pictures and some 200 bytes for each frame.
class SteadyPage {
 public:
  // `info`: of the input. Errors: those of stabilizer::AnalysisReader::Open.
  [[nodiscard]] static Result<std::unique_ptr<SteadyPage>> Create(const std::string& analysis_file,
                                                                  const media::VideoInfo& info,
                                                                  const std::string& output);

  // To be called with every frame, in the order of the analysis file.
  [[nodiscard]] Status Observe(const media::VideoFrame& frame, const Frame& steady);

  // The page, once. `encode_command`: options beyond those that the analysis file holds.
  [[nodiscard]] Result<std::string> Make(const std::string& encode_command,
                                         const std::vector<StageTime>& stages);

 private:
  SteadyPage(std::unique_ptr<stabilizer::AnalysisReader> analysis, media::VideoInfo info,
             std::string output);
  [[nodiscard]] CompareReport::Clip Describe(const std::string& path,
                                             const stabilizer::ClipMeter& meter) const;

  std::unique_ptr<stabilizer::AnalysisReader> analysis_;
  media::VideoInfo info_;
  std::string output_;
  double start_s_ = 0.0;
  WorkerPool workers_{2};  // one for each meter
  stabilizer::ClipMeter input_meter_;
  stabilizer::ClipMeter output_meter_;
  ShakeScale shake_;
  ExhibitPicker picker_;
  std::vector<RsMoment> moments_;
};

}  // namespace rsstab::cli

#endif  // RSSTAB_CLI_PAGES_STEADY_PAGE_H_
