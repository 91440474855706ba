// SPDX-License-Identifier: Apache-2.0
#include "evaluation/correction_score.h"

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <utility>

#include "evaluation/synthetic_sample.h"
#include "stabilizer/backward_map.h"
#include "stabilizer/interpolation.h"
#include "stabilizer/plane_warper.h"

namespace rsstab::evaluation {

Result<CorrectedPicture> CorrectPicture(const FrameView& rs, const MotionField& field,
                                        WorkerPool& workers) {
  if (field.width() != rs.width || field.height() != rs.height) {
    return Fail(ErrorCode::kInvalidArgument,
                "a field of {}x{} pixels does not correct a picture of {}x{}", field.width(),
                field.height(), rs.width, rs.height);
  }
  auto picture = AllocateFrame(rs.layout, rs.width, rs.height);
  if (!picture) {
    return Propagate(picture.error());
  }
  stabilizer::FrameWarp warp;
  warp.width = rs.width;
  warp.height = rs.height;
  warp.rs_field = field;
  const stabilizer::BackwardMap map = stabilizer::ComposeBackwardMap(warp);
  if (Status status = stabilizer::PlaneWarper().Warp(rs, map, stabilizer::Interpolation::kBicubic,
                                                     *picture, workers);
      !status) {
    return Propagate(status.error());
  }
  CorrectedPicture corrected{std::move(*picture), {}};
  std::vector<Eigen::Vector2f> displacement;
  displacement.reserve(static_cast<std::size_t>(rs.width) * static_cast<std::size_t>(rs.height));
  for (int y = 0; y < rs.height; ++y) {
    for (int x = 0; x < rs.width; ++x) {
      const Eigen::Vector2d pixel(x, y);
      displacement.emplace_back((map.Sample(pixel) - pixel).cast<float>());
    }
  }
  corrected.valid = SourcesInside(displacement, rs.width, rs.height);
  return corrected;
}

Result<PictureScore> ScorePicture(const FrameView& picture, const FrameView& truth,
                                  stabilizer::PixelMask valid) {
  const auto psnr = stabilizer::Psnr(picture, truth, valid);
  if (!psnr) {
    return Propagate(psnr.error());
  }
  const auto ssim = stabilizer::Ssim(picture, truth, valid);
  if (!ssim) {
    return Propagate(ssim.error());
  }
  const auto counted = static_cast<double>(
      std::count_if(valid.begin(), valid.end(), [](std::uint8_t v) { return v != 0; }));
  const double share = valid.empty() ? 1.0 : counted / static_cast<double>(valid.size());
  return PictureScore{*psnr, *ssim, share};
}

}  // namespace rsstab::evaluation
