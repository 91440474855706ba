// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/correct.h"

#include <chrono>
#include <cmath>
#include <filesystem>
#include <ostream>
#include <string>
#include <system_error>
#include <utility>

#include "cli/commands/correct_plan.h"
#include "cli/images/picture_file.h"
#include "igf/base/parallel_for.h"
#include "igf/base/whole_file.h"
#include "rsdiff/model_path.h"
#include "stabilizer/pipeline/image_corrector.h"

namespace rsstab::cli {
namespace {

namespace fs = std::filesystem;

Result<pipeline::ImageCorrector> LoadCorrector(const CorrectOptions& options,
                                               const Logger& logger) {
  const auto model_file = rsdiff::FindModel(options.model);
  if (!model_file) {
    return Propagate(model_file.error());
  }
  auto estimator = rsdiff::SingleImageEstimator::Load(
      *model_file, {.device = options.device, .num_threads = options.threads});
  if (!estimator) {
    return Propagate(std::move(estimator.error()));
  }
  logger->debug("correct: model {} ({})", estimator->model().name, model_file->string());
  pipeline::ImageCorrectionOptions correction;
  correction.sampling.samples = options.samples;
  correction.sampling.steps = options.steps;
  correction.sampling.guidance = options.guidance.value_or(correction.sampling.guidance);
  correction.sampling.eta = options.eta.value_or(correction.sampling.eta);
  correction.sampling.seed = options.seed;
  correction.strength = options.strength;
  correction.full_frame = options.full_frame;
  correction.interpolation = options.interpolation;
  correction.num_threads = options.threads;
  return pipeline::ImageCorrector::Create(std::move(*estimator), correction);
}

Status WriteBytes(const std::string& path, const images::Bytes& bytes) {
  return WriteWholeFile(path, [&bytes](std::ostream& out) {
    out.write(reinterpret_cast<const char*>(bytes.data()),
              static_cast<std::streamsize>(bytes.size()));
  });
}

// The user's word goes before the camera's.
std::optional<double> FocalLength(const CorrectOptions& options, const images::Picture& picture) {
  if (options.focal_px || !picture.facts.focal_per_diagonal) {
    return options.focal_px;
  }
  return *picture.facts.focal_per_diagonal *
         std::hypot(picture.pixels.width, picture.pixels.height);
}

// Corrects one picture after the other.
class Darkroom {
 public:
  Darkroom(const CorrectOptions& options, pipeline::ImageCorrector corrector, const Logger& logger)
      : options_(options),
        corrector_(std::move(corrector)),
        logger_(logger),
        workers_(ResolveThreadCount(options.threads)) {}

  Status Develop(const CorrectionJob& job) {
    const auto picture = images::ReadPicture(job.input);
    if (!picture) {
      return Propagate(picture.error());
    }
    if (picture->pages > 1) {
      logger_->warn("{}: of its {} pictures only the first is corrected", job.input,
                    picture->pages);
    }
    const FrameView view = picture->pixels.View();
    const auto motion = corrector_.Estimate(view, FocalLength(options_, *picture));
    if (!motion) {
      return Propagate(motion.error(), job.input);
    }
    std::string kept;
    if (!job.output.empty()) {
      const auto corrected = corrector_.Correct(view, motion->field);
      if (!corrected) {
        return Propagate(corrected.error(), job.input);
      }
      if (Status written = Write(job, *picture, corrected->picture); !written) {
        return written;
      }
      if (!options_.full_frame) {
        kept = fmt::format(", {:.1f} % of each side kept", 100.0 * corrected->kept_ratio);
      }
    }
    if (job.field) {
      if (Status written = images::WriteFieldFiles(*job.field, motion->field,
                                                   motion->vertex_spread_px, workers_);
          !written) {
        return written;
      }
    }
    const std::string& shown = job.output.empty() ? job.field->flo : job.output;
    logger_->info("{} -> {}: moved by up to {:.1f} px{}{}", job.input, shown,
                  motion->field.MaxLength(), Spread(motion->spread_px), kept);
    return {};
  }

 private:
  static std::string Spread(double spread_px) {
    return std::isfinite(spread_px) ? fmt::format(" (spread {:.1f} px)", spread_px) : "";
  }

  Status Write(const CorrectionJob& job, const images::Picture& original, const Frame& corrected) {
    const auto encoded =
        images::EncodePicture(job.output, corrected.View(), options_.quality, &original.file);
    if (!encoded) {
      return Propagate(encoded.error(), job.input);
    }
    for (const std::string& loss : encoded->losses) {
      logger_->warn("{}: {}", job.output, loss);
    }
    return WriteBytes(job.output, encoded->bytes);
  }

  const CorrectOptions& options_;
  pipeline::ImageCorrector corrector_;
  Logger logger_;
  WorkerPool workers_;  // for the fields
};

// Folders that were made for this run, and go again when nothing was put into them.
class NewFolders {
 public:
  Status Make(const std::vector<std::string>& folders) {
    for (const std::string& folder : folders) {
      std::error_code error;
      if (fs::create_directories(folder, error)) {
        made_.push_back(folder);
      }
      if (error) {
        return Fail(ErrorCode::kIo, "{}: the folder cannot be made: {}", folder, error.message());
      }
    }
    return {};
  }
  NewFolders() = default;
  NewFolders(const NewFolders&) = delete;
  NewFolders& operator=(const NewFolders&) = delete;
  ~NewFolders() {
    for (const std::string& folder : made_) {
      std::error_code ignored;
      fs::remove(folder, ignored);  // only if it is empty
    }
  }

 private:
  std::vector<std::string> made_;
};

}  // namespace

Status RunCorrect(const CorrectOptions& options, const Logger& logger,
                  const CorrectProgress& progress) {
  auto plan = PlanCorrections(options, images::ListImages(options.images));
  if (!plan) {
    return Propagate(plan.error());
  }
  const std::size_t pictures = plan->jobs.size() + plan->problems.size();
  if (pictures == 1 && plan->jobs.empty()) {
    return Propagate(plan->problems.front());
  }
  auto corrector = LoadCorrector(options, logger);
  if (!corrector) {
    return Propagate(corrector.error());
  }
  NewFolders folders;
  if (Status made = folders.Make(plan->folders); !made) {
    return made;
  }
  for (const Error& problem : plan->problems) {
    logger->error("{}", problem.message);
  }
  std::size_t failed = plan->problems.size();
  std::size_t done = failed;
  const auto start = std::chrono::steady_clock::now();
  Darkroom darkroom(options, std::move(*corrector), logger);
  const auto tell = [&] {
    return !progress ||
           progress(static_cast<std::int64_t>(done), static_cast<std::int64_t>(pictures));
  };
  bool goes_on = tell();
  for (auto job = plan->jobs.begin(); goes_on && job != plan->jobs.end(); ++job) {
    if (Status status = darkroom.Develop(*job); !status) {
      if (pictures == 1) {
        return status;
      }
      logger->error("{}", status.error().message);
      ++failed;
    }
    ++done;
    goes_on = tell();
  }
  if (!goes_on && done < pictures) {
    return Fail(ErrorCode::kCancelled, "stopped as asked for; {} of {} pictures are done",
                done - failed, pictures);
  }
  if (failed > 0) {
    return Fail(ErrorCode::kIo, "{} of {} pictures could not be corrected", failed, pictures);
  }
  if (pictures > 1) {
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
    logger->info("{} pictures corrected, {:.2f} s each", pictures,
                 elapsed.count() / static_cast<double>(pictures));
  }
  return {};
}

}  // namespace rsstab::cli
