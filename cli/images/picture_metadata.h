// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_IMAGES_PICTURE_METADATA_H_
#define RSSTAB_CLI_IMAGES_PICTURE_METADATA_H_

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "igf/base/result.h"

namespace rsstab::images {

using Bytes = std::vector<std::uint8_t>;

// What a picture file tells beside its pixels.
struct PictureFacts {
  // 1 to 8 as in EXIF: how viewers turn the stored picture; 1 as it is.
  int orientation = 1;
  // Of the lens, as a share of the picture's diagonal; from the focal length in 35 mm terms.
  std::optional<double> focal_per_diagonal;
};

// Reads what is there; a file without metadata, or with damaged metadata, tells nothing.
[[nodiscard]] PictureFacts ReadFacts(const Bytes& file);

// The same file with the orientation set to 1, for decoders that turn the picture by themselves.
// Errors: kCorruptData.
[[nodiscard]] Result<Bytes> WithoutOrientation(Bytes file);

// `encoded`, a picture file, with the EXIF, IPTC and XMP data, comment and colour profile of the
// file `original`. Left out: the preview, which shows the picture as it was, and a colour profile
// for another kind of pixels (`channels` are stored: 1 grey, 3 or 4 colour).
// Errors: kUnsupported when there is metadata and the format of `encoded` cannot hold any;
// kCorruptData when it cannot be understood.
[[nodiscard]] Result<Bytes> WithMetadataOf(const Bytes& original, Bytes encoded, int channels);

}  // namespace rsstab::images

#endif  // RSSTAB_CLI_IMAGES_PICTURE_METADATA_H_
