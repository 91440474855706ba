// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_TESTS_PLUGIN_FREI0R_PLUGIN_LIBRARY_H_
#define RSSTAB_TESTS_PLUGIN_FREI0R_PLUGIN_LIBRARY_H_

#include <cinttypes>
#include <string>
#include <vector>

extern "C" {
#include <frei0r.h>  // has no such lines of its own
}

namespace rsstab::frei0r::testing {

// The plugin, loaded as FFmpeg and MLT load it. Throws std::runtime_error when a function is
// missing.
class PluginLibrary {
 public:
  PluginLibrary();
  ~PluginLibrary();
  PluginLibrary(const PluginLibrary&) = delete;
  PluginLibrary& operator=(const PluginLibrary&) = delete;

  decltype(&f0r_init) init = nullptr;
  decltype(&f0r_deinit) deinit = nullptr;
  decltype(&f0r_get_plugin_info) get_plugin_info = nullptr;
  decltype(&f0r_get_param_info) get_param_info = nullptr;
  decltype(&f0r_construct) construct = nullptr;
  decltype(&f0r_destruct) destruct = nullptr;
  decltype(&f0r_set_param_value) set_param_value = nullptr;
  decltype(&f0r_get_param_value) get_param_value = nullptr;
  decltype(&f0r_update) update = nullptr;

 private:
  void* module_ = nullptr;
};

using Pixels = std::vector<std::uint32_t>;

// An instance of it.
class PluginInstance {
 public:
  PluginInstance(const PluginLibrary& library, unsigned width, unsigned height);
  ~PluginInstance();
  PluginInstance(const PluginInstance&) = delete;
  PluginInstance& operator=(const PluginInstance&) = delete;

  void SetText(int index, const std::string& text);
  void SetNumber(int index, double number);
  [[nodiscard]] std::string GetText(int index) const;
  [[nodiscard]] double GetNumber(int index) const;
  // What the plugin makes of `in`; guards beyond the last pixel are checked.
  [[nodiscard]] Pixels Update(double time, const Pixels& in);

 private:
  const PluginLibrary* library_;
  f0r_instance_t instance_;
};

// Frame `index` of a shaky clip, RGBA without padding; every channel differs from its neighbours.
[[nodiscard]] Pixels ShakyPicture(int width, int height, int index);

// Analyses that clip with the C interface, frames at index / rate seconds.
void AnalyseShakyClip(const std::string& path, int width, int height, int frames,
                      double frames_per_second);

}  // namespace rsstab::frei0r::testing

#endif  // RSSTAB_TESTS_PLUGIN_FREI0R_PLUGIN_LIBRARY_H_
