// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <utility>

#include "stabilizer/analysis_file.h"
#include "stabilizer/analysis_format_detail.h"

namespace rsstab::stabilizer {
namespace {

using namespace detail;

// Limits a damaged length field cannot exceed.
constexpr std::uint32_t kMaxRecordSize = 1U << 22;
constexpr std::uint64_t kMaxSummarySize = 1U << 20;
constexpr std::uint64_t kMaxFileSize = 1ULL << 60;
constexpr std::size_t kPrefixSize = 8;  // of a record: size, CRC
constexpr std::size_t kKeySize = 8 + sizeof(LumaFingerprint);

struct RecordPrefix {
  std::uint32_t size = 0;
  std::uint32_t checksum = 0;
};

}  // namespace

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

  bool SeekTo(std::uint64_t position) {
    offset = position;
    return position <= kMaxFileSize &&
           std::fseek(file.get(), static_cast<long>(position), SEEK_SET) == 0;
  }

  // Size and checksum of the record at `offset`, where the file stands.
  Result<RecordPrefix> ReadPrefix() {
    if (!Fill(kPrefixSize)) {
      return Damaged("a record is cut off");
    }
    ByteSource source(buffer);
    RecordPrefix prefix;
    prefix.size = source.Get<std::uint32_t>();
    prefix.checksum = source.Get<std::uint32_t>();
    if (prefix.size > kMaxRecordSize || offset + kPrefixSize + prefix.size > summary_offset) {
      return Damaged("a record is too long");
    }
    return prefix;
  }

  Result<FrameAnalysis> ReadRecord();
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
    s.offset = std::filesystem::file_size(path, error);  // where the rest should have begun
    return s.Damaged("its end is missing");
  }
  ByteSource footer(s.buffer);
  const auto summary_offset = footer.Get<std::uint64_t>();
  const auto summary_size = footer.Get<std::uint64_t>();
  const auto summary_checksum = footer.Get<std::uint32_t>();
  const auto num_frames = footer.Get<std::uint64_t>();
  const auto footer_checksum = footer.Get<std::uint32_t>();
  if (footer_checksum != Checksum(std::span(s.buffer).first(kFooterSize - 4 - kEndMagic.size())) ||
      summary_size > kMaxSummarySize || summary_offset > kMaxFileSize) {
    return s.Damaged("its footer does not add up");
  }
  if (!s.SeekTo(summary_offset) || !s.Fill(summary_size) ||
      Checksum(s.buffer) != summary_checksum) {
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
  if (!s.SeekTo(kHeaderSize)) {
    return s.Damaged("it cannot be rewound");
  }
  return std::unique_ptr<AnalysisReader>(new AnalysisReader(std::move(impl)));
}

const ClipAnalysis& AnalysisReader::clip() const { return impl_->clip; }

Result<FrameAnalysis> AnalysisReader::Impl::ReadRecord() {
  const auto prefix = ReadPrefix();
  if (!prefix) {
    return Propagate(prefix.error());
  }
  if (!Fill(prefix->size) || Checksum(buffer) != prefix->checksum) {
    return Damaged("the checksum of a record differs");
  }
  ByteSource body(buffer);
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
  auto mesh_update = GetField(body, clip.width, clip.height);
  auto rs_field = mesh_update ? GetField(body, clip.width, clip.height) : std::nullopt;
  if (!rs_field || !body.ok() || !GetOptionalParts(body, frame) ||
      !frame.rectified_from_output.allFinite() ||
      !(frame.crop_ratio > 0.0 && frame.crop_ratio <= 1.0)) {
    return Damaged("a record makes no sense");
  }
  frame.mesh_update = std::move(*mesh_update);
  frame.rs_field = std::move(*rs_field);
  offset += kPrefixSize + prefix->size;
  return frame;
}

Result<std::optional<FrameAnalysis>> AnalysisReader::Next() {
  Impl& s = *impl_;
  if (s.next_record >= s.clip.num_frames) {
    return std::nullopt;
  }
  auto frame = s.ReadRecord();
  if (!frame) {
    return Propagate(std::move(frame.error()));
  }
  ++s.next_record;
  return std::move(*frame);
}

Result<std::vector<RecordKey>> AnalysisReader::ReadKeys() {
  Impl& s = *impl_;
  std::vector<RecordKey> keys;
  std::uint64_t position = kHeaderSize;
  for (std::int64_t i = 0; i < s.clip.num_frames; ++i) {
    if (!s.SeekTo(position)) {
      return s.Damaged("a record cannot be reached");
    }
    const auto prefix = s.ReadPrefix();
    if (!prefix) {
      return Propagate(prefix.error());
    }
    if (prefix->size < kKeySize || !s.Fill(kKeySize)) {
      return s.Damaged("a record is too short");
    }
    ByteSource body(s.buffer);
    RecordKey& key = keys.emplace_back();
    key.pts = body.Get<std::int64_t>();
    key.offset = position;
    for (std::uint8_t& level : key.fingerprint) {
      level = body.Get<std::uint8_t>();
    }
    position += kPrefixSize + prefix->size;
  }
  s.next_record = 0;
  if (!s.SeekTo(kHeaderSize)) {
    return s.Damaged("it cannot be rewound");
  }
  return keys;
}

Result<FrameAnalysis> AnalysisReader::ReadAt(const std::vector<RecordKey>& keys,
                                             std::size_t index) {
  Impl& s = *impl_;
  const RecordKey& key = keys[index];
  if (!s.SeekTo(key.offset)) {
    return s.Damaged("a record cannot be reached");
  }
  auto frame = s.ReadRecord();
  if (frame && (frame->pts != key.pts || frame->fingerprint != key.fingerprint)) {
    s.offset = key.offset;
    return s.Damaged("a record changed while the file was in use");
  }
  s.next_record = static_cast<std::int64_t>(index) + 1;
  return frame;
}

}  // namespace rsstab::stabilizer
