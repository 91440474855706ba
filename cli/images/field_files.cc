// SPDX-License-Identifier: Apache-2.0
#include "cli/images/field_files.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <ostream>
#include <vector>

#include "cli/images/flo_file.h"
#include "cli/images/flow_colors.h"
#include "cli/images/npz_file.h"
#include "cli/images/picture_file.h"
#include "igf/base/whole_file.h"

namespace rsstab::images {
namespace {

constexpr int kRowsPerBlock = 32;
constexpr int kAnyQuality = 95;  // PNG loses nothing

Status WriteColors(const std::string& path, const MotionField& field, WorkerPool& workers) {
  const auto colors = FlowColors(field, workers);
  if (!colors) {
    return Propagate(colors.error(), path);
  }
  const auto encoded = EncodePicture(path, colors->View(), kAnyQuality);
  if (!encoded) {
    return Propagate(encoded.error());
  }
  return WriteWholeFile(path, [&encoded](std::ostream& out) {
    out.write(reinterpret_cast<const char*>(encoded->bytes.data()),
              static_cast<std::streamsize>(encoded->bytes.size()));
  });
}

// `spread`: in the x components; without vertices where nothing is known.
Status WriteArrays(const std::string& path, const MotionField& field, const MotionField& spread,
                   WorkerPool& workers) {
  const auto width = static_cast<std::size_t>(field.width());
  const auto height = static_cast<std::size_t>(field.height());
  const std::size_t pixels = width * height;
  std::vector<float> displacement(2 * pixels);
  std::vector<float> deviation(pixels, std::numeric_limits<float>::infinity());
  workers.ForBlocks(field.height(), kRowsPerBlock, [&](int begin, int end) {
    std::size_t i = static_cast<std::size_t>(begin) * width;
    for (int y = begin; y < end; ++y) {
      for (int x = 0; x < field.width(); ++x, ++i) {
        const Eigen::Vector2d sample = field.Sample({x, y});
        displacement[i] = static_cast<float>(sample.x());
        displacement[pixels + i] = static_cast<float>(sample.y());
        if (spread.columns() != 0) {
          deviation[i] = static_cast<float>(spread.Sample({x, y}).x());
        }
      }
    }
  });
  return WriteNpz(path, std::vector<NpzArray>{{"field", {2, height, width}, displacement},
                                              {"spread", {height, width}, deviation}});
}

// A number for each vertex as the x component of a field; without vertices when a number is not
// finite.
MotionField AsField(std::span<const float> values, const MotionField& like) {
  if (!std::all_of(values.begin(), values.end(), [](float v) { return std::isfinite(v); })) {
    return {};
  }
  MotionField field = like;
  std::transform(values.begin(), values.end(), field.vertices().begin(),
                 [](float value) { return Eigen::Vector2f(value, 0.0F); });
  return field;
}

}  // namespace

FieldFiles::FieldFiles(const std::filesystem::path& folder, const std::string& name)
    : flo((folder / (name + ".flo")).string()),
      npz((folder / (name + ".npz")).string()),
      picture((folder / (name + "-field.png")).string()) {}

Status WriteFieldFiles(const FieldFiles& files, const MotionField& field,
                       std::span<const float> vertex_spread_px, WorkerPool& workers) {
  if (vertex_spread_px.size() != field.vertices().size()) {
    return Fail(ErrorCode::kInvalidArgument,
                "{}: a field of {} vertices needs as many spreads, not {}", files.npz,
                field.vertices().size(), vertex_spread_px.size());
  }
  if (Status status = WriteWholeFile(files.flo, [&](std::ostream& out) { WriteFlo(field, out); });
      !status) {
    return status;
  }
  if (Status status = WriteArrays(files.npz, field, AsField(vertex_spread_px, field), workers);
      !status) {
    return status;
  }
  return WriteColors(files.picture, field, workers);
}

}  // namespace rsstab::images
