// SPDX-License-Identifier: Apache-2.0
#include "cli/media/video_reader.h"

extern "C" {
#include <libavutil/display.h>
#include <libavutil/pixdesc.h>
}

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <deque>
#include <utility>

#include "cli/media/av_error.h"
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

Rational ToRational(AVRational value) { return {value.num, value.den}; }

// The frame rate libav guesses, for where the timestamps do not tell.
double GuessedRate(AVFormatContext& input, int stream) {
  constexpr double kUsualRate = 30.0;
  constexpr double kHighestRate = 1000.0;
  const double rate = av_q2d(av_guess_frame_rate(&input, input.streams[stream], nullptr));
  return rate > 0.0 && rate <= kHighestRate ? rate : kUsualRate;
}

// Rates that cameras have, so that 29.97002 from rounded stamps becomes 30000/1001.
Rational NearestRate(double rate) {
  constexpr double kSame = 2e-4;  // 29.97 and 30 differ by 1e-3
  constexpr std::array<Rational, 16> kUsual = {{{24000, 1001},
                                                {24, 1},
                                                {25, 1},
                                                {30000, 1001},
                                                {30, 1},
                                                {48, 1},
                                                {50, 1},
                                                {60000, 1001},
                                                {60, 1},
                                                {100, 1},
                                                {120000, 1001},
                                                {120, 1},
                                                {240000, 1001},
                                                {240, 1},
                                                {15, 1},
                                                {10, 1}}};
  for (const Rational& usual : kUsual) {
    if (std::abs(rate - usual.Value()) <= kSame * usual.Value()) {
      return usual;
    }
  }
  constexpr int kLargestTerm = 60000;  // MPEG-4 allows 65535
  return ToRational(av_d2q(rate, kLargestTerm));
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

double RotationOf(const AVStream& stream) {
  std::size_t size = 0;
  const std::uint8_t* matrix = av_stream_get_side_data(&stream, AV_PKT_DATA_DISPLAYMATRIX, &size);
  if (matrix == nullptr || size < 9 * sizeof(std::int32_t)) {
    return 0.0;
  }
  const double degrees = av_display_rotation_get(reinterpret_cast<const std::int32_t*>(matrix));
  if (std::isnan(degrees)) {
    return 0.0;
  }
  return degrees <= -180.0 ? 180.0 : degrees;
}

bool HasHdrMetadata(const AVFrame* properties) {
  return properties != nullptr &&
         (av_frame_get_side_data(properties, AV_FRAME_DATA_MASTERING_DISPLAY_METADATA) != nullptr ||
          av_frame_get_side_data(properties, AV_FRAME_DATA_CONTENT_LIGHT_LEVEL) != nullptr);
}

// What the picture says, completed by what the container says.
AvColor ColorOf(const AVFrame& picture, const AVCodecParameters& parameters) {
  AvColor color{picture.color_range, picture.color_primaries, picture.color_trc, picture.colorspace,
                picture.chroma_location};
  if (color.range == AVCOL_RANGE_UNSPECIFIED) {
    color.range = NameSaysFullRange(static_cast<AVPixelFormat>(picture.format))
                      ? AVCOL_RANGE_JPEG
                      : parameters.color_range;
  }
  if (color.primaries == AVCOL_PRI_UNSPECIFIED) {
    color.primaries = parameters.color_primaries;
  }
  if (color.transfer == AVCOL_TRC_UNSPECIFIED) {
    color.transfer = parameters.color_trc;
  }
  if (color.matrix == AVCOL_SPC_UNSPECIFIED) {
    color.matrix = parameters.color_space;
  }
  if (color.chroma_location == AVCHROMA_LOC_UNSPECIFIED) {
    color.chroma_location = parameters.chroma_location;
  }
  return color;
}

void CountStreams(const AVFormatContext& input, VideoInfo& info) {
  for (unsigned i = 0; i < input.nb_streams; ++i) {
    const AVCodecParameters& parameters = *input.streams[i]->codecpar;
    switch (parameters.codec_type) {
      case AVMEDIA_TYPE_AUDIO:
        ++info.audio_streams;
        break;
      case AVMEDIA_TYPE_SUBTITLE:
        ++info.subtitle_streams;
        break;
      case AVMEDIA_TYPE_ATTACHMENT:
        ++info.attachment_streams;
        break;
      case AVMEDIA_TYPE_DATA:
        if (std::string kind = FourLetterKind(parameters); !kind.empty()) {
          info.telemetry_kinds.push_back(std::move(kind));
        }
        break;
      default:
        break;
    }
  }
  info.chapters = static_cast<int>(input.nb_chapters);
}

}  // namespace

struct VideoReader::Impl {
  Logger logger;
  VideoInfo info;
  AvColor color;
  AVPixelFormat format = AV_PIX_FMT_NONE;
  std::unique_ptr<VideoDecoder> decoder;
  std::unique_ptr<TimestampRepair> repair;
  std::unique_ptr<FrameConverter> converter;
  AvFramePtr first_picture;  // decoded by Open()
  AvFramePtr first_properties;
  // Decoded, waiting for their times: at most kLookAhead + 1.
  std::deque<AvFramePtr> waiting;
  bool has_started = false;
  bool is_followed = false;  // a writer takes the other streams' packets
  bool is_finished = false;
  bool has_told_change = false;
  std::int64_t next_index = 0;
  double nominal_period = 1.0;  // ticks

  Status OpenFile(const std::string& path, const ReaderOptions& options);
  void Describe(const AVFrame& picture, const TimestampPlan& plan, bool was_scanned);
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
  nominal_period = std::max(1.0, 1.0 / (GuessedRate(**input, *stream) * av_q2d(time_base)));

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
  info.path = path;
  Describe(**picture, plan, can_scan);
  if (info.timestamps_repaired) {
    logger->warn(
        "{}: some timestamps are damaged (missing, repeated or absurd); every frame is "
        "kept, with a time put in its place",
        path);
  }
  repair = std::make_unique<TimestampRepair>(std::move(plan), nominal_period);
  first_picture = std::move(*picture);
  return {};
}

void VideoReader::Impl::Describe(const AVFrame& picture, const TimestampPlan& plan,
                                 bool was_scanned) {
  AVFormatContext& input = decoder->input();
  const AVStream& stream = decoder->stream();
  const AVCodecParameters& parameters = *stream.codecpar;
  const auto stored = static_cast<AVPixelFormat>(picture.format);
  color = ColorOf(picture, parameters);
  format = DeliveredFormat(stored);
  if (parameters.codec_id == AV_CODEC_ID_MJPEG &&
      color.chroma_location == AVCHROMA_LOC_UNSPECIFIED) {
    color.chroma_location = AVCHROMA_LOC_CENTER;  // JFIF
  }
  info.layout = LayoutOf(format, color.range, color.chroma_location).value_or(PixelLayout());
  first_properties = WithContainerHdr(KeptProperties(picture), stream);

  info.container = input.iformat->name;
  info.codec = avcodec_get_name(parameters.codec_id);
  info.pixel_format = FormatName(stored);
  info.width = picture.width;
  info.height = picture.height;
  info.time_base = ToRational(stream.time_base);
  info.interlaced = picture.interlaced_frame != 0;
  info.rotation_degrees = RotationOf(stream);
  const AVRational aspect = av_guess_sample_aspect_ratio(&input, const_cast<AVStream*>(&stream),
                                                         const_cast<AVFrame*>(&picture));
  info.sample_aspect_ratio = aspect.num > 0 && aspect.den > 0 ? ToRational(aspect) : Rational{1, 1};
  info.color = NamesOf(color);
  info.has_hdr_metadata = HasHdrMetadata(first_properties.get());
  CountStreams(input, info);

  const double tick_s = av_q2d(stream.time_base);
  double rate = 1.0 / (nominal_period * tick_s);
  if (was_scanned && !plan.slots().empty()) {
    const auto count = static_cast<std::int64_t>(plan.slots().size());
    const std::int64_t span = plan.slots().back().time - plan.slots().front().time;
    info.frame_count = count;
    info.start_s = static_cast<double>(plan.slots().front().time) * tick_s;
    info.timestamps_repaired = plan.is_damaged();
    info.variable_frame_rate = count > 1 && !plan.is_constant_rate();
    if (count > 1) {
      rate = static_cast<double>(count - 1) / (static_cast<double>(span) * tick_s);
      nominal_period = plan.period();
    }
    info.duration_s = static_cast<double>(count) / rate;
  } else {
    info.start_s = picture.pts != AV_NOPTS_VALUE ? static_cast<double>(picture.pts) * tick_s : 0.0;
    if (stream.duration != AV_NOPTS_VALUE && stream.duration > 0) {
      info.duration_s = static_cast<double>(stream.duration) * tick_s;
    } else if (input.duration != AV_NOPTS_VALUE && input.duration > 0) {
      info.duration_s = static_cast<double>(input.duration) / AV_TIME_BASE;
    }
    info.frame_count =
        stream.nb_frames > 0 ? stream.nb_frames : std::llround(info.duration_s * rate);
  }
  info.frame_rate = NearestRate(rate);
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
  const bool same_size = picture->width == info.width && picture->height == info.height;
  if (stored == format && same_size && !is_upside_down) {
    return picture;
  }
  if (!has_told_change && next_index > 0 &&
      (!same_size || FormatName(stored) != FormatName(WithoutRange(static_cast<AVPixelFormat>(
                                               av_get_pix_fmt(info.pixel_format.c_str())))))) {
    logger->warn(
        "{}: frame {}: the picture changes to {}x{} {} within the clip; it is converted "
        "to {}x{} as at the start",
        info.path, next_index, picture->width, picture->height, FormatName(stored), info.width,
        info.height);
    has_told_change = true;
  }
  if (converter == nullptr) {
    converter = std::make_unique<FrameConverter>(
        FrameConverter::Target{format, info.width, info.height, info.layout.full_range});
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
    return Propagate(deliverable.error(), fmt::format("{}: frame {}", info.path, next_index));
  }
  frame.frame = WrapPicture(std::move(*deliverable), info.layout);
  SetOrigin(frame.frame, std::move(origin));
  frame.index = next_index++;
  frame.pts = pts;
  frame.time_s = static_cast<double>(pts) * info.time_base.Value();
  return frame;
}

void VideoReader::Impl::TellDamage() const {
  if (decoder->damaged_count() > 0) {
    logger->warn("{}: {} damaged packets or frames; they were concealed or left out", info.path,
                 decoder->damaged_count());
  }
  if (decoder->ended_early()) {
    logger->warn("{}: the file ends early; {} frames could be read", info.path, next_index);
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

const VideoInfo& VideoReader::info() const { return impl_->info; }

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
  access.path = impl.info.path;
  access.format = impl.format;
  access.color = impl.color;
  access.first_frame_properties = impl.first_properties.get();
  access.packets = impl.decoder->other_packets();
  access.has_started = impl.has_started;
  return access;
}

}  // namespace rsstab::media
