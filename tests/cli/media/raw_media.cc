// SPDX-License-Identifier: Apache-2.0
#include "tests/cli/media/raw_media.h"

extern "C" {
#include <libavutil/display.h>
#include <libavutil/mastering_display_metadata.h>
}

#include <algorithm>
#include <array>
#include <random>
#include <stdexcept>

#include "cli/media/av_handles.h"
#include "cli/media/av_log.h"

// Asked by the leak checker of a sanitized build: x265 does not free all it allocates.
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() { return "leak:libx265\n"; }

namespace rsstab::media::testing {
namespace {

std::map<std::string, std::string> ToMap(const AVDictionary* dictionary) {
  std::map<std::string, std::string> map;
  const AVDictionaryEntry* entry = nullptr;
  while ((entry = av_dict_get(dictionary, "", entry, AV_DICT_IGNORE_SUFFIX)) != nullptr) {
    map[entry->key] = entry->value;
  }
  return map;
}

void Check(int code, const char* what) {
  if (code < 0) {
    std::array<char, AV_ERROR_MAX_STRING_SIZE> text{};
    av_strerror(code, text.data(), text.size());
    throw std::runtime_error(std::string(what) + ": " + text.data());
  }
}

AvInputPtr OpenRaw(const std::filesystem::path& path) {
  RouteAvLog();
  AVFormatContext* input = nullptr;
  Check(avformat_open_input(&input, path.c_str(), nullptr, nullptr), "open");
  AvInputPtr owner(input);
  Check(avformat_find_stream_info(input, nullptr), "probe");
  return owner;
}

std::vector<std::uint8_t> RandomBytes(std::size_t count, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<std::uint8_t> bytes(count);
  for (std::uint8_t& byte : bytes) {
    byte = static_cast<std::uint8_t>(random());
  }
  return bytes;
}

// One file being put together.
class Remuxer {
 public:
  Remuxer(const std::filesystem::path& target, const RemuxRecipe& recipe) : recipe_(recipe) {
    AVFormatContext* output = nullptr;
    Check(avformat_alloc_output_context2(&output, nullptr, nullptr, target.c_str()), "allocate");
    output_.reset(output);
    Check(avio_open(&output->pb, target.c_str(), AVIO_FLAG_WRITE), "create");
  }
  ~Remuxer() { avio_closep(&output_->pb); }

  AVStream* Add(AVMediaType type, AVCodecID codec, AVRational time_base) {
    AVStream* stream = avformat_new_stream(output_.get(), nullptr);
    stream->codecpar->codec_type = type;
    stream->codecpar->codec_id = codec;
    stream->time_base = time_base;
    return stream;
  }

  static void SetExtradata(AVStream& stream, const std::vector<std::uint8_t>& bytes) {
    stream.codecpar->extradata =
        static_cast<std::uint8_t*>(av_mallocz(bytes.size() + AV_INPUT_BUFFER_PADDING_SIZE));
    std::copy(bytes.begin(), bytes.end(), stream.codecpar->extradata);
    stream.codecpar->extradata_size = static_cast<int>(bytes.size());
  }

  void AddVideo(const AVStream& source) {
    AVStream* stream = avformat_new_stream(output_.get(), nullptr);
    Check(avcodec_parameters_copy(stream->codecpar, source.codecpar), "describe");
    stream->codecpar->codec_tag = 0;
    stream->time_base = recipe_.video_times.empty() ? source.time_base : AVRational{1, 90000};
    stream->avg_frame_rate = source.avg_frame_rate;
    if (recipe_.rotation_degrees) {
      auto* matrix = reinterpret_cast<std::int32_t*>(
          av_stream_new_side_data(stream, AV_PKT_DATA_DISPLAYMATRIX, 9 * sizeof(std::int32_t)));
      av_display_rotation_set(matrix, -*recipe_.rotation_degrees);
    }
    if (recipe_.with_hdr) {
      AddHdr(*stream);
    }
  }

  static void AddHdr(AVStream& stream) {
    std::size_t size = 0;
    AVMasteringDisplayMetadata* display = av_mastering_display_metadata_alloc();
    display->display_primaries[0][0] = {34000, 50000};
    display->display_primaries[0][1] = {16000, 50000};
    display->display_primaries[1][0] = {13250, 50000};
    display->display_primaries[1][1] = {34500, 50000};
    display->display_primaries[2][0] = {7500, 50000};
    display->display_primaries[2][1] = {3000, 50000};
    display->white_point[0] = {15635, 50000};
    display->white_point[1] = {16450, 50000};
    display->min_luminance = {50, 10000};
    display->max_luminance = {10000000, 10000};
    display->has_primaries = 1;
    display->has_luminance = 1;
    av_stream_add_side_data(&stream, AV_PKT_DATA_MASTERING_DISPLAY_METADATA,
                            reinterpret_cast<std::uint8_t*>(display), sizeof(*display));
    AVContentLightMetadata* light = av_content_light_metadata_alloc(&size);
    light->MaxCLL = 1000;
    light->MaxFALL = 400;
    av_stream_add_side_data(&stream, AV_PKT_DATA_CONTENT_LIGHT_LEVEL,
                            reinterpret_cast<std::uint8_t*>(light), size);
  }

  void AddOthers() {
    if (recipe_.with_audio) {
      AVStream* audio = Add(AVMEDIA_TYPE_AUDIO, AV_CODEC_ID_AAC, {1, 44100});
      audio->codecpar->sample_rate = 44100;
      audio->codecpar->ch_layout = AV_CHANNEL_LAYOUT_STEREO;
      audio->codecpar->frame_size = 1024;
      audio->codecpar->bit_rate = 64000;
      SetExtradata(*audio, {0x12, 0x10});  // AAC-LC, 44100 Hz, stereo
      av_dict_set(&audio->metadata, "language", "fra", 0);
      audio_ = audio->index;
    }
    if (!recipe_.subtitle_codec.empty()) {
      const AVCodecDescriptor* codec =
          avcodec_descriptor_get_by_name(recipe_.subtitle_codec.c_str());
      AVStream* subtitle = Add(AVMEDIA_TYPE_SUBTITLE, codec->id, {1, 1000});
      av_dict_set(&subtitle->metadata, "language", "deu", 0);
      subtitle_ = subtitle->index;
    }
    if (recipe_.with_data) {
      AVStream* data = Add(AVMEDIA_TYPE_DATA, AV_CODEC_ID_BIN_DATA, {1, 1000});
      data->codecpar->codec_tag = MKTAG('g', 'p', 'm', 'd');
      data_ = data->index;
    }
    if (recipe_.with_attachment) {
      AVStream* attachment = Add(AVMEDIA_TYPE_ATTACHMENT, AV_CODEC_ID_TTF, {1, 1000});
      SetExtradata(*attachment, RandomBytes(500, 3));
      av_dict_set(&attachment->metadata, "filename", "letters.ttf", 0);
      av_dict_set(&attachment->metadata, "mimetype", "application/x-truetype-font", 0);
    }
    for (const auto& [key, value] : recipe_.metadata) {
      av_dict_set(&output_->metadata, key.c_str(), value.c_str(), 0);
    }
    if (recipe_.with_chapters) {
      output_->chapters = static_cast<AVChapter**>(av_calloc(2, sizeof(AVChapter*)));
      for (int i = 0; i < 2; ++i) {
        auto* chapter = static_cast<AVChapter*>(av_mallocz(sizeof(AVChapter)));
        chapter->id = i + 1;
        chapter->time_base = {1, 1000};
        chapter->start = i * 200;
        chapter->end = (i + 1) * 200;
        av_dict_set(&chapter->metadata, "title", i == 0 ? "Departure" : "Arrival", 0);
        output_->chapters[output_->nb_chapters++] = chapter;
      }
    }
  }

  void Begin() {
    AvDictionary options;
    options.Set("movflags", "+use_metadata_tags");
    Check(avformat_write_header(output_.get(), options.address()), "header");
  }

  void WriteVideo(AVPacket& packet, AVRational time_base, int number) {
    const AVStream& stream = *output_->streams[0];
    if (std::find(recipe_.garbled_packets.begin(), recipe_.garbled_packets.end(), number) !=
        recipe_.garbled_packets.end()) {
      Check(av_packet_make_writable(&packet), "copy");
      const std::vector<std::uint8_t> garbage =
          RandomBytes(static_cast<std::size_t>(packet.size), 11);
      // The length field in front stays, so that the packet still parses.
      std::copy(garbage.begin() + std::min<std::ptrdiff_t>(5, packet.size), garbage.end(),
                packet.data + std::min(5, packet.size));
    }
    if (!recipe_.video_times.empty()) {
      const auto index = static_cast<std::size_t>(number);
      packet.pts = recipe_.video_times.at(index);
      packet.dts = (number - 20) * 3000;  // early enough for any of them
      packet.duration = 3000;
      time_base = {1, 90000};
    }
    av_packet_rescale_ts(&packet, time_base, stream.time_base);
    packet.stream_index = 0;
    packet.pos = -1;
    Check(av_interleaved_write_frame(output_.get(), &packet), "video packet");
  }

  void WriteOthers(double duration_s) {
    if (audio_ >= 0) {
      for (int i = 0; i * 1024 < duration_s * 44100; ++i) {
        WriteBytes(audio_, {1, 44100}, recipe_.audio_start + i * 1024, 1024,
                   RandomBytes(static_cast<std::size_t>(90 + i % 7), static_cast<unsigned>(i)));
      }
    }
    if (subtitle_ >= 0) {
      for (int i = 0; i < 2; ++i) {
        std::string text = i == 0 ? "first line" : "second line";
        if (recipe_.subtitle_codec == "mov_text") {
          text.insert(0, {'\0', static_cast<char>(text.size())});
        }
        WriteBytes(subtitle_, {1, 1000}, 100 + 150 * i, 100, {text.begin(), text.end()});
      }
    }
    if (data_ >= 0 && recipe_.data_packets.empty()) {
      for (int i = 0; i < duration_s; ++i) {
        WriteBytes(data_, {1, 1000}, i * 1000, 1000, RandomBytes(64, static_cast<unsigned>(i)));
      }
    }
    for (std::size_t i = 0; data_ >= 0 && i < recipe_.data_packets.size(); ++i) {
      WriteBytes(data_, {1, 1000}, static_cast<std::int64_t>(i) * 1000, 1000,
                 recipe_.data_packets[i]);
    }
  }

  void WriteBytes(int index, AVRational time_base, std::int64_t pts, std::int64_t duration,
                  const std::vector<std::uint8_t>& bytes) {
    const AvPacketPtr packet(av_packet_alloc());
    Check(av_new_packet(packet.get(), static_cast<int>(bytes.size())), "packet");
    std::copy(bytes.begin(), bytes.end(), packet->data);
    packet->pts = pts;
    packet->dts = pts;
    packet->duration = duration;
    packet->flags = AV_PKT_FLAG_KEY;
    packet->stream_index = index;
    av_packet_rescale_ts(packet.get(), time_base, output_->streams[index]->time_base);
    Check(av_interleaved_write_frame(output_.get(), packet.get()), "packet");
  }

  void End() { Check(av_write_trailer(output_.get()), "trailer"); }

 private:
  const RemuxRecipe& recipe_;
  AvOutputPtr output_;
  int audio_ = -1;
  int subtitle_ = -1;
  int data_ = -1;
};

}  // namespace

std::vector<const StreamContent*> FileContent::OfType(const std::string& type) const {
  std::vector<const StreamContent*> found;
  for (const StreamContent& stream : streams) {
    if (stream.type == type) {
      found.push_back(&stream);
    }
  }
  return found;
}

FileContent Inspect(const std::filesystem::path& path) {
  const AvInputPtr input = OpenRaw(path);
  FileContent content;
  content.metadata = ToMap(input->metadata);
  for (unsigned i = 0; i < input->nb_chapters; ++i) {
    const AVChapter& chapter = *input->chapters[i];
    content.chapters.emplace_back(static_cast<double>(chapter.start) * av_q2d(chapter.time_base),
                                  ToMap(chapter.metadata)["title"]);
  }
  for (unsigned i = 0; i < input->nb_streams; ++i) {
    const AVStream& stream = *input->streams[i];
    const AVCodecParameters& parameters = *stream.codecpar;
    StreamContent found;
    found.type = av_get_media_type_string(parameters.codec_type);
    found.codec = avcodec_get_name(parameters.codec_id);
    std::array<char, AV_FOURCC_MAX_STRING_SIZE> letters{};
    found.tag = av_fourcc_make_string(letters.data(), parameters.codec_tag);
    found.metadata = ToMap(stream.metadata);
    if (parameters.extradata_size > 0) {
      found.extradata.assign(parameters.extradata,
                             parameters.extradata + parameters.extradata_size);
    }
    content.streams.push_back(std::move(found));
  }
  const AvPacketPtr packet(av_packet_alloc());
  while (av_read_frame(input.get(), packet.get()) >= 0) {
    const auto index = static_cast<std::size_t>(packet->stream_index);
    if (packet->size > 0 && index < content.streams.size()) {
      const double tick_s = av_q2d(input->streams[index]->time_base);
      content.streams[index].packets.push_back({static_cast<double>(packet->pts) * tick_s,
                                                static_cast<double>(packet->duration) * tick_s,
                                                {packet->data, packet->data + packet->size}});
    }
    av_packet_unref(packet.get());
  }
  return content;
}

void Remux(const std::filesystem::path& source, const std::filesystem::path& target,
           const RemuxRecipe& recipe) {
  const AvInputPtr input = OpenRaw(source);
  Remuxer remuxer(target, recipe);
  remuxer.AddVideo(*input->streams[0]);
  remuxer.AddOthers();
  remuxer.Begin();
  const AvPacketPtr packet(av_packet_alloc());
  double end_s = 0.0;
  int number = 0;
  while (av_read_frame(input.get(), packet.get()) >= 0) {
    const AVRational time_base = input->streams[0]->time_base;
    end_s =
        std::max(end_s, static_cast<double>(packet->pts + packet->duration) * av_q2d(time_base));
    remuxer.WriteVideo(*packet, time_base, number++);
  }
  remuxer.WriteOthers(end_s);
  remuxer.End();
}

bool HasEncoder(const std::string& name) {
  return avcodec_find_encoder_by_name(name.c_str()) != nullptr;
}

}  // namespace rsstab::media::testing
