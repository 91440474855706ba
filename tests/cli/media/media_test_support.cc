// SPDX-License-Identifier: Apache-2.0
#include "tests/cli/media/media_test_support.h"

#include <spdlog/sinks/base_sink.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <mutex>
#include <stdexcept>

namespace rsstab::media::testing {
namespace {

class WarningSink : public spdlog::sinks::base_sink<std::mutex> {
 public:
  explicit WarningSink(std::shared_ptr<std::vector<std::string>> texts)
      : texts_(std::move(texts)) {}

 protected:
  void sink_it_(const spdlog::details::log_msg& message) override {
    if (message.level == spdlog::level::warn) {
      texts_->emplace_back(message.payload.begin(), message.payload.end());
    }
  }
  void flush_() override {}

 private:
  std::shared_ptr<std::vector<std::string>> texts_;
};

int Sample(const PlaneView& plane, bool wide, int row, int index) {
  const std::uint8_t* line = plane.data + plane.stride * row;
  if (!wide) {
    return line[index];
  }
  std::uint16_t value = 0;
  std::memcpy(&value, line + 2 * index, sizeof(value));
  return value;
}

// Calls f(sample of a, sample of b) for every sample.
template <typename F>
void ForSamples(const Frame& a, const Frame& b, const F& f) {
  if (!(a.layout == b.layout) || a.width != b.width || a.height != b.height) {
    throw std::runtime_error("frames differ in layout or size");
  }
  const FrameView view_a = a.View();
  const FrameView view_b = b.View();
  const bool wide = a.layout.bit_depth > 8;
  for (int p = 0; p < a.layout.num_planes; ++p) {
    const auto index = static_cast<std::size_t>(p);
    const int columns = view_a.planes[index].width * a.layout.channels[index];
    for (int y = 0; y < view_a.planes[index].height; ++y) {
      for (int x = 0; x < columns; ++x) {
        f(Sample(view_a.planes[index], wide, y, x), Sample(view_b.planes[index], wide, y, x));
      }
    }
  }
}

}  // namespace

Frame TestPicture(const PixelLayout& layout, int width, int height, int index) {
  Frame frame = AllocateFrame(layout, width, height).value();
  const int scale = 1 << (layout.bit_depth - 8);
  for (int p = 0; p < layout.num_planes; ++p) {
    const auto number = static_cast<std::size_t>(p);
    MutablePlaneView& plane = frame.planes[number];
    const int channels = layout.channels[number];
    for (int y = 0; y < plane.height; ++y) {
      std::uint8_t* line = plane.data + plane.stride * y;
      for (int x = 0; x < plane.width; ++x) {
        for (int c = 0; c < channels; ++c) {
          const bool in_square = x >= 2 * index && x < 2 * index + 8 && y >= 4 && y < 12;
          const int base = 40 + 20 * p + 15 * c + (100 * x) / plane.width + (40 * y) / plane.height;
          const int value = (in_square ? 200 - 10 * p : base) * scale;
          const int i = x * channels + c;
          if (layout.bit_depth > 8) {
            const auto wide = static_cast<std::uint16_t>(value);
            std::memcpy(line + 2 * i, &wide, sizeof(wide));
          } else {
            line[i] = static_cast<std::uint8_t>(value);
          }
        }
      }
    }
  }
  return frame;
}

PixelLayout PlanarYuv(int bit_depth, int shift_x, int shift_y) {
  PixelLayout layout = Yuv420Layout(bit_depth);
  layout.chroma_shift_x = shift_x;
  layout.chroma_shift_y = shift_y;
  layout.chroma_offset_x = 0.0;
  layout.chroma_offset_y = ((1 << shift_y) - 1) / 2.0;
  return layout;
}

int LargestDifference(const Frame& a, const Frame& b) {
  int largest = 0;
  ForSamples(a, b, [&largest](int x, int y) { largest = std::max(largest, std::abs(x - y)); });
  return largest;
}

double Psnr(const Frame& a, const Frame& b) {
  double sum = 0.0;
  double count = 0.0;
  ForSamples(a, b, [&](int x, int y) {
    sum += static_cast<double>(x - y) * static_cast<double>(x - y);
    count += 1.0;
  });
  const double peak = static_cast<double>((1 << a.layout.bit_depth) - 1);
  return sum == 0.0 ? 200.0 : 10.0 * std::log10(peak * peak * count / sum);
}

ClipRecipe SmallRecipe() {
  ClipRecipe recipe;
  recipe.description.width = 96;
  recipe.description.height = 72;
  recipe.description.layout = Yuv420Layout();
  recipe.options.preset = "ultrafast";
  recipe.options.num_threads = 1;
  return recipe;
}

Status MakeClip(const std::filesystem::path& path, const ClipRecipe& recipe) {
  Result<std::unique_ptr<VideoWriter>> writer =
      VideoWriter::Create(path.string(), recipe.description, recipe.options);
  if (!writer) {
    return Propagate(writer.error());
  }
  for (int i = 0; i < recipe.frames; ++i) {
    const VideoDescription& clip = recipe.description;
    VideoFrame frame;
    frame.frame = TestPicture(clip.layout, clip.width, clip.height, i);
    frame.index = i;
    frame.pts = recipe.times.empty() ? 0 : recipe.times.at(static_cast<std::size_t>(i));
    const Status written =
        recipe.times.empty() ? (*writer)->Write(frame.frame) : (*writer)->Write(frame);
    if (!written) {
      return written;
    }
  }
  return (*writer)->Finish();
}

std::vector<std::int64_t> Clip::Times() const {
  std::vector<std::int64_t> times;
  for (const VideoFrame& frame : frames) {
    times.push_back(frame.pts);
  }
  return times;
}

Result<Clip> ReadClip(const std::filesystem::path& path, const Logger& logger) {
  Result<std::unique_ptr<VideoReader>> reader = VideoReader::Open(path.string(), {1, logger});
  if (!reader) {
    return Propagate(reader.error());
  }
  Clip clip{(*reader)->info(), {}};
  while (true) {
    Result<std::optional<VideoFrame>> frame = (*reader)->Read();
    if (!frame) {
      return Propagate(frame.error());
    }
    if (!*frame) {
      return clip;
    }
    clip.frames.push_back(std::move(**frame));
  }
}

Result<std::int64_t> CopyClip(const std::filesystem::path& source,
                              const std::filesystem::path& target, const WriterOptions& options) {
  Result<std::unique_ptr<VideoReader>> reader =
      VideoReader::Open(source.string(), {1, options.logger});
  if (!reader) {
    return Propagate(reader.error());
  }
  Result<std::unique_ptr<VideoWriter>> writer =
      VideoWriter::Open(target.string(), **reader, options);
  if (!writer) {
    return Propagate(writer.error());
  }
  while (true) {
    Result<std::optional<VideoFrame>> frame = (*reader)->Read();
    if (!frame) {
      return Propagate(frame.error());
    }
    if (!*frame) {
      break;
    }
    if (Status written = (*writer)->Write((*frame)->frame); !written) {
      return Propagate(written.error());
    }
  }
  if (Status finished = (*writer)->Finish(); !finished) {
    return Propagate(finished.error());
  }
  return (*writer)->frames_written();
}

Warnings CollectWarnings() {
  auto texts = std::make_shared<std::vector<std::string>>();
  return {std::make_shared<spdlog::logger>("test", std::make_shared<WarningSink>(texts)), texts};
}

std::vector<std::string> FilesIn(const std::filesystem::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    names.push_back(entry.path().filename().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace rsstab::media::testing
