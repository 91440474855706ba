// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_IMAGES_PICTURE_FILE_H_
#define RSSTAB_CLI_IMAGES_PICTURE_FILE_H_

#include <cstddef>
#include <string>
#include <vector>

#include "cli/images/picture_metadata.h"
#include "igf/base/frame.h"
#include "igf/base/result.h"

namespace rsstab::images {

// A photograph as it is stored: the orientation is not applied, so that the rows of `pixels` are
// those of the sensor. One packed plane, 8 or 16 bits: grey, RGB or RGBA.
struct Picture {
  Frame pixels;
  PictureFacts facts;
  std::size_t pages = 1;  // pictures in the file, of which this is the first
  Bytes file;             // as it was read, for its metadata
};

// Any format that OpenCV reads. A sequence (multi-page TIFF, for example) gives its first picture.
// Errors: kNotFound, kIo; kCorruptData for what is no picture; kUnsupported for samples that are
// neither 8 nor 16 bits, naming the file.
[[nodiscard]] Result<Picture> ReadPicture(const std::string& path);

// A picture file in memory, and what had to be given up for its format.
struct EncodedPicture {
  Bytes bytes;
  std::vector<std::string> losses;  // "16 bits became 8"
};

// Encodes `pixels` (a layout as above) in the format that the ending of `path` names; nothing is
// written. `quality` 1 .. 100 is for formats that lose something (JPEG, WebP, JPEG 2000). Metadata
// is that of `original`, as WithMetadataOf tells.
// Errors: kUnsupported for an ending that is no picture format; kInvalidArgument for a picture that
// the format cannot hold.
[[nodiscard]] Result<EncodedPicture> EncodePicture(const std::string& path, const FrameView& pixels,
                                                   int quality, const Bytes* original = nullptr);

// True for names whose ending says that OpenCV might read them.
[[nodiscard]] bool HasPictureEnding(const std::string& path);

}  // namespace rsstab::images

#endif  // RSSTAB_CLI_IMAGES_PICTURE_FILE_H_
