// SPDX-License-Identifier: Apache-2.0
// Video stabilization that removes rolling shutter, by librsstab:
//   rsanalyze    first pass of two: writes an analysis file, hands the frames through
//   rsstabilize  second pass by an analysis file; without one, a single pass with look-ahead
// Written for libavfilter 8 to 12 (FFmpeg 5.1 to 9); add_to_ffmpeg.sh puts it into a source tree.
#include <rsstab.h>

#include "avfilter.h"
#include "filters.h"
#include "formats.h"
#include "libavutil/avstring.h"
#include "libavutil/dict.h"
#include "libavutil/internal.h"
#include "libavutil/mathematics.h"
#include "libavutil/opt.h"
#include "libavutil/pixdesc.h"
#include "version.h"
#include "video.h"
#if LIBAVFILTER_VERSION_INT < AV_VERSION_INT(10, 4, 100)
#include "internal.h"
#endif

typedef struct StabContext {
  const AVClass* class;

  // Options. Values go to the library as text: it knows their ranges and defaults, and a NULL
  // leaves its default alone.
  char* file;  // analysis file; NULL: live
  char* rs;
  char* smoothness;
  char* crop;
  char* zoom;
  char* tripod;
  char* interpolation;
  char* lookahead;
  char* opts;

  int is_analysis;
  rsstab_instance* stab;
  rsstab_video video;  // what `stab` was created for
  int64_t frames;      // taken in so far
  int64_t unchanged;   // frames that the analysis file did not know
  int closed;          // `stab` is flushed, or what it holds is not wanted any more
  int end_status;      // of the input, once it ended; 0 before
  int64_t end_pts;
  int said_interlaced;
} StabContext;

#define OFFSET(x) offsetof(StabContext, x)

// ---- Errors and messages ------------------------------------------------------------------------

static int error_of(rsstab_status status) {
  switch (status) {
    case RSSTAB_ERROR_INVALID_ARGUMENT:
      return AVERROR(EINVAL);
    case RSSTAB_ERROR_NOT_FOUND:
      return AVERROR(ENOENT);
    case RSSTAB_ERROR_UNSUPPORTED:
      return AVERROR(ENOSYS);
    case RSSTAB_ERROR_CORRUPT_DATA:
    case RSSTAB_ERROR_UNTRUSTWORTHY:
      return AVERROR_INVALIDDATA;
    case RSSTAB_ERROR_IO:
      return AVERROR(EIO);
    case RSSTAB_ERROR_CANCELLED:
      return AVERROR_EXIT;
    case RSSTAB_ERROR_OUT_OF_MEMORY:
      return AVERROR(ENOMEM);
    default:
      return status < 0 ? AVERROR_EXTERNAL : 0;
  }
}

// Says why the last call with the instance failed.
static int fail(AVFilterContext* ctx, rsstab_status status) {
  const StabContext* s = ctx->priv;
  av_log(ctx, AV_LOG_ERROR, "%s\n", rsstab_error(s->stab));
  return error_of(status);
}

static void log_message(void* ctx, rsstab_log_level level, const char* message) {
  static const int levels[] = {AV_LOG_ERROR, AV_LOG_WARNING, AV_LOG_INFO, AV_LOG_DEBUG};
  const int known = level >= RSSTAB_LOG_ERROR && level <= RSSTAB_LOG_DEBUG;
  av_log(ctx, known ? levels[level] : AV_LOG_INFO, "%s\n", message);
}

// ---- Frames -------------------------------------------------------------------------------------

// X(libavutil's name of a format, the library's)
// clang-format off
#define FORMATS(X)                                                                             \
  X(YUV420P, YUV420P)     X(YUV422P, YUV422P)     X(YUV444P, YUV444P)     X(GRAY8, GRAY8)      \
  X(YUVJ420P, YUV420P)    X(YUVJ422P, YUV422P)    X(YUVJ444P, YUV444P)    X(NV12, NV12)        \
  X(YUV420P10, YUV420P10) X(YUV422P10, YUV422P10) X(YUV444P10, YUV444P10) X(GRAY10, GRAY10)    \
  X(YUV420P12, YUV420P12) X(YUV422P12, YUV422P12) X(YUV444P12, YUV444P12) X(GRAY12, GRAY12)    \
  X(GRAY16, GRAY16)       X(GBRP, GBRP)           X(GBRP10, GBRP10)
// clang-format on

#define AV_NAME(av, ours) AV_PIX_FMT_##av,
static const enum AVPixelFormat pixel_formats[] = {FORMATS(AV_NAME) AV_PIX_FMT_NONE};

static rsstab_pixel_format format_of(enum AVPixelFormat format) {
#define CASE(av, ours)  \
  case AV_PIX_FMT_##av: \
    return RSSTAB_PIXEL_##ours;
  switch (format) {
    FORMATS(CASE)
    default:
      return RSSTAB_PIXEL_NONE;
  }
}

static AVRational frame_rate_of(AVFilterLink* link) {
#if LIBAVFILTER_VERSION_INT >= AV_VERSION_INT(10, 4, 100)
  return ff_filter_link(link)->frame_rate;
#else
  return link->frame_rate;
#endif
}

static int is_interlaced(const AVFrame* frame) {
#if LIBAVFILTER_VERSION_MAJOR >= 10
  return frame->flags & AV_FRAME_FLAG_INTERLACED;
#else
  return frame->interlaced_frame;
#endif
}

// What the library needs to know of the frames on `link`, of which `frame` (may be NULL) is one: it
// knows more than the link, and may have changed in mid-stream.
static rsstab_video describe(AVFilterLink* link, const AVFrame* frame) {
  const int format = frame ? frame->format : link->format;
  const AVRational rate = frame_rate_of(link);
  rsstab_video video = RSSTAB_VIDEO_INIT;
  video.width = frame ? frame->width : link->w;
  video.height = frame ? frame->height : link->h;
  video.format = format_of(format);
  video.full_range = format == AV_PIX_FMT_YUVJ420P || format == AV_PIX_FMT_YUVJ422P ||
                     format == AV_PIX_FMT_YUVJ444P ||
                     (frame && frame->color_range == AVCOL_RANGE_JPEG);
  if (frame && frame->chroma_location == AVCHROMA_LOC_CENTER) {
    video.chroma_location = RSSTAB_CHROMA_CENTER;
  } else if (frame && frame->chroma_location == AVCHROMA_LOC_TOPLEFT) {
    video.chroma_location = RSSTAB_CHROMA_TOP_LEFT;
  }
  video.time_base_num = link->time_base.num;
  video.time_base_den = link->time_base.den;
  if (rate.num > 0 && rate.den > 0) {
    video.frame_rate_num = rate.num;
    video.frame_rate_den = rate.den;
  }
  return video;
}

static int same_pictures(const rsstab_video* a, const rsstab_video* b, int colours_matter) {
  return a->width == b->width && a->height == b->height && a->format == b->format &&
         (!colours_matter ||
          (a->full_range == b->full_range && a->chroma_location == b->chroma_location));
}

static rsstab_picture picture_of(const AVFrame* frame) {
  rsstab_picture picture;
  for (int p = 0; p < RSSTAB_MAX_PLANES; p++) {
    picture.data[p] = frame->data[p];
    picture.stride[p] = frame->linesize[p];
  }
  return picture;
}

static rsstab_buffer buffer_of(AVFrame* frame) {
  rsstab_buffer buffer;
  for (int p = 0; p < RSSTAB_MAX_PLANES; p++) {
    buffer.data[p] = frame->data[p];
    buffer.stride[p] = frame->linesize[p];
  }
  return buffer;
}

static void release_frame(void* frame_data) {
  AVFrame* frame = frame_data;
  av_frame_free(&frame);
}

// ---- The instance -------------------------------------------------------------------------------

static int set_option(AVFilterContext* ctx, rsstab_options* options, const char* name,
                      const char* value) {
  const rsstab_status status = rsstab_options_set(options, name, value);
  if (status < 0) {
    av_log(ctx, AV_LOG_ERROR, "%s\n", rsstab_options_error(options));
  }
  return status == RSSTAB_ERROR_NOT_FOUND ? AVERROR_OPTION_NOT_FOUND : error_of(status);
}

static int set_options(AVFilterContext* ctx, rsstab_options* options) {
  const StabContext* s = ctx->priv;
  AVDictionary* others = NULL;
  const AVDictionaryEntry* entry = NULL;
  char threads[16];
  int ret;

  // The graph's choice (-filter_threads, or the filter's own "threads").
  snprintf(threads, sizeof(threads), "%d",
           ctx->thread_type & AVFILTER_THREAD_SLICE ? ff_filter_get_nb_threads(ctx) : 1);
  ret = set_option(ctx, options, "threads", threads);
  for (const AVOption* o = s->class->option; ret >= 0 && o->name; o++) {
    const char* value = *(char* const*)((const char*)s + o->offset);
    if (o->offset != OFFSET(file) && o->offset != OFFSET(opts) && value) {
      ret = set_option(ctx, options, o->name, value);
    }
  }
  if (ret >= 0 && s->opts) {
    ret = av_dict_parse_string(&others, s->opts, "=", "|", 0);
    if (ret < 0) {
      av_log(ctx, AV_LOG_ERROR, "opts: '%s' is not a list of name=value, separated by |\n",
             s->opts);
    }
  }
  while (ret >= 0 && (entry = av_dict_get(others, "", entry, AV_DICT_IGNORE_SUFFIX))) {
    ret = set_option(ctx, options, entry->key, entry->value);
  }
  av_dict_free(&others);
  return ret;
}

static int create_instance(AVFilterContext* ctx, const rsstab_video* video) {
  StabContext* s = ctx->priv;
  rsstab_options* options = rsstab_options_create();
  rsstab_status status;
  int ret;

  if (!options) {
    return AVERROR(ENOMEM);
  }
  rsstab_options_set_log(options, log_message, ctx,
                         av_log_get_level() >= AV_LOG_DEBUG ? RSSTAB_LOG_DEBUG : RSSTAB_LOG_INFO);
  ret = set_options(ctx, options);
  if (ret >= 0) {
    if (s->is_analysis) {
      status = rsstab_create_analyze(options, video, s->file, &s->stab);
    } else if (s->file) {
      if (s->rs || s->smoothness || s->crop || s->zoom || s->tripod) {
        av_log(ctx, AV_LOG_WARNING,
               "rs, smoothness, crop, zoom and tripod were decided when %s was made: give them to "
               "rsanalyze\n",
               s->file);
      }
      status = rsstab_create_apply(options, video, s->file, &s->stab);
    } else {
      status = rsstab_create_live(options, video, &s->stab);
    }
    if (status < 0) {
      av_log(ctx, AV_LOG_ERROR, "%s\n", rsstab_options_error(options));
    }
    ret = error_of(status);
  }
  rsstab_options_destroy(options);
  s->video = *video;
  s->closed = 0;
  return ret;
}

static int config_input(AVFilterLink* inlink) {
  AVFilterContext* ctx = inlink->dst;
  StabContext* s = ctx->priv;
  const rsstab_video video = describe(inlink, NULL);

  rsstab_destroy(s->stab);
  s->stab = NULL;
  // Now, not with the first frame: a file that cannot be used must show before anything is encoded.
  return create_instance(ctx, &video);
}

// ---- Frames through the instance ----------------------------------------------------------------

// Sends the next finished frame on. 1: sent; 0: none is ready.
static int send_next(AVFilterContext* ctx) {
  StabContext* s = ctx->priv;
  AVFilterLink* outlink = ctx->outputs[0];
  AVFrame* out;
  rsstab_buffer buffer;
  rsstab_status status;
  void* in;
  int ret;

  status = rsstab_peek(s->stab, NULL, &in);
  if (status < 0) {
    return fail(ctx, status);
  }
  if (status == RSSTAB_AGAIN || status == RSSTAB_END) {
    return 0;
  }
  out = ff_get_video_buffer(outlink, s->video.width, s->video.height);
  if (!out) {
    return AVERROR(ENOMEM);
  }
  ret = av_frame_copy_props(out, in);
  if (ret < 0) {
    av_frame_free(&out);
    return ret;
  }
  buffer = buffer_of(out);
  status = rsstab_pull(s->stab, &buffer, NULL, NULL);
  if (status < 0) {
    av_frame_free(&out);
    return fail(ctx, status);
  }
  if (status == RSSTAB_UNCHANGED && s->unchanged++ == 0) {
    av_log(ctx, AV_LOG_WARNING, "%s\n", rsstab_error(s->stab));
  }
  ret = ff_filter_frame(outlink, out);
  return ret < 0 ? ret : 1;
}

// No more frames go in; completes the analysis file.
static int flush_instance(AVFilterContext* ctx) {
  StabContext* s = ctx->priv;
  rsstab_status status;

  if (s->closed) {
    return 0;
  }
  s->closed = 1;
  status = rsstab_flush(s->stab);
  return status < 0 ? fail(ctx, status) : 0;
}

// The pictures have changed (or the first one tells more than the link did): gets out what the old
// instance holds, and begins with a new one.
static int change_pictures(AVFilterContext* ctx, const rsstab_video* video) {
  StabContext* s = ctx->priv;
  int ret = 0;

  if (s->is_analysis && s->frames > 0) {
    av_log(ctx, AV_LOG_ERROR,
           "frame %" PRId64
           " is not like the ones before it (%dx%d after %dx%d): an analysis file is of one kind "
           "of picture; analyse the parts one by one, or scale them to one size first\n",
           s->frames, video->width, video->height, s->video.width, s->video.height);
    return AVERROR(EINVAL);
  }
  if (s->frames > 0) {
    ret = flush_instance(ctx);
    while (ret >= 0 && (ret = send_next(ctx)) > 0) {
    }
  }
  rsstab_destroy(s->stab);
  s->stab = NULL;
  return ret < 0 ? ret : create_instance(ctx, video);
}

// Takes `in` over.
static int push_frame(AVFilterContext* ctx, AVFrame* in) {
  StabContext* s = ctx->priv;
  AVFilterLink* inlink = ctx->inputs[0];
  const rsstab_video video = describe(inlink, in);
  rsstab_picture picture;
  rsstab_status status;
  int64_t pts = in->pts;

  if (!same_pictures(&video, &s->video, !s->is_analysis || s->frames == 0)) {
    const int ret = change_pictures(ctx, &video);
    if (ret < 0) {
      av_frame_free(&in);
      return ret;
    }
  }
  if (is_interlaced(in) && !s->said_interlaced) {
    s->said_interlaced = 1;
    av_log(ctx, AV_LOG_WARNING,
           "the frames are interlaced, and their fields would be mixed: deinterlace first, for "
           "example with bwdif\n");
  }
  if (pts == AV_NOPTS_VALUE) {  // any clock will do that runs the same in both passes
    const AVRational rate = video.frame_rate_num > 0
                                ? (AVRational){video.frame_rate_num, video.frame_rate_den}
                                : (AVRational){30, 1};
    pts = av_rescale_q(s->frames, av_inv_q(rate), inlink->time_base);
  }
  picture = picture_of(in);
  status = rsstab_push(s->stab, &picture, pts, in, release_frame);
  if (status != RSSTAB_OK) {
    av_frame_free(&in);
    return status < 0 ? fail(ctx, status)
                      : AVERROR_BUG;  // each frame that was ready has been pulled
  }
  s->frames++;
  return 0;
}

// Takes `in` over. 1: a frame went out; 0: none did, yet.
static int take_frame(AVFilterContext* ctx, AVFrame* in) {
  StabContext* s = ctx->priv;
  AVFrame* looked_at;
  int ret;

  if (!s->is_analysis) {
    ret = push_frame(ctx, in);
    return ret < 0 ? ret : send_next(ctx);
  }
  looked_at = av_frame_clone(in);
  ret = looked_at ? push_frame(ctx, looked_at) : AVERROR(ENOMEM);
  if (ret < 0) {
    s->closed = 1;  // a frame is missing: no file
    av_frame_free(&in);
    return ret;
  }
  ret = ff_filter_frame(ctx->outputs[0], in);
  return ret < 0 ? ret : 1;
}

// The input has ended: one of the frames left inside each time, then the end itself.
static int finish(AVFilterContext* ctx) {
  StabContext* s = ctx->priv;
  int ret = 0;

  if (s->is_analysis && s->end_status != AVERROR_EOF) {
    s->closed = 1;  // a broken clip must not leave a file that looks whole
  }
  if (s->frames > 0) {  // a clip without frames is no error of ours
    ret = flush_instance(ctx);
    if (ret >= 0 && !s->is_analysis) {
      ret = send_next(ctx);
    }
  }
  if (ret > 0) {
    ff_filter_set_ready(ctx, 100);
    return 0;
  }
  ff_outlink_set_status(ctx->outputs[0], ret < 0 ? ret : s->end_status, s->end_pts);
  return ret;
}

static int activate(AVFilterContext* ctx) {
  StabContext* s = ctx->priv;
  AVFilterLink* inlink = ctx->inputs[0];
  AVFilterLink* outlink = ctx->outputs[0];
  AVFrame* in;
  int ret = ff_outlink_get_status(outlink);

  if (ret) {  // nobody wants more, for example after -t
    ff_inlink_set_status(inlink, ret);
    return s->is_analysis && s->frames > 0 && ret == AVERROR_EOF ? flush_instance(ctx) : 0;
  }
  if (s->end_status) {
    return finish(ctx);
  }
  ret = ff_inlink_consume_frame(inlink, &in);
  if (ret > 0) {
    ret = take_frame(ctx, in);
    if (ret > 0 || ff_inlink_check_available_frame(inlink)) {
      ff_filter_set_ready(ctx, 100);
      return ret < 0 ? ret : 0;
    }
  }
  if (ret < 0) {
    return ret;
  }
  if (ff_inlink_acknowledge_status(inlink, &s->end_status, &s->end_pts)) {
    return finish(ctx);
  }
  FF_FILTER_FORWARD_WANTED(outlink, inlink);
  return FFERROR_NOT_READY;
}

// ---- The filters --------------------------------------------------------------------------------

static int process_command(AVFilterContext* ctx, const char* cmd, const char* arg, char* res,
                           int res_len, int flags) {
  StabContext* s = ctx->priv;
  rsstab_status status;

  if (!s->stab || !av_opt_find(s, cmd, NULL, AV_OPT_FLAG_RUNTIME_PARAM, 0)) {
    return AVERROR(ENOSYS);
  }
  status = rsstab_set(s->stab, cmd, arg);
  if (status < 0) {
    av_log(ctx, AV_LOG_ERROR, "%s=%s: %s\n", cmd, arg, rsstab_error(s->stab));
    if (res && res_len > 0) {
      av_strlcpy(res, rsstab_error(s->stab), res_len);
    }
    return error_of(status);
  }
  return av_opt_set(s, cmd, arg, 0);  // for the instance after a change of size
}

static av_cold int init_analysis(AVFilterContext* ctx) {
  StabContext* s = ctx->priv;
  s->is_analysis = 1;
  return 0;
}

static av_cold void uninit(AVFilterContext* ctx) {
  StabContext* s = ctx->priv;

  // After -t, -frames or q, ffmpeg takes the graph down without telling that the clip has ended.
  if (s->stab && s->is_analysis && s->frames > 0) {
    flush_instance(ctx);
  }
  if (s->unchanged > 0) {
    av_log(ctx, AV_LOG_WARNING,
           "%" PRId64 " of %" PRId64 " frames are not in %s and were left as they are\n",
           s->unchanged, s->frames, s->file);
  }
  rsstab_destroy(s->stab);
}

#define FLAGS (AV_OPT_FLAG_FILTERING_PARAM | AV_OPT_FLAG_VIDEO_PARAM)
#define RUNTIME_FLAGS (FLAGS | AV_OPT_FLAG_RUNTIME_PARAM)
#define TEXT(name, help, field, standard, option_flags) \
  { name, help, OFFSET(field), AV_OPT_TYPE_STRING, {.str = standard}, .flags = option_flags, }
// Decided in the first pass, or in the only one.
#define MOTION_OPTIONS(option_flags)                                                        \
  TEXT("rs", "what tells rolling shutter (see rs-stabilize --help)", rs, NULL, FLAGS),      \
      TEXT("smoothness", "take out shake quicker than this many seconds", smoothness, NULL, \
           option_flags),                                                                   \
      TEXT("crop", "smallest share of width and height to keep", crop, NULL, option_flags), \
      TEXT("zoom", "adaptive, fixed, or a factor", zoom, NULL, FLAGS),                      \
      TEXT("tripod", "hold the view still: true or false", tripod, NULL, option_flags),     \
      TEXT("opts", "more options of the library: name=value|name=value", opts, NULL, FLAGS)

static const AVOption rsanalyze_options[] = {
    TEXT("result", "path of the analysis file to write", file, "analysis.rsstab", FLAGS),
    MOTION_OPTIONS(FLAGS),
    {NULL}};

static const AVOption rsstabilize_options[] = {
    TEXT("input", "path of the analysis file; without one, look ahead", file, NULL, FLAGS),
    MOTION_OPTIONS(RUNTIME_FLAGS),
    TEXT("lookahead", "frames to look ahead without analysis file", lookahead, NULL, FLAGS),
    TEXT("interpolation", "bilinear, bicubic or lanczos", interpolation, NULL, RUNTIME_FLAGS),
    {NULL}};

AVFILTER_DEFINE_CLASS(rsanalyze);
AVFILTER_DEFINE_CLASS(rsstabilize);

static const AVFilterPad inputs[] = {{
    .name = "default",
    .type = AVMEDIA_TYPE_VIDEO,
    .config_props = config_input,
}};

static const AVFilterPad outputs[] = {{
    .name = "default",
    .type = AVMEDIA_TYPE_VIDEO,
}};

// The public part of a filter became a struct of its own in libavfilter 11.
#if LIBAVFILTER_VERSION_MAJOR >= 11
#define FILTER const FFFilter
#define PUBLIC(field) .p.field
#else
#define FILTER const AVFilter
#define PUBLIC(field) .field
#endif

FILTER ff_vf_rsanalyze = {
    PUBLIC(name) = "rsanalyze",
    PUBLIC(description) = NULL_IF_CONFIG_SMALL(
        "Find camera motion and rolling shutter, pass 1 of 2 (see rsstabilize for pass 2)."),
    PUBLIC(priv_class) = &rsanalyze_class,
    PUBLIC(flags) = AVFILTER_FLAG_SLICE_THREADS,
    .priv_size = sizeof(StabContext),
    .init = init_analysis,
    .uninit = uninit,
    .activate = activate,
    FILTER_INPUTS(inputs),
    FILTER_OUTPUTS(outputs),
    FILTER_PIXFMTS_ARRAY(pixel_formats),
};

FILTER ff_vf_rsstabilize = {
    PUBLIC(name) = "rsstabilize",
    PUBLIC(description) = NULL_IF_CONFIG_SMALL(
        "Steady the picture and remove rolling shutter, pass 2 of 2 or with look-ahead."),
    PUBLIC(priv_class) = &rsstabilize_class,
    PUBLIC(flags) = AVFILTER_FLAG_SLICE_THREADS,
    .priv_size = sizeof(StabContext),
    .uninit = uninit,
    .activate = activate,
    .process_command = process_command,
    FILTER_INPUTS(inputs),
    FILTER_OUTPUTS(outputs),
    FILTER_PIXFMTS_ARRAY(pixel_formats),
};
