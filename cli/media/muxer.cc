// SPDX-License-Identifier: Apache-2.0
#include "cli/media/muxer.h"

extern "C" {
#include <libavutil/display.h>
}

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <utility>

#include "cli/media/av_error.h"
#include "cli/media/av_log.h"
#include "cli/media/container.h"
#include "cli/media/stream_copy.h"

namespace rsstab::media {
namespace {

constexpr int kIoBufferBytes = 1 << 18;
constexpr int kOpusRate = 48000;  // whatever the sound's own

int WriteBytes(void* opaque, std::uint8_t* data, int size) {
  const int code = static_cast<OutputFile*>(opaque)->Write(data, static_cast<std::size_t>(size));
  return code < 0 ? code : size;
}

std::int64_t SeekBytes(void* opaque, std::int64_t offset, int whence) {
  auto* file = static_cast<OutputFile*>(opaque);
  if ((whence & AVSEEK_SIZE) != 0) {
    const std::int64_t here = file->Seek(0, SEEK_CUR);
    const std::int64_t size = file->Seek(0, SEEK_END);
    const std::int64_t back = file->Seek(here, SEEK_SET);
    return back < 0 ? back : size;
  }
  return file->Seek(offset, whence & ~AVSEEK_FORCE);
}

// A display matrix for a plain turn.
int AddRotation(double degrees, AVStream& stream) {
  if (degrees == 0.0) {
    return 0;
  }
  constexpr std::size_t kBytes = 9 * sizeof(std::int32_t);
  std::uint8_t* data = av_stream_new_side_data(&stream, AV_PKT_DATA_DISPLAYMATRIX, kBytes);
  if (data == nullptr) {
    return AVERROR(ENOMEM);
  }
  // The function takes clockwise degrees, its inverse gives counter-clockwise ones.
  av_display_rotation_set(reinterpret_cast<std::int32_t*>(data), -degrees);
  return 0;
}

void FillOptions(const AVOutputFormat& format, bool can_seek, bool has_special_metadata,
                 AVRational video_time_base, const WriterOptions& options, AvDictionary& target) {
  if (IsMp4Like(format)) {
    std::string flags;
    if (!can_seek) {
      flags += "+frag_keyframe+empty_moov+default_base_moof";
    }
    if (has_special_metadata) {
      flags += "+use_metadata_tags";  // keys of phone makers, otherwise dropped
    }
    if (!flags.empty()) {
      target.Set("movflags", flags.c_str());
    }
    // A start after zero is stored on this clock, whose default is one millisecond.
    if (video_time_base.num == 1 && video_time_base.den > 1000) {
      target.Set("movie_timescale", std::to_string(video_time_base.den).c_str());
    }
  }
  for (const auto& [key, value] : options.muxer_options) {
    const AVDictionaryEntry* ours = av_dict_get(target.get(), key.c_str(), nullptr, 0);
    const bool adds_flags = ours != nullptr && !value.empty() && value.front() == '+';
    const std::string both = adds_flags ? ours->value + value : value;
    target.Set(key.c_str(), both.c_str());
  }
}

}  // namespace

Result<std::unique_ptr<Muxer>> Muxer::Open(OutputFile& file, const AVOutputFormat& format,
                                           const MuxerVideo& video, const SourceAccess* source,
                                           const WriterOptions& options, const Logger& logger) {
  RouteAvLog();
  if (avformat_query_codec(&format, video.encoder->codec_id, FF_COMPLIANCE_NORMAL) == 0) {
    return Fail(ErrorCode::kUnsupported,
                "a '{}' file cannot hold {} video; choose another file name extension or --codec",
                format.name, avcodec_get_name(video.encoder->codec_id));
  }
  std::unique_ptr<Muxer> muxer(new Muxer(file, logger));
  // Whether a stream really fits shows when the header is written: what is dispensable goes first.
  int code = 0;
  std::string unknown_option;
  for (const Scope scope : {Scope::kAll, Scope::kNoData, Scope::kAudioOnly, Scope::kNone}) {
    code = muxer->Start(format, video, source, options, scope, unknown_option);
    const bool may_retry = source != nullptr && file.can_seek() && file.first_error() == 0 &&
                           unknown_option.empty() && code != AVERROR(ENOMEM);
    if (code >= 0 || !may_retry || file.Truncate() < 0) {
      break;
    }
  }
  if (!unknown_option.empty()) {
    return Fail(ErrorCode::kInvalidArgument, "the container '{}' has no option '{}'", format.name,
                unknown_option);
  }
  if (code < 0) {
    return Propagate(muxer->WriteError(code));
  }
  if (!muxer->left_out_.empty()) {
    logger->warn("{}: a '{}' file cannot hold these, they are left out: {}{}", file.path(),
                 format.name, fmt::join(muxer->left_out_, ", "),
                 IsMatroska(format) ? "" : " (.mkv holds most kinds)");
  }
  if (video.has_variable_rate && HoldsConstantRateOnly(format)) {
    logger->warn(
        "{}: a '{}' file shows frames at constant rate, the clip's rate varies; .mp4 and "
        ".mkv keep the times",
        file.path(), format.name);
  }
  return muxer;
}

Muxer::~Muxer() {
  if (io_ != nullptr) {
    av_freep(&io_->buffer);
    avio_context_free(&io_);
  }
}

int Muxer::Start(const AVOutputFormat& format, const MuxerVideo& video, const SourceAccess* source,
                 const WriterOptions& options, Scope scope, std::string& unknown_option) {
  left_out_.clear();
  copied_.clear();
  AVFormatContext* context = nullptr;
  const std::string url = "file:" + file_.current_path();
  if (const int code = avformat_alloc_output_context2(&context, &format, nullptr, url.c_str());
      code < 0) {
    return code;
  }
  output_.reset(context);
  context->opaque = const_cast<Logger*>(&logger_);
  if (io_ != nullptr) {
    av_freep(&io_->buffer);
    avio_context_free(&io_);
  }
  auto* buffer = static_cast<unsigned char*>(av_malloc(kIoBufferBytes));
  io_ = avio_alloc_context(buffer, kIoBufferBytes, 1, &file_, nullptr, WriteBytes,
                           file_.can_seek() ? SeekBytes : nullptr);
  if (io_ == nullptr) {
    av_free(buffer);
    return AVERROR(ENOMEM);
  }
  context->pb = io_;
  keeps_zero_ = IsMatroska(format) && !video.starts_before_zero;

  int code = 0;
  if (source == nullptr) {
    code = AddVideo(video, nullptr);
    for (const auto& [key, value] : video.metadata) {
      av_dict_set(&context->metadata, key.c_str(), value.c_str(), 0);
    }
  } else {
    const AVFormatContext& input = *source->input;
    // Broadcast streams count from an arbitrary instant; other containers mean what they say.
    const bool has_arbitrary_start = (input.iformat->flags & AVFMT_TS_DISCONT) != 0 &&
                                     input.start_time != AV_NOPTS_VALUE && input.start_time > 0;
    source_start_ = has_arbitrary_start ? input.start_time : 0;
    copied_.resize(input.nb_streams);
    for (unsigned i = 0; i < input.nb_streams && code >= 0; ++i) {
      const AVStream& stream = *input.streams[i];
      if (static_cast<int>(i) == source->video_stream) {
        code = AddVideo(video, source);
        continue;
      }
      const AVMediaType type = stream.codecpar->codec_type;
      const bool in_scope = scope == Scope::kAll ||
                            (scope == Scope::kNoData && type != AVMEDIA_TYPE_DATA) ||
                            (scope == Scope::kAudioOnly && type == AVMEDIA_TYPE_AUDIO);
      const bool is_hidden = stream.discard == AVDISCARD_ALL;  // the chapters' titles
      if (!options.copy_streams || is_hidden) {
        continue;
      }
      if (in_scope && ContainerTakes(format, stream)) {
        code = AddCopied(stream);
      } else {
        left_out_.push_back(StreamName(stream));
      }
    }
    if (code >= 0) {
      code = CopyMetadata(input.metadata, &context->metadata);
    }
    if (code >= 0 && options.copy_streams) {
      code = CopyChapters(input);
    }
  }
  if (code < 0) {
    return code;
  }
  AvDictionary dictionary;
  // No random identifiers: the same input gives the same bytes.
  context->flags |= AVFMT_FLAG_BITEXACT;
  if (keeps_zero_) {
    context->avoid_negative_ts = AVFMT_AVOID_NEG_TS_DISABLED;
  }
  FillOptions(format, file_.can_seek(), HasSpecialMetadata(context->metadata), video_time_base_,
              options, dictionary);
  code = avformat_write_header(context, dictionary.address());
  if (code >= 0) {
    if (const AVDictionaryEntry* left =
            av_dict_get(dictionary.get(), "", nullptr, AV_DICT_IGNORE_SUFFIX)) {
      unknown_option = left->key;
      return AVERROR_OPTION_NOT_FOUND;
    }
  }
  return code < 0 ? code : 0;
}

int Muxer::AddVideo(const MuxerVideo& video, const SourceAccess* source) {
  AVStream* stream = avformat_new_stream(output_.get(), nullptr);
  if (stream == nullptr) {
    return AVERROR(ENOMEM);
  }
  video_index_ = stream->index;
  video_time_base_ = {video.time_base.num, video.time_base.den};
  const AVRational frame_rate = {video.frame_rate.num, video.frame_rate.den};
  stream->time_base =
      HoldsConstantRateOnly(*output_->oformat) ? av_inv_q(frame_rate) : video_time_base_;
  stream->avg_frame_rate = frame_rate;
  stream->sample_aspect_ratio = video.encoder->sample_aspect_ratio;
  if (const int code = avcodec_parameters_from_context(stream->codecpar, video.encoder); code < 0) {
    return code;
  }
  if (IsMp4Like(*output_->oformat) && video.encoder->codec_id == AV_CODEC_ID_HEVC) {
    stream->codecpar->codec_tag = MKTAG('h', 'v', 'c', '1');  // Apple's players know only this one
  }
  if (source == nullptr) {
    stream->disposition = AV_DISPOSITION_DEFAULT;
    return AddRotation(video.rotation_degrees, *stream);
  }
  const AVStream& original = *source->input->streams[source->video_stream];
  stream->disposition = original.disposition;
  if (const int code = CopyVideoSideData(original, source->first_frame_properties, *stream);
      code < 0) {
    return code;
  }
  return CopyMetadata(original.metadata, &stream->metadata);
}

int Muxer::AddCopied(const AVStream& source) {
  AVStream* stream = avformat_new_stream(output_.get(), nullptr);
  if (stream == nullptr) {
    return AVERROR(ENOMEM);
  }
  copied_[static_cast<std::size_t>(source.index)] = Copied{stream->index, source.time_base, {}};
  return CopyDescription(*output_->oformat, source, *stream);
}

int Muxer::CopyChapters(const AVFormatContext& input) {
  if (input.nb_chapters == 0) {
    return 0;
  }
  output_->chapters = static_cast<AVChapter**>(av_calloc(input.nb_chapters, sizeof(AVChapter*)));
  if (output_->chapters == nullptr) {
    return AVERROR(ENOMEM);
  }
  for (unsigned i = 0; i < input.nb_chapters; ++i) {
    const AVChapter& source = *input.chapters[i];
    auto* chapter = static_cast<AVChapter*>(av_mallocz(sizeof(AVChapter)));
    if (chapter == nullptr) {
      return AVERROR(ENOMEM);
    }
    output_->chapters[output_->nb_chapters++] = chapter;
    const std::int64_t shift = av_rescale_q(source_start_, AV_TIME_BASE_Q, source.time_base);
    chapter->id = source.id;
    chapter->time_base = source.time_base;
    chapter->start = source.start - shift;
    chapter->end = source.end - shift;
    if (const int code = av_dict_copy(&chapter->metadata, source.metadata, 0); code < 0) {
      return code;
    }
  }
  return 0;
}

Error Muxer::WriteError(int code) const {
  const int cause = file_.first_error() != 0 ? file_.first_error() : code;
  return AvError(cause, "writing " + file_.path());
}

int Muxer::Write(AVPacket& packet) {
  packet.pos = -1;
  const int code = av_interleaved_write_frame(output_.get(), &packet);
  return code >= 0 ? file_.first_error() : code;
}

Status Muxer::WriteVideo(AVPacket& packet) {
  const AVStream& stream = *output_->streams[video_index_];
  const std::int64_t shift = av_rescale_q(source_start_, AV_TIME_BASE_Q, video_time_base_);
  packet.pts -= shift;
  packet.dts -= shift;
  av_packet_rescale_ts(&packet, video_time_base_, stream.time_base);
  // A coarser clock may make neighbours equal.
  if (last_video_dts_ && packet.dts <= *last_video_dts_) {
    packet.dts = *last_video_dts_ + 1;
  }
  packet.pts = std::max(packet.pts, packet.dts);
  last_video_dts_ = packet.dts;
  packet.stream_index = video_index_;
  const int code = Write(packet);
  return code < 0 ? Status(Propagate(WriteError(code))) : Status();
}

Status Muxer::WriteCopied(AVPacket& packet) {
  const auto source_index = static_cast<std::size_t>(packet.stream_index);
  if (source_index >= copied_.size() || !copied_[source_index]) {
    return {};
  }
  Copied& copied = *copied_[source_index];
  const AVStream& stream = *output_->streams[copied.output_index];
  const std::int64_t shift = av_rescale_q(source_start_, AV_TIME_BASE_Q, copied.source_time_base);
  if (packet.pts != AV_NOPTS_VALUE) {
    packet.pts -= shift;
  }
  if (packet.dts != AV_NOPTS_VALUE) {
    packet.dts -= shift;
  }
  av_packet_rescale_ts(&packet, copied.source_time_base, stream.time_base);
  const AVCodecParameters& parameters = *stream.codecpar;
  if (keeps_zero_ && parameters.codec_id == AV_CODEC_ID_OPUS && parameters.initial_padding > 0) {
    // libav's muxer writes the delay that readers subtract, but does not add it to the times.
    const std::int64_t delay =
        av_rescale_q(parameters.initial_padding, AVRational{1, kOpusRate}, stream.time_base);
    packet.pts += packet.pts != AV_NOPTS_VALUE ? delay : 0;
    packet.dts += packet.dts != AV_NOPTS_VALUE ? delay : 0;
  }
  if (packet.dts == AV_NOPTS_VALUE) {
    packet.dts = packet.pts != AV_NOPTS_VALUE ? packet.pts : copied.last_dts.value_or(-1) + 1;
  }
  const bool allows_equal = (output_->oformat->flags & AVFMT_TS_NONSTRICT) != 0;
  if (copied.last_dts && packet.dts < *copied.last_dts + (allows_equal ? 0 : 1)) {
    packet.dts = *copied.last_dts + 1;
    ++moved_packets_;
  }
  if (packet.pts == AV_NOPTS_VALUE || packet.pts < packet.dts) {
    packet.pts = packet.dts;
  }
  if (keeps_zero_ && parameters.codec_type != AVMEDIA_TYPE_AUDIO && packet.dts < 0) {
    packet.dts = 0;
    packet.pts = std::max<std::int64_t>(packet.pts, 0);
  }
  copied.last_dts = packet.dts;
  packet.stream_index = copied.output_index;
  const int code = Write(packet);
  return code < 0 ? Status(Propagate(WriteError(code))) : Status();
}

Status Muxer::Finish() {
  int code = av_write_trailer(output_.get());
  avio_flush(io_);
  if (code >= 0) {
    code = file_.first_error() != 0 ? file_.first_error() : io_->error;
  }
  if (code < 0) {
    return Propagate(WriteError(code));
  }
  if (moved_packets_ > 0) {
    logger_->warn("{}: {} packets of copied streams had times running backwards and were moved",
                  file_.path(), moved_packets_);
  }
  return {};
}

}  // namespace rsstab::media
