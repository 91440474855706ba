// SPDX-License-Identifier: Apache-2.0
#include "cli/media/video_encoder.h"

extern "C" {
#include <libavutil/pixdesc.h>
}

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <utility>
#include <vector>

#include "cli/media/av_error.h"
#include "cli/media/av_log.h"
#include "cli/media/encoder_choice.h"
#include "cli/media/hdr_metadata.h"

namespace rsstab::media {
namespace {

AVRational ToAv(Rational value) { return {value.num, value.den}; }

std::vector<AVPixelFormat> FormatsOf(const AVCodec& codec) {
  std::vector<AVPixelFormat> formats;
  for (const AVPixelFormat* format = codec.pix_fmts;
       format != nullptr && *format != AV_PIX_FMT_NONE; ++format) {
    // Surfaces of graphics cards are not for frames in memory.
    if (sws_isSupportedOutput(*format) != 0) {
      formats.push_back(*format);
    }
  }
  return formats;
}

// H.264 and HEVC store sizes in whole chroma samples: an odd width needs unsubsampled chroma.
bool CanHaveSize(const AVCodec& codec, AVPixelFormat format, int width, int height) {
  const AVPixFmtDescriptor* description = av_pix_fmt_desc_get(format);
  if ((codec.id != AV_CODEC_ID_H264 && codec.id != AV_CODEC_ID_HEVC) || description == nullptr) {
    return true;
  }
  return width % (1 << description->log2_chroma_w) == 0 &&
         height % (1 << description->log2_chroma_h) == 0;
}

std::string Names(const std::vector<AVPixelFormat>& formats) {
  std::vector<std::string> names;
  names.reserve(formats.size());
  for (const AVPixelFormat format : formats) {
    names.push_back(FormatName(format));
  }
  return fmt::format("{}", fmt::join(names, ", "));
}

Result<AVPixelFormat> WantedFormat(const AVCodec& codec, const EncoderInput& input,
                                   const std::string& wanted) {
  const std::vector<AVPixelFormat> possible = FormatsOf(codec);
  const AVPixelFormat format = av_get_pix_fmt(wanted.c_str());
  if (format == AV_PIX_FMT_NONE || sws_isSupportedOutput(format) == 0) {
    return Fail(ErrorCode::kInvalidArgument,
                "'{}' is not a pixel format; examples are yuv420p, yuv422p10le, yuv444p", wanted);
  }
  if (!possible.empty() && std::find(possible.begin(), possible.end(), format) == possible.end()) {
    return Fail(ErrorCode::kInvalidArgument,
                "the encoder {} does not take the pixel format {}; it takes {}", codec.name, wanted,
                Names(possible));
  }
  if (!CanHaveSize(codec, format, input.width, input.height)) {
    return Fail(ErrorCode::kInvalidArgument,
                "{} in the pixel format {} cannot have the odd size {}x{}; leave the pixel format "
                "out, or choose yuv444p or another --codec",
                avcodec_get_name(codec.id), wanted, input.width, input.height);
  }
  return format;
}

// The format to encode in: the wanted one, else that of the input, else what comes nearest.
Result<AVPixelFormat> ChooseFormat(const AVCodec& codec, const EncoderInput& input,
                                   const std::string& wanted, const Logger& logger) {
  if (!wanted.empty()) {
    return WantedFormat(codec, input, wanted);
  }
  std::vector<AVPixelFormat> possible = FormatsOf(codec);
  if (possible.empty()) {
    return input.format;
  }
  const bool takes_size = CanHaveSize(codec, input.format, input.width, input.height);
  std::erase_if(possible, [&](AVPixelFormat format) {
    return !CanHaveSize(codec, format, input.width, input.height);
  });
  const AVPixelFormat format = NearestFormat(input.format, possible);
  if (format == AV_PIX_FMT_NONE) {
    return Fail(ErrorCode::kUnsupported, "the encoder {} cannot write pictures of {}x{}",
                codec.name, input.width, input.height);
  }
  if (!takes_size) {
    logger->warn("{} cannot write {} pictures of the odd size {}x{}; the output is {}",
                 avcodec_get_name(codec.id), FormatName(input.format), input.width, input.height,
                 FormatName(format));
  } else if (WithoutRange(format) != WithoutRange(input.format)) {
    logger->warn("the encoder {} does not take the pixel format {}; the output is {}", codec.name,
                 FormatName(input.format), FormatName(format));
  }
  return format;
}

// Options of the encoder's own library, "a=1:b=2", given in one libav option.
const char* ParametersKey(const std::string& encoder) {
  return encoder == "libx264"     ? "x264-params"
         : encoder == "libx265"   ? "x265-params"
         : encoder == "libsvtav1" ? "svtav1-params"
                                  : nullptr;
}

// Everything the encoder is told by name: ours first, so that the user's words win.
void FillOptions(const std::string& encoder, const EncoderSettings& settings,
                 const EncoderInput& input, const WriterOptions& options, AvDictionary& target) {
  const char* parameters_key = ParametersKey(encoder);
  std::string parameters = HdrParameters(encoder, input.first_frame_properties);
  const auto add = [&parameters](const std::string& word) {
    parameters += (parameters.empty() || word.empty() ? "" : ":") + word;
  };
  if (encoder == "libx265") {
    add("log-level=none");  // it writes to stderr by itself
    if (options.num_threads > 0) {
      add(fmt::format("pools={}", options.num_threads));
    }
  }
  const auto take = [&](const KeyValueList& list) {
    for (const auto& [key, value] : list) {
      if (parameters_key != nullptr && key == parameters_key) {
        add(value);
      } else {
        target.Set(key.c_str(), value.c_str());
      }
    }
  };
  take(settings.options);
  take(options.encoder_options);
  if (!parameters.empty()) {
    target.Set(parameters_key, parameters.c_str());
  }
}

void SetQuality(const EncoderSettings& settings, const EncoderInput& input,
                AVCodecContext& context) {
  if (settings.quantiser) {
    context.flags |= AV_CODEC_FLAG_QSCALE;
    context.global_quality = static_cast<int>(std::lround(*settings.quantiser * FF_QP2LAMBDA));
  }
  if (settings.bits_per_pixel > 0.0) {
    context.bit_rate = std::llround(settings.bits_per_pixel * input.width * input.height *
                                    input.frame_rate.Value());
  }
}

bool IsRgb(AVPixelFormat format) {
  const AVPixFmtDescriptor* description = av_pix_fmt_desc_get(format);
  return description != nullptr && (description->flags & AV_PIX_FMT_FLAG_RGB) != 0;
}

void SetPicture(const EncoderInput& input, AVPixelFormat format, AVCodecContext& context) {
  context.width = input.width;
  context.height = input.height;
  context.pix_fmt = format;
  context.framerate = ToAv(input.frame_rate);
  context.time_base = av_inv_q(context.framerate);
  context.sample_aspect_ratio = ToAv(input.sample_aspect_ratio);
  context.color_range = input.color.range;
  context.color_primaries = input.color.primaries;
  context.color_trc = input.color.transfer;
  context.colorspace = input.color.matrix;
  context.chroma_sample_location = input.color.chroma_location;
  if (NameSaysFullRange(format)) {
    context.color_range = AVCOL_RANGE_JPEG;
  }
  // Across colour models the tags of the input do not hold; these are what FrameConverter makes.
  if (IsRgb(format) != IsRgb(input.format)) {
    constexpr int kFirstHighDefinitionHeight = 720;
    if (IsRgb(format)) {
      context.colorspace = AVCOL_SPC_RGB;
      context.color_range = AVCOL_RANGE_JPEG;
    } else {
      context.colorspace =
          input.height >= kFirstHighDefinitionHeight ? AVCOL_SPC_BT709 : AVCOL_SPC_SMPTE170M;
      context.color_range = NameSaysFullRange(format) ? AVCOL_RANGE_JPEG : AVCOL_RANGE_MPEG;
    }
  }
}

}  // namespace

Result<std::unique_ptr<VideoEncoder>> VideoEncoder::Open(const EncoderInput& input,
                                                         const WriterOptions& options,
                                                         const std::string& codec_name,
                                                         const Logger* logger) {
  RouteAvLog();
  Result<EncoderChoice> choice = ChooseEncoder(codec_name, [](const std::string& name) {
    const AVCodec* found = avcodec_find_encoder_by_name(name.c_str());
    return found != nullptr && found->type == AVMEDIA_TYPE_VIDEO;
  });
  if (!choice) {
    return Propagate(choice.error());
  }
  if (!choice->warning.empty()) {
    (*logger)->warn("{}", choice->warning);
  }
  Result<EncoderSettings> settings =
      SettingsFor(choice->encoder, options.crf, options.preset, options.num_threads);
  if (!settings) {
    return Propagate(settings.error());
  }
  const AVCodec* codec = avcodec_find_encoder_by_name(choice->encoder.c_str());
  Result<AVPixelFormat> format = ChooseFormat(*codec, input, options.pix_fmt, *logger);
  if (!format) {
    return Propagate(format.error());
  }

  std::unique_ptr<VideoEncoder> encoder(new VideoEncoder());
  encoder->context_.reset(avcodec_alloc_context3(codec));
  if (encoder->context_ == nullptr) {
    return AvFail(AVERROR(ENOMEM), "opening the encoder");
  }
  AVCodecContext& context = *encoder->context_;
  context.opaque = const_cast<Logger*>(logger);
  SetPicture(input, *format, context);
  SetQuality(*settings, input, context);
  context.thread_count = options.num_threads;
  if (input.needs_global_header) {
    context.flags |= AV_CODEC_FLAG_GLOBAL_HEADER;
  }
  if (input.needs_display_order) {
    context.max_b_frames = 0;
  }
  if (choice->encoder == "libsvtav1") {
    // Its library writes to stderr unless told by the environment not to; there is no other way.
    setenv("SVT_LOG", "0", 0);
  }
  AvDictionary dictionary;
  FillOptions(choice->encoder, *settings, input, options, dictionary);
  if (const int code = avcodec_open2(&context, codec, dictionary.address()); code < 0) {
    Error error =
        AvError(code, fmt::format("opening the encoder {} for {}x{} {} pictures", codec->name,
                                  input.width, input.height, FormatName(*format)));
    error.message +=
        "; if you gave encoder options, check them, otherwise choose another --codec "
        "or --pix-fmt (--log-level debug shows the encoder's own words)";
    return Propagate(std::move(error));
  }
  if (const AVDictionaryEntry* left =
          av_dict_get(dictionary.get(), "", nullptr, AV_DICT_IGNORE_SUFFIX)) {
    return Fail(ErrorCode::kInvalidArgument, "the encoder {} has no option '{}'", codec->name,
                left->key);
  }
  const bool to_full = context.color_range == AVCOL_RANGE_JPEG;
  const bool range_changes = NameSaysFullRange(*format) && !input.full_range;
  if (range_changes) {
    (*logger)->warn("the encoder {} writes full-range pictures only; the range is converted",
                    codec->name);
  }
  if (WithoutRange(*format) != input.format || range_changes) {
    encoder->converter_ = std::make_unique<FrameConverter>(
        FrameConverter::Target{*format, input.width, input.height, to_full});
  }
  encoder->input_is_full_range_ = input.full_range;
  encoder->input_matrix_ = input.color.matrix;
  const double tick_s = input.time_base.Value();
  encoder->period_ =
      std::max<std::int64_t>(1, std::llround(1.0 / (input.frame_rate.Value() * tick_s)));
  return encoder;
}

Status VideoEncoder::Send(AvFramePtr picture, std::int64_t pts, std::int64_t duration) {
  if (converter_ != nullptr) {
    picture->color_range = input_is_full_range_ ? AVCOL_RANGE_JPEG : AVCOL_RANGE_MPEG;
    picture->colorspace = input_matrix_;
    Result<AvFramePtr> converted = converter_->Convert(*picture);
    if (!converted) {
      return Propagate(converted.error());
    }
    picture = std::move(*converted);
  }
  picture->format = context_->pix_fmt;  // the same memory under the name the encoder knows
  picture->color_range = context_->color_range;
  picture->color_primaries = context_->color_primaries;
  picture->color_trc = context_->color_trc;
  picture->colorspace = context_->colorspace;
  picture->chroma_location = context_->chroma_sample_location;
  picture->sample_aspect_ratio = context_->sample_aspect_ratio;
  picture->pts = next_index_;
  picture->pict_type = AV_PICTURE_TYPE_NONE;
  if ((context_->flags & AV_CODEC_FLAG_QSCALE) != 0) {
    picture->quality = context_->global_quality;  // MPEG-4 and JPEG take it from the frame
  }
  timings_.push_back({pts, duration});
  ++next_index_;
  if (const int code = avcodec_send_frame(context_.get(), picture.get()); code < 0) {
    return AvFail(code, fmt::format("encoding frame {}", next_index_ - 1));
  }
  return {};
}

Status VideoEncoder::Flush() {
  const int code = avcodec_send_frame(context_.get(), nullptr);
  return code < 0 && code != AVERROR_EOF ? Status(AvFail(code, "finishing the encoding"))
                                         : Status();
}

Result<AvPacketPtr> VideoEncoder::Receive() {
  AvPacketPtr packet(av_packet_alloc());
  if (packet == nullptr) {
    return AvFail(AVERROR(ENOMEM), "encoding");
  }
  const int code = avcodec_receive_packet(context_.get(), packet.get());
  if (code == AVERROR(EAGAIN) || code == AVERROR_EOF) {
    return AvPacketPtr();
  }
  if (code < 0) {
    return AvFail(code, "encoding");
  }
  Retime(*packet);
  return packet;
}

std::int64_t VideoEncoder::TimeOf(std::int64_t index) const {
  // Before the first frame (decoding starts early when there are B-frames) and, for safety, after
  // the last: steps of the usual period.
  if (index < first_kept_) {
    return timings_.front().pts - (first_kept_ - index) * period_;
  }
  if (index >= next_index_) {
    return timings_.back().pts + (index - next_index_ + 1) * period_;
  }
  return timings_[static_cast<std::size_t>(index - first_kept_)].pts;
}

void VideoEncoder::Retime(AVPacket& packet) {
  const std::int64_t shown = packet.pts;
  const std::int64_t decoded = packet.dts == AV_NOPTS_VALUE ? shown : packet.dts;
  packet.pts = TimeOf(shown);
  packet.duration = shown >= first_kept_ && shown < next_index_
                        ? timings_[static_cast<std::size_t>(shown - first_kept_)].duration
                        : 0;
  if (packet.duration <= 0) {
    packet.duration = shown + 1 < next_index_ ? TimeOf(shown + 1) - packet.pts : period_;
  }
  packet.dts = TimeOf(decoded);
  if (last_dts_) {
    packet.dts = std::max(packet.dts, *last_dts_ + 1);
  }
  last_dts_ = packet.dts;
  // Packets come in decoding order, so nothing refers to earlier times again.
  while (first_kept_ < decoded && timings_.size() > 1) {
    timings_.pop_front();
    ++first_kept_;
  }
}

}  // namespace rsstab::media
