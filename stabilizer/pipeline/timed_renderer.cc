// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/pipeline/timed_renderer.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "stabilizer/luma_proxy.h"
#include "stabilizer/pipeline/frame_lookup.h"
#include "stabilizer/pipeline/frame_renderer.h"

namespace rsstab::pipeline {
namespace {

// Looking at a picture costs a millisecond, so only some are compared with pass 1.
constexpr int kFingerprintEvery = 30;
// Frames that fit in a row before a file is trusted to be this clip's.
constexpr int kFramesUntilTrusted = 5;
// The same frame decoded again differs by less than one level, re-encoded by two; another colour
// model weighs colours differently.
constexpr double kMaxDistance = 4.0;
constexpr double kMaxDistanceRgb = 10.0;
// What is looked for in the whole clip must fit better than what is expected.
constexpr double kSearchShare = 0.5;
// The same frame differs by 0.3 to 0.5 levels, its neighbour in a shaky clip by 2. Once a file is
// trusted, nothing else is looked for below this.
constexpr double kSurelyAlike = 0.7;
// Frames by which a changed frame rate moves one at most.
constexpr double kRetimedShare = 0.75;
constexpr double kMaxShapeDifference = 0.01;

}  // namespace

struct TimedRenderer::Impl {
  Impl(std::unique_ptr<stabilizer::AnalysisReader> analysis,
       std::vector<stabilizer::RecordKey> keys, const StabilizeOptions& options, int width,
       int height, Logger log)
      : reader(std::move(analysis)),
        lookup(std::move(keys), reader->clip()),
        renderer(
            {width, height, reader->clip().width, reader->clip().height, reader->clip().camera},
            options),
        logger(std::move(log)) {}

  std::unique_ptr<stabilizer::AnalysisReader> reader;
  FrameLookup lookup;
  FrameRenderer renderer;
  Logger logger;
  double shift_s = 0.0;  // analysed clip's time - host's time
  int fitting = 0;       // compared frames that fitted in a row
  int unseen = 0;        // frames since the last comparison

  [[nodiscard]] double DistanceTo(std::size_t record,
                                  const stabilizer::LumaFingerprint& fingerprint) const {
    return PictureDistance(fingerprint, lookup.keys()[record].fingerprint);
  }

  // Of a record and its neighbours, the one that looks most like the picture: hosts that change the
  // frame rate show a frame up to one interval before or after its time.
  [[nodiscard]] std::size_t MostAlikeNear(std::size_t record,
                                          const stabilizer::LumaFingerprint& fingerprint) const {
    std::size_t best = record;
    for (const std::size_t neighbour : {record - 1, record + 1}) {  // wraps round below 0
      if (neighbour < lookup.keys().size() &&
          DistanceTo(neighbour, fingerprint) < DistanceTo(best, fingerprint)) {
        best = neighbour;
      }
    }
    return best;
  }

  // The record of a frame, by its time; compared with the picture when there is reason to.
  Result<std::size_t> Find(const FrameView& picture, double time_s) {
    auto at_time = lookup.AtTime(time_s + shift_s);
    if (at_time && at_time->is_exact && fitting >= kFramesUntilTrusted &&
        unseen < kFingerprintEvery) {
      ++unseen;
      return at_time->record;
    }
    unseen = 0;
    const auto proxy = stabilizer::MakeLumaProxy(picture);
    if (!proxy) {
      return Propagate(proxy.error());
    }
    const auto fingerprint = stabilizer::FingerprintOf(*proxy);
    const double limit = picture.layout.is_rgb ? kMaxDistanceRgb : kMaxDistance;
    if (at_time && !at_time->is_exact) {
      at_time->record = MostAlikeNear(at_time->record, fingerprint);
    }
    const double expected = at_time ? DistanceTo(at_time->record, fingerprint)
                                    : std::numeric_limits<double>::infinity();
    // A clip that was cut at its start has records at these times, too: those of other frames.
    const auto alike = fitting >= kFramesUntilTrusted && expected <= kSurelyAlike
                           ? std::nullopt
                           : lookup.ByPicture(fingerprint, kSearchShare * std::min(limit, expected),
                                              time_s + shift_s);
    if (!alike && expected <= limit) {
      ++fitting;
      return at_time->record;
    }
    fitting = 0;
    if (!alike) {
      if (!at_time) {
        return Fail(ErrorCode::kNotFound,
                    "the analysis file knows no frame at {:.3f} s: analyse this clip", time_s);
      }
      return Fail(ErrorCode::kNotFound,
                  "the frame at {:.3f} s does not look like the one that was analysed: analyse "
                  "this clip",
                  time_s);
    }
    const double found_shift_s = lookup.TimeOf(*alike) - time_s;
    // A frame shown a little before or after its time (another frame rate) shifts no others.
    if (std::abs(found_shift_s - shift_s) > kRetimedShare * lookup.frame_s()) {
      shift_s = found_shift_s;
      logger->info("the frame at {:.3f} s is the one at {:.3f} s of the analysed clip", time_s,
                   lookup.TimeOf(*alike));
    }
    return *alike;
  }
};

TimedRenderer::TimedRenderer(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
TimedRenderer::~TimedRenderer() = default;

Result<std::unique_ptr<TimedRenderer>> TimedRenderer::Create(const StabilizeOptions& options,
                                                             const std::string& analysis_path,
                                                             int width, int height, Logger logger) {
  auto reader = stabilizer::AnalysisReader::Open(analysis_path);
  if (!reader) {
    return Propagate(std::move(reader.error()));
  }
  const stabilizer::ClipAnalysis& clip = (*reader)->clip();
  const double shape =
      static_cast<double>(width) * clip.height / (static_cast<double>(height) * clip.width);
  if (!(std::abs(shape - 1.0) <= kMaxShapeDifference)) {
    return Fail(ErrorCode::kInvalidArgument,
                "{} was made for a clip of {}x{}, this one is {}x{}: analyse this clip",
                analysis_path, clip.width, clip.height, width, height);
  }
  auto keys = (*reader)->ReadKeys();
  if (!keys) {
    return Propagate(std::move(keys.error()));
  }
  if (keys->empty()) {
    return Fail(ErrorCode::kCorruptData, "{} knows no frame at all: analyse the clip again",
                analysis_path);
  }
  return std::unique_ptr<TimedRenderer>(new TimedRenderer(
      std::make_unique<Impl>(std::move(*reader), std::move(*keys), options, width, height,
                             logger ? std::move(logger) : SilentLogger())));
}

const stabilizer::ClipAnalysis& TimedRenderer::clip() const { return impl_->reader->clip(); }

std::optional<double> TimedRenderer::TimeOf(std::int64_t record) const {
  if (record < 0 || record >= clip().num_frames) {
    return std::nullopt;
  }
  return impl_->lookup.TimeOf(static_cast<std::size_t>(record));
}

void TimedRenderer::set_interpolation(stabilizer::Interpolation interpolation) {
  impl_->renderer.set_interpolation(interpolation);
}

Status TimedRenderer::Render(const FrameView& picture, double time_s, Frame& destination) {
  Impl& s = *impl_;
  const auto record = s.Find(picture, time_s);
  if (!record) {
    return Propagate(record.error());
  }
  const auto analysis = s.reader->ReadAt(s.lookup.keys(), *record);
  if (!analysis) {
    return Propagate(analysis.error());
  }
  const stabilizer::ClipAnalysis& clip = s.reader->clip();
  const double crop = clip.fixed_zoom ? clip.smallest_crop_ratio : analysis->crop_ratio;
  return s.renderer.Render(picture, *analysis, crop, destination);
}

void TimedRenderer::Reset() {
  impl_->shift_s = 0.0;
  impl_->fitting = 0;
  impl_->unseen = 0;
}

}  // namespace rsstab::pipeline
