// SPDX-License-Identifier: Apache-2.0
#include "cli/media/telemetry_track.h"

#include <cerrno>

#include "cli/media/av_error.h"
#include "cli/media/av_handles.h"
#include "cli/media/input_file.h"

namespace rsstab::media {

Result<std::vector<TelemetryPayload>> ReadTelemetry(const std::string& path,
                                                    const std::string& kind) {
  Result<AvInputPtr> opened = OpenInput(path, nullptr);
  if (!opened) {
    return Propagate(opened.error());
  }
  AVFormatContext& input = **opened;
  int track = -1;
  for (unsigned i = 0; i < input.nb_streams; ++i) {
    AVStream& stream = *input.streams[i];
    const bool wanted = track < 0 && stream.codecpar->codec_type == AVMEDIA_TYPE_DATA &&
                        FourLetterKind(*stream.codecpar) == kind;
    stream.discard = wanted ? AVDISCARD_DEFAULT : AVDISCARD_ALL;
    if (wanted) {
      track = static_cast<int>(i);
    }
  }
  if (track < 0) {
    return Fail(ErrorCode::kNotFound, "{}: there is no '{}' data track in this file", path, kind);
  }
  const double tick_s = av_q2d(input.streams[track]->time_base);

  std::vector<TelemetryPayload> payloads;
  const AvPacketPtr packet(av_packet_alloc());
  if (packet == nullptr) {
    return AvFail(AVERROR(ENOMEM), "reading " + path);
  }
  // A file that ends early still gives the payloads before its end.
  while (av_read_frame(&input, packet.get()) >= 0) {
    if (packet->stream_index == track && packet->size > 0) {
      TelemetryPayload payload;
      payload.bytes.assign(packet->data, packet->data + packet->size);
      const std::int64_t start = packet->pts != AV_NOPTS_VALUE ? packet->pts : packet->dts;
      if (start != AV_NOPTS_VALUE) {
        payload.start_s = static_cast<double>(start) * tick_s;
      } else if (!payloads.empty()) {
        payload.start_s = payloads.back().start_s + payloads.back().duration_s;
      }
      payload.duration_s = static_cast<double>(packet->duration) * tick_s;
      payloads.push_back(std::move(payload));
    }
    av_packet_unref(packet.get());
  }
  if (payloads.empty()) {
    return Fail(ErrorCode::kCorruptData, "{}: the '{}' data track holds no data", path, kind);
  }
  return payloads;
}

}  // namespace rsstab::media
