// SPDX-License-Identifier: Apache-2.0
#include "tests/plugin/frei0r/plugin_library.h"

#include <dlfcn.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <stdexcept>

#include "plugin/capi/rsstab.h"
#include "tests/support/test_clip.h"

namespace rsstab::frei0r::testing {
namespace {

constexpr std::size_t kGuardPixels = 64;
constexpr std::uint32_t kGuard = 0xA5C3F00FU;

template <typename Function>
void Load(void* module, const char* name, Function& function) {
  function = reinterpret_cast<Function>(dlsym(module, name));
  if (function == nullptr) {
    throw std::runtime_error(std::string(name) + " is missing");
  }
}

}  // namespace

PluginLibrary::PluginLibrary() : module_(dlopen(RSSTAB_FREI0R_PLUGIN, RTLD_NOW | RTLD_LOCAL)) {
  if (module_ == nullptr) {
    throw std::runtime_error(dlerror());
  }
  Load(module_, "f0r_init", init);
  Load(module_, "f0r_deinit", deinit);
  Load(module_, "f0r_get_plugin_info", get_plugin_info);
  Load(module_, "f0r_get_param_info", get_param_info);
  Load(module_, "f0r_construct", construct);
  Load(module_, "f0r_destruct", destruct);
  Load(module_, "f0r_set_param_value", set_param_value);
  Load(module_, "f0r_get_param_value", get_param_value);
  Load(module_, "f0r_update", update);
  init();
}

PluginLibrary::~PluginLibrary() {
  deinit();
  dlclose(module_);
}

PluginInstance::PluginInstance(const PluginLibrary& library, unsigned width, unsigned height)
    : library_(&library), instance_(library.construct(width, height)) {
  if (instance_ == nullptr) {
    throw std::runtime_error("f0r_construct failed");
  }
}

PluginInstance::~PluginInstance() { library_->destruct(instance_); }

void PluginInstance::SetText(int index, const std::string& text) {
  std::string copy = text;  // of its own, and gone after the call: the plugin has to copy
  f0r_param_string value = copy.data();
  library_->set_param_value(instance_, &value, index);
}

void PluginInstance::SetNumber(int index, double number) {
  library_->set_param_value(instance_, &number, index);
}

std::string PluginInstance::GetText(int index) const {
  f0r_param_string value = nullptr;
  library_->get_param_value(instance_, &value, index);
  return value;
}

double PluginInstance::GetNumber(int index) const {
  double value = std::nan("");
  library_->get_param_value(instance_, &value, index);
  return value;
}

Pixels PluginInstance::Update(double time, const Pixels& in) {
  const Pixels before = in;
  Pixels out(in.size() + kGuardPixels, kGuard);
  library_->update(instance_, time, in.data(), out.data());
  EXPECT_TRUE(in == before) << "the input was written to";
  EXPECT_TRUE(std::all_of(out.end() - kGuardPixels, out.end(), [](std::uint32_t pixel) {
    return pixel == kGuard;
  })) << "written beyond the picture";
  out.resize(in.size());
  return out;
}

Pixels ShakyPicture(int width, int height, int index) {
  rsstab::testing::TestClip clip;
  clip.width = width;
  clip.height = height;
  clip.layout = RgbaLayout();
  const Frame frame = rsstab::testing::MakeTestFrame(clip, index);
  Pixels pixels(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  for (int y = 0; y < height; ++y) {
    std::memcpy(pixels.data() + static_cast<std::ptrdiff_t>(y) * width,
                frame.planes[0].data + y * frame.planes[0].stride,
                static_cast<std::size_t>(width) * sizeof(std::uint32_t));
  }
  for (std::uint32_t& pixel : pixels) {  // from gray with alpha to four unlike channels
    const std::uint32_t gray = pixel & 0xFFU;
    pixel = gray | (255U - gray) << 8U | gray / 2U << 16U | 0xFF000000U;
  }
  return pixels;
}

void AnalyseShakyClip(const std::string& path, int width, int height, int frames,
                      double frames_per_second) {
  rsstab_options* options = rsstab_options_create();
  rsstab_video video = RSSTAB_VIDEO_INIT;
  video.width = width;
  video.height = height;
  video.format = RSSTAB_PIXEL_RGBA;
  video.frame_rate_num = static_cast<std::int32_t>(std::lround(1000.0 * frames_per_second));
  video.frame_rate_den = 1000;
  rsstab_instance* instance = nullptr;
  ASSERT_EQ(rsstab_create_analyze(options, &video, path.c_str(), &instance), RSSTAB_OK)
      << rsstab_options_error(options);
  rsstab_options_destroy(options);
  for (int i = 0; i < frames; ++i) {
    const Pixels pixels = ShakyPicture(width, height, i);
    const rsstab_picture picture = {
        {reinterpret_cast<const std::uint8_t*>(pixels.data()), nullptr, nullptr, nullptr},
        {std::ptrdiff_t{4} * width, 0, 0, 0}};
    const auto pts = static_cast<std::int64_t>(std::llround(1e6 * i / frames_per_second));
    ASSERT_EQ(rsstab_push(instance, &picture, pts, nullptr, nullptr), RSSTAB_OK)
        << rsstab_error(instance);
  }
  ASSERT_EQ(rsstab_flush(instance), RSSTAB_OK) << rsstab_error(instance);
  rsstab_destroy(instance);
}

}  // namespace rsstab::frei0r::testing
