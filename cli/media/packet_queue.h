// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_MEDIA_PACKET_QUEUE_H_
#define RSSTAB_CLI_MEDIA_PACKET_QUEUE_H_

// How packets of audio, subtitles and the like get from the reader, which demuxes them between
// video packets, to the writer, which copies them (includes libav).

#include <deque>
#include <mutex>
#include <utility>

#include "cli/media/av_handles.h"

namespace rsstab::media {

// The reader pushes, the writer pops, each from its own thread. It holds what lies between the
// frame being decoded and the frame being written. Handing packets over, rather than reading the
// file again, is what makes copying work from pipes and keeps both in step.
class PacketQueue {
 public:
  // Until somebody takes the packets, or once nobody will, they are dropped.
  void Push(AvPacketPtr packet) {
    const std::lock_guard lock(mutex_);
    if (is_open_) {
      packets_.push_back(std::move(packet));
    }
  }
  // The oldest packet, null when there is none.
  [[nodiscard]] AvPacketPtr Pop() {
    const std::lock_guard lock(mutex_);
    if (packets_.empty()) {
      return nullptr;
    }
    AvPacketPtr packet = std::move(packets_.front());
    packets_.pop_front();
    return packet;
  }
  void Close() {
    const std::lock_guard lock(mutex_);
    is_open_ = false;
    packets_.clear();
  }

 private:
  std::mutex mutex_;
  std::deque<AvPacketPtr> packets_;
  bool is_open_ = true;
};

}  // namespace rsstab::media

#endif  // RSSTAB_CLI_MEDIA_PACKET_QUEUE_H_
