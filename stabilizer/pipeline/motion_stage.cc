// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/pipeline/motion_stage.h"

#include <cmath>
#include <deque>
#include <utility>
#include <variant>

#include "igf/base/rotation.h"
#include "stabilizer/crop_planner.h"
#include "stabilizer/global_motion.h"
#include "stabilizer/mesh_motion.h"
#include "stabilizer/normalized_coordinates.h"
#include "stabilizer/online_zoom_planner.h"
#include "stabilizer/path_smoother.h"
#include "stabilizer/pipeline/warp_assembly.h"
#include "stabilizer/scene_cut.h"

namespace rsstab::pipeline {
namespace {

using stabilizer::FrameAnalysis;
using stabilizer::MotionRung;
using stabilizer::RectifiedMatch;

// The smoother's zoom hides most of every border; what is left is planned over this long to either
// side of a frame that needs it.
constexpr double kZoomReachS = 0.4;
// A look-ahead is shared: this part of it is the zoom planner's, unless that wants less.
constexpr int kZoomShare = 4;
// Where the look-ahead is too short for the planner, zooming out is held back for kZoomHoldS and
// then changes by no more than this a second.
constexpr double kZoomHoldS = 2.0;
constexpr double kMaxWideningPerS = 0.02;
// Focal length where nobody knows it, in picture widths (64 degrees): phones and action cameras in
// their linear modes lie between 0.6 and 1.0.
constexpr double kDefaultFocalRatio = 0.8;
// Steps of the fixed point that takes a recorded pixel to the corrected picture: x + G(x) = y.
constexpr int kRectifySteps = 3;

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

using AnyZoomPlanner = std::variant<stabilizer::ZoomPlanner, stabilizer::OnlineZoomPlanner>;

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
  const auto wanted = 2 * static_cast<int>(std::lround(kZoomReachS * frames_per_second));
  const int zoom = std::min(*frames / kZoomShare, wanted);
  Lookahead shared;
  shared.smoother = *frames - zoom;
  if (zoom < wanted) {
    shared.zoom = static_cast<std::size_t>(zoom);
  }
  return shared;
}

AnyZoomPlanner MakeZoomPlanner(std::optional<std::size_t> lookahead, double frames_per_second) {
  if (!lookahead) {
    return stabilizer::ZoomPlanner(
        static_cast<std::size_t>(std::lround(kZoomReachS * frames_per_second)));
  }
  return stabilizer::OnlineZoomPlanner(
      *lookahead, static_cast<std::size_t>(std::lround(kZoomHoldS * frames_per_second)),
      kMaxWideningPerS / frames_per_second);
}

}  // namespace

struct MotionStage::Impl {
  Impl(const StabilizeOptions& stabilize_options, const ClipGeometry& geometry,
       RsSelection* rs_selection, Logger log, const Lookahead& shared)
      : options(stabilize_options),
        clip(geometry),
        selection(rs_selection),
        logger(std::move(log)),
        mesh(stabilize_options.mesh_columns, stabilize_options.mesh_rows,
             static_cast<double>(geometry.height) / geometry.width),
        mesh_solver(mesh),
        lookahead(shared),
        zoom(MakeZoomPlanner(shared.zoom, geometry.frames_per_second)) {}

  StabilizeOptions options;
  ClipGeometry clip;
  RsSelection* selection;
  Logger logger;
  stabilizer::MeshGrid mesh;
  stabilizer::MeshMotionSolver mesh_solver;
  std::unique_ptr<stabilizer::PathSmoother> smoother;
  Lookahead lookahead;
  AnyZoomPlanner zoom;

  std::int64_t num_frames = 0;    // decided
  std::int64_t num_observed = 0;  // shown to the source
  stabilizer::LumaFingerprint observed_fingerprint{};
  std::int64_t num_without_rs = 0;  // frames that the RS source could not tell
  MotionField previous_field;
  double previous_time_s = 0.0;
  stabilizer::LumaFingerprint previous_fingerprint{};
  std::deque<FrameObservation> waiting_for_source;
  std::deque<FrameAnalysis> waiting_for_path;
  std::deque<FrameAnalysis> waiting_for_zoom;
  std::vector<FrameAnalysis> ready;

  // Recorded pixel (proxy size) -> rectified, normalised. Empty where the lens has no ray.
  [[nodiscard]] std::optional<Eigen::Vector2d> Rectify(const Eigen::Vector2f& proxy_pixel,
                                                       const PointTracks& tracks,
                                                       const MotionField& field) const {
    const Eigen::Vector2d n =
        stabilizer::ToNormalized(proxy_pixel.cast<double>(), tracks.width, tracks.height);
    // The proxy may round its height: scale each axis to the full picture.
    const Eigen::Vector2d recorded((proxy_pixel.x() + 0.5) * clip.width / tracks.width - 0.5,
                                   (proxy_pixel.y() + 0.5) * clip.height / tracks.height - 0.5);
    const bool lens = selection->camera && selection->camera->model != LensModel::kPinhole;
    if (field.columns() == 0 && !lens) {
      return n;
    }
    Eigen::Vector2d p = recorded;
    if (field.columns() != 0) {
      for (int i = 0; i < kRectifySteps; ++i) {
        p = recorded - field.Sample(p);
      }
    }
    if (lens) {
      const auto ray = selection->camera->UnprojectPixel(p);
      if (!ray) {
        return std::nullopt;
      }
      const Eigen::Vector3d ideal = selection->camera->K() * *ray;
      p = ideal.hnormalized();
    }
    return stabilizer::ToNormalized(p, clip.width, clip.height);
  }

  // What the RS source knows of the turn between two frames, normalised; empty when nothing.
  [[nodiscard]] std::optional<Eigen::Matrix3d> PredictedMotion(double from_s, double to_s) const {
    if (!selection->rotation_is_known || !selection->camera) {
      return std::nullopt;
    }
    const auto from = selection->source->CameraFromWorld(from_s);
    const auto to = selection->source->CameraFromWorld(to_s);
    if (!from || !to) {
      return std::nullopt;
    }
    const Eigen::Matrix3d to_from = stabilizer::NormalizedFromPixels(clip.width, clip.height) *
                                    RotationHomography(selection->camera->K(), *to, *from) *
                                    stabilizer::PixelsFromNormalized(clip.width, clip.height);
    return Eigen::Matrix3d(to_from / to_from(2, 2));
  }

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

  [[nodiscard]] stabilizer::FrameMotion EstimateMotion(const FrameObservation& o,
                                                       const MotionField& field) {
    stabilizer::FrameMotion motion;
    if (num_frames == 0) {
      motion.path_begins = true;
      return motion;
    }
    std::vector<RectifiedMatch> matches;
    matches.reserve(o.tracks.matches.size());
    for (const PointMatch& m : o.tracks.matches) {
      const auto from = Rectify(m.from, o.tracks, previous_field);
      const auto to = Rectify(m.to, o.tracks, field);
      if (from && to) {
        matches.push_back({*from, *to});
      }
    }
    stabilizer::GlobalMotionOptions global_options;
    const auto predicted = PredictedMotion(previous_time_s, o.time_s);
    if (predicted) {
      global_options.predicted = *predicted;
      global_options.finest = MotionRung::kSimilarity;
    }
    const stabilizer::GlobalMotion global =
        stabilizer::EstimateGlobalMotion(matches, global_options);
    motion.to_from = global.to_from;
    motion.rung = global.rung;
    const stabilizer::SceneChangeEvidence evidence = {
        stabilizer::FingerprintDistance(o.fingerprint, previous_fingerprint), o.attempted_points,
        global.num_inliers};
    if (stabilizer::IsSceneCut(evidence)) {
      motion = {};
      motion.path_begins = true;
      logger->debug("frame {}: scene cut", num_frames);
      return motion;
    }
    if (predicted && selection->only_turns) {
      motion.to_from = *predicted;
      motion.rung = MotionRung::kSimilarity;
      return motion;
    }
    const bool well_supported = global.rung == global_options.finest;
    if (well_supported) {
      motion.local = mesh_solver.Solve(matches, global.to_from);
      if (!motion.local.empty()) {
        motion.rung = MotionRung::kMesh;
      }
    }
    return motion;
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
    const stabilizer::FrameMotion motion = EstimateMotion(observation, frame.rs_field);
    previous_field = frame.rs_field;
    previous_time_s = observation.time_s;
    previous_fingerprint = observation.fingerprint;
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
      double allowed = stabilizer::LargestCropRatio(
          AssembleWarp(frame, clip.width, clip.height, selection->camera));
      if (options.zoom == ZoomMode::kFixed && options.fixed_zoom) {
        allowed = std::min(allowed, 1.0 / *options.fixed_zoom);
      }
      std::visit([&](auto& planner) { planner.Push(allowed, frame.path_begins); }, zoom);
      waiting_for_zoom.push_back(std::move(frame));
    }
    TakeZooms();
  }

  void TakeZooms() {
    for (const double ratio : std::visit([](auto& planner) { return planner.TakeReady(); }, zoom)) {
      waiting_for_zoom.front().crop_ratio = ratio;
      ready.push_back(std::move(waiting_for_zoom.front()));
      waiting_for_zoom.pop_front();
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
  s.options = options;
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
  std::visit([](auto& planner) { planner.Finish(); }, s.zoom);
  s.TakeZooms();
  if (s.num_without_rs > 0) {
    s.logger->warn("{} of {} frames keep their rolling shutter: the {} source has no data for them",
                   s.num_without_rs, s.num_frames, s.selection->source->Name());
  }
  return {};
}

std::vector<FrameAnalysis> MotionStage::TakeReady() { return std::exchange(impl_->ready, {}); }

}  // namespace rsstab::pipeline
