// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_STABILIZER_PIPELINE_SHARED_OPTIONS_H_
#define RSSTAB_STABILIZER_PIPELINE_SHARED_OPTIONS_H_

// Options that several tables have, with their help.

#include <string>
#include <utility>
#include <vector>

#include "rsdiff/backend/backend_options.h"
#include "stabilizer/interpolation.h"
#include "stabilizer/pipeline/option_table.h"

namespace rsstab::pipeline {

template <typename Options>
OptionSpec<Options> ModelOption(std::string Options::*field) {
  auto spec = TextOption("model", "FILE", field);
  spec.help =
      "Diffusion model: its JSON file, the folder of it, or the name of an installed one. Without "
      "it the installed compact model.";
  return spec;
}

template <typename Options>
OptionSpec<Options> DeviceOption(std::string Options::*field) {
  std::vector<std::pair<std::string, std::string>> choices;
  choices.reserve(rsdiff::kDeviceNames.size());
  for (const char* device : rsdiff::kDeviceNames) {
    choices.emplace_back(device, device);
  }
  auto spec = ChoiceOption("device", field, std::move(choices));
  spec.help =
      "Where the network runs; all but auto and cpu need an OpenCV (or libtorch) built for it.";
  return spec;
}

template <typename Options>
OptionSpec<Options> InterpolationOption(stabilizer::Interpolation Options::*field) {
  using stabilizer::Interpolation;
  auto spec = ChoiceOption<Options, Interpolation>("interpolation", field,
                                                   {{"bilinear", Interpolation::kBilinear},
                                                    {"bicubic", Interpolation::kBicubic},
                                                    {"lanczos", Interpolation::kLanczos}});
  spec.help = "How pixels are resampled, from quickest to sharpest.";
  return spec;
}

}  // namespace rsstab::pipeline

#endif  // RSSTAB_STABILIZER_PIPELINE_SHARED_OPTIONS_H_
