// SPDX-License-Identifier: Apache-2.0
#include "cli/datasets/labels.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "evaluation/photo.h"
#include "evaluation/synthetic_sample.h"

namespace rsstab::datasets {

using evaluation::LabelledPicture;

Status SetTruth(const images::NpyArray& field, LabelledPicture& picture) {
  const auto width = static_cast<std::size_t>(picture.rs.width);
  const auto height = static_cast<std::size_t>(picture.rs.height);
  if (field.shape != std::vector<std::size_t>{2, height, width}) {
    return Fail(ErrorCode::kCorruptData, "its field is not of 2 x {} x {}", height, width);
  }
  const auto values = images::ToFloats(field);
  if (!values) {
    return Propagate(values.error());
  }
  const std::size_t pixels = width * height;
  picture.truth.clear();
  picture.truth.reserve(pixels);
  for (std::size_t i = 0; i < pixels; ++i) {
    picture.truth.emplace_back((*values)[i], (*values)[pixels + i]);
  }
  picture.valid = evaluation::SourcesInside(picture.truth, picture.rs.width, picture.rs.height);
  for (std::size_t i = 0; i < pixels; ++i) {
    if (!picture.truth[i].allFinite()) {
      picture.truth[i].setZero();
      picture.valid[i] = 0;
    }
  }
  return {};
}

Result<std::vector<std::uint8_t>> OutsideBlackEdges(const FrameView& picture, int level) {
  if (!(picture.layout == evaluation::RgbLayout())) {
    return Fail(ErrorCode::kInvalidArgument, "black edges are looked for in packed 8-bit RGB only");
  }
  // One pixel of black around the picture joins all edges.
  cv::Mat dark(picture.height + 2, picture.width + 2, CV_8U, cv::Scalar(255));
  for (int y = 0; y < picture.height; ++y) {
    const std::uint8_t* in = picture.planes[0].data + y * picture.planes[0].stride;
    auto* out = dark.ptr<std::uint8_t>(y + 1) + 1;
    for (int x = 0; x < picture.width; ++x, in += 3) {
      out[x] = in[0] <= level && in[1] <= level && in[2] <= level ? 255 : 0;
    }
  }
  constexpr int kEdge = 128;
  constexpr int kNeighbours = 4;
  cv::floodFill(dark, {0, 0}, kEdge, nullptr, {}, {}, kNeighbours);
  const cv::Mat edge = dark == kEdge;
  std::vector<std::uint8_t> outside;
  outside.reserve(static_cast<std::size_t>(picture.width) *
                  static_cast<std::size_t>(picture.height));
  for (int y = 1; y <= picture.height; ++y) {
    for (int x = 1; x <= picture.width; ++x) {
      // The frame around the picture is no neighbour: a picture without edges counts as a whole.
      const auto is_edge = [&](int row, int column) {
        return row >= 1 && row <= picture.height && column >= 1 && column <= picture.width &&
               edge.at<std::uint8_t>(row, column) != 0;
      };
      outside.push_back(is_edge(y, x) || is_edge(y - 1, x) || is_edge(y + 1, x) ||
                                is_edge(y, x - 1) || is_edge(y, x + 1)
                            ? 0
                            : 1);
    }
  }
  return outside;
}

Status LeaveOutBlackEdges(int rs_black, int gs_black, LabelledPicture& picture) {
  auto rs = OutsideBlackEdges(picture.rs.View(), rs_black);
  auto gs = OutsideBlackEdges(picture.gs.View(), gs_black);
  if (!rs || !gs) {
    return Propagate(rs ? gs.error() : rs.error());
  }
  picture.rs_valid = std::move(*rs);
  if (picture.truth.empty()) {
    picture.valid = std::move(*gs);
    return {};
  }
  const int width = picture.rs.width;
  std::size_t i = 0;
  for (int y = 0; y < picture.rs.height; ++y) {
    for (int x = 0; x < width; ++x, ++i) {
      if (picture.valid[i] != 0) {
        const Eigen::Vector2f& d = picture.truth[i];
        const int column = std::clamp(x + static_cast<int>(std::lround(d.x())), 0, width - 1);
        const int row =
            std::clamp(y + static_cast<int>(std::lround(d.y())), 0, picture.rs.height - 1);
        const auto source = static_cast<std::size_t>(row * width + column);
        picture.valid[i] = (*gs)[i] != 0 && picture.rs_valid[source] != 0 ? 1 : 0;
      }
    }
  }
  return {};
}

}  // namespace rsstab::datasets
