// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/pipeline/motion_stage.h"

#include <algorithm>
#include <deque>
#include <utility>

#include "stabilizer/mesh_grid.h"
#include "stabilizer/path_smoother.h"
#include "stabilizer/pipeline/crop_stage.h"
#include "stabilizer/pipeline/frame_motion_estimator.h"
#include "stabilizer/pipeline/orientation_recorder.h"
#include "stabilizer/scene_cut.h"

namespace rsstab::pipeline {
namespace {

using stabilizer::FrameAnalysis;

// A look-ahead is shared: this part of it is the zoom planner's, unless that wants less.
constexpr int kZoomShare = 4;
// Focal length where nobody knows it, in picture widths (64 degrees): phones and action cameras in
// their linear modes lie between 0.6 and 1.0.
constexpr double kDefaultFocalRatio = 0.8;

stabilizer::PathSmootherOptions SmootherOptions(const StabilizeOptions& options,
                                                const ClipGeometry& clip,
                                                const RsSelection& selection,
                                                std::optional<int> lookahead_frames) {
  stabilizer::PathSmootherOptions smoother;
  smoother.lookahead_frames = lookahead_frames;
  smoother.aspect = static_cast<double>(clip.height) / clip.width;
  smoother.frames_per_second = clip.frames_per_second;
  smoother.smoothness_s = options.smoothness_s;
  smoother.tripod = options.tripod;
  smoother.min_crop_ratio = options.min_crop_ratio;
  if (options.zoom == ZoomMode::kFixed && options.fixed_zoom) {
    smoother.min_crop_ratio = std::max(smoother.min_crop_ratio, 1.0 / *options.fixed_zoom);
  }
  smoother.focal_ratio =
      selection.camera ? selection.camera->fx / selection.camera->width : kDefaultFocalRatio;
  smoother.adaptive_zoom = options.zoom == ZoomMode::kAdaptive && !options.tripod;
  smoother.rotation_known = selection.rotation_is_known;
  smoother.mesh_columns = options.mesh_columns;
  smoother.mesh_rows = options.mesh_rows;
  return smoother;
}

// How a look-ahead is shared between rolling-shutter source, smoother and zoom planner.
struct Lookahead {
  std::optional<int> smoother;
  std::optional<std::size_t> zoom;    // empty: as long as the planner wants
  std::optional<std::size_t> source;  // empty: as long as the source wants
};

Lookahead ShareLookahead(std::optional<int> frames, double frames_per_second) {
  if (!frames) {
    return {};
  }
  const int wanted = CropStage::WantedLookahead(frames_per_second);
  const int zoom = std::min(*frames / kZoomShare, wanted);
  Lookahead shared;
  shared.smoother = *frames - zoom;
  if (zoom < wanted) {
    shared.zoom = static_cast<std::size_t>(zoom);
  }
  return shared;
}

}  // namespace

struct MotionStage::Impl {
  Impl(const StabilizeOptions& stabilize_options, const ClipGeometry& geometry,
       RsSelection* rs_selection, Logger log, const Lookahead& shared)
      : clip(geometry),
        selection(rs_selection),
        logger(std::move(log)),
        mesh(stabilize_options.mesh_columns, stabilize_options.mesh_rows,
             static_cast<double>(geometry.height) / geometry.width),
        lookahead(shared),
        motion_estimator(geometry, rs_selection, mesh, logger),
        crop(stabilize_options, geometry, rs_selection, shared.zoom) {}

  ClipGeometry clip;
  RsSelection* selection;
  Logger logger;
  stabilizer::MeshGrid mesh;
  Lookahead lookahead;
  FrameMotionEstimator motion_estimator;
  std::unique_ptr<stabilizer::PathSmoother> smoother;
  CropStage crop;

  std::int64_t num_frames = 0;    // that the source has answered for, or had to
  std::int64_t num_observed = 0;  // shown to the source
  stabilizer::LumaFingerprint observed_fingerprint{};
  std::int64_t num_without_rs = 0;  // frames that the RS source could not tell
  OrientationRecorder orientations;
  std::deque<FrameObservation> waiting_for_source;
  std::deque<FrameAnalysis> waiting_for_path;

  [[nodiscard]] MotionField EstimateField(const FrameObservation& o, const FrameView* image) {
    if (!selection->source) {
      return {};
    }
    const auto motion = selection->source->EstimateMotion({num_frames, o.time_s, image});
    if (!motion) {
      if (num_without_rs++ == 0) {
        logger->debug("frame {}: {}", num_frames, motion.error().message);
      }
      return {};
    }
    return motion->field;
  }

  // A cut as far as it can be told before rolling shutter is taken out.
  [[nodiscard]] bool BeginsScene(const FrameObservation& o) const {
    return stabilizer::IsSceneCut(
        {stabilizer::FingerprintDistance(o.fingerprint, observed_fingerprint), o.attempted_points,
         static_cast<int>(o.tracks.matches.size())});
  }

  Status Advance(const FrameObservation& observation, const FrameView* image) {
    FrameAnalysis frame;
    frame.pts = observation.pts;
    frame.fingerprint = observation.fingerprint;
    frame.rs_field = EstimateField(observation, image);
    if (selection->source) {
      frame.orientation = orientations.Next(*selection->source, observation.time_s);
    }
    const stabilizer::FrameMotion motion = motion_estimator.Push(observation, frame.rs_field);
    ++num_frames;
    waiting_for_path.push_back(std::move(frame));
    if (Status ok = smoother->Push(motion); !ok) {
      return ok;
    }
    TakeUpdates();
    return {};
  }

  Status AdvanceAnswerable() {
    while (!waiting_for_source.empty() && num_frames < selection->source->NumAnswerable()) {
      const FrameObservation observation = std::move(waiting_for_source.front());
      waiting_for_source.pop_front();
      if (Status ok = Advance(observation, nullptr); !ok) {
        return ok;
      }
    }
    return {};
  }

  void TakeUpdates() {
    for (stabilizer::PathUpdate& update : smoother->TakeReady()) {
      FrameAnalysis frame = std::move(waiting_for_path.front());
      waiting_for_path.pop_front();
      frame.rung = update.rung;
      frame.path_begins = update.path_begins;
      frame.rectified_from_output = update.rectified_from_output;
      if (!update.mesh_update.empty()) {
        frame.mesh_update =
            MotionField(clip.width, clip.height, mesh.columns() + 1, mesh.rows() + 1);
        auto vertices = frame.mesh_update.vertices();
        for (std::size_t i = 0; i < vertices.size(); ++i) {
          vertices[i] = (update.mesh_update[i] * clip.width).cast<float>();
        }
      }
      crop.Push(std::move(frame));
    }
  }
};

MotionStage::MotionStage(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
MotionStage::~MotionStage() = default;

Result<std::unique_ptr<MotionStage>> MotionStage::Create(const StabilizeOptions& options,
                                                         const ClipGeometry& clip,
                                                         RsSelection* selection, Logger logger,
                                                         std::optional<int> lookahead_frames) {
  if (clip.width < 1 || clip.height < 1 || !(clip.frames_per_second > 0.0)) {
    return Fail(ErrorCode::kInvalidArgument,
                "a clip of {}x{} at {} frames per second is not possible", clip.width, clip.height,
                clip.frames_per_second);
  }
  const int source_delay = selection->source ? selection->source->DelayFrames() : 0;
  std::optional<int> left = lookahead_frames;
  if (left && *left < source_delay) {
    return Fail(ErrorCode::kInvalidArgument,
                "a look-ahead of {} frames is too short for the rolling-shutter source {}, which "
                "needs {}",
                *left, selection->source->Name(), source_delay);
  }
  if (left) {
    *left -= source_delay;
  }
  Lookahead lookahead = ShareLookahead(left, clip.frames_per_second);
  if (left) {
    lookahead.source = static_cast<std::size_t>(source_delay);
  }
  auto smoother = stabilizer::MakeCeresPathSmoother(
      SmootherOptions(options, clip, *selection, lookahead.smoother));
  if (!smoother) {
    return Propagate(std::move(smoother.error()));
  }
  auto impl = std::make_unique<Impl>(options, clip, selection, std::move(logger), lookahead);
  impl->smoother = std::move(*smoother);
  return std::unique_ptr<MotionStage>(new MotionStage(std::move(impl)));
}

Status MotionStage::Update(const StabilizeOptions& options) {
  Impl& s = *impl_;
  s.crop.Update(options);
  return s.smoother->Update(SmootherOptions(options, s.clip, *s.selection, s.lookahead.smoother));
}

Status MotionStage::Push(const FrameObservation& observation, const FrameView* image) {
  Impl& s = *impl_;
  if (!s.selection->source) {
    return s.Advance(observation, image);
  }
  const bool begins = s.num_observed > 0 && s.BeginsScene(observation);
  s.selection->source->Observe(begins ? PointTracks{} : observation.tracks, observation.time_s);
  s.observed_fingerprint = observation.fingerprint;
  ++s.num_observed;
  if (s.waiting_for_source.empty() && s.num_frames < s.selection->source->NumAnswerable()) {
    return s.Advance(observation, image);
  }
  s.waiting_for_source.push_back(observation);
  if (Status ok = s.AdvanceAnswerable(); !ok) {
    return ok;
  }
  // A source that takes longer than it was given (frames that repeat each other tell it nothing):
  // the frame is due, and goes without.
  while (s.lookahead.source && s.waiting_for_source.size() > *s.lookahead.source) {
    const FrameObservation due = std::move(s.waiting_for_source.front());
    s.waiting_for_source.pop_front();
    if (Status ok = s.Advance(due, nullptr); !ok) {
      return ok;
    }
  }
  return {};
}

Status MotionStage::Finish() {
  Impl& s = *impl_;
  if (s.selection->source) {
    s.selection->source->FinishObserving();
    if (Status ok = s.AdvanceAnswerable(); !ok) {
      return ok;
    }
  }
  if (Status ok = s.smoother->Finish(); !ok) {
    return ok;
  }
  s.TakeUpdates();
  s.crop.Finish();
  if (s.num_without_rs > 0) {
    s.logger->warn("{} of {} frames keep their rolling shutter: the {} source has no data for them",
                   s.num_without_rs, s.num_frames, s.selection->source->Name());
  }
  return {};
}

std::vector<FrameAnalysis> MotionStage::TakeReady() { return impl_->crop.TakeReady(); }

}  // namespace rsstab::pipeline
