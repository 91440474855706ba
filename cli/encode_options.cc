// SPDX-License-Identifier: Apache-2.0
#include "cli/encode_options.h"

namespace rsstab::cli {
namespace {

using Spec = pipeline::OptionSpec<EncodeOptions>;

Spec PassThroughOption() {
  Spec spec;
  spec.name = "encoder-option";
  spec.value_name = "KEY=VALUE";
  spec.repeatable = true;
  spec.set = [](EncodeOptions& options, const std::string& text) -> Status {
    const std::size_t split = text.find('=');
    if (split == std::string::npos || split == 0) {
      return pipeline::BadOption("encoder-option", text, "of the form KEY=VALUE");
    }
    options.encoder_options.emplace_back(text.substr(0, split), text.substr(split + 1));
    return {};
  };
  spec.get = [](const EncodeOptions& options) {
    std::string text;
    for (const auto& [key, value] : options.encoder_options) {
      text += (text.empty() ? "" : " ") + key + "=" + value;
    }
    return text;
  };
  return spec;
}

pipeline::OptionTable<EncodeOptions> BuildTable() {
  pipeline::OptionTable<EncodeOptions> table;
  const auto add = [&](Spec spec, std::string group, std::string help) {
    spec.group = std::move(group);
    spec.stage = pipeline::OptionStage::kRender;
    spec.help = std::move(help);
    table.push_back(std::move(spec));
  };
  using O = EncodeOptions;

  Spec output = pipeline::TextOption("output", "FILE", &O::output);
  output.short_name = 'o';
  add(std::move(output), "Output",
      "Clip to write; its ending chooses the container, - writes Matroska to standard output. "
      "Without it the clip lies beside the input, with -stable added to the name.");
  add(pipeline::SwitchOption("overwrite", &O::overwrite), "Output",
      "Replace the output file, and the report, if they exist.");
  add(pipeline::TextOption("report", "FILE", &O::report), "Output",
      "Also write an HTML page, all in one file: pictures before and after, the camera path, the "
      "motion within the frames, what was used and how long it took.");
  add(pipeline::TextOption("codec", "NAME", &O::codec), "Encoding",
      "h264, hevc, vp9, av1, mpeg4, mjpeg, ffv1, prores, or the name of any encoder of libavcodec. "
      "Without it what fits the container: H.264 where it can.");
  add(pipeline::RealOption("crf", "N", &O::crf, {0.0, 51.0}), "Encoding",
      "Constant quality on the scale of x264, lower is better and larger. Without it 18 for H.264 "
      "and "
      "similar elsewhere.");
  add(pipeline::TextOption("preset", "NAME", &O::preset), "Encoding",
      "Speed against size: ultrafast to veryslow, or the encoder's own word. Without it medium.");
  add(pipeline::TextOption("pix-fmt", "NAME", &O::pix_fmt), "Encoding",
      "Pixel format to encode, such as yuv420p or yuv420p10le. Without it the clip's own, or the "
      "nearest one that the encoder takes.");
  add(PassThroughOption(), "Encoding",
      "Any other option of the encoder, passed on as it is. May be given several times.");
  return table;
}

}  // namespace

const pipeline::OptionTable<EncodeOptions>& EncodeOptionTable() {
  static const pipeline::OptionTable<EncodeOptions> table = BuildTable();
  return table;
}

}  // namespace rsstab::cli
