// SPDX-License-Identifier: Apache-2.0
#include "cli/pages/steady_page.h"

#include <spdlog/fmt/fmt.h>

#include <array>
#include <optional>
#include <utility>

#include "cli/pages/page_parts.h"

namespace rsstab::cli {
namespace {

constexpr double kReferenceWidth = 640.0;
constexpr double kMilliseconds = 1000.0;

std::vector<report::Fact> FactsOf(const stabilizer::ClipAnalysis& analysis,
                                  const media::VideoInfo& info, const std::string& output) {
  std::vector<report::Fact> facts = {{"Input", ClipText(info)}, {"Output", output}};
  if (analysis.gyro_offset_s) {
    facts.push_back({"Clock offset", fmt::format("{:+.2f} ms, from the gyro log's to the video's",
                                                 kMilliseconds * *analysis.gyro_offset_s)});
  }
  if (analysis.camera) {
    facts.push_back({"Camera", CameraText(*analysis.camera)});
  }
  facts.push_back({"Program", ProgramName() + (analysis.program_version.empty()
                                                   ? ""
                                                   : ", analysis by " + analysis.program_version)});
  return facts;
}

}  // namespace

SteadyPage::SteadyPage(std::unique_ptr<stabilizer::AnalysisReader> analysis, media::VideoInfo info,
                       std::string output)
    : analysis_(std::move(analysis)),
      info_(std::move(info)),
      output_(std::move(output)),
      picker_(report::ColorMatrixOf(info_.color.matrix, info_.height)) {}

Result<std::unique_ptr<SteadyPage>> SteadyPage::Create(const std::string& analysis_file,
                                                       const media::VideoInfo& info,
                                                       const std::string& output) {
  auto analysis = stabilizer::AnalysisReader::Open(analysis_file);
  if (!analysis) {
    return Propagate(analysis.error());
  }
  return std::unique_ptr<SteadyPage>(new SteadyPage(std::move(*analysis), info, output));
}

Status SteadyPage::Observe(const media::VideoFrame& frame, const Frame& steady) {
  const auto record = analysis_->Next();
  if (!record) {
    return Propagate(record.error());
  }
  if (!*record) {
    return {};  // the renderer refuses frames that were not analysed
  }
  const FrameView input = frame.frame.View();
  const FrameView output = steady.View();
  std::array<Status, 2> measured;
  workers_.ForBlocks(2, 1, [&](int index, int) {
    measured[static_cast<std::size_t>(index)] =
        index == 0 ? input_meter_.Push(input) : output_meter_.Push(output);
  });
  for (const Status& status : measured) {
    if (!status) {
      return status;
    }
  }
  if (frame.index == 0) {
    start_s_ = frame.time_s;
  }
  const stabilizer::FrameAnalysis& found = **record;
  const bool has_field = found.rs_field.columns() > 0;
  const double time_s = frame.time_s - start_s_;
  moments_.push_back(DescribeField(found.rs_field, time_s, KeptRatio(found, analysis_->clip())));
  ExhibitCandidate candidate;
  candidate.index = frame.index;
  candidate.time_s = time_s;
  candidate.shake_px = shake_.Next(input_meter_.LastStep());
  if (has_field) {
    candidate.rs_px = found.rs_field.RmsLength() * kReferenceWidth / found.rs_field.width();
    candidate.rs_field = &found.rs_field;
  }
  candidate.input = input;
  candidate.output = output;
  return picker_.Push(candidate);
}

CompareReport::Clip SteadyPage::Describe(const std::string& path,
                                         const stabilizer::ClipMeter& meter) const {
  CompareReport::Clip clip;
  clip.path = path;
  clip.width = info_.width;
  clip.height = info_.height;
  clip.frames_per_second = analysis_->clip().frames_per_second;
  clip.metrics = meter.Measure(clip.frames_per_second);
  clip.poses = meter.Path();
  return clip;
}

Result<std::string> SteadyPage::Make(const std::string& encode_command,
                                     const std::vector<StageTime>& stages) {
  ClipPage page;
  page.kind = ProgramName() + ", a steadied clip";
  page.figures.input = Describe(info_.path, input_meter_);
  page.figures.output = Describe(output_, output_meter_);
  page.exhibits = picker_.Finish();
  page.quarter_turns = QuarterTurns(info_);
  page.moments = std::move(moments_);
  page.analysis = analysis_->clip();
  page.facts = FactsOf(*page.analysis, info_, output_);
  page.command = page.analysis->options;
  if (!encode_command.empty()) {
    page.command += (page.command.empty() ? "" : " ") + encode_command;
  }
  page.stages = stages;
  return MakeClipPage(page);
}

}  // namespace rsstab::cli
