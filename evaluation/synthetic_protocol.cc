// SPDX-License-Identifier: Apache-2.0
#include "evaluation/synthetic_protocol.h"

#include <array>
#include <chrono>
#include <cstddef>
#include <utility>

#include "evaluation/correction_score.h"
#include "evaluation/photo.h"
#include "evaluation/synthetic_sample.h"
#include "igf/base/parallel_for.h"
#include "stabilizer/metrics/field_metrics.h"

namespace rsstab::evaluation {
namespace {

constexpr std::array<MotionClass, 5> kClasses = {MotionClass::kSkewTwist, MotionClass::kStretch,
                                                 MotionClass::kOscillation, MotionClass::kMixed,
                                                 MotionClass::kStill};

MethodInput InputOf(const SyntheticSample& sample) {
  MethodInput input;
  input.rs = sample.rs.View();
  input.seed = sample.seed;
  input.camera = &sample.camera;
  input.motion = &sample.curve;
  return input;
}

Result<MethodScore> ScoreMethod(const SyntheticSample& sample, MotionMethod& method,
                                WorkerPool& workers) {
  MethodScore score;
  score.method = method.Name();
  const auto begin = std::chrono::steady_clock::now();
  const auto answer = EstimateOrDecline(method, InputOf(sample), score.declined);
  score.ms =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
  if (!answer) {
    return Propagate(answer.error(), score.method);
  }
  auto corrected = CorrectPicture(sample.rs.View(), answer->field, workers);
  if (!corrected) {
    return Propagate(corrected.error(), score.method);
  }
  const auto error = stabilizer::CompareFields(PixelDisplacements(answer->field),
                                               sample.displacement, sample.valid);
  if (!error) {
    return Propagate(error.error(), score.method);
  }
  score.epe_px = error->length;
  score.horizontal_px = error->horizontal;
  score.vertical_px = error->vertical;
  for (std::size_t i = 0; i < sample.valid.size(); ++i) {
    corrected->valid[i] = corrected->valid[i] != 0 && sample.valid[i] != 0 ? 1 : 0;
  }
  const auto picture = ScorePicture(corrected->picture.View(), sample.gs.View(), corrected->valid);
  if (!picture) {
    return Propagate(picture.error(), score.method);
  }
  score.psnr_db = picture->psnr_db;
  score.ssim = picture->ssim;
  score.valid_share = picture->valid_share;
  return score;
}

Result<std::optional<AxisCoverage>> ScoreSpread(const SyntheticSample& sample,
                                                MotionMethod* sampler) {
  if (sampler == nullptr) {
    return std::nullopt;
  }
  const auto answer = sampler->Estimate(InputOf(sample));
  if (!answer) {
    return Propagate(answer.error(), sampler->Name());
  }
  const int bands = answer->curves.empty() ? 0 : static_cast<int>(answer->curves.front().size());
  if (bands <= kMiddleBands) {
    return std::nullopt;  // a model of dense fields, or of no more than the middle
  }
  const auto coverage = CountCoverage(BandsOfCurve(sample.curve, bands), answer->curves);
  if (!coverage) {
    return Propagate(coverage.error(), sampler->Name());
  }
  return *coverage;
}

Result<SampleRecord> ScoreSample(const SyntheticSample& sample, MethodSet& methods,
                                 WorkerPool& workers) {
  SampleRecord record;
  record.motion_class = sample.motion_class;
  record.focal_widths = sample.camera.fx / sample.camera.width;
  record.top_to_bottom = sample.curve.top_to_bottom;
  record.photo_per_pixel = sample.photo_per_pixel;
  for (const auto& method : methods.methods) {
    auto score = ScoreMethod(sample, *method, workers);
    if (!score) {
      return Propagate(score.error());
    }
    record.methods.push_back(std::move(*score));
  }
  auto coverage = ScoreSpread(sample, methods.sampler.get());
  if (!coverage) {
    return Propagate(coverage.error());
  }
  record.coverage = *coverage;
  return record;
}

Result<SyntheticSample> MakeSample(const FrameView& photo, const std::filesystem::path& path,
                                   MotionClass motion_class, std::uint64_t seed) {
  auto sample = MakeSyntheticSample(photo, motion_class,
                                    SampleSeed(seed, path.filename().string(), motion_class));
  return sample ? std::move(sample) : Propagate(sample.error(), path.string());
}

// Everything that one photograph gives.
struct PhotoResult {
  std::vector<SampleRecord> samples;
  std::vector<SkewAnswer> skews;
  std::optional<Error> error;
};

Status JudgePhoto(const std::filesystem::path& path, bool with_skew,
                  const SyntheticOptions& options, MethodSet& methods, PhotoResult& result) {
  const auto photo = LoadPhoto(path);
  if (!photo) {
    return Propagate(photo.error());
  }
  WorkerPool workers(1);  // the photographs are what runs in parallel
  const std::string name = path.filename().string();
  for (const MotionClass motion_class : kClasses) {
    const auto sample = MakeSample(photo->View(), path, motion_class, options.seed);
    if (!sample) {
      return Propagate(sample.error());
    }
    auto record = ScoreSample(*sample, methods, workers);
    if (!record) {
      return Propagate(record.error(), path.string());
    }
    record->photo = name;
    record->structured = options.structured.contains(name);
    result.samples.push_back(std::move(*record));
  }
  if (with_skew && methods.skew) {
    auto skews = AskForSkew(photo->View(), *methods.skew,
                            SampleSeed(~options.seed, name, MotionClass::kSkewTwist), workers);
    if (!skews) {
      return Propagate(skews.error(), path.string());
    }
    result.skews = std::move(*skews);
  }
  return {};
}

}  // namespace

Result<SyntheticRecords> RunSyntheticProtocol(std::span<const std::filesystem::path> photos,
                                              const SyntheticOptions& options,
                                              const MethodFactory& factory,
                                              const EvaluationProgress& progress) {
  std::vector<PhotoResult> results(photos.size());
  const auto result_of = [&results](int index) -> PhotoResult& {
    return results[static_cast<std::size_t>(index)];
  };
  const Status status = ForEachItem(
      static_cast<int>(photos.size()), options.jobs, factory,
      [&](int index, MethodSet& methods) {
        return JudgePhoto(photos[static_cast<std::size_t>(index)], index < options.linearity_photos,
                          options, methods, result_of(index));
      },
      [&](int index, const Error& error) { result_of(index).error = error; }, progress);
  if (!status) {
    return Propagate(status.error());
  }
  SyntheticRecords records;
  for (std::size_t i = 0; i < results.size(); ++i) {
    PhotoResult& result = results[i];
    if (result.error) {
      records.failures.emplace_back(photos[i].filename().string(), *result.error);
      continue;
    }
    for (SampleRecord& sample : result.samples) {
      sample.photo_index = i;
      records.samples.push_back(std::move(sample));
    }
    if (!result.skews.empty()) {
      records.skews.push_back(std::move(result.skews));
    }
  }
  if (records.samples.empty()) {
    return records.failures.empty()
               ? Fail(ErrorCode::kInvalidArgument, "there is no photo to evaluate on")
               : Fail(records.failures.front().second.code, "no photo could be used; the first: {}",
                      records.failures.front().second.message);
  }
  return records;
}

Result<PictureInspection> InspectSyntheticSample(const std::filesystem::path& photo,
                                                 MotionClass motion_class, std::uint64_t seed,
                                                 MethodSet& methods) {
  const auto picture = LoadPhoto(photo);
  if (!picture) {
    return Propagate(picture.error());
  }
  auto sample = MakeSample(picture->View(), photo, motion_class, seed);
  if (!sample) {
    return Propagate(sample.error());
  }
  PictureInspection inspection;
  for (const auto& method : methods.methods) {
    bool declined = false;
    auto answer = EstimateOrDecline(*method, InputOf(*sample), declined);
    if (!answer) {
      return Propagate(answer.error(), method->Name());
    }
    inspection.answers.push_back({method->Name(), std::move(answer->field)});
  }
  LabelledPicture& labelled = inspection.picture;
  labelled.reference_row = sample->truth.reference_row();
  labelled.rs = std::move(sample->rs);
  labelled.gs = std::move(sample->gs);
  labelled.truth = std::move(sample->displacement);
  labelled.valid = std::move(sample->valid);
  labelled.camera = sample->camera;
  labelled.source = photo.filename().string();
  return inspection;
}

}  // namespace rsstab::evaluation
