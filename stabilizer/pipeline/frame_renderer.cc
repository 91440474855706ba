// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/pipeline/frame_renderer.h"

#include "igf/base/parallel_for.h"
#include "stabilizer/pipeline/covered_map.h"
#include "stabilizer/pipeline/warp_assembly.h"
#include "stabilizer/plane_warper.h"

namespace rsstab::pipeline {

struct FrameRenderer::Impl {
  Impl(const RenderGeometry& render_geometry, const StabilizeOptions& options)
      : geometry(render_geometry),
        interpolation(options.interpolation),
        is_scaled(geometry.width != geometry.analysed_width ||
                  geometry.height != geometry.analysed_height),
        camera(geometry.camera && is_scaled
                   ? geometry.camera->Rescaled(geometry.width, geometry.height)
                   : geometry.camera),
        grid(stabilizer::DefaultMapGrid(geometry.width, geometry.height)),
        workers(ResolveThreadCount(options.num_threads)) {}

  // The warp for pictures of `geometry`'s size.
  [[nodiscard]] stabilizer::FrameWarp Assemble(const stabilizer::FrameAnalysis& analysis) const {
    stabilizer::FrameWarp warp = AssembleWarp(analysis, geometry.width, geometry.height, camera);
    if (is_scaled) {
      for (MotionField* field : {&warp.mesh_update, &warp.rs_field}) {
        if (field->columns() != 0) {
          *field = field->Rescaled(geometry.width, geometry.height);
        }
      }
    }
    return warp;
  }

  RenderGeometry geometry;
  stabilizer::Interpolation interpolation;
  bool is_scaled;
  std::optional<Camera> camera;  // of the pictures' size
  stabilizer::MapGrid grid;
  WorkerPool workers;
  stabilizer::PlaneWarper warper;
};

FrameRenderer::FrameRenderer(const RenderGeometry& geometry, const StabilizeOptions& options)
    : impl_(std::make_unique<Impl>(geometry, options)) {}
FrameRenderer::~FrameRenderer() = default;

void FrameRenderer::set_interpolation(stabilizer::Interpolation interpolation) {
  impl_->interpolation = interpolation;
}

Status FrameRenderer::Render(const FrameView& picture, const stabilizer::FrameAnalysis& analysis,
                             double crop_ratio, Frame& destination) {
  Impl& s = *impl_;
  const CoveredMap covered = ComposeCoveredMap(s.Assemble(analysis), crop_ratio, s.grid);
  return s.warper.Warp(picture, covered.map, s.interpolation, destination, s.workers);
}

}  // namespace rsstab::pipeline
