// SPDX-License-Identifier: Apache-2.0
#include "cli/media/clip_description.h"

extern "C" {
#include <libavutil/display.h>
#include <libavutil/pixdesc.h>
}

#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>

#include "cli/media/frame_bridge.h"
#include "cli/media/input_file.h"

namespace rsstab::media {
namespace {

Rational ToRational(AVRational value) { return {value.num, value.den}; }

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

void TimesFromPlan(const TimestampPlan& plan, double nominal_period, VideoInfo& info) {
  const double tick_s = info.time_base.Value();
  const auto count = static_cast<std::int64_t>(plan.slots().size());
  const std::int64_t span = plan.slots().back().time - plan.slots().front().time;
  const double period_s =
      tick_s *
      (count > 1 ? static_cast<double>(span) / static_cast<double>(count - 1) : nominal_period);
  info.frame_count = count;
  info.frame_rate = NearestRate(1.0 / period_s);
  info.start_s = static_cast<double>(plan.slots().front().time) * tick_s;
  info.duration_s = static_cast<double>(count) * period_s;
  info.timestamps_repaired = plan.is_damaged();
  info.variable_frame_rate = !plan.is_constant_rate();
}

void TimesFromContainer(const AVFormatContext& input, const AVStream& stream, const AVFrame& first,
                        double nominal_period, VideoInfo& info) {
  const double tick_s = info.time_base.Value();
  const double rate = 1.0 / (nominal_period * tick_s);
  info.frame_rate = NearestRate(rate);
  info.start_s = first.pts != AV_NOPTS_VALUE ? static_cast<double>(first.pts) * tick_s : 0.0;
  if (stream.duration != AV_NOPTS_VALUE && stream.duration > 0) {
    info.duration_s = static_cast<double>(stream.duration) * tick_s;
  } else if (input.duration != AV_NOPTS_VALUE && input.duration > 0) {
    info.duration_s = static_cast<double>(input.duration) / AV_TIME_BASE;
  }
  info.frame_count = stream.nb_frames > 0 ? stream.nb_frames : std::llround(info.duration_s * rate);
}

}  // namespace

double GuessedRate(AVFormatContext& input, int stream) {
  constexpr double kUsualRate = 30.0;
  constexpr double kHighestRate = 1000.0;
  const double rate = av_q2d(av_guess_frame_rate(&input, input.streams[stream], nullptr));
  return rate > 0.0 && rate <= kHighestRate ? rate : kUsualRate;
}

ClipDescription DescribeClip(AVFormatContext& input, const AVStream& stream, const AVFrame& first,
                             const TimestampPlan* plan, double nominal_period) {
  ClipDescription clip;
  const AVCodecParameters& parameters = *stream.codecpar;
  const auto stored = static_cast<AVPixelFormat>(first.format);
  clip.format = DeliveredFormat(stored);
  clip.color = ColorOf(first, parameters);
  if (parameters.codec_id == AV_CODEC_ID_MJPEG &&
      clip.color.chroma_location == AVCHROMA_LOC_UNSPECIFIED) {
    clip.color.chroma_location = AVCHROMA_LOC_CENTER;  // JFIF
  }
  clip.properties = WithContainerHdr(KeptProperties(first), stream);

  VideoInfo& info = clip.info;
  info.container = input.iformat->name;
  info.codec = avcodec_get_name(parameters.codec_id);
  info.pixel_format = FormatName(stored);
  info.width = first.width;
  info.height = first.height;
  info.layout =
      LayoutOf(clip.format, clip.color.range, clip.color.chroma_location).value_or(PixelLayout());
  info.interlaced = first.interlaced_frame != 0;
  info.rotation_degrees = RotationOf(stream);
  const AVRational aspect = av_guess_sample_aspect_ratio(&input, const_cast<AVStream*>(&stream),
                                                         const_cast<AVFrame*>(&first));
  info.sample_aspect_ratio = aspect.num > 0 && aspect.den > 0 ? ToRational(aspect) : Rational{1, 1};
  info.color = NamesOf(clip.color);
  info.has_hdr_metadata = HasHdrMetadata(clip.properties.get());
  CountStreams(input, info);
  info.time_base = ToRational(stream.time_base);
  if (plan != nullptr && !plan->slots().empty()) {
    TimesFromPlan(*plan, nominal_period, info);
  } else {
    TimesFromContainer(input, stream, first, nominal_period, info);
  }
  return clip;
}

}  // namespace rsstab::media
