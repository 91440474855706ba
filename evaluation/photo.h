// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_EVALUATION_PHOTO_H_
#define RSSTAB_EVALUATION_PHOTO_H_

#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "igf/base/frame.h"
#include "igf/base/result.h"

namespace rsstab::evaluation {

// Packed RGB, 8 bit, full range: what every picture of the evaluation is.
[[nodiscard]] PixelLayout RgbLayout();

// A picture file (any format that OpenCV reads; EXIF orientation applied, alpha dropped).
// Errors: kNotFound, kIo; kCorruptData for what is no picture.
[[nodiscard]] Result<Frame> LoadPhoto(const std::filesystem::path& path);

// The picture files of a folder (by their ending; not of folders inside), in the order of their
// names. Errors: kNotFound for a folder that is not there or holds none.
[[nodiscard]] Result<std::vector<std::filesystem::path>> ListPhotos(
    const std::filesystem::path& folder);

// File names that a list names: one a line, up to the first comma (a CSV with the names in its
// first column will do); of those lines only that contain `text`, when it is not empty.
// Errors: those of ReadWholeFile; kNotFound when no line is left.
[[nodiscard]] Result<std::set<std::string>> ReadPhotoList(const std::filesystem::path& file,
                                                          const std::string& text = "");

}  // namespace rsstab::evaluation

#endif  // RSSTAB_EVALUATION_PHOTO_H_
