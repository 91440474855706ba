// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/pipeline/track_spool.h"

#include <stdlib.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <string>
#include <system_error>
#include <vector>

namespace rsstab::pipeline {
namespace {

struct FileCloser {
  void operator()(std::FILE* file) const { std::fclose(file); }
};

// Fixed-size part of a record; the matches follow. Never leaves this process, so its layout may be
// the compiler's.
struct RecordHead {
  std::int64_t pts;
  double time_s;
  double from_time_s;
  double to_time_s;
  std::int32_t width;
  std::int32_t height;
  std::int32_t attempted_points;
  std::uint32_t num_matches;
  stabilizer::LumaFingerprint fingerprint;
};
using MatchRecord = std::array<float, 4>;

}  // namespace

struct TrackSpool::Impl {
  std::unique_ptr<std::FILE, FileCloser> file;
  std::int64_t count = 0;
  std::int64_t next = 0;
  std::vector<MatchRecord> matches;
};

TrackSpool::TrackSpool(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
TrackSpool::~TrackSpool() = default;

Result<std::unique_ptr<TrackSpool>> TrackSpool::Create() {
  // Not std::tmpfile(): it does not look at TMPDIR.
  std::error_code error;
  std::string path = std::filesystem::temp_directory_path(error) / "rs-stabilize-tracks-XXXXXX";
  if (error) {
    return Fail(ErrorCode::kIo, "there is no folder for temporary files ({}); set TMPDIR to one",
                error.message());
  }
  auto impl = std::make_unique<Impl>();
  const int descriptor = mkstemp(path.data());
  if (descriptor >= 0) {
    unlink(path.c_str());  // lives on, without a name, until it is closed
    impl->file.reset(fdopen(descriptor, "w+b"));
    if (!impl->file) {
      close(descriptor);
    }
  }
  if (!impl->file) {
    return Fail(ErrorCode::kIo, "cannot create the temporary file {}: {}; set TMPDIR", path,
                std::strerror(errno));
  }
  return std::unique_ptr<TrackSpool>(new TrackSpool(std::move(impl)));
}

Status TrackSpool::Append(const FrameObservation& o) {
  const RecordHead head = {o.pts,
                           o.time_s,
                           o.tracks.from_time_s,
                           o.tracks.to_time_s,
                           o.tracks.width,
                           o.tracks.height,
                           o.attempted_points,
                           static_cast<std::uint32_t>(o.tracks.matches.size()),
                           o.fingerprint};
  impl_->matches.clear();
  for (const PointMatch& m : o.tracks.matches) {
    impl_->matches.push_back({m.from.x(), m.from.y(), m.to.x(), m.to.y()});
  }
  const std::size_t n = impl_->matches.size();
  // Without matches there is no array: C's functions must not see its null pointer.
  if (std::fwrite(&head, sizeof head, 1, impl_->file.get()) != 1 ||
      (n > 0 &&
       std::fwrite(impl_->matches.data(), sizeof(MatchRecord), n, impl_->file.get()) != n)) {
    return Fail(ErrorCode::kIo,
                "writing the temporary track file failed: {}; set TMPDIR to a "
                "folder with more room",
                std::strerror(errno));
  }
  ++impl_->count;
  return {};
}

Status TrackSpool::Rewind() {
  if (std::fflush(impl_->file.get()) != 0 || std::fseek(impl_->file.get(), 0, SEEK_SET) != 0) {
    return Fail(ErrorCode::kIo, "rewinding the temporary track file failed: {}",
                std::strerror(errno));
  }
  impl_->next = 0;
  return {};
}

Result<std::optional<FrameObservation>> TrackSpool::Next() {
  if (impl_->next >= impl_->count) {
    return std::nullopt;
  }
  RecordHead head{};
  if (std::fread(&head, sizeof head, 1, impl_->file.get()) != 1) {
    return Fail(ErrorCode::kIo, "reading the temporary track file failed at frame {}", impl_->next);
  }
  impl_->matches.resize(head.num_matches);
  if (head.num_matches > 0 && std::fread(impl_->matches.data(), sizeof(MatchRecord),
                                         head.num_matches, impl_->file.get()) != head.num_matches) {
    return Fail(ErrorCode::kIo, "reading the temporary track file failed at frame {}", impl_->next);
  }
  FrameObservation o;
  o.pts = head.pts;
  o.time_s = head.time_s;
  o.fingerprint = head.fingerprint;
  o.attempted_points = head.attempted_points;
  o.tracks.width = head.width;
  o.tracks.height = head.height;
  o.tracks.from_time_s = head.from_time_s;
  o.tracks.to_time_s = head.to_time_s;
  o.tracks.matches.reserve(head.num_matches);
  for (const MatchRecord& m : impl_->matches) {
    o.tracks.matches.push_back({{m[0], m[1]}, {m[2], m[3]}});
  }
  ++impl_->next;
  return o;
}

std::int64_t TrackSpool::count() const { return impl_->count; }

}  // namespace rsstab::pipeline
