// SPDX-License-Identifier: Apache-2.0
#include "evaluation/synthetic_sample.h"

#include <cmath>
#include <cstddef>
#include <utility>

#include "evaluation/exposure.h"
#include "igf/base/seeded_random.h"

namespace rsstab::evaluation {

std::vector<Eigen::Vector2f> PixelDisplacements(const MotionField& field) {
  std::vector<Eigen::Vector2f> displacement;
  displacement.reserve(static_cast<std::size_t>(field.width()) *
                       static_cast<std::size_t>(field.height()));
  for (int y = 0; y < field.height(); ++y) {
    for (int x = 0; x < field.width(); ++x) {
      displacement.emplace_back(field.Sample(Eigen::Vector2d(x, y)).cast<float>());
    }
  }
  return displacement;
}

std::vector<std::uint8_t> SourcesInside(const std::vector<Eigen::Vector2f>& displacement, int width,
                                        int height) {
  std::vector<std::uint8_t> inside(displacement.size());
  const auto inside_of = [](float source, int size) {
    return source >= -kEdgeTolerancePx && source <= size - 1 + kEdgeTolerancePx;
  };
  std::size_t i = 0;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x, ++i) {
      const Eigen::Vector2f source =
          Eigen::Vector2f(static_cast<float>(x), static_cast<float>(y)) + displacement[i];
      inside[i] = inside_of(source.x(), width) && inside_of(source.y(), height) ? 1 : 0;
    }
  }
  return inside;
}

std::uint64_t HashOfName(std::string_view name) {
  std::uint64_t hash = 0xcbf29ce484222325ULL;
  for (const char c : name) {
    hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3ULL;
  }
  return hash;
}

std::uint64_t SampleSeed(std::uint64_t seed, std::string_view photo_name,
                         MotionClass motion_class) {
  return MixBits(
      seed ^ MixBits(HashOfName(photo_name) ^ MixBits(static_cast<std::uint64_t>(motion_class))));
}

Result<SyntheticSample> MakeSyntheticSample(const FrameView& photo, MotionClass motion_class,
                                            std::uint64_t sample_seed) {
  SeededRandom random(sample_seed);
  SyntheticSample sample;
  sample.motion_class = motion_class;
  sample.seed = MixBits(sample_seed);
  const double focal_widths =
      std::exp(random.Uniform(std::log(kLeastFocalWidths), std::log(kMostFocalWidths)));
  sample.camera =
      Camera::Pinhole(kSyntheticWidth, kSyntheticHeight, focal_widths * kSyntheticWidth);
  const double uncorrected_px = random.Uniform(kLeastUncorrectedPx, kMostUncorrectedPx);
  sample.curve = DrawCurve(motion_class, random);
  if (motion_class != MotionClass::kStill) {
    if (Status status = ScaleToMeanLength(sample.curve, sample.camera, uncorrected_px); !status) {
      return Propagate(status.error());
    }
  }
  ExposureOptions exposure;
  exposure.noise_seed = MixBits(sample.seed);
  auto pair = Expose(photo, sample.camera, sample.curve, exposure);
  if (!pair) {
    return Propagate(pair.error());
  }
  sample.rs = std::move(pair->rs);
  sample.gs = std::move(pair->gs);
  sample.photo_per_pixel = pair->photo_per_pixel;
  auto truth = TruthField(sample.curve, sample.camera);
  if (!truth) {
    return Propagate(truth.error());
  }
  sample.truth = std::move(*truth);
  sample.displacement = PixelDisplacements(sample.truth);
  sample.valid = SourcesInside(sample.displacement, sample.camera.width, sample.camera.height);
  return sample;
}

}  // namespace rsstab::evaluation
