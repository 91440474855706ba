// SPDX-License-Identifier: Apache-2.0
// The entry points of frei0r.h. Hosts call f0r_init and
// f0r_deinit as often as they like, MLT the latter even before the instances are gone.
#include <cinttypes>
#include <exception>

extern "C" {
#include <frei0r.h>  // has no such lines of its own
}

#include "plugin/frei0r/effect.h"
#include "plugin/frei0r/say_once.h"

namespace {

using rsstab::frei0r::Effect;
using rsstab::frei0r::kNumParameters;
using rsstab::frei0r::Parameters;
using rsstab::frei0r::SayOnce;

constexpr unsigned kMaxSide = 65535;
constexpr int kPluginMajor = 0;
constexpr int kPluginMinor = 1;

Effect* EffectOf(f0r_instance_t instance) { return static_cast<Effect*>(instance); }

bool IsParameter(int index) { return index >= 0 && index < kNumParameters; }

bool IsText(int index) { return Parameters()[static_cast<std::size_t>(index)].is_text; }

}  // namespace

int f0r_init(void) { return 1; }

void f0r_deinit(void) {}

void f0r_get_plugin_info(f0r_plugin_info_t* info) {
  info->name = "Stabilize and remove rolling shutter";
  info->author = "rs-stabilize";
  info->plugin_type = F0R_PLUGIN_TYPE_FILTER;
  info->color_model = F0R_COLOR_MODEL_RGBA8888;
  info->frei0r_version = FREI0R_MAJOR_VERSION;
  info->major_version = kPluginMajor;
  info->minor_version = kPluginMinor;
  info->num_params = kNumParameters;
  info->explanation =
      "Steadies shaky clips by an analysis file of rs-stabilize, or live without one";
}

void f0r_get_param_info(f0r_param_info_t* info, int param_index) {
  if (!IsParameter(param_index)) {
    return;
  }
  const auto& parameter = Parameters()[static_cast<std::size_t>(param_index)];
  info->name = parameter.name;
  info->type = parameter.is_text ? F0R_PARAM_STRING : F0R_PARAM_DOUBLE;
  info->explanation = parameter.explanation;
}

f0r_instance_t f0r_construct(unsigned int width, unsigned int height) {
  if (width == 0 || height == 0 || width > kMaxSide || height > kMaxSide) {
    return nullptr;
  }
  try {
    return new Effect(width, height);
  } catch (const std::exception& error) {
    SayOnce(error.what());
    return nullptr;
  }
}

void f0r_destruct(f0r_instance_t instance) { delete EffectOf(instance); }

void f0r_set_param_value(f0r_instance_t instance, f0r_param_t param, int param_index) {
  if (!IsParameter(param_index) || param == nullptr) {
    return;
  }
  try {
    if (IsText(param_index)) {
      EffectOf(instance)->SetText(param_index, *static_cast<f0r_param_string*>(param));
    } else {
      EffectOf(instance)->SetNumber(param_index, *static_cast<f0r_param_double*>(param));
    }
  } catch (const std::exception& error) {
    SayOnce(error.what());
  }
}

void f0r_get_param_value(f0r_instance_t instance, f0r_param_t param, int param_index) {
  if (!IsParameter(param_index) || param == nullptr) {
    return;
  }
  const auto& values = EffectOf(instance)->values();
  if (IsText(param_index)) {
    // The host must not write through it (frei0r.h), but the type has no const.
    *static_cast<f0r_param_string*>(param) =
        const_cast<char*>(values.TextAt(param_index).c_str());  // NOLINT
  } else {
    *static_cast<f0r_param_double*>(param) = values.numbers[static_cast<std::size_t>(param_index)];
  }
}

void f0r_update(f0r_instance_t instance, double time, const uint32_t* inframe, uint32_t* outframe) {
  try {
    EffectOf(instance)->Update(time, inframe, outframe, __builtin_return_address(0));
  } catch (const std::exception& error) {
    SayOnce(error.what());
  }
}
