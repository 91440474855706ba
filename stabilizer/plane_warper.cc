// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/plane_warper.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace rsstab::stabilizer {
namespace {

constexpr int kRowsPerBlock = 16;

// Positions farther outside than this many pixels are all alike, so clamping them there keeps the
// fixed-point arithmetic in range.
constexpr float kOutsideMarginPx = 8.0F;

// One axis of a plane's samples among the map's vertices.
struct PlaneAxis {
  int size;        // samples
  double step;     // luma pixels from one sample to the next
  double offset;   // luma pixel of sample 0
  double spacing;  // luma pixels from one vertex to the next; 0 when there is one pixel only
  int cells;       // vertices less one

  PlaneAxis(int plane_size, int chroma_shift, double chroma_offset, int map_size, int vertices)
      : size(plane_size),
        step(1 << chroma_shift),
        offset(chroma_offset),
        spacing(static_cast<double>(map_size - 1) / (vertices - 1)),
        cells(vertices - 1) {}

  // Sample -> place among the vertices, where vertex v is at v.
  [[nodiscard]] double GridPosition(int sample) const {
    return spacing > 0.0 ? (sample * step + offset) / spacing : 0.0;
  }
  // The cell of a sample; the outer cells reach beyond the grid.
  [[nodiscard]] int CellOf(int sample) const {
    return std::min(static_cast<int>(GridPosition(sample)), cells - 1);
  }
  // Luma pixel -> 1 / kPhases of a sample, as scale and offset.
  [[nodiscard]] float PhasesPerPixel() const { return static_cast<float>(kPhases / step); }
  [[nodiscard]] float PhaseOfPixelZero() const {
    return static_cast<float>(-offset * kPhases / step);
  }
};

// A run of samples whose positions follow one straight line.
struct Segment {
  int begin;
  int end;
  float grid_begin;  // place of `begin` in its cell, 0..1 on the grid
  float grid_step;   // the same from one sample to the next
};

// Positions start + i step of one coordinate, in 1 / kPhases of a sample.
struct Line {
  float start;
  float step;
  float low;  // bounds to clamp to
  float high;

  [[nodiscard]] float At(int i) const { return start + step * static_cast<float>(i); }
  // False for NaN.
  [[nodiscard]] bool StaysInside(int count) const {
    const float last = At(count - 1);
    return start >= low && start <= high && last >= low && last <= high;
  }
  // NaN comes out as the lower bound.
  [[nodiscard]] float ClampedAt(int i) const {
    const float above = At(i) > low ? At(i) : low;
    return std::min(above, high);
  }
};

// To the nearest; `position` is not below -kOutsideMarginPx.
std::int32_t Round(float position) {
  // Truncation rounds down once the number is positive.
  constexpr int kLift = static_cast<int>(kOutsideMarginPx) * kPhases;
  return static_cast<std::int32_t>(position + (kLift + 0.5F)) - kLift;
}

void FillLines(const Line& x, const Line& y, int count, std::int32_t* out_x, std::int32_t* out_y) {
  if (x.StaysInside(count) && y.StaysInside(count)) {
    for (int i = 0; i < count; ++i) {
      out_x[i] = Round(x.At(i));
      out_y[i] = Round(y.At(i));
    }
  } else {
    for (int i = 0; i < count; ++i) {
      out_x[i] = Round(x.ClampedAt(i));
      out_y[i] = Round(y.ClampedAt(i));
    }
  }
}

// Source positions of the planes of one geometry (all full-size planes, or all chroma planes).
class PositionSampler {
 public:
  PositionSampler(const BackwardMap& map, const PlaneAxis& x, const PlaneAxis& y,
                  OutsidePixels outside)
      : map_(map),
        x_(x),
        y_(y),
        reach_(outside == OutsidePixels::kBlack ? kOutsideMarginPx : 0.0F) {
    int begin = 0;
    for (int cell = 0; cell < x.cells; ++cell) {
      int end = begin;
      while (end < x.size && x.CellOf(end) == cell) {
        ++end;
      }
      segments_.push_back({begin, end, static_cast<float>(x.GridPosition(begin) - cell),
                           static_cast<float>(x.GridPosition(1) - x.GridPosition(0))});
      begin = end;
    }
  }

  // Positions of a row of samples in 1 / kPhases of a sample, clamped to the plane, or to a little
  // outside it where that is to show.
  void Row(int row, std::int32_t* out_x, std::int32_t* out_y) const {
    const int cell_y = y_.CellOf(row);
    const auto fraction = static_cast<float>(y_.GridPosition(row) - cell_y);
    const auto between_rows = [&](int column) -> Eigen::Vector2f {
      const Eigen::Vector2f& top = map_.At(column, cell_y);
      const Eigen::Vector2f luma = top + fraction * (map_.At(column, cell_y + 1) - top);
      return {luma.x() * x_.PhasesPerPixel() + x_.PhaseOfPixelZero(),
              luma.y() * y_.PhasesPerPixel() + y_.PhaseOfPixelZero()};
    };
    const float low = -reach_ * kPhases;
    const float high_x = (static_cast<float>(x_.size - 1) + reach_) * kPhases;
    const float high_y = (static_cast<float>(y_.size - 1) + reach_) * kPhases;
    Eigen::Vector2f left = between_rows(0);
    for (std::size_t cell = 0; cell < segments_.size(); ++cell) {
      const Segment& segment = segments_[cell];
      const Eigen::Vector2f right = between_rows(static_cast<int>(cell) + 1);
      const Eigen::Vector2f across = right - left;
      const Eigen::Vector2f start = left + segment.grid_begin * across;
      const Eigen::Vector2f step = segment.grid_step * across;
      const int count = segment.end - segment.begin;
      FillLines({start.x(), step.x(), low, high_x}, {start.y(), step.y(), low, high_y}, count,
                out_x + segment.begin, out_y + segment.begin);
      left = right;
    }
  }

 private:
  const BackwardMap& map_;
  PlaneAxis x_;
  PlaneAxis y_;
  float reach_;                    // px beyond the outermost pixel centres
  std::vector<Segment> segments_;  // one per cell, left to right
};

// Every entry `times` times, in place: pixels -> interleaved samples. `values` holds count * times.
void RepeatEach(std::vector<std::int32_t>& values, int count, int times) {
  if (times == 1) {
    return;
  }
  for (int i = count - 1; i >= 0; --i) {
    const std::int32_t value = values[static_cast<std::size_t>(i)];
    std::fill_n(values.begin() + static_cast<std::ptrdiff_t>(i) * times, times, value);
  }
}

// Planes that have the same source positions, sample by sample.
struct PlaneGroup {
  bool chroma;
  int channels;
  std::vector<std::size_t> planes;
};

std::vector<PlaneGroup> GroupPlanes(const PixelLayout& layout) {
  std::vector<PlaneGroup> groups;
  for (int p = 0; p < layout.num_planes; ++p) {
    const auto plane = static_cast<std::size_t>(p);
    const bool chroma = layout.IsChroma(p);
    const int channels = layout.channels[plane];
    auto group = std::find_if(groups.begin(), groups.end(), [&](const PlaneGroup& g) {
      return g.chroma == chroma && g.channels == channels;
    });
    if (group == groups.end()) {
      group = groups.insert(group, PlaneGroup{chroma, channels, {}});
    }
    group->planes.push_back(plane);
  }
  return groups;
}

Status CheckArguments(const FrameView& source, const BackwardMap& map, const Frame& destination) {
  if (source.width != destination.width || source.height != destination.height ||
      source.width != map.width() || source.height != map.height() || source.width < 1 ||
      source.height < 1) {
    return Fail(ErrorCode::kInvalidArgument,
                "a picture of {}x{} cannot be warped by a map of {}x{} into one of {}x{}: the "
                "sizes must be equal",
                source.width, source.height, map.width(), map.height(), destination.width,
                destination.height);
  }
  const PixelLayout& layout = source.layout;
  if (!(layout == destination.layout)) {
    return Fail(ErrorCode::kInvalidArgument,
                "a picture cannot be warped into one of another pixel layout");
  }
  for (int p = 0; p < layout.num_planes; ++p) {
    const auto plane = static_cast<std::size_t>(p);
    if (source.planes[plane].data == nullptr || destination.planes[plane].data == nullptr) {
      return Fail(ErrorCode::kInvalidArgument, "plane {} of a picture to be warped is missing", p);
    }
    if (layout.channels[plane] < 1 || layout.channels[plane] > kMaxChannels) {
      return Fail(ErrorCode::kInvalidArgument, "a plane of {} channels cannot be warped",
                  layout.channels[plane]);
    }
  }
  return {};
}

}  // namespace

PlaneWarper::PlaneWarper(KernelSet kernels)
    : kernels_(kernels),
      filters_{FilterBank(Interpolation::kBilinear), FilterBank(Interpolation::kBicubic),
               FilterBank(Interpolation::kLanczos)} {}

Status PlaneWarper::Warp(const FrameView& source, const BackwardMap& map,
                         Interpolation interpolation, Frame& destination, WorkerPool& workers,
                         OutsidePixels outside) const {
  if (Status status = CheckArguments(source, map, destination); !status) {
    return status;
  }
  const PixelLayout& layout = source.layout;
  const FilterBank& filter = filters_[static_cast<std::size_t>(interpolation)];
  for (const PlaneGroup& group : GroupPlanes(layout)) {
    const int any_plane = static_cast<int>(group.planes.front());
    const int width = layout.PlaneWidth(any_plane, source.width);
    const int height = layout.PlaneHeight(any_plane, source.height);
    const PositionSampler sampler(
        map,
        PlaneAxis(width, group.chroma ? layout.chroma_shift_x : 0,
                  group.chroma ? layout.chroma_offset_x : 0.0, map.width(), map.columns()),
        PlaneAxis(height, group.chroma ? layout.chroma_shift_y : 0,
                  group.chroma ? layout.chroma_offset_y : 0.0, map.height(), map.rows()),
        outside);

    workers.ForBlocks(height, kRowsPerBlock, [&](int begin, int end) {
      std::vector<std::int32_t> source_x(static_cast<std::size_t>(width * group.channels));
      std::vector<std::int32_t> source_y(source_x.size());
      for (int y = begin; y < end; ++y) {
        sampler.Row(y, source_x.data(), source_y.data());
        RepeatEach(source_x, width, group.channels);
        RepeatEach(source_y, width, group.channels);
        for (const std::size_t plane : group.planes) {
          const PlaneView& from = source.planes[plane];
          const MutablePlaneView& to = destination.planes[plane];
          ResampleRow row;
          row.source = from.data;
          row.source_stride = from.stride;
          row.source_width = width;
          row.source_height = height;
          row.channels = group.channels;
          row.bit_depth = layout.bit_depth;
          for (int c = 0; c < group.channels; ++c) {
            row.black[static_cast<std::size_t>(c)] = layout.BlackLevel(static_cast<int>(plane), c);
          }
          row.source_x = source_x;
          row.source_y = source_y;
          row.output = to.data + y * to.stride;
          Resample(row, filter, kernels_);
        }
      }
    });
  }
  return {};
}

}  // namespace rsstab::stabilizer
