// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_IMAGES_COLOR_PROFILE_H_
#define RSSTAB_CLI_IMAGES_COLOR_PROFILE_H_

#include <cstdint>
#include <span>
#include <vector>

namespace rsstab::images {

// Exiv2 0.27 writes colour profiles into PNG under an empty name, which readers refuse, and into
// WebP under the name of another chunk. These two put that right.

// Puts `profile` into an iCCP chunk of `png`, a PNG file without one.
void InsertPngProfile(std::span<const std::uint8_t> profile, std::vector<std::uint8_t>& png);

// Renames the profile's chunk of a WebP file that Exiv2 has written.
void RepairWebpProfile(std::span<std::uint8_t> webp);

}  // namespace rsstab::images

#endif  // RSSTAB_CLI_IMAGES_COLOR_PROFILE_H_
