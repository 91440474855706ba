// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/analysis_file.h"

#include <zlib.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <span>

#include "stabilizer/byte_stream.h"

namespace rsstab::stabilizer {
namespace {

constexpr std::array<char, 8> kMagic = {'R', 'S', 'S', 'T', 'A', 'B', 'A', 'N'};
constexpr std::array<char, 8> kEndMagic = {'R', 'S', 'S', 'T', 'A', 'B', 'E', 'N'};
constexpr std::uint32_t kVersion = 1;
constexpr std::size_t kHeaderSize = kMagic.size() + sizeof(std::uint32_t);
// summary offset, summary size, summary CRC, number of records, CRC of the footer so far, end magic
constexpr std::size_t kFooterSize = 8 + 8 + 4 + 8 + 4 + kEndMagic.size();
// Limits a damaged length field cannot exceed.
constexpr std::uint32_t kMaxRecordSize = 1U << 22;
constexpr std::uint64_t kMaxSummarySize = 1U << 20;
constexpr int kMaxGridSide = 512;
constexpr float kQuantizationSteps = 32767.0F;

struct FileCloser {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using FileHandle = std::unique_ptr<std::FILE, FileCloser>;

std::uint32_t Checksum(std::span<const std::uint8_t> bytes) {
  return static_cast<std::uint32_t>(
      crc32(crc32(0L, Z_NULL, 0), bytes.data(), static_cast<uInt>(bytes.size())));
}

std::string LastError() { return std::strerror(errno); }

// Linear enlargement of the picture's middle: output px a rectified px becomes, inverted.
double ZoomRatio(const Eigen::Matrix3d& rectified_from_output) {
  const double area = rectified_from_output.topLeftCorner<2, 2>().determinant();
  return std::sqrt(std::abs(area)) / std::abs(rectified_from_output(2, 2));
}

void PutField(ByteSink& sink, const MotionField& field) {
  sink.Put(static_cast<std::uint16_t>(field.columns()));
  sink.Put(static_cast<std::uint16_t>(field.rows()));
  if (field.columns() == 0) {
    return;
  }
  float largest = 0.0F;
  for (const Eigen::Vector2f& d : field.vertices()) {
    largest = std::max(largest, d.cwiseAbs().maxCoeff());
  }
  const float step = largest > 0.0F ? largest / kQuantizationSteps : 1.0F;
  sink.Put(step);
  sink.Put(static_cast<float>(field.reference_row()));
  for (const Eigen::Vector2f& d : field.vertices()) {
    sink.Put(static_cast<std::int16_t>(std::lround(d.x() / step)));
    sink.Put(static_cast<std::int16_t>(std::lround(d.y() / step)));
  }
}

// Empty when the bytes make no sense.
std::optional<MotionField> GetField(ByteSource& source, int width, int height) {
  const int columns = source.Get<std::uint16_t>();
  const int rows = source.Get<std::uint16_t>();
  if (columns == 0 && rows == 0) {
    return MotionField();
  }
  if (columns < 2 || rows < 2 || columns > kMaxGridSide || rows > kMaxGridSide) {
    return std::nullopt;
  }
  const auto step = source.Get<float>();
  const auto reference_row = source.Get<float>();
  const std::size_t needed = static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows) * 4;
  if (!std::isfinite(step) || !std::isfinite(reference_row) || source.remaining() < needed) {
    return std::nullopt;
  }
  MotionField field(width, height, columns, rows);
  field.set_reference_row(static_cast<double>(reference_row));
  for (Eigen::Vector2f& d : field.vertices()) {
    const float x = static_cast<float>(source.Get<std::int16_t>()) * step;
    const float y = static_cast<float>(source.Get<std::int16_t>()) * step;
    d = {x, y};
  }
  return field;
}

nlohmann::json ToJson(const ClipAnalysis& clip) {
  nlohmann::json json = {{"program_version", clip.program_version},
                         {"width", clip.width},
                         {"height", clip.height},
                         {"frames_per_second", clip.frames_per_second},
                         {"num_frames", clip.num_frames},
                         {"smallest_crop_ratio", clip.smallest_crop_ratio},
                         {"fixed_zoom", clip.fixed_zoom},
                         {"smallest_kept_ratio", clip.smallest_kept_ratio},
                         {"mean_kept_ratio", clip.mean_kept_ratio},
                         {"rs_source", clip.rs_source},
                         {"rs_reason", clip.rs_reason},
                         {"readout_s", clip.readout_s},
                         {"options", clip.options}};
  if (clip.gyro_offset_s) {
    json["gyro_offset_s"] = *clip.gyro_offset_s;
  }
  if (clip.camera) {
    const Camera& c = *clip.camera;
    json["camera"] = {{"fx", c.fx},
                      {"fy", c.fy},
                      {"cx", c.cx},
                      {"cy", c.cy},
                      {"model", static_cast<int>(c.model)},
                      {"distortion", c.distortion}};
  }
  return json;
}

// Throws nlohmann::json::exception on a missing key or a wrong type; caught by Open().
ClipAnalysis FromJson(const nlohmann::json& json) {
  ClipAnalysis clip;
  clip.program_version = json.at("program_version").get<std::string>();
  clip.width = json.at("width").get<int>();
  clip.height = json.at("height").get<int>();
  clip.frames_per_second = json.at("frames_per_second").get<double>();
  clip.num_frames = json.at("num_frames").get<std::int64_t>();
  clip.smallest_crop_ratio = json.at("smallest_crop_ratio").get<double>();
  clip.fixed_zoom = json.at("fixed_zoom").get<bool>();
  clip.smallest_kept_ratio = json.at("smallest_kept_ratio").get<double>();
  clip.mean_kept_ratio = json.at("mean_kept_ratio").get<double>();
  clip.rs_source = json.at("rs_source").get<std::string>();
  clip.rs_reason = json.at("rs_reason").get<std::string>();
  clip.readout_s = json.at("readout_s").get<double>();
  clip.options = json.at("options").get<std::string>();
  if (json.contains("gyro_offset_s")) {
    clip.gyro_offset_s = json.at("gyro_offset_s").get<double>();
  }
  if (json.contains("camera")) {
    const auto& c = json.at("camera");
    Camera camera;
    camera.width = clip.width;
    camera.height = clip.height;
    camera.fx = c.at("fx").get<double>();
    camera.fy = c.at("fy").get<double>();
    camera.cx = c.at("cx").get<double>();
    camera.cy = c.at("cy").get<double>();
    camera.model = static_cast<LensModel>(std::clamp(c.at("model").get<int>(), 0, 2));
    camera.distortion = c.at("distortion").get<std::vector<double>>();
    clip.camera = camera;
  }
  return clip;
}

}  // namespace

struct AnalysisWriter::Impl {
  std::string path;
  std::string partial_path;
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

AnalysisWriter::~AnalysisWriter() {
  if (impl_->file) {
    impl_->file.reset();
    std::error_code ignored;
    std::filesystem::remove(impl_->partial_path, ignored);
  }
}

Result<std::unique_ptr<AnalysisWriter>> AnalysisWriter::Create(const std::string& path) {
  auto impl = std::make_unique<Impl>();
  impl->path = path;
  impl->partial_path = path + ".part";
  impl->file.reset(std::fopen(impl->partial_path.c_str(), "wb"));
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
    const std::string cause = LastError();
    std::error_code ignored;
    std::filesystem::remove(impl_->partial_path, ignored);
    return Fail(ErrorCode::kIo, "writing the analysis file {} failed: {}", impl_->path, cause);
  }
  std::error_code error;
  std::filesystem::rename(impl_->partial_path, impl_->path, error);
  if (error) {
    std::error_code ignored;
    std::filesystem::remove(impl_->partial_path, ignored);
    return Fail(ErrorCode::kIo, "cannot name the analysis file {}: {}", impl_->path,
                error.message());
  }
  return clip;
}

struct AnalysisReader::Impl {
  std::string path;
  FileHandle file;
  ClipAnalysis clip;
  std::int64_t next_record = 0;
  std::uint64_t summary_offset = 0;
  std::uint64_t offset = kHeaderSize;
  std::vector<std::uint8_t> buffer;

  [[nodiscard]] tl::unexpected<Error> Damaged(const std::string& what) const {
    return Fail(ErrorCode::kCorruptData,
                "{} is a damaged analysis file ({}, byte {}): run `rs-stabilize analyze` again",
                path, what, offset);
  }

  // Reads exactly `size` bytes into `buffer`.
  bool Fill(std::size_t size) {
    buffer.resize(size);
    return std::fread(buffer.data(), 1, size, file.get()) == size;
  }
};

AnalysisReader::AnalysisReader(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
AnalysisReader::~AnalysisReader() = default;

Result<std::unique_ptr<AnalysisReader>> AnalysisReader::Open(const std::string& path) {
  auto impl = std::make_unique<Impl>();
  Impl& s = *impl;
  s.path = path;
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) {
    return Fail(ErrorCode::kNotFound, "no analysis file {}: make one with `rs-stabilize analyze`",
                path);
  }
  s.file.reset(std::fopen(path.c_str(), "rb"));
  if (!s.file) {
    return Fail(ErrorCode::kIo, "cannot open the analysis file {}: {}", path, LastError());
  }
  if (!s.Fill(kHeaderSize) || std::memcmp(s.buffer.data(), kMagic.data(), kMagic.size()) != 0) {
    return Fail(ErrorCode::kCorruptData,
                "{} is not an analysis file: make one with `rs-stabilize analyze`", path);
  }
  std::uint32_t version = 0;
  std::memcpy(&version, s.buffer.data() + kMagic.size(), sizeof version);
  if (version != kVersion) {
    return Fail(
        ErrorCode::kUnsupported,
        "{} has analysis format {}, this program reads {}: run `rs-stabilize analyze` again", path,
        version, kVersion);
  }
  if (std::fseek(s.file.get(), -static_cast<long>(kFooterSize), SEEK_END) != 0 ||
      !s.Fill(kFooterSize) ||
      std::memcmp(s.buffer.data() + kFooterSize - kEndMagic.size(), kEndMagic.data(),
                  kEndMagic.size()) != 0) {
    return s.Damaged("its end is missing");
  }
  ByteSource footer(s.buffer);
  const auto summary_offset = footer.Get<std::uint64_t>();
  const auto summary_size = footer.Get<std::uint64_t>();
  const auto summary_checksum = footer.Get<std::uint32_t>();
  const auto num_frames = footer.Get<std::uint64_t>();
  const auto footer_checksum = footer.Get<std::uint32_t>();
  if (footer_checksum != Checksum(std::span(s.buffer).first(kFooterSize - 4 - kEndMagic.size())) ||
      summary_size > kMaxSummarySize || summary_offset > (1ULL << 60)) {
    return s.Damaged("its footer does not add up");
  }
  if (std::fseek(s.file.get(), static_cast<long>(summary_offset), SEEK_SET) != 0 ||
      !s.Fill(summary_size) || Checksum(s.buffer) != summary_checksum) {
    return s.Damaged("its summary does not add up");
  }
  try {
    s.clip = FromJson(nlohmann::json::parse(s.buffer.begin(), s.buffer.end()));
  } catch (const nlohmann::json::exception& e) {
    return s.Damaged(e.what());
  }
  const bool sizes_fit =
      s.clip.width >= 1 && s.clip.height >= 1 && s.clip.width <= 65535 && s.clip.height <= 65535;
  if (!sizes_fit || static_cast<std::uint64_t>(s.clip.num_frames) != num_frames ||
      (s.clip.camera && !s.clip.camera->Validate())) {
    return s.Damaged("its summary makes no sense");
  }
  s.summary_offset = summary_offset;
  if (std::fseek(s.file.get(), static_cast<long>(kHeaderSize), SEEK_SET) != 0) {
    return s.Damaged("it cannot be rewound");
  }
  return std::unique_ptr<AnalysisReader>(new AnalysisReader(std::move(impl)));
}

const ClipAnalysis& AnalysisReader::clip() const { return impl_->clip; }

Result<std::optional<FrameAnalysis>> AnalysisReader::Next() {
  Impl& s = *impl_;
  if (s.next_record >= s.clip.num_frames) {
    return std::nullopt;
  }
  if (!s.Fill(8)) {
    return s.Damaged("a record is cut off");
  }
  ByteSource prefix(s.buffer);
  const auto size = prefix.Get<std::uint32_t>();
  const auto checksum = prefix.Get<std::uint32_t>();
  if (size > kMaxRecordSize || s.offset + 8 + size > s.summary_offset) {
    return s.Damaged("a record is too long");
  }
  if (!s.Fill(size) || Checksum(s.buffer) != checksum) {
    return s.Damaged("the checksum of a record differs");
  }
  ByteSource body(s.buffer);
  FrameAnalysis frame;
  frame.pts = body.Get<std::int64_t>();
  for (std::uint8_t& level : frame.fingerprint) {
    level = body.Get<std::uint8_t>();
  }
  frame.rung = static_cast<MotionRung>(std::min<int>(body.Get<std::uint8_t>(), 3));
  frame.path_begins = body.Get<std::uint8_t>() != 0;
  frame.crop_ratio = static_cast<double>(body.Get<float>());
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) {
      frame.rectified_from_output(r, c) = body.Get<double>();
    }
  }
  auto mesh_update = GetField(body, s.clip.width, s.clip.height);
  auto rs_field = mesh_update ? GetField(body, s.clip.width, s.clip.height) : std::nullopt;
  if (!rs_field || !body.ok() || !frame.rectified_from_output.allFinite() ||
      !(frame.crop_ratio > 0.0 && frame.crop_ratio <= 1.0)) {
    return s.Damaged("a record makes no sense");
  }
  frame.mesh_update = std::move(*mesh_update);
  frame.rs_field = std::move(*rs_field);
  s.offset += 8 + size;
  ++s.next_record;
  return frame;
}

}  // namespace rsstab::stabilizer
