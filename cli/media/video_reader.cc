// SPDX-License-Identifier: Apache-2.0
#include "cli/media/video_reader.h"

extern "C" {
#include <libavutil/pixdesc.h>
}

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <deque>
#include <utility>

#include "cli/media/av_error.h"
#include "cli/media/clip_description.h"
#include "cli/media/frame_bridge.h"
#include "cli/media/frame_converter.h"
#include "cli/media/input_file.h"
#include "cli/media/source_access.h"
#include "cli/media/timestamp_repair.h"
#include "cli/media/video_decoder.h"

namespace rsstab::media {
namespace {

std::optional<std::int64_t> Stamp(std::int64_t value) {
  return value == AV_NOPTS_VALUE ? std::nullopt : std::optional(value);
}

// All timestamps of the video stream, without decoding.
Result<std::vector<TimestampPlan::Packet>> ScanTimestamps(AVFormatContext& input, int stream) {
  for (unsigned i = 0; i < input.nb_streams; ++i) {
    input.streams[i]->discard = static_cast<int>(i) == stream ? AVDISCARD_DEFAULT : AVDISCARD_ALL;
  }
  std::vector<TimestampPlan::Packet> packets;
  const AvPacketPtr packet(av_packet_alloc());
  if (packet == nullptr) {
    return AvFail(AVERROR(ENOMEM), "reading timestamps");
  }
  while (av_read_frame(&input, packet.get()) >= 0) {
    if (packet->stream_index == stream && (packet->flags & AV_PKT_FLAG_DISCARD) == 0) {
      packets.push_back({Stamp(packet->pts), Stamp(packet->dts)});
    }
    av_packet_unref(packet.get());
  }
  return packets;
}

}  // namespace

struct VideoReader::Impl {
  Logger logger;
  ClipDescription clip;
  std::unique_ptr<VideoDecoder> decoder;
  std::unique_ptr<TimestampRepair> repair;
  std::unique_ptr<FrameConverter> converter;
  AvFramePtr first_picture;  // decoded by Open()
  // Decoded, waiting for their times: at most kLookAhead + 1.
  std::deque<AvFramePtr> waiting;
  bool has_started = false;
  bool is_followed = false;  // a writer takes the other streams' packets
  bool is_finished = false;
  bool has_told_change = false;
  std::int64_t next_index = 0;

  Status OpenFile(const std::string& path, const ReaderOptions& options);
  Result<AvFramePtr> NextPicture();
  Result<AvFramePtr> Deliverable(AvFramePtr picture);
  Result<VideoFrame> MakeFrame(AvFramePtr picture, std::int64_t pts);
  void TellDamage() const;
};

Status VideoReader::Impl::OpenFile(const std::string& path, const ReaderOptions& options) {
  logger = options.logger != nullptr ? options.logger : SilentLogger();
  Result<AvInputPtr> input = OpenInput(path, &logger);
  if (!input) {
    return Propagate(input.error());
  }
  Result<int> stream = FindVideoStream(**input, path);
  if (!stream) {
    return Propagate(stream.error());
  }
  const AVRational time_base = (*input)->streams[*stream]->time_base;
  const double nominal_period =
      std::max(1.0, 1.0 / (GuessedRate(**input, *stream) * av_q2d(time_base)));

  // Scan, then open afresh: going back to the start is not exact in every container.
  TimestampPlan plan;
  const bool can_scan = IsRegularFile(path);
  if (can_scan) {
    Result<std::vector<TimestampPlan::Packet>> packets = ScanTimestamps(**input, *stream);
    if (!packets) {
      return Propagate(packets.error());
    }
    plan = TimestampPlan(*packets, nominal_period);
    input = OpenInput(path, &logger);
    if (!input) {
      return Propagate(input.error());
    }
  }
  Result<std::unique_ptr<VideoDecoder>> opened =
      VideoDecoder::Open(std::move(*input), *stream, options.num_threads, &logger, path);
  if (!opened) {
    return Propagate(opened.error());
  }
  decoder = std::move(*opened);
  Result<AvFramePtr> picture = decoder->Next();
  if (!picture) {
    return Propagate(picture.error());
  }
  if (*picture == nullptr) {
    return Fail(
        ErrorCode::kCorruptData,
        "{}: no frame of its '{}' video stream can be decoded; the file is damaged or empty", path,
        avcodec_get_name(decoder->stream().codecpar->codec_id));
  }
  clip = DescribeClip(decoder->input(), decoder->stream(), **picture, can_scan ? &plan : nullptr,
                      nominal_period);
  clip.info.path = path;
  if (clip.info.timestamps_repaired) {
    logger->warn(
        "{}: some timestamps are damaged (missing, repeated or absurd); every frame is "
        "kept, with a time put in its place",
        path);
  }
  repair = std::make_unique<TimestampRepair>(std::move(plan), nominal_period);
  first_picture = std::move(*picture);
  return {};
}

Result<AvFramePtr> VideoReader::Impl::NextPicture() {
  return first_picture != nullptr ? Result<AvFramePtr>(std::move(first_picture)) : decoder->Next();
}

Result<AvFramePtr> VideoReader::Impl::Deliverable(AvFramePtr picture) {
  const AVPixelFormat stored = WithoutRange(static_cast<AVPixelFormat>(picture->format));
  // Negative strides (pictures stored bottom-up) are for libav only.
  const bool is_upside_down =
      std::any_of(std::begin(picture->linesize), std::begin(picture->linesize) + kMaxPlanes,
                  [](int stride) { return stride < 0; });
  const bool same_size = picture->width == clip.info.width && picture->height == clip.info.height;
  if (stored == clip.format && same_size && !is_upside_down) {
    return picture;
  }
  if (!has_told_change && next_index > 0 &&
      (!same_size || FormatName(stored) != FormatName(WithoutRange(static_cast<AVPixelFormat>(
                                               av_get_pix_fmt(clip.info.pixel_format.c_str())))))) {
    logger->warn(
        "{}: frame {}: the picture changes to {}x{} {} within the clip; it is converted "
        "to {}x{} as at the start",
        clip.info.path, next_index, picture->width, picture->height, FormatName(stored),
        clip.info.width, clip.info.height);
    has_told_change = true;
  }
  if (converter == nullptr) {
    converter = std::make_unique<FrameConverter>(FrameConverter::Target{
        clip.format, clip.info.width, clip.info.height, clip.info.layout.full_range});
  }
  return converter->Convert(*picture);
}

Result<VideoFrame> VideoReader::Impl::MakeFrame(AvFramePtr picture, std::int64_t pts) {
  VideoFrame frame;
  FrameOrigin origin;
  origin.pts = pts;
  origin.duration = picture->pkt_duration;
  origin.properties = KeptProperties(*picture);
  Result<AvFramePtr> deliverable = Deliverable(std::move(picture));
  if (!deliverable) {
    return Propagate(deliverable.error(), fmt::format("{}: frame {}", clip.info.path, next_index));
  }
  frame.frame = WrapPicture(std::move(*deliverable), clip.info.layout);
  SetOrigin(frame.frame, std::move(origin));
  frame.index = next_index++;
  frame.pts = pts;
  frame.time_s = static_cast<double>(pts) * clip.info.time_base.Value();
  return frame;
}

void VideoReader::Impl::TellDamage() const {
  if (decoder->damaged_count() > 0) {
    logger->warn("{}: {} damaged packets or frames; they were concealed or left out",
                 clip.info.path, decoder->damaged_count());
  }
  if (decoder->ended_early()) {
    logger->warn("{}: the file ends early; {} frames could be read", clip.info.path, next_index);
  }
}

VideoReader::VideoReader(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
VideoReader::~VideoReader() = default;

Result<std::unique_ptr<VideoReader>> VideoReader::Open(const std::string& path,
                                                       const ReaderOptions& options) {
  auto impl = std::make_unique<Impl>();
  if (Status ok = impl->OpenFile(path, options); !ok) {
    return Propagate(ok.error());
  }
  return std::unique_ptr<VideoReader>(new VideoReader(std::move(impl)));
}

const VideoInfo& VideoReader::info() const { return impl_->clip.info; }

Result<std::optional<VideoFrame>> VideoReader::Read() {
  Impl& impl = *impl_;
  if (!impl.has_started) {
    impl.has_started = true;
    if (!impl.is_followed) {
      impl.decoder->other_packets()->Close();
      AVFormatContext& input = impl.decoder->input();
      for (unsigned i = 0; i < input.nb_streams; ++i) {
        if (input.streams[i] != &impl.decoder->stream()) {
          input.streams[i]->discard = AVDISCARD_ALL;
        }
      }
    }
  }
  while (true) {
    if (const std::optional<std::int64_t> pts = impl.repair->Pop()) {
      AvFramePtr picture = std::move(impl.waiting.front());
      impl.waiting.pop_front();
      Result<VideoFrame> frame = impl.MakeFrame(std::move(picture), *pts);
      if (!frame) {
        return Propagate(frame.error());
      }
      return std::optional<VideoFrame>(std::move(*frame));
    }
    if (impl.is_finished) {
      return std::optional<VideoFrame>();
    }
    Result<AvFramePtr> picture = impl.NextPicture();
    if (!picture) {
      return Propagate(picture.error());
    }
    if (*picture == nullptr) {
      impl.is_finished = true;
      impl.repair->Finish();
      impl.TellDamage();
      continue;
    }
    impl.repair->Push(Stamp((*picture)->pts));
    impl.waiting.push_back(std::move(*picture));
  }
}

SourceAccess AccessSource(VideoReader& reader) {
  VideoReader::Impl& impl = reader.impl();
  impl.is_followed = true;
  SourceAccess access;
  access.input = &impl.decoder->input();
  access.video_stream = impl.decoder->stream().index;
  access.path = impl.clip.info.path;
  access.format = impl.clip.format;
  access.color = impl.clip.color;
  access.first_frame_properties = impl.clip.properties.get();
  access.packets = impl.decoder->other_packets();
  access.has_started = impl.has_started;
  return access;
}

}  // namespace rsstab::media
