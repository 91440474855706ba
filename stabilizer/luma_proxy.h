// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_STABILIZER_LUMA_PROXY_H_
#define RSSTAB_STABILIZER_LUMA_PROXY_H_

#include <array>
#include <cstdint>
#include <vector>

#include "igf/base/frame.h"
#include "igf/base/result.h"

namespace rsstab::stabilizer {

// Widest picture that motion analysis looks at, px.
inline constexpr int kMaxProxyWidth = 640;

// An 8-bit gray picture, rows packed without padding.
struct GrayImage {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> pixels;
};

// Size of the proxy of a width x height picture: at most kMaxProxyWidth wide, same aspect, never
// enlarged.
struct ProxySize {
  int width = 0;
  int height = 0;
};
[[nodiscard]] ProxySize ProxySizeFor(int width, int height);

// Brightness of a frame (luma; green-weighted mean for RGB), area-averaged down to ProxySizeFor.
// Errors: kUnsupported for a layout without a first plane that OpenCV can resize.
[[nodiscard]] Result<GrayImage> MakeLumaProxy(const FrameView& frame);

// Mean brightness over an 8x8 grid: tells whether pass 2 sees the frame that pass 1 saw. Survives
// re-encoding (a few levels of difference), not another picture.
using LumaFingerprint = std::array<std::uint8_t, 64>;
[[nodiscard]] LumaFingerprint FingerprintOf(const GrayImage& image);

// Mean absolute difference of two fingerprints, in 8-bit levels.
[[nodiscard]] double FingerprintDistance(const LumaFingerprint& a, const LumaFingerprint& b);

}  // namespace rsstab::stabilizer

#endif  // RSSTAB_STABILIZER_LUMA_PROXY_H_
