// SPDX-License-Identifier: Apache-2.0
#include "cli/media/frame_converter.h"

extern "C" {
#include <libavutil/pixdesc.h>
}

#include <cerrno>

#include "cli/media/av_error.h"
#include "cli/media/pixel_format.h"

namespace rsstab::media {
namespace {

constexpr int kFirstHighDefinitionHeight = 720;
constexpr int kUnity = 1 << 16;  // swscale's fixed point for contrast and saturation

int MatrixOf(const AVFrame& frame) {
  switch (frame.colorspace) {
    case AVCOL_SPC_BT709:
      return SWS_CS_ITU709;
    case AVCOL_SPC_FCC:
      return SWS_CS_FCC;
    case AVCOL_SPC_BT470BG:
    case AVCOL_SPC_SMPTE170M:
      return SWS_CS_ITU601;
    case AVCOL_SPC_SMPTE240M:
      return SWS_CS_SMPTE240M;
    case AVCOL_SPC_BT2020_NCL:
    case AVCOL_SPC_BT2020_CL:
      return SWS_CS_BT2020;
    default:
      return frame.height >= kFirstHighDefinitionHeight ? SWS_CS_ITU709 : SWS_CS_ITU601;
  }
}

bool IsRgb(AVPixelFormat format) {
  const AVPixFmtDescriptor* description = av_pix_fmt_desc_get(format);
  return description != nullptr && (description->flags & AV_PIX_FMT_FLAG_RGB) != 0;
}

}  // namespace

Result<AvFramePtr> FrameConverter::Convert(const AVFrame& source) {
  const auto source_format = static_cast<AVPixelFormat>(source.format);
  const bool source_full =
      source.color_range == AVCOL_RANGE_JPEG || NameSaysFullRange(source_format);
  const int matrix = MatrixOf(source);
  if (context_ == nullptr || source.width != source_width_ || source.height != source_height_ ||
      source.format != source_format_ || source_full != source_full_range_ || matrix != matrix_) {
    constexpr int kQuality =
        SWS_BICUBIC | SWS_ACCURATE_RND | SWS_FULL_CHR_H_INT | SWS_FULL_CHR_H_INP;
    context_.reset(sws_getContext(source.width, source.height, WithoutRange(source_format),
                                  target_.width, target_.height, WithoutRange(target_.format),
                                  kQuality, nullptr, nullptr, nullptr));
    if (context_ == nullptr) {
      return Fail(ErrorCode::kUnsupported, "pictures of {}x{} {} cannot be converted to {}x{} {}",
                  source.width, source.height, FormatName(source_format), target_.width,
                  target_.height, FormatName(target_.format));
    }
    const int* coefficients = sws_getCoefficients(matrix);
    // Fails for conversions that need no matrix, which is fine.
    sws_setColorspaceDetails(context_.get(), coefficients, source_full ? 1 : 0, coefficients,
                             target_.full_range || IsRgb(target_.format) ? 1 : 0, 0, kUnity,
                             kUnity);
    source_width_ = source.width;
    source_height_ = source.height;
    source_format_ = source.format;
    source_full_range_ = source_full;
    matrix_ = matrix;
  }
  AvFramePtr converted(av_frame_alloc());
  if (converted == nullptr) {
    return AvFail(AVERROR(ENOMEM), "converting a frame");
  }
  converted->format = target_.format;
  converted->width = target_.width;
  converted->height = target_.height;
  if (const int code = av_frame_get_buffer(converted.get(), 0); code < 0) {
    return AvFail(code, "converting a frame");
  }
  if (const int code = av_frame_copy_props(converted.get(), &source); code < 0) {
    return AvFail(code, "converting a frame");
  }
  converted->color_range = target_.full_range ? AVCOL_RANGE_JPEG : AVCOL_RANGE_MPEG;
  const int rows = sws_scale(context_.get(), source.data, source.linesize, 0, source.height,
                             converted->data, converted->linesize);
  if (rows < 0) {
    return AvFail(rows, "converting a frame");
  }
  return converted;
}

}  // namespace rsstab::media
