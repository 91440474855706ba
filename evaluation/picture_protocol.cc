// SPDX-License-Identifier: Apache-2.0
#include "evaluation/picture_protocol.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <mutex>
#include <optional>

#include "evaluation/correction_score.h"
#include "evaluation/field_reference.h"
#include "evaluation/synthetic_sample.h"
#include "igf/base/parallel_for.h"
#include "igf/base/seeded_random.h"
#include "stabilizer/metrics/field_metrics.h"

namespace rsstab::evaluation {
namespace {

using Displacements = std::vector<Eigen::Vector2f>;

// The error of a method's field on the frame before, where that had a truth.
struct ErrorField {
  Displacements error;
  std::vector<std::uint8_t> valid;
};

bool Counts(const std::vector<std::uint8_t>& mask, std::size_t pixel) {
  return mask.empty() || mask[pixel] != 0;
}

// The pixel of the recorded frame that is nearest to a position inside it.
bool LandsOnPicture(const LabelledPicture& picture, const Eigen::Vector2d& source) {
  if (picture.rs_valid.empty()) {
    return true;
  }
  const int x = std::clamp(static_cast<int>(std::lround(source.x())), 0, picture.rs.width - 1);
  const int y = std::clamp(static_cast<int>(std::lround(source.y())), 0, picture.rs.height - 1);
  return picture.rs_valid[static_cast<std::size_t>(y) * static_cast<std::size_t>(picture.rs.width) +
                          static_cast<std::size_t>(x)] != 0;
}

double MeanLength(const Displacements& field) {
  double length = 0.0;
  for (const Eigen::Vector2f& d : field) {
    length += static_cast<double>(d.norm());
  }
  return length / static_cast<double>(field.size());
}

// How the error changed since the frame before.
double MeanChange(const ErrorField& now, const ErrorField& before) {
  double sum = 0.0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < now.error.size(); ++i) {
    if (Counts(now.valid, i) && Counts(before.valid, i)) {
      sum += static_cast<double>((now.error[i] - before.error[i]).norm());
      ++count;
    }
  }
  return count > 0 ? sum / static_cast<double>(count) : kUnknown;
}

// The method's field, told from the picture's reference row. Fields of methods that know nothing of
// that row are turned as the camera says, or a usual one.
Result<MotionField> AskMethod(const LabelledPicture& picture, const MethodInput& input,
                              MotionMethod& method, MethodFigures& figures) {
  const auto begin = std::chrono::steady_clock::now();
  auto answer = EstimateOrDecline(method, input, figures.declined);
  figures.ms =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
  if (!answer) {
    return Propagate(answer.error(), figures.method);
  }
  const Camera camera = picture.camera.value_or(
      Camera::Pinhole(picture.rs.width, picture.rs.height, picture.rs.width));
  return WithReferenceRow(answer->field, camera, picture.reference_row);
}

Status ScoreField(const LabelledPicture& picture, const MotionField& field, WorkerPool& workers,
                  MethodFigures& figures) {
  auto corrected = CorrectPicture(picture.rs.View(), field, workers);
  if (!corrected) {
    return Propagate(corrected.error());
  }
  std::size_t i = 0;
  for (int y = 0; y < picture.rs.height; ++y) {
    for (int x = 0; x < picture.rs.width; ++x, ++i) {
      const Eigen::Vector2d pixel(x, y);
      if (!Counts(picture.valid, i) ||
          (corrected->valid[i] != 0 && !LandsOnPicture(picture, pixel + field.Sample(pixel)))) {
        corrected->valid[i] = 0;
      }
    }
  }
  const auto after = ScorePicture(corrected->picture.View(), picture.gs.View(), corrected->valid);
  if (!after) {
    return Propagate(after.error());
  }
  figures.psnr_db = after->psnr_db;
  figures.ssim = after->ssim;
  figures.valid_share = after->valid_share;
  if (figures.moved_px == 0.0) {
    figures.untouched_psnr_db = after->psnr_db;
    figures.untouched_ssim = after->ssim;
    return {};
  }
  const auto before = ScorePicture(picture.rs.View(), picture.gs.View(), corrected->valid);
  if (!before) {
    return Propagate(before.error());
  }
  figures.untouched_psnr_db = before->psnr_db;
  figures.untouched_ssim = before->ssim;
  return {};
}

// `last`: the method's error on the frame before; replaced by that on this one.
Result<MethodFigures> ScoreMethod(const LabelledPicture& picture, const MethodInput& input,
                                  MotionMethod& method, std::optional<ErrorField>& last,
                                  WorkerPool& workers) {
  MethodFigures figures;
  figures.method = method.Name();
  const auto before = std::move(last);
  last.reset();
  const auto field = AskMethod(picture, input, method, figures);
  if (!field && field.error().code == ErrorCode::kUnsupported) {
    MethodFigures nothing;
    nothing.method = figures.method;
    return nothing;
  }
  if (!field) {
    return Propagate(field.error());
  }
  Displacements estimate = PixelDisplacements(*field);
  figures.moved_px = MeanLength(estimate);
  if (Status status = ScoreField(picture, *field, workers, figures); !status) {
    return Propagate(status.error(), figures.method);
  }
  if (picture.truth.empty()) {
    return figures;
  }
  const auto error = stabilizer::CompareFields(estimate, picture.truth, picture.valid);
  if (!error) {
    return Propagate(error.error(), figures.method);
  }
  figures.epe_px = error->length;
  figures.horizontal_px = error->horizontal;
  figures.vertical_px = error->vertical;
  std::transform(estimate.begin(), estimate.end(), picture.truth.begin(), estimate.begin(),
                 [](const Eigen::Vector2f& e, const Eigen::Vector2f& t) { return e - t; });
  last = ErrorField{std::move(estimate), picture.valid};
  if (before && before->error.size() == last->error.size()) {
    figures.flicker_px = MeanChange(*last, *before);
  }
  return figures;
}

// A clip's pictures, each read once, with a window of one before and one after.
class ClipWindow {
 public:
  // `first`: the index that Advance is called with first.
  ClipWindow(const PictureSet& set, const PictureClip& clip, std::size_t first = 0)
      : set_(set), clip_(clip) {
    after_ = Load(first);
  }

  // Moves on to the picture of `index`, which counts up.
  void Advance(std::size_t index) {
    before_ = std::move(now_);
    now_ = std::move(after_);
    after_ = index + 1 < clip_.pictures.size() ? Load(index + 1) : std::nullopt;
  }
  [[nodiscard]] const Result<LabelledPicture>& Now() const { return *now_; }
  // Empty at the ends of the clip, for a picture that could not be read, or for one of another
  // size.
  [[nodiscard]] std::optional<FrameView> Before() const {
    const auto neighbour = Neighbour(before_);
    return neighbour || !(*now_)->previous ? neighbour : (*now_)->previous->View();
  }
  [[nodiscard]] std::optional<FrameView> After() const { return Neighbour(after_); }

 private:
  using Slot = std::optional<Result<LabelledPicture>>;

  [[nodiscard]] Slot Load(std::size_t index) const { return set_.Load(clip_.pictures[index]); }
  [[nodiscard]] std::optional<FrameView> Neighbour(const Slot& slot) const {
    if (!slot || !slot->has_value() || (*slot)->rs.width != (*now_)->rs.width ||
        (*slot)->rs.height != (*now_)->rs.height) {
      return std::nullopt;
    }
    return (*slot)->rs.View();
  }

  const PictureSet& set_;
  const PictureClip& clip_;
  Slot before_;
  Slot now_;
  Slot after_;
};

// What a method is given of the picture in the middle of a window, which must be there.
class WindowInput {
 public:
  WindowInput(const ClipWindow& window, const std::string& name, std::uint64_t seed)
      : previous_(window.Before()), next_(window.After()) {
    const LabelledPicture& picture = *window.Now();
    input_.rs = picture.rs.View();
    input_.seed = MixBits(seed ^ HashOfName(name));
    input_.camera = picture.camera ? &*picture.camera : nullptr;
    input_.gyro = picture.gyro ? &*picture.gyro : nullptr;
    input_.previous = previous_ ? &*previous_ : nullptr;
    input_.next = next_ ? &*next_ : nullptr;
    input_.frame_interval_s = picture.frame_interval_s;
    input_.reference_row = picture.reference_row;
  }
  WindowInput(const WindowInput&) = delete;
  WindowInput& operator=(const WindowInput&) = delete;

  [[nodiscard]] const MethodInput& Get() const { return input_; }

 private:
  std::optional<FrameView> previous_;
  std::optional<FrameView> next_;
  MethodInput input_;
};

Result<PictureRecord> JudgePicture(const ClipWindow& window, const std::string& name,
                                   std::uint64_t seed, MethodSet& methods,
                                   std::vector<std::optional<ErrorField>>& last,
                                   WorkerPool& workers) {
  if (!window.Now()) {
    return Propagate(window.Now().error());
  }
  const LabelledPicture& picture = *window.Now();
  const WindowInput input(window, name, seed);
  PictureRecord record;
  record.name = name;
  record.split = picture.split;
  record.strength = picture.strength;
  record.source = picture.source;
  record.width = picture.rs.width;
  record.height = picture.rs.height;
  for (std::size_t m = 0; m < methods.methods.size(); ++m) {
    auto figures = ScoreMethod(picture, input.Get(), *methods.methods[m], last[m], workers);
    if (!figures) {
      return Propagate(figures.error(), name);
    }
    record.methods.push_back(std::move(*figures));
  }
  return record;
}

ClipResult JudgeClip(const PictureSet& set, const PictureClip& clip, std::uint64_t seed,
                     MethodSet& methods) {
  ClipResult result;
  WorkerPool workers(1);  // the clips are what runs in parallel
  std::vector<std::optional<ErrorField>> last(methods.methods.size());
  ClipWindow window(set, clip);
  for (std::size_t i = 0; i < clip.pictures.size(); ++i) {
    window.Advance(i);
    auto record = JudgePicture(window, clip.pictures[i], seed, methods, last, workers);
    if (record) {
      record->clip = clip.name;
      result.records.push_back(std::move(*record));
    } else {
      result.failures.push_back({clip.pictures[i], record.error()});
      last.assign(last.size(), std::nullopt);
    }
  }
  return result;
}

}  // namespace

Status RunPictureProtocol(const PictureSet& set, const PictureOptions& options,
                          const MethodFactory& factory,
                          const std::function<Status(ClipResult result)>& done,
                          const EvaluationProgress& progress) {
  std::vector<const PictureClip*> clips;
  for (const PictureClip& clip : set.Clips()) {
    if (!options.skip.contains(clip.name) && !clip.pictures.empty()) {
      clips.push_back(&clip);
    }
  }
  std::mutex mutex;  // guards `stopped_by`, and calls to `done`
  std::optional<Error> stopped_by;
  const auto deliver = [&](ClipResult result) {
    const std::scoped_lock lock(mutex);
    if (!stopped_by) {
      if (Status told = done(std::move(result)); !told) {
        stopped_by = told.error();
      }
    }
  };
  const Status status = ForEachItem(
      static_cast<int>(clips.size()), options.jobs, factory,
      [&](int index, MethodSet& methods) -> Status {
        deliver(JudgeClip(set, *clips[static_cast<std::size_t>(index)], options.seed, methods));
        return {};
      },
      [&](int index, const Error& error) {
        // What a library threw: the whole clip is left out.
        ClipResult result;
        for (const std::string& picture : clips[static_cast<std::size_t>(index)]->pictures) {
          result.failures.push_back({picture, error});
        }
        deliver(std::move(result));
      },
      [&](std::int64_t items, std::int64_t total) {
        const bool go_on = !progress || progress(items, total);
        const std::scoped_lock lock(mutex);
        return go_on && !stopped_by;
      });
  return stopped_by ? Propagate(*stopped_by) : status;
}

Result<PictureInspection> InspectPicture(const PictureSet& set, const std::string& clip,
                                         const std::string& picture, std::uint64_t seed,
                                         MethodSet& methods) {
  for (const PictureClip& candidate : set.Clips()) {
    const auto& names = candidate.pictures;
    const auto found = std::find(names.begin(), names.end(), picture);
    if (candidate.name != clip || found == names.end()) {
      continue;
    }
    const auto index = static_cast<std::size_t>(found - names.begin());
    ClipWindow window(set, candidate, index == 0 ? 0 : index - 1);
    for (std::size_t i = index == 0 ? 0 : index - 1; i <= index; ++i) {
      window.Advance(i);
    }
    if (!window.Now()) {
      return Propagate(window.Now().error());
    }
    PictureInspection inspection;
    const WindowInput input(window, picture, seed);
    for (const auto& method : methods.methods) {
      MethodFigures figures;
      figures.method = method->Name();
      auto field = AskMethod(*window.Now(), input.Get(), *method, figures);
      if (field) {
        inspection.answers.push_back({figures.method, std::move(*field)});
      } else if (field.error().code != ErrorCode::kUnsupported) {
        return Propagate(field.error(), picture);
      }
    }
    inspection.picture = *window.Now();
    return inspection;
  }
  return Fail(ErrorCode::kNotFound, "{}: the data set has no such picture", picture);
}

}  // namespace rsstab::evaluation
