// SPDX-License-Identifier: Apache-2.0
#include "evaluation/image_pairs.h"

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <optional>
#include <system_error>
#include <utility>

#include "evaluation/correction_score.h"
#include "evaluation/photo.h"
#include "evaluation/synthetic_sample.h"
#include "igf/base/parallel_for.h"

namespace rsstab::evaluation {
namespace {

constexpr const char* kRsName = "rs_1.png";
constexpr const char* kGsName = "gs_1.png";

Result<PairScore> ScoreMethod(const Frame& rs, const Frame& gs, std::uint64_t seed,
                              MotionMethod& method, WorkerPool& workers) {
  PairScore score;
  score.method = method.Name();
  MethodInput input;
  input.rs = rs.View();
  input.seed = seed;
  const auto begin = std::chrono::steady_clock::now();
  const auto answer = method.Estimate(input);
  score.ms =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
  if (!answer) {
    return Propagate(answer.error(), score.method);
  }
  const auto corrected = CorrectPicture(rs.View(), answer->field, workers);
  if (!corrected) {
    return Propagate(corrected.error(), score.method);
  }
  const auto after = ScorePicture(corrected->picture.View(), gs.View(), corrected->valid);
  const auto before = ScorePicture(rs.View(), gs.View(), corrected->valid);
  if (!after || !before) {
    return Propagate(after ? before.error() : after.error(), score.method);
  }
  score.psnr_db = after->psnr_db;
  score.ssim = after->ssim;
  score.untouched_psnr_db = before->psnr_db;
  score.untouched_ssim = before->ssim;
  score.valid_share = after->valid_share;
  double length = 0.0;
  const auto displacement = PixelDisplacements(answer->field);
  for (const Eigen::Vector2f& d : displacement) {
    length += static_cast<double>(d.norm());
  }
  score.moved_px = length / static_cast<double>(displacement.size());
  return score;
}

Status JudgePair(const ImagePair& pair, std::uint64_t seed, MethodSet& methods,
                 PairRecord& record) {
  const auto rs = LoadPhoto(pair.rs);
  if (!rs) {
    return Propagate(rs.error());
  }
  const auto gs = LoadPhoto(pair.gs);
  if (!gs) {
    return Propagate(gs.error());
  }
  if (rs->width != gs->width || rs->height != gs->height) {
    return Fail(ErrorCode::kCorruptData, "{}: {} is {}x{}, {} is {}x{}; a pair must be of one size",
                pair.name, kRsName, rs->width, rs->height, kGsName, gs->width, gs->height);
  }
  record.name = pair.name;
  record.width = rs->width;
  record.height = rs->height;
  WorkerPool workers(1);
  for (const auto& method : methods.methods) {
    auto score = ScoreMethod(*rs, *gs, seed, *method, workers);
    if (!score) {
      return Propagate(score.error(), pair.name);
    }
    record.methods.push_back(std::move(*score));
  }
  return {};
}

}  // namespace

Result<std::vector<ImagePair>> FindImagePairs(const std::filesystem::path& root) {
  std::error_code error;
  std::vector<ImagePair> pairs;
  const auto add = [&](const std::filesystem::path& folder) {
    std::error_code ignored;
    if (std::filesystem::is_regular_file(folder / kRsName, ignored) &&
        std::filesystem::is_regular_file(folder / kGsName, ignored)) {
      pairs.push_back(
          {folder.lexically_relative(root).generic_string(), folder / kRsName, folder / kGsName});
    }
  };
  add(root);
  std::filesystem::recursive_directory_iterator entry(root, error);
  for (; !error && entry != std::filesystem::recursive_directory_iterator();
       entry.increment(error)) {
    if (entry->is_directory(error)) {
      add(entry->path());
    }
  }
  if (error) {
    return Fail(ErrorCode::kNotFound, "{}: the folder cannot be read: {}.", root.string(),
                error.message());
  }
  if (pairs.empty()) {
    return Fail(ErrorCode::kNotFound, "{}: no folder in it holds both {} and {}.", root.string(),
                kRsName, kGsName);
  }
  std::sort(pairs.begin(), pairs.end(),
            [](const ImagePair& a, const ImagePair& b) { return a.name < b.name; });
  return pairs;
}

Result<PairRecords> RunImagePairs(std::span<const ImagePair> pairs, const PairOptions& options,
                                  const MethodFactory& factory,
                                  const EvaluationProgress& progress) {
  std::vector<PairRecord> records(pairs.size());
  std::vector<std::optional<Error>> errors(pairs.size());
  const Status status = ForEachItem(
      static_cast<int>(pairs.size()), options.jobs, factory,
      [&](int index, MethodSet& methods) {
        const auto i = static_cast<std::size_t>(index);
        return JudgePair(pairs[i], options.seed, methods, records[i]);
      },
      [&](int index, const Error& error) { errors[static_cast<std::size_t>(index)] = error; },
      progress);
  if (!status) {
    return Propagate(status.error());
  }
  PairRecords result;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (errors[i]) {
      result.failures.emplace_back(pairs[i].name, *errors[i]);
    } else {
      result.pairs.push_back(std::move(records[i]));
    }
  }
  if (result.pairs.empty() && !result.failures.empty()) {
    return Propagate(result.failures.front().second);
  }
  return result;
}

}  // namespace rsstab::evaluation
