// SPDX-License-Identifier: Apache-2.0
#include "cli/pages/clip_showcase.h"

#include <spdlog/fmt/fmt.h>

#include <array>
#include <cmath>
#include <utility>

#include "cli/media/video_reader.h"
#include "cli/pages/page_parts.h"
#include "cli/report/difference_map.h"
#include "cli/report/preview.h"

namespace rsstab::cli {
namespace {

using report::Panel;

// Twice what a page shows side by side: sharp on a screen of fine pixels, and small.
constexpr int kPreviewWidth = 480;

// A frame made small, and which way up players show it.
struct Shown {
  Frame picture;
  int quarter_turns = 0;
};

Result<Shown> ShowFrame(const std::string& path, std::int64_t index) {
  const auto reader = media::VideoReader::Open(path, {0, SilentLogger()});
  if (!reader) {
    return Propagate(reader.error());
  }
  const media::VideoInfo& info = (*reader)->info();
  while (true) {
    const auto frame = (*reader)->Read();
    if (!frame) {
      return Propagate(frame.error());
    }
    if (!*frame) {
      return Fail(ErrorCode::kCorruptData, "{} ends before frame {}, which is to be shown", path,
                  index);
    }
    if ((*frame)->index < index) {
      continue;
    }
    auto picture = report::MakePreview((*frame)->frame.View(), kPreviewWidth,
                                       report::ColorMatrixOf(info.color.matrix, info.height));
    if (!picture) {
      return Propagate(picture.error());
    }
    return Shown{std::move(*picture), QuarterTurns(info)};
  }
}

Result<Panel> MakePanel(const std::string& title, const std::string& note, const Frame& picture,
                        int quarter_turns) {
  auto uri = DataUri(picture.View(), report::PictureFormat::kWebp, quarter_turns);
  if (!uri) {
    return Propagate(uri.error());
  }
  Panel panel{title, note, std::move(*uri), picture.width, picture.height};
  if (quarter_turns % 2 != 0) {
    std::swap(panel.width, panel.height);
  }
  return panel;
}

// Camera residual of one frame; empty where it was not measured.
std::optional<double> ResidualOf(const CompareReport::Clip& clip, std::size_t frame) {
  if (!clip.truth || frame >= clip.truth->frame_residual.size()) {
    return std::nullopt;
  }
  const auto residual = static_cast<double>(clip.truth->frame_residual[frame]);
  return std::isfinite(residual) ? std::optional(residual) : std::nullopt;
}

}  // namespace

ChosenFrame ChooseFrame(const CompareReport::Clip& input) {
  std::optional<std::size_t> chosen;
  double most = 0.0;
  const auto offer = [&](std::size_t frame, double value) {
    if (value > most) {
      most = value;
      chosen = frame;
    }
  };
  if (input.truth) {
    for (std::size_t n = 0; n < input.truth->frame_residual.size(); ++n) {
      offer(n, ResidualOf(input, n).value_or(0.0));
    }
    if (chosen) {
      return {static_cast<std::int64_t>(*chosen),
              fmt::format("the input is furthest from the truth there, {:.2f} px", most)};
    }
  }
  for (std::size_t n = 2; n < input.poses.size(); ++n) {
    offer(n, (input.poses[n].position - 2.0 * input.poses[n - 1].position +
              input.poses[n - 2].position)
                 .norm());
  }
  if (chosen) {
    return {static_cast<std::int64_t>(*chosen),
            fmt::format("the input's motion changes most there, by {:.1f} px", most)};
  }
  return {0, "nothing moves"};
}

Result<ClipShowcase> ClipShowcase::Create(const CompareReport::Clip& input, const std::string& twin,
                                          const std::optional<Camera>& camera) {
  ClipShowcase showcase(ChooseFrame(input));
  if (twin.empty()) {
    return showcase;
  }
  auto truth = ShowFrame(twin, showcase.frame_.index);
  if (!truth) {
    return Propagate(truth.error());
  }
  auto panel = MakePanel("truth", "", truth->picture, truth->quarter_turns);
  if (!panel) {
    return Propagate(panel.error());
  }
  showcase.twin_ = std::move(truth->picture);
  showcase.truth_ = std::move(*panel);
  showcase.camera_ = camera;
  return showcase;
}

Status ClipShowcase::Add(const std::string& method, const std::string& path,
                         const CompareReport::Clip& measured) {
  const auto shown = ShowFrame(path, frame_.index);
  if (!shown) {
    return Propagate(shown.error());
  }
  auto picture = MakePanel(method, "", shown->picture, shown->quarter_turns);
  if (!picture) {
    return Propagate(picture.error());
  }
  pictures_.push_back(std::move(*picture));
  if (!twin_ || !camera_) {
    return {};
  }
  const auto map = report::AlignedDifferenceMap(shown->picture.View(), twin_->View(), *camera_);
  if (!map) {
    return Propagate(map.error());
  }
  if (!*map) {
    return {};
  }
  const auto residual = ResidualOf(measured, static_cast<std::size_t>(frame_.index));
  auto panel = MakePanel(method, residual ? fmt::format("{:.2f} px", *residual) : "", **map,
                         shown->quarter_turns);
  if (!panel) {
    return Propagate(panel.error());
  }
  maps_.push_back(std::move(*panel));
  return {};
}

Status ClipShowcase::Show(report::HtmlPage& html) const {
  std::vector<Panel> pictures = pictures_;
  if (truth_) {
    pictures.push_back(*truth_);
  }
  html.AddGallery(pictures);
  if (maps_.empty()) {
    return {};
  }
  html.AddGallery(maps_);
  const auto key = DifferenceColorKey();
  if (!key) {
    return Propagate(key.error());
  }
  html.Add(std::array{*key});
  return {};
}

}  // namespace rsstab::cli
