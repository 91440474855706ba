// SPDX-License-Identifier: Apache-2.0
#include "cli/media/video_decoder.h"

#include <algorithm>
#include <cerrno>
#include <utility>

#include "cli/media/av_error.h"
#include "cli/media/video_info.h"

namespace rsstab::media {
namespace {

// How often in a row reading may fail before the file is taken to be over. Some demuxers find
// their way again after damage, some report every remaining packet of a cut-off file as an error.
constexpr int kReadAttempts = 64;

}  // namespace

Result<std::unique_ptr<VideoDecoder>> VideoDecoder::Open(AvInputPtr input, int stream,
                                                         int num_threads, const Logger* logger,
                                                         const std::string& path) {
  const AVCodecParameters& parameters = *input->streams[stream]->codecpar;
  const AVCodec* codec = avcodec_find_decoder(parameters.codec_id);
  if (codec == nullptr) {
    return Fail(ErrorCode::kNotFound, "{}: this libavcodec has no decoder for its '{}' video", path,
                avcodec_get_name(parameters.codec_id));
  }
  std::unique_ptr<VideoDecoder> decoder(new VideoDecoder());
  decoder->path_ = path;
  decoder->input_ = std::move(input);
  decoder->stream_ = stream;
  decoder->known_streams_ = decoder->input_->nb_streams;
  decoder->packet_.reset(av_packet_alloc());
  decoder->codec_.reset(avcodec_alloc_context3(codec));
  if (decoder->packet_ == nullptr || decoder->codec_ == nullptr) {
    return AvFail(AVERROR(ENOMEM), "decoding " + path);
  }
  AVCodecContext& context = *decoder->codec_;
  if (const int code = avcodec_parameters_to_context(&context, &parameters); code < 0) {
    return AvFail(code, "decoding " + path);
  }
  context.opaque = const_cast<Logger*>(logger);
  context.pkt_timebase = decoder->stream().time_base;
  context.thread_count = num_threads;
  context.thread_type = FF_THREAD_FRAME | FF_THREAD_SLICE;
  // A damaged picture is better than a missing one: it keeps the frame count and the timing.
  context.flags |= AV_CODEC_FLAG_OUTPUT_CORRUPT;
  context.max_pixels = std::int64_t{kMaxPictureSide} * kMaxPictureSide;
  if (const int code = avcodec_open2(&context, codec, nullptr); code < 0) {
    return AvFail(code, fmt::format("opening the '{}' decoder for {}", codec->name, path));
  }
  return decoder;
}

Result<AvFramePtr> VideoDecoder::Next() {
  AvFramePtr picture(av_frame_alloc());
  if (picture == nullptr) {
    return AvFail(AVERROR(ENOMEM), "decoding " + path_);
  }
  while (true) {
    const int code = avcodec_receive_frame(codec_.get(), picture.get());
    if (code == 0) {
      if ((picture->flags & AV_FRAME_FLAG_CORRUPT) != 0 || picture->decode_error_flags != 0) {
        ++damaged_count_;
      }
      return picture;
    }
    if (code == AVERROR_EOF) {
      return AvFramePtr();
    }
    if (code == AVERROR(ENOMEM)) {
      return AvFail(code, "decoding " + path_);
    }
    if (code != AVERROR(EAGAIN)) {
      ++damaged_count_;
      continue;  // each error uses up a packet, so this ends
    }
    if (Status fed = Feed(); !fed) {
      return Propagate(fed.error());
    }
  }
}

int VideoDecoder::ReadPacket(AVPacket& packet) {
  int code = 0;
  for (int attempt = 0; attempt < kReadAttempts; ++attempt) {
    code = av_read_frame(input_.get(), &packet);
    if (code >= 0 || code == AVERROR_EOF || code == AVERROR_EXIT) {
      break;
    }
  }
  if (code < 0) {
    ended_early_ = ended_early_ || code != AVERROR_EOF;
  }
  return code;
}

Status VideoDecoder::Feed() {
  while (!is_flushing_) {
    const int read = ReadPacket(*packet_);
    if (read == AVERROR(ENOMEM)) {
      return AvFail(read, "reading " + path_);
    }
    if (read < 0) {
      is_flushing_ = true;
      avcodec_send_packet(codec_.get(), nullptr);
      return {};
    }
    if (packet_->stream_index != stream_) {
      // A stream that shows up later was never announced to the writer.
      const bool is_known = static_cast<unsigned>(packet_->stream_index) < known_streams_;
      AvPacketPtr other(av_packet_alloc());
      if (other == nullptr) {
        return AvFail(AVERROR(ENOMEM), "reading " + path_);
      }
      av_packet_move_ref(other.get(), packet_.get());
      if (is_known) {
        // The demuxer may own the bytes only until its next packet.
        if (const int code = av_packet_make_refcounted(other.get()); code < 0) {
          return AvFail(code, "reading " + path_);
        }
        others_->Push(std::move(other));
      }
      continue;
    }
    if ((packet_->flags & AV_PKT_FLAG_CORRUPT) != 0) {
      ++damaged_count_;
    }
    const int code = avcodec_send_packet(codec_.get(), packet_.get());
    av_packet_unref(packet_.get());
    if (code == AVERROR(ENOMEM)) {
      return AvFail(code, "decoding " + path_);
    }
    if (code < 0) {
      ++damaged_count_;
    }
    return {};
  }
  return {};
}

}  // namespace rsstab::media
