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
      text += fmt::format("{}{}={}", text.empty() ? "" : " ", key, value);
    }
    return text;
  };
  return spec;
}

pipeline::OptionTable<EncodeOptions> BuildTable() {
  pipeline::OptionTableBuilder<EncodeOptions> table;
  using O = EncodeOptions;

  table.Group("Output", pipeline::OptionStage::kRender);
  table.Add(
      pipeline::TextOption("output", "FILE", &O::output, 'o'),
      "Clip to write; its ending chooses the container, - writes Matroska to standard output. "
      "Without it the clip lies beside the input, with -stable added to the name.");
  table.Add(pipeline::SwitchOption("overwrite", &O::overwrite),
            "Replace the output file, and the report, if they exist.");
  table.Add(
      pipeline::TextOption("report", "FILE", &O::report),
      "Also write an HTML page, all in one file: pictures before and after, the camera path, the "
      "motion within the frames, what was used and how long it took.");

  table.Group("Encoding", pipeline::OptionStage::kRender);
  table.Add(
      pipeline::TextOption("codec", "NAME", &O::codec),
      "h264, hevc, vp9, av1, mpeg4, mjpeg, ffv1, prores, or the name of any encoder of libavcodec. "
      "Without it what fits the container: H.264 where it can.");
  table.Add(
      pipeline::RealOption("crf", "N", &O::crf, {0.0, 51.0}),
      "Constant quality on the scale of x264, lower is better and larger. Without it 18 for H.264 "
      "and "
      "similar elsewhere.");
  table.Add(
      pipeline::TextOption("preset", "NAME", &O::preset),
      "Speed against size: ultrafast to veryslow, or the encoder's own word. Without it medium.");
  table.Add(
      pipeline::TextOption("pix-fmt", "NAME", &O::pix_fmt),
      "Pixel format to encode, such as yuv420p or yuv420p10le. Without it the clip's own, or the "
      "nearest one that the encoder takes.");
  table.Add(PassThroughOption(),
            "Any other option of the encoder, passed on as it is. May be given several times.");
  return table.Take();
}

}  // namespace

const pipeline::OptionTable<EncodeOptions>& EncodeOptionTable() {
  static const pipeline::OptionTable<EncodeOptions> table = BuildTable();
  return table;
}

}  // namespace rsstab::cli
