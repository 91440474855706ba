// SPDX-License-Identifier: Apache-2.0
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "igf/base/staged_file.h"
#include "stabilizer/analysis_file.h"
#include "stabilizer/analysis_format_detail.h"

namespace rsstab::stabilizer {
namespace {

using namespace detail;

// Linear enlargement of the picture's middle: output px a rectified px becomes, inverted.
double ZoomRatio(const Eigen::Matrix3d& rectified_from_output) {
  const double area = rectified_from_output.topLeftCorner<2, 2>().determinant();
  return std::sqrt(std::abs(area)) / std::abs(rectified_from_output(2, 2));
}

}  // namespace

double KeptRatio(const FrameAnalysis& frame, const ClipAnalysis& clip) {
  return ZoomRatio(frame.rectified_from_output) *
         (clip.fixed_zoom ? clip.smallest_crop_ratio : frame.crop_ratio);
}

struct AnalysisWriter::Impl {
  Impl(std::string name, StagedFile file_to_be)
      : path(std::move(name)), staged(std::move(file_to_be)) {}

  std::string path;
  StagedFile staged;
  FileHandle file;
  std::int64_t num_frames = 0;
  double smallest_crop_ratio = 1.0;
  double smallest_zoom_ratio = 1.0;  // of the path updates alone
  double sum_zoom_ratio = 0.0;
  double smallest_kept_ratio = 1.0;
  double sum_kept_ratio = 0.0;
  std::uint64_t offset = 0;

  void Count(const FrameAnalysis& frame) {
    ++num_frames;
    const double zoom_ratio = ZoomRatio(frame.rectified_from_output);
    const double kept_ratio = zoom_ratio * frame.crop_ratio;
    smallest_crop_ratio = std::min(smallest_crop_ratio, frame.crop_ratio);
    smallest_zoom_ratio = std::min(smallest_zoom_ratio, zoom_ratio);
    smallest_kept_ratio = std::min(smallest_kept_ratio, kept_ratio);
    sum_zoom_ratio += zoom_ratio;
    sum_kept_ratio += kept_ratio;
  }

  Status Write(std::span<const std::uint8_t> bytes) {
    if (std::fwrite(bytes.data(), 1, bytes.size(), file.get()) != bytes.size()) {
      return Fail(ErrorCode::kIo, "writing the analysis file {} failed: {}", path, LastError());
    }
    offset += bytes.size();
    return {};
  }
};

AnalysisWriter::AnalysisWriter(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}

AnalysisWriter::~AnalysisWriter() = default;

Result<std::unique_ptr<AnalysisWriter>> AnalysisWriter::Create(const std::string& path) {
  auto staged = StagedFile::Create(path);
  if (!staged) {
    return Propagate(std::move(staged.error()));
  }
  auto impl = std::make_unique<Impl>(path, std::move(*staged));
  impl->file.reset(std::fopen(impl->staged.current_path().c_str(), "wb"));
  if (!impl->file) {
    return Fail(ErrorCode::kIo, "cannot create the analysis file {}: {}", path, LastError());
  }
  std::unique_ptr<AnalysisWriter> writer(new AnalysisWriter(std::move(impl)));
  ByteSink header;
  header.Put(std::span(reinterpret_cast<const std::uint8_t*>(kMagic.data()), kMagic.size()));
  header.Put(kVersion);
  if (Status ok = writer->impl_->Write(header.bytes()); !ok) {
    return Propagate(std::move(ok.error()));
  }
  return writer;
}

Status AnalysisWriter::Append(const FrameAnalysis& frame) {
  ByteSink body;
  body.Put(frame.pts);
  body.Put(std::span<const std::uint8_t>(frame.fingerprint));
  body.Put(static_cast<std::uint8_t>(frame.rung));
  body.Put(static_cast<std::uint8_t>(frame.path_begins ? 1 : 0));
  body.Put(static_cast<float>(frame.crop_ratio));
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) {
      body.Put(frame.rectified_from_output(r, c));
    }
  }
  PutField(body, frame.mesh_update);
  PutField(body, frame.rs_field);
  PutOptionalParts(body, frame);
  ByteSink prefix;
  prefix.Put(static_cast<std::uint32_t>(body.bytes().size()));
  prefix.Put(Checksum(body.bytes()));
  if (Status ok = impl_->Write(prefix.bytes()); !ok) {
    return ok;
  }
  impl_->Count(frame);
  return impl_->Write(body.bytes());
}

Result<ClipAnalysis> AnalysisWriter::Finish(ClipAnalysis clip) {
  clip.num_frames = impl_->num_frames;
  clip.smallest_crop_ratio = impl_->smallest_crop_ratio;
  const auto frames = static_cast<double>(std::max<std::int64_t>(impl_->num_frames, 1));
  if (clip.fixed_zoom) {
    clip.smallest_kept_ratio = impl_->smallest_zoom_ratio * impl_->smallest_crop_ratio;
    clip.mean_kept_ratio = impl_->sum_zoom_ratio * impl_->smallest_crop_ratio / frames;
  } else {
    clip.smallest_kept_ratio = impl_->smallest_kept_ratio;
    clip.mean_kept_ratio = impl_->sum_kept_ratio / frames;
  }
  // Names and reasons may hold any bytes; JSON wants UTF-8.
  const std::string text =
      ToJson(clip).dump(1, ' ', false, nlohmann::json::error_handler_t::replace);
  const std::span summary(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
  ByteSink footer;
  footer.Put(impl_->offset);
  footer.Put(static_cast<std::uint64_t>(summary.size()));
  footer.Put(Checksum(summary));
  footer.Put(static_cast<std::uint64_t>(impl_->num_frames));
  footer.Put(Checksum(footer.bytes()));
  footer.Put(std::span(reinterpret_cast<const std::uint8_t*>(kEndMagic.data()), kEndMagic.size()));
  if (Status ok = impl_->Write(summary); !ok) {
    return Propagate(std::move(ok.error()));
  }
  if (Status ok = impl_->Write(footer.bytes()); !ok) {
    return Propagate(std::move(ok.error()));
  }
  if (std::fclose(impl_->file.release()) != 0) {
    return Fail(ErrorCode::kIo, "writing the analysis file {} failed: {}", impl_->path,
                LastError());
  }
  if (Status named = impl_->staged.Commit(true); !named) {
    return Propagate(std::move(named.error()));
  }
  return clip;
}

}  // namespace rsstab::stabilizer
