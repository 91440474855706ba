// SPDX-License-Identifier: Apache-2.0
#include "cli/media/stream_copy.h"

extern "C" {
#include <libavutil/mastering_display_metadata.h>
}

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <string_view>

#include "cli/media/container.h"

namespace rsstab::media {
namespace {

// Written by the container or the encoder itself; a copy would be wrong.
constexpr std::array<std::string_view, 6> kOwnedKeys = {
    "major_brand", "minor_version", "compatible_brands", "encoder", "vendor_id", "duration"};

// Keys with a place of their own in MP4; any other key needs its free-form table.
constexpr std::array<std::string_view, 18> kOrdinaryKeys = {
    "title",   "artist",   "album_artist", "composer", "album",         "date",
    "comment", "genre",    "copyright",    "grouping", "lyrics",        "description",
    "track",   "synopsis", "show",         "location", "creation_time", "timecode"};

template <std::size_t N>
bool Contains(const std::array<std::string_view, N>& keys, std::string_view key) {
  return std::find(keys.begin(), keys.end(), key) != keys.end();
}

int AddSideData(AVStream& target, AVPacketSideDataType type, const std::uint8_t* data,
                std::size_t size) {
  std::uint8_t* copy = av_stream_new_side_data(&target, type, size);
  if (copy == nullptr) {
    return AVERROR(ENOMEM);
  }
  std::memcpy(copy, data, size);
  return 0;
}

}  // namespace

bool ContainerTakes(const AVOutputFormat& format, const AVStream& stream) {
  const AVCodecParameters& parameters = *stream.codecpar;
  if (parameters.codec_type == AVMEDIA_TYPE_DATA) {
    // MP4 knows GoPro's track by its letters; the other kinds (time codes, index tracks) belong to
    // the old file's structure.
    constexpr unsigned kGpmd = MKTAG('g', 'p', 'm', 'd');
    if (IsMp4Like(format)) {
      return parameters.codec_tag == kGpmd;
    }
    return parameters.codec_id != AV_CODEC_ID_NONE && parameters.codec_id != AV_CODEC_ID_BIN_DATA &&
           avformat_query_codec(&format, parameters.codec_id, FF_COMPLIANCE_NORMAL) == 1;
  }
  const bool is_cover = parameters.codec_type == AVMEDIA_TYPE_VIDEO &&
                        (stream.disposition & AV_DISPOSITION_ATTACHED_PIC) != 0;
  if (parameters.codec_type == AVMEDIA_TYPE_VIDEO && !is_cover) {
    return false;  // a second picture that would not move like the first
  }
  if (parameters.codec_id == AV_CODEC_ID_NONE) {
    return false;
  }
  if (parameters.codec_type == AVMEDIA_TYPE_ATTACHMENT) {
    return std::string_view(format.name) == "matroska";
  }
  return avformat_query_codec(&format, parameters.codec_id, FF_COMPLIANCE_NORMAL) != 0;
}

std::string StreamName(const AVStream& stream) {
  const AVCodecParameters& parameters = *stream.codecpar;
  const char* type = av_get_media_type_string(parameters.codec_type);
  std::string codec = avcodec_get_name(parameters.codec_id);
  if (parameters.codec_type == AVMEDIA_TYPE_DATA && parameters.codec_tag != 0) {
    std::array<char, AV_FOURCC_MAX_STRING_SIZE> letters{};
    codec = av_fourcc_make_string(letters.data(), parameters.codec_tag);
  }
  return fmt::format("{} stream {} ({})", type != nullptr ? type : "unknown", stream.index, codec);
}

int CopyDescription(const AVOutputFormat& format, const AVStream& source, AVStream& target) {
  if (const int code = avcodec_parameters_copy(target.codecpar, source.codecpar); code < 0) {
    return code;
  }
  // A tag of the old container is kept if it means the same codec in the new one.
  unsigned tag = 0;
  const AVCodecID codec = source.codecpar->codec_id;
  const bool is_data = source.codecpar->codec_type == AVMEDIA_TYPE_DATA;
  const bool keeps_tag = is_data || format.codec_tag == nullptr ||
                         av_codec_get_id(format.codec_tag, source.codecpar->codec_tag) == codec ||
                         av_codec_get_tag2(format.codec_tag, codec, &tag) == 0;
  if (!keeps_tag) {
    target.codecpar->codec_tag = 0;
  }
  target.time_base = source.time_base;
  target.disposition = source.disposition;
  target.avg_frame_rate = source.avg_frame_rate;
  target.sample_aspect_ratio = source.sample_aspect_ratio;
  target.duration = source.duration;
  for (int i = 0; i < source.nb_side_data; ++i) {
    const AVPacketSideData& data = source.side_data[i];
    if (const int code = AddSideData(target, data.type, data.data, data.size); code < 0) {
      return code;
    }
  }
  return CopyMetadata(source.metadata, &target.metadata);
}

int CopyVideoSideData(const AVStream& source, const AVFrame* first_frame_properties,
                      AVStream& target) {
  constexpr std::array kKept = {AV_PKT_DATA_DISPLAYMATRIX, AV_PKT_DATA_MASTERING_DISPLAY_METADATA,
                                AV_PKT_DATA_CONTENT_LIGHT_LEVEL, AV_PKT_DATA_STEREO3D,
                                AV_PKT_DATA_SPHERICAL};
  for (int i = 0; i < source.nb_side_data; ++i) {
    const AVPacketSideData& data = source.side_data[i];
    if (std::find(kKept.begin(), kKept.end(), data.type) == kKept.end()) {
      continue;
    }
    if (const int code = AddSideData(target, data.type, data.data, data.size); code < 0) {
      return code;
    }
  }
  // Some files carry HDR10 data with the pictures only; the container has a place for it.
  const auto from_frame = [&](AVFrameSideDataType type, AVPacketSideDataType stream_type) {
    const AVFrameSideData* data = first_frame_properties != nullptr
                                      ? av_frame_get_side_data(first_frame_properties, type)
                                      : nullptr;
    if (data == nullptr || av_stream_get_side_data(&target, stream_type, nullptr) != nullptr) {
      return 0;
    }
    return AddSideData(target, stream_type, data->data, data->size);
  };
  if (const int code = from_frame(AV_FRAME_DATA_MASTERING_DISPLAY_METADATA,
                                  AV_PKT_DATA_MASTERING_DISPLAY_METADATA);
      code < 0) {
    return code;
  }
  return from_frame(AV_FRAME_DATA_CONTENT_LIGHT_LEVEL, AV_PKT_DATA_CONTENT_LIGHT_LEVEL);
}

int CopyMetadata(const AVDictionary* source, AVDictionary** target) {
  const AVDictionaryEntry* entry = nullptr;
  while ((entry = av_dict_get(source, "", entry, AV_DICT_IGNORE_SUFFIX)) != nullptr) {
    if (Contains(kOwnedKeys, entry->key)) {
      continue;
    }
    if (const int code = av_dict_set(target, entry->key, entry->value, 0); code < 0) {
      return code;
    }
  }
  return 0;
}

bool HasSpecialMetadata(const AVDictionary* metadata) {
  const AVDictionaryEntry* entry = nullptr;
  while ((entry = av_dict_get(metadata, "", entry, AV_DICT_IGNORE_SUFFIX)) != nullptr) {
    if (!Contains(kOwnedKeys, entry->key) && !Contains(kOrdinaryKeys, entry->key)) {
      return true;
    }
  }
  return false;
}

}  // namespace rsstab::media
