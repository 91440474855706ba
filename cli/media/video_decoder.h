// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_MEDIA_VIDEO_DECODER_H_
#define RSSTAB_CLI_MEDIA_VIDEO_DECODER_H_

// Demuxing and decoding of one video stream, damage included (includes libav).

#include <cstdint>
#include <memory>
#include <string>

#include "cli/media/av_handles.h"
#include "cli/media/packet_queue.h"
#include "igf/base/log.h"
#include "igf/base/result.h"

namespace rsstab::media {

// Yields the pictures of one stream in presentation order, and hands the packets of all other
// streams that are not set to be discarded to a queue. Not thread safe.
class VideoDecoder {
 public:
  // Takes `input` over. num_threads: 0 = one per core. `logger` must outlive the decoder.
  // Errors: kNotFound (no decoder for the codec), kUnsupported, kIo.
  [[nodiscard]] static Result<std::unique_ptr<VideoDecoder>> Open(AvInputPtr input, int stream,
                                                                  int num_threads,
                                                                  const Logger* logger,
                                                                  const std::string& path);

  // The next picture, null at the end. Damaged packets are counted and skipped or concealed.
  // Errors: kIo when out of memory.
  [[nodiscard]] Result<AvFramePtr> Next();

  [[nodiscard]] AVFormatContext& input() { return *input_; }
  [[nodiscard]] const AVStream& stream() const { return *input_->streams[stream_]; }
  [[nodiscard]] const std::shared_ptr<PacketQueue>& other_packets() const { return others_; }
  // Packets or pictures that were damaged so far.
  [[nodiscard]] std::int64_t damaged_count() const { return damaged_count_; }
  // The file ended before its own structure says so.
  [[nodiscard]] bool ended_early() const { return ended_early_; }

 private:
  VideoDecoder() = default;

  // Sends one packet (or the end) to the codec. Errors as Next().
  [[nodiscard]] Status Feed();
  // 0, or an AVERROR at the end of the file.
  [[nodiscard]] int ReadPacket(AVPacket& packet);

  std::string path_;
  AvInputPtr input_;
  AvCodecContextPtr codec_;
  AvPacketPtr packet_;
  int stream_ = 0;
  unsigned known_streams_ = 0;
  std::shared_ptr<PacketQueue> others_ = std::make_shared<PacketQueue>();
  bool is_flushing_ = false;
  bool ended_early_ = false;
  std::int64_t damaged_count_ = 0;
};

}  // namespace rsstab::media

#endif  // RSSTAB_CLI_MEDIA_VIDEO_DECODER_H_
