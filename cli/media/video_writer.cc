// SPDX-License-Identifier: Apache-2.0
#include "cli/media/video_writer.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "cli/media/container.h"
#include "cli/media/frame_bridge.h"
#include "cli/media/muxer.h"
#include "cli/media/output_file.h"
#include "cli/media/pixel_format.h"
#include "cli/media/source_access.h"
#include "cli/media/video_encoder.h"

namespace rsstab::media {
namespace {

// The codec when none is asked for: H.264 where the container can hold it, otherwise what the
// container is made for.
std::string CodecFor(const AVOutputFormat& container, const std::string& wanted) {
  if (!wanted.empty() ||
      avformat_query_codec(&container, AV_CODEC_ID_H264, FF_COMPLIANCE_NORMAL) == 1) {
    return wanted;
  }
  return avcodec_get_name(container.video_codec);
}

}  // namespace

struct VideoWriter::Impl {
  Logger logger;
  int width = 0;
  int height = 0;
  PixelLayout layout;
  AVPixelFormat format = AV_PIX_FMT_NONE;
  std::int64_t period = 1;  // ticks
  // In this order: the muxer writes to the file, so it goes first.
  std::unique_ptr<OutputFile> file;
  std::unique_ptr<VideoEncoder> encoder;
  std::unique_ptr<Muxer> muxer;
  std::shared_ptr<PacketQueue> others;
  std::string encoder_name;
  std::string pixel_format;
  std::optional<std::int64_t> last_pts;
  std::int64_t frames_written = 0;

  ~Impl() {
    if (others != nullptr) {
      others->Close();
    }
  }

  // file, encoder and muxer, once the rest is set.
  Status Start(const std::string& path, EncoderInput input, MuxerVideo video,
               const SourceAccess* source, const WriterOptions& options);
  Status Encode(const Frame& frame, std::int64_t pts, std::int64_t duration);
  Status DrainEncoder();
  Status DrainOthers();
};

Status VideoWriter::Impl::Start(const std::string& path, EncoderInput input, MuxerVideo video,
                                const SourceAccess* source, const WriterOptions& options) {
  if (!(input.frame_rate.Value() > 0.0) || !(input.time_base.Value() > 0.0)) {
    return Fail(ErrorCode::kInvalidArgument, "a clip of {}/{} frames per second is not possible",
                input.frame_rate.num, input.frame_rate.den);
  }
  const std::string source_path = source != nullptr ? source->path : "";
  Result<const AVOutputFormat*> container = ChooseContainer(path, options.format);
  if (!container) {
    return Propagate(container.error());
  }
  Result<std::unique_ptr<OutputFile>> opened =
      OutputFile::Open(path, options.overwrite, source_path);
  if (!opened) {
    return Propagate(opened.error());
  }
  file = std::move(*opened);

  input.width = width;
  input.height = height;
  input.format = format;
  input.full_range = layout.full_range;
  input.needs_global_header = ((*container)->flags & AVFMT_GLOBALHEADER) != 0;
  input.needs_display_order = HoldsConstantRateOnly(**container);
  Result<std::unique_ptr<VideoEncoder>> made =
      VideoEncoder::Open(input, options, CodecFor(**container, options.codec), &logger);
  if (!made) {
    return Propagate(made.error());
  }
  encoder = std::move(*made);
  encoder_name = encoder->name();
  pixel_format = FormatName(encoder->format());

  video.encoder = &encoder->context();
  video.time_base = input.time_base;
  video.frame_rate = input.frame_rate;
  Result<std::unique_ptr<Muxer>> started =
      Muxer::Open(*file, **container, video, source, options, logger);
  if (!started) {
    return Propagate(started.error());
  }
  muxer = std::move(*started);
  if (source != nullptr) {
    // What is not copied need not be read.
    for (unsigned i = 0; i < source->input->nb_streams; ++i) {
      const int index = static_cast<int>(i);
      if (index != source->video_stream && !muxer->Copies(index)) {
        source->input->streams[i]->discard = AVDISCARD_ALL;
      }
    }
  }
  period = std::max<std::int64_t>(
      1, std::llround(1.0 / (input.frame_rate.Value() * input.time_base.Value())));
  return {};
}

VideoWriter::VideoWriter(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
VideoWriter::~VideoWriter() = default;

Result<std::unique_ptr<VideoWriter>> VideoWriter::Open(const std::string& path, VideoReader& source,
                                                       const WriterOptions& options) {
  auto impl = std::make_unique<Impl>();
  impl->logger = options.logger != nullptr ? options.logger : SilentLogger();
  const SourceAccess access = AccessSource(source);
  impl->others = access.packets;
  if (access.has_started) {
    return Fail(ErrorCode::kInternal,
                "{}: a writer must be opened before the first frame of its source is read", path);
  }
  const VideoInfo& info = source.info();
  impl->width = info.width;
  impl->height = info.height;
  impl->layout = info.layout;
  impl->format = access.format;
  EncoderInput input;
  input.frame_rate = info.frame_rate;
  input.time_base = info.time_base;
  input.sample_aspect_ratio = info.sample_aspect_ratio;
  input.color = access.color;
  input.first_frame_properties = access.first_frame_properties;
  MuxerVideo video;
  video.has_variable_rate = info.variable_frame_rate;
  video.starts_before_zero = info.start_s < 0.0;
  if (Status ok = impl->Start(path, input, video, &access, options); !ok) {
    return Propagate(ok.error());
  }
  return std::unique_ptr<VideoWriter>(new VideoWriter(std::move(impl)));
}

Result<std::unique_ptr<VideoWriter>> VideoWriter::Create(const std::string& path,
                                                         const VideoDescription& description,
                                                         const WriterOptions& options) {
  auto impl = std::make_unique<Impl>();
  impl->logger = options.logger != nullptr ? options.logger : SilentLogger();
  if (description.width < 1 || description.height < 1 || description.width > kMaxPictureSide ||
      description.height > kMaxPictureSide) {
    return Fail(ErrorCode::kInvalidArgument, "{}: pictures of {}x{} pixels are not possible", path,
                description.width, description.height);
  }
  impl->width = description.width;
  impl->height = description.height;
  impl->layout = description.layout;
  impl->format = FormatOf(description.layout);
  if (impl->format == AV_PIX_FMT_NONE) {
    return Fail(ErrorCode::kUnsupported,
                "{}: no pixel format of libav lies in memory like the frames to be written", path);
  }
  EncoderInput input;
  input.frame_rate = description.frame_rate;
  input.time_base = description.time_base.num > 0
                        ? description.time_base
                        : Rational{description.frame_rate.den, description.frame_rate.num};
  input.sample_aspect_ratio = description.sample_aspect_ratio;
  input.color = ColorOf(description.color);
  if (input.color.range == AVCOL_RANGE_UNSPECIFIED && description.layout.full_range) {
    input.color.range = AVCOL_RANGE_JPEG;
  }
  if (input.color.chroma_location == AVCHROMA_LOC_UNSPECIFIED) {
    input.color.chroma_location = SitingOf(description.layout);
  }
  MuxerVideo video;
  video.rotation_degrees = description.rotation_degrees;
  video.metadata = description.metadata;
  if (Status ok = impl->Start(path, input, video, nullptr, options); !ok) {
    return Propagate(ok.error());
  }
  return std::unique_ptr<VideoWriter>(new VideoWriter(std::move(impl)));
}

Status VideoWriter::Impl::Encode(const Frame& frame, std::int64_t pts, std::int64_t duration) {
  if (muxer == nullptr) {
    return Fail(ErrorCode::kInternal, "a frame was written after the clip was finished");
  }
  if (frame.width != width || frame.height != height || !(frame.layout == layout)) {
    return Fail(ErrorCode::kInvalidArgument,
                "{}: frame {} is {}x{} or lies differently in memory; the clip is {}x{}",
                file->path(), frames_written, frame.width, frame.height, width, height);
  }
  if (last_pts && pts <= *last_pts) {
    return Fail(ErrorCode::kInvalidArgument,
                "{}: frame {} has the time {}, not after {} of the one before", file->path(),
                frames_written, pts, *last_pts);
  }
  Result<AvFramePtr> picture = SharePicture(frame, format);
  if (!picture) {
    return Propagate(picture.error());
  }
  if (Status ok = DrainOthers(); !ok) {
    return ok;
  }
  if (Status ok = encoder->Send(std::move(*picture), pts, duration); !ok) {
    return Propagate(ok.error(), file->path());
  }
  last_pts = pts;
  ++frames_written;
  return DrainEncoder();
}

Status VideoWriter::Impl::DrainEncoder() {
  while (true) {
    Result<AvPacketPtr> packet = encoder->Receive();
    if (!packet) {
      return Propagate(packet.error(), file->path());
    }
    if (*packet == nullptr) {
      return {};
    }
    if (Status ok = muxer->WriteVideo(**packet); !ok) {
      return ok;
    }
  }
}

Status VideoWriter::Impl::DrainOthers() {
  if (others == nullptr) {
    return {};
  }
  while (const AvPacketPtr packet = others->Pop()) {
    if (Status ok = muxer->WriteCopied(*packet); !ok) {
      return ok;
    }
  }
  return {};
}

Status VideoWriter::Write(const VideoFrame& frame) {
  const FrameOrigin* origin = OriginOf(frame.frame);
  return impl_->Encode(frame.frame, frame.pts, origin != nullptr ? origin->duration : 0);
}

Status VideoWriter::Write(const Frame& frame) {
  if (const FrameOrigin* origin = OriginOf(frame)) {
    return impl_->Encode(frame, origin->pts, origin->duration);
  }
  return impl_->Encode(frame, impl_->last_pts ? *impl_->last_pts + impl_->period : 0, 0);
}

Status VideoWriter::Finish() {
  Impl& impl = *impl_;
  if (impl.muxer == nullptr) {
    return Fail(ErrorCode::kInternal, "the clip was finished twice");
  }
  const auto complete = [&impl]() -> Status {
    if (Status ok = impl.encoder->Flush(); !ok) {
      return Propagate(ok.error(), impl.file->path());
    }
    if (Status ok = impl.DrainEncoder(); !ok) {
      return ok;
    }
    if (Status ok = impl.DrainOthers(); !ok) {
      return ok;
    }
    return impl.muxer->Finish();
  };
  const Status completed = complete();
  impl.muxer.reset();
  const Status committed = completed ? impl.file->Commit() : completed;
  impl.file.reset();  // removes what was not committed
  if (impl.others != nullptr) {
    impl.others->Close();
  }
  return committed;
}

const std::string& VideoWriter::encoder_name() const { return impl_->encoder_name; }
const std::string& VideoWriter::pixel_format() const { return impl_->pixel_format; }
std::int64_t VideoWriter::frames_written() const { return impl_->frames_written; }

}  // namespace rsstab::media
