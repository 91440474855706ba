// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_MEDIA_AV_HANDLES_H_
#define RSSTAB_CLI_MEDIA_AV_HANDLES_H_

// Owning pointers for libav objects, and the one place that includes libav's C headers. For this
// module only.

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libswscale/swscale.h>
}

#include <memory>

namespace rsstab::media {

struct AvDeleter {
  void operator()(AVFrame* p) const { av_frame_free(&p); }
  void operator()(AVPacket* p) const { av_packet_free(&p); }
  void operator()(AVCodecContext* p) const { avcodec_free_context(&p); }
  void operator()(AVCodecParameters* p) const { avcodec_parameters_free(&p); }
  void operator()(SwsContext* p) const { sws_freeContext(p); }
  void operator()(AVDictionary* p) const { av_dict_free(&p); }
};

using AvFramePtr = std::unique_ptr<AVFrame, AvDeleter>;
using AvPacketPtr = std::unique_ptr<AVPacket, AvDeleter>;
using AvCodecContextPtr = std::unique_ptr<AVCodecContext, AvDeleter>;
using AvCodecParametersPtr = std::unique_ptr<AVCodecParameters, AvDeleter>;
using SwsContextPtr = std::unique_ptr<SwsContext, AvDeleter>;

// libav's functions take AVDictionary** and replace what it points to, so this one hands out the
// address.
class AvDictionary {
 public:
  AvDictionary() = default;
  ~AvDictionary() { av_dict_free(&dictionary_); }
  AvDictionary(const AvDictionary&) = delete;
  AvDictionary& operator=(const AvDictionary&) = delete;

  [[nodiscard]] AVDictionary** address() { return &dictionary_; }
  [[nodiscard]] const AVDictionary* get() const { return dictionary_; }
  void Set(const char* key, const char* value) { av_dict_set(&dictionary_, key, value, 0); }

 private:
  AVDictionary* dictionary_ = nullptr;
};

struct AvInputCloser {
  void operator()(AVFormatContext* p) const { avformat_close_input(&p); }
};
using AvInputPtr = std::unique_ptr<AVFormatContext, AvInputCloser>;

// Output contexts do not own their AVIOContext here, see output_file.h.
struct AvOutputFreer {
  void operator()(AVFormatContext* p) const { avformat_free_context(p); }
};
using AvOutputPtr = std::unique_ptr<AVFormatContext, AvOutputFreer>;

}  // namespace rsstab::media

#endif  // RSSTAB_CLI_MEDIA_AV_HANDLES_H_
