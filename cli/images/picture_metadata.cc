// SPDX-License-Identifier: Apache-2.0
#include "cli/images/picture_metadata.h"

#include <cmath>
#include <exception>
#include <exiv2/exiv2.hpp>
#include <string_view>

#include "cli/images/color_profile.h"

namespace rsstab::images {
namespace {

constexpr char kOrientationKey[] = "Exif.Image.Orientation";
constexpr char kFocalKey[] = "Exif.Photo.FocalLengthIn35mmFilm";
constexpr double kFilmDiagonal_mm = 43.266615;  // of 36 mm x 24 mm

// A file in memory, which has to stay there, with its metadata read; Exiv2 throws when there is no
// such format.
Exiv2::Image::AutoPtr Open(const Bytes& file) {
  // Exiv2 would print what it finds odd.
  Exiv2::LogMsg::setLevel(Exiv2::LogMsg::mute);
  auto image = Exiv2::ImageFactory::open(file.data(), static_cast<long>(file.size()));
  image->readMetadata();
  return image;
}

// The file with what was written into it.
Bytes Contents(Exiv2::Image& image) {
  Exiv2::BasicIo& io = image.io();
  io.open();
  const Exiv2::byte* begin = io.mmap();
  Bytes bytes(begin, begin + io.size());
  io.munmap();
  io.close();
  return bytes;
}

// Exiv2 asks for a non-const image where it only reads.
bool HasMetadata(Exiv2::Image& image) {
  return !image.exifData().empty() || !image.iptcData().empty() || !image.xmpData().empty() ||
         !image.comment().empty() || image.iccProfileDefined();
}

// The kind of pixels that a colour profile is for stands in its header.
bool ProfileFits(const Exiv2::DataBuf& profile, int channels) {
  constexpr long kColorSpace = 16;
  if (profile.size_ < kColorSpace + 4) {
    return false;
  }
  const std::string_view space(reinterpret_cast<const char*>(profile.pData_) + kColorSpace, 4);
  return space == (channels == 1 ? "GRAY" : "RGB ");
}

// What the format of `to` has no place for is left out.
void CopyTags(Exiv2::Image& from, Exiv2::Image& to) {
  const auto holds = [&to](Exiv2::MetadataId kind) {
    return (to.checkMode(kind) & Exiv2::amWrite) != 0;
  };
  if (holds(Exiv2::mdExif)) {
    Exiv2::ExifData exif = from.exifData();
    Exiv2::ExifThumb(exif).erase();
    to.setExifData(exif);
  }
  if (holds(Exiv2::mdIptc)) {
    to.setIptcData(from.iptcData());
  }
  if (holds(Exiv2::mdXmp)) {
    to.setXmpData(from.xmpData());
  }
  if (holds(Exiv2::mdComment) && !from.comment().empty()) {
    to.setComment(from.comment());
  }
}

}  // namespace

PictureFacts ReadFacts(const Bytes& file) {
  PictureFacts facts;
  try {
    const auto image = Open(file);
    const Exiv2::ExifData& exif = image->exifData();
    if (const auto found = exif.findKey(Exiv2::ExifKey(kOrientationKey)); found != exif.end()) {
      const long orientation = found->toLong();
      facts.orientation = orientation >= 1 && orientation <= 8 ? static_cast<int>(orientation) : 1;
    }
    if (const auto found = exif.findKey(Exiv2::ExifKey(kFocalKey)); found != exif.end()) {
      const double focal_mm = found->toFloat();
      if (std::isfinite(focal_mm) && focal_mm > 0.0) {
        facts.focal_per_diagonal = focal_mm / kFilmDiagonal_mm;
      }
    }
  } catch (const std::exception&) {
    return facts;
  }
  return facts;
}

Result<Bytes> WithoutOrientation(Bytes file) {
  try {
    // Exiv2 writes TIFF in place where it can, that is into `file`.
    const auto image = Open(file);
    image->exifData()[kOrientationKey] = std::uint16_t{1};
    image->writeMetadata();
    return Contents(*image);
  } catch (const std::exception& error) {
    return Fail(ErrorCode::kCorruptData, "its orientation cannot be undone: {}", error.what());
  }
}

Result<Bytes> WithMetadataOf(const Bytes& original, Bytes encoded, int channels) {
  Exiv2::Image::AutoPtr from;
  try {
    from = Open(original);
  } catch (const std::exception&) {
    return encoded;  // a format without metadata
  }
  if (!HasMetadata(*from)) {
    return encoded;
  }
  Exiv2::Image::AutoPtr to;
  try {
    to = Open(encoded);
  } catch (const std::exception&) {
    return Fail(ErrorCode::kUnsupported, "this format holds no metadata");
  }
  try {
    CopyTags(*from, *to);
    const bool has_profile =
        from->iccProfileDefined() && ProfileFits(*from->iccProfile(), channels);
    const bool is_png = to->mimeType() == "image/png";
    if (has_profile && !is_png) {
      Exiv2::DataBuf profile(from->iccProfile()->pData_, from->iccProfile()->size_);
      to->setIccProfile(profile, false);
    }
    to->writeMetadata();
    Bytes complete = Contents(*to);
    if (has_profile && is_png) {
      const Exiv2::DataBuf& profile = *from->iccProfile();
      InsertPngProfile({profile.pData_, static_cast<std::size_t>(profile.size_)}, complete);
    }
    if (to->mimeType() == "image/webp") {
      RepairWebpProfile(complete);
    }
    return complete;
  } catch (const std::exception& error) {
    return Fail(ErrorCode::kCorruptData, "the metadata cannot be carried over: {}", error.what());
  }
}

}  // namespace rsstab::images
