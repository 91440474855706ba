// SPDX-License-Identifier: Apache-2.0
// Any bytes as an analysis file, in a host that renders by it: never a crash, a hang or an
// undefined operation. Checksums would stop most inputs at the door, so each one is tried as it is
// and with its checksums put right.
#include <sys/mman.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <vector>

#include "stabilizer/analysis_file.h"
#include "stabilizer/pipeline/timed_renderer.h"

namespace {

using namespace rsstab;

constexpr std::size_t kHeader = 12;
constexpr std::size_t kFooter = 40;
constexpr int kMaxSide = 96;  // larger pictures cost time and show nothing new
constexpr int kMaxRecords = 64;

std::uint32_t Crc(std::span<const std::uint8_t> bytes) {
  return static_cast<std::uint32_t>(
      crc32(crc32(0L, Z_NULL, 0), bytes.data(), static_cast<uInt>(bytes.size())));
}

template <typename T>
T Get(const std::vector<std::uint8_t>& bytes, std::size_t at) {
  T value{};
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

void Put(std::vector<std::uint8_t>& bytes, std::size_t at, std::uint32_t value) {
  std::memcpy(bytes.data() + at, &value, sizeof value);
}

// docs/analysis-file.md tells where they are.
void PutChecksumsRight(std::vector<std::uint8_t>& bytes) {
  if (bytes.size() < kHeader + kFooter) {
    return;
  }
  const std::size_t footer = bytes.size() - kFooter;
  const auto summary = Get<std::uint64_t>(bytes, footer);
  const auto summary_size = Get<std::uint64_t>(bytes, footer + 8);
  if (summary <= footer && summary_size <= footer - summary) {
    Put(bytes, footer + 16, Crc(std::span(bytes).subspan(summary, summary_size)));
  }
  Put(bytes, footer + 28, Crc(std::span(bytes).subspan(footer, 28)));
  for (std::size_t at = kHeader; at + 8 <= footer;) {
    const auto size = Get<std::uint32_t>(bytes, at);
    if (size > footer - at - 8) {
      break;
    }
    Put(bytes, at + 4, Crc(std::span(bytes).subspan(at + 8, size)));
    at += 8 + size;
  }
}

// A file in memory, and its name.
class MemoryFile {
 public:
  explicit MemoryFile(std::span<const std::uint8_t> bytes) : file_(memfd_create("analysis", 0)) {
    if (write(file_, bytes.data(), bytes.size()) != static_cast<ssize_t>(bytes.size())) {
      std::abort();
    }
    path_ = "/proc/self/fd/" + std::to_string(file_);
  }
  ~MemoryFile() { close(file_); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;
  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  int file_;
  std::string path_;
};

void Use(std::span<const std::uint8_t> bytes) {
  const MemoryFile file(bytes);
  const auto reader = stabilizer::AnalysisReader::Open(file.path());
  if (!reader) {
    return;
  }
  for (int i = 0; i < kMaxRecords; ++i) {
    const auto record = (*reader)->Next();
    if (!record || !*record) {
      break;
    }
  }
  const int width = (*reader)->clip().width;
  const int height = (*reader)->clip().height;
  if (width > kMaxSide || height > kMaxSide) {
    return;
  }
  pipeline::StabilizeOptions options;
  options.num_threads = 1;
  const auto renderer =
      pipeline::TimedRenderer::Create(options, file.path(), width, height, SilentLogger());
  auto picture = AllocateFrame(GrayLayout(), width, height);
  auto output = AllocateFrame(GrayLayout(), width, height);
  if (!renderer || !picture || !output) {
    return;
  }
  const MutablePlaneView& plane = picture->planes[0];
  for (int y = 0; y < height; ++y) {
    std::fill_n(plane.data + y * plane.stride, width, static_cast<std::uint8_t>(40 + 2 * y));
  }
  for (const double time_s : {0.0, 0.04, -1.0, 0.2, 1e9}) {
    static_cast<void>((*renderer)->Render(picture->View(), time_s, *output));
  }
  if (const auto time_s = (*renderer)->TimeOf(1)) {
    static_cast<void>((*renderer)->Render(picture->View(), *time_s, *output));
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::vector<std::uint8_t> bytes(data, data + size);
  Use(bytes);
  PutChecksumsRight(bytes);
  Use(bytes);
  return 0;
}
