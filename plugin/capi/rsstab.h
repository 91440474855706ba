// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_PLUGIN_CAPI_RSSTAB_H_
#define RSSTAB_PLUGIN_CAPI_RSSTAB_H_

/*
 * rs-stabilize for hosts: video stabilization and removal of rolling shutter, C99.
 *
 * Three kinds of instances, all of one clip each:
 *   live      frames in, steady frames out, with a delay of `lookahead` frames (0: none)
 *   analyze   frames in, an analysis file at the end                        (first pass of two)
 *   apply     one frame in, one frame out, by an analysis file, any order   (second pass of two)
 *
 * Life cycle:   options = rsstab_options_create(); rsstab_options_set(options, "crop", "0.9"); ...
 *               rsstab_create_live(options, &video, &instance);        options may go now
 *               rsstab_push() / rsstab_pull() ... rsstab_flush(); rsstab_pull() ...
 *               rsstab_destroy(instance);
 *
 * Threads: distinct objects may be used by distinct threads at the same time. One object (options
 * or instance) may be used by any thread, but by one at a time. Functions without an object
 * argument may be called at any time. An instance has worker threads of its own (option "threads");
 * they end in rsstab_destroy().
 *
 * The library has no state outside its objects, never prints, never exits, and lets no C++
 * exception out. Object pointers must not be NULL but where said so.
 *
 * Stability: functions, enumerators and structs keep their meaning within one major version.
 * Structs that may grow begin with their size.
 */

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Version of this interface, which counts apart from the program's. */
#define RSSTAB_VERSION_MAJOR 1
#define RSSTAB_VERSION_MINOR 0
#define RSSTAB_VERSION_PATCH 0
#define RSSTAB_VERSION_NUMBER(major, minor, patch) \
  ((uint32_t)(major) << 16 | (uint32_t)(minor) << 8 | (uint32_t)(patch))
#define RSSTAB_VERSION \
  RSSTAB_VERSION_NUMBER(RSSTAB_VERSION_MAJOR, RSSTAB_VERSION_MINOR, RSSTAB_VERSION_PATCH)

#if defined(__GNUC__)
#define RSSTAB_API __attribute__((visibility("default")))
#else
#define RSSTAB_API
#endif

/* The RSSTAB_VERSION that the library in use was built with. */
RSSTAB_API uint32_t rsstab_version(void);
/* Version of rs-stabilize itself, "0.1.0": what an analysis file names as its maker. */
RSSTAB_API const char* rsstab_program_version(void);

/* ---- What a function answers -------------------------------------------------------------- */

/* 0 is success, positive a state that is no failure, negative a failure. */
typedef enum rsstab_status {
  RSSTAB_OK = 0,
  RSSTAB_AGAIN = 1,     /* no frame is ready: push more, or flush */
  RSSTAB_END = 2,       /* flushed, and the last frame was pulled */
  RSSTAB_UNCHANGED = 3, /* the frame was copied as it is: the analysis file does not know it */

  RSSTAB_ERROR_INVALID_ARGUMENT = -1, /* the caller asked for something that makes no sense */
  RSSTAB_ERROR_NOT_FOUND = -2,        /* a file is not there */
  RSSTAB_ERROR_UNSUPPORTED = -3,      /* valid, but this library cannot do it */
  RSSTAB_ERROR_CORRUPT_DATA = -4,     /* a file breaks its own format */
  RSSTAB_ERROR_IO = -5,               /* reading or writing failed */
  RSSTAB_ERROR_UNTRUSTWORTHY = -6,    /* an estimate exists, but the data do not determine it */
  RSSTAB_ERROR_CANCELLED = -7,
  RSSTAB_ERROR_INTERNAL = -8, /* our own bug */
  RSSTAB_ERROR_OUT_OF_MEMORY = -9,
  RSSTAB_ERROR_BAD_STATE = -10 /* not in this mode, or not after flush */
} rsstab_status;

/* A few words for a status. Static text. */
RSSTAB_API const char* rsstab_status_text(rsstab_status status);

/* ---- Options ------------------------------------------------------------------------------ */

/* What the user may choose: names, values, ranges and defaults are those of the command line
 * (`rs-stabilize --help`) without the dashes, and "lookahead". Listed at run time, so that a host
 * can show whatever the library in use knows. */
typedef enum rsstab_option_field {
  RSSTAB_OPTION_NAME = 0,   /* "smoothness" */
  RSSTAB_OPTION_VALUES = 1, /* "S", "FILE", "auto|gyro|off"; "" for a switch (values true, false) */
  RSSTAB_OPTION_RANGE = 2,  /* "0 to 10"; "" when the values say it all */
  RSSTAB_OPTION_HELP = 3,   /* one or two sentences, without default and range */
  RSSTAB_OPTION_GROUP = 4,  /* heading to list it under */
  RSSTAB_OPTION_DEFAULT = 5 /* "1"; "" = the library chooses */
} rsstab_option_field;

RSSTAB_API size_t rsstab_option_count(void);
/* Static text; NULL for an index or a field that does not exist. */
RSSTAB_API const char* rsstab_option_text(size_t index, rsstab_option_field field);

typedef struct rsstab_options rsstab_options;

/* NULL when out of memory. */
RSSTAB_API rsstab_options* rsstab_options_create(void);
/* NULL is allowed. Instances made with the options live on. */
RSSTAB_API void rsstab_options_destroy(rsstab_options* options);

/* Sets one option from text. RSSTAB_ERROR_NOT_FOUND: there is none of that name;
 * RSSTAB_ERROR_INVALID_ARGUMENT: the value is not allowed, and nothing changes. */
RSSTAB_API rsstab_status rsstab_options_set(rsstab_options* options, const char* name,
                                            const char* value);
/* The value as text that rsstab_options_set() takes; NULL: there is no such option. Valid until the
 * next call with `options`. */
RSSTAB_API const char* rsstab_options_get(rsstab_options* options, const char* name);

/* Why the last call with `options` (rsstab_create_...() included) failed: sentences that say what
 * was wrong, where, and what to do. "" after success. Valid until the next call with `options`. */
RSSTAB_API const char* rsstab_options_error(const rsstab_options* options);

typedef enum rsstab_log_level {
  RSSTAB_LOG_ERROR = 0,
  RSSTAB_LOG_WARNING = 1,
  RSSTAB_LOG_INFO = 2,
  RSSTAB_LOG_DEBUG = 3
} rsstab_log_level;

/* `message`: one line without line end, valid during the call. Called from the thread that uses the
 * instance or from one of the instance's own, one call at a time per instance; must not use the
 * instance. */
typedef void (*rsstab_log_function)(void* user, rsstab_log_level level, const char* message);

/* Messages of instances made from `options` afterwards, up to `most_detailed`, go to `log`. NULL:
 * nowhere, as at first. */
RSSTAB_API rsstab_status rsstab_options_set_log(rsstab_options* options, rsstab_log_function log,
                                                void* user, rsstab_log_level most_detailed);

/* ---- Pictures ----------------------------------------------------------------------------- */

/* Samples deeper than 8 bits: 16 bits each in the machine's byte order, value in the low bits. */
typedef enum rsstab_pixel_format {
  RSSTAB_PIXEL_NONE = 0,
  RSSTAB_PIXEL_YUV420P = 1,
  RSSTAB_PIXEL_YUV422P = 2,
  RSSTAB_PIXEL_YUV444P = 3,
  RSSTAB_PIXEL_YUV420P10 = 4,
  RSSTAB_PIXEL_YUV422P10 = 5,
  RSSTAB_PIXEL_YUV444P10 = 6,
  RSSTAB_PIXEL_YUV420P12 = 7,
  RSSTAB_PIXEL_YUV422P12 = 8,
  RSSTAB_PIXEL_YUV444P12 = 9,
  RSSTAB_PIXEL_NV12 = 10,
  RSSTAB_PIXEL_GRAY8 = 11,
  RSSTAB_PIXEL_GRAY10 = 12,
  RSSTAB_PIXEL_GRAY12 = 13,
  RSSTAB_PIXEL_GRAY16 = 14,
  RSSTAB_PIXEL_RGB24 = 15, /* packed, bytes R G B */
  RSSTAB_PIXEL_BGR24 = 16,
  RSSTAB_PIXEL_RGBA = 17, /* packed, bytes R G B A; alpha moves with the picture */
  RSSTAB_PIXEL_BGRA = 18,
  RSSTAB_PIXEL_GBRP = 19, /* planar, G first as libav orders it */
  RSSTAB_PIXEL_GBRP10 = 20
} rsstab_pixel_format;

/* Where the first chroma sample of a subsampled format sits. Zero is what MPEG-2, H.264 and later
 * assume. */
typedef enum rsstab_chroma_location {
  RSSTAB_CHROMA_LEFT = 0,
  RSSTAB_CHROMA_CENTER = 1,
  RSSTAB_CHROMA_TOP_LEFT = 2
} rsstab_chroma_location;

/* What every frame of a clip shares. Fill it with RSSTAB_VIDEO_INIT first. */
typedef struct rsstab_video {
  size_t struct_size; /* sizeof(rsstab_video) */
  int32_t width;      /* px, 1 to 65535; odd sizes are fine, chroma rounds up */
  int32_t height;
  rsstab_pixel_format format;
  int32_t full_range; /* YUV: 1 when luma black is 0 */
  rsstab_chroma_location chroma_location;
  /* One tick of the timestamps is time_base_num / time_base_den seconds; both positive. */
  int32_t time_base_num;
  int32_t time_base_den;
  /* Mean frames per second, num/den. Needed by live and analyze instances; 0/0 means 30. */
  int32_t frame_rate_num;
  int32_t frame_rate_den;
} rsstab_video;

#define RSSTAB_VIDEO_INIT \
  { sizeof(rsstab_video), 0, 0, RSSTAB_PIXEL_NONE, 0, RSSTAB_CHROMA_LEFT, 1, 1000000, 0, 0 }

#define RSSTAB_MAX_PLANES 4

/* A picture in the caller's memory. Strides in bytes; negative ones (bottom row first in memory)
 * are allowed, `data` then points to the top row. Planes that the format does not have are ignored.
 */
typedef struct rsstab_picture {
  const uint8_t* data[RSSTAB_MAX_PLANES];
  ptrdiff_t stride[RSSTAB_MAX_PLANES];
} rsstab_picture;

/* The same to write to; shares no memory with a picture that is read in the same call. */
typedef struct rsstab_buffer {
  uint8_t* data[RSSTAB_MAX_PLANES];
  ptrdiff_t stride[RSSTAB_MAX_PLANES];
} rsstab_buffer;

/* ---- Instances ---------------------------------------------------------------------------- */

typedef struct rsstab_instance rsstab_instance;

/* Makes an instance; `*instance` is NULL after a failure, and rsstab_options_error() says why.
 * Options and video are copied. */

/* Live. Every frame comes out exactly `lookahead` (an option) frames after it went in, the last
 * ones after rsstab_flush(). Rolling shutter (option "rs"): whatever can be had without having seen
 * the whole clip; a gyro log needs "gyro-offset" and, unless the log or the camera file tells it,
 * "readout". Memory: `lookahead` + 2 frames, whatever the clip's length. */
RSSTAB_API rsstab_status rsstab_create_live(rsstab_options* options, const rsstab_video* video,
                                            rsstab_instance** instance);

/* Analyze. `path` appears, complete, when rsstab_flush() succeeds, and replaces a file of that
 * name; without it nothing is left there. */
RSSTAB_API rsstab_status rsstab_create_analyze(rsstab_options* options, const rsstab_video* video,
                                               const char* path, rsstab_instance** instance);

/* Apply. Of the options it uses "interpolation" and "threads"; the rest was decided when the file
 * was made. The picture may have another size than the analysed one, if of the same shape (within
 * 1 %), and another pixel format.
 *
 * Which record a frame is rendered by: the one of its presentation time (the same tick, or within
 * half a frame when rounded to another time base or when frames were doubled). The file's picture
 * fingerprints are compared now and then. When they do not fit (the clip was cut at its start, so
 * that all times are shifted), a record whose fingerprint fits is looked for, and its time shift
 * kept. A frame without a record is handed on unchanged: RSSTAB_UNCHANGED. Seeking and rewinding
 * cost nothing. Memory: 100 bytes for each frame of the file. */
RSSTAB_API rsstab_status rsstab_create_apply(rsstab_options* options, const rsstab_video* video,
                                             const char* path, rsstab_instance** instance);

/* NULL is allowed. Frames still inside are released. */
RSSTAB_API void rsstab_destroy(rsstab_instance* instance);

/* Why the last call with `instance` failed, or why it answered RSSTAB_UNCHANGED. "" otherwise.
 * Valid until the next call with `instance`. */
RSSTAB_API const char* rsstab_error(const rsstab_instance* instance);

/* Frames between the one that goes in and the one that comes out: `lookahead` of a live instance, 0
 * of others. */
RSSTAB_API int32_t rsstab_delay(const rsstab_instance* instance);

/* Gives back a frame that was handed over to rsstab_push(). Called once per frame, by the thread
 * that is inside rsstab_pull(), rsstab_push(), rsstab_flush(), rsstab_reset() or rsstab_destroy().
 * Must not use the instance. */
typedef void (*rsstab_release_function)(void* frame_data);

/* The next frame in presentation order. `pts`: its time in ticks; comes out unchanged with the
 * steady frame. `frame_data`: anything of the caller's, comes out with the frame, too. `release`
 * NULL: the picture is copied before the call returns. Otherwise it is read where it is until
 * `release(frame_data)` is called; unless the answer is RSSTAB_OK it is not called, and the frame
 * is the caller's as before. RSSTAB_AGAIN: steady frames wait; pull them, then push this one again.
 */
RSSTAB_API rsstab_status rsstab_push(rsstab_instance* instance, const rsstab_picture* picture,
                                     int64_t pts, void* frame_data,
                                     rsstab_release_function release);

/* What rsstab_pull() would give: RSSTAB_OK with the frame's `pts` and `frame_data` (each may be
 * NULL), RSSTAB_AGAIN or RSSTAB_END. The frame stays. */
RSSTAB_API rsstab_status rsstab_peek(rsstab_instance* instance, int64_t* pts, void** frame_data);

/* Renders the next steady frame into `buffer` and takes it off: RSSTAB_OK (RSSTAB_UNCHANGED),
 * RSSTAB_AGAIN or RSSTAB_END. Frames come in the order they went in. `pts`, `frame_data`: may be
 * NULL; where the frame was handed over, it is released before the call returns, so take what is
 * needed of it after rsstab_peek(). A frame that fails is taken off, too, unless it was the
 * buffer's fault (RSSTAB_ERROR_INVALID_ARGUMENT). */
RSSTAB_API rsstab_status rsstab_pull(rsstab_instance* instance, const rsstab_buffer* buffer,
                                     int64_t* pts, void** frame_data);

/* No more frames will come. Live: what is inside becomes ready. Analyze: completes the file. Once
 * only, until rsstab_reset(). */
RSSTAB_API rsstab_status rsstab_flush(rsstab_instance* instance);

/* Apply only: the frame of time `pts`, in any order, steady into `buffer`. RSSTAB_OK or
 * RSSTAB_UNCHANGED. The same as rsstab_push() and rsstab_pull(), without keeping anything. */
RSSTAB_API rsstab_status rsstab_render(rsstab_instance* instance, const rsstab_picture* picture,
                                       int64_t pts, const rsstab_buffer* buffer);

/* Apply only: the time, in ticks of the video, of the `index`th frame (from 0) of the analysis
 * file, for hosts that hand over frames in order but without times. RSSTAB_ERROR_INVALID_ARGUMENT:
 * the file has no such frame. */
RSSTAB_API rsstab_status rsstab_frame_time(rsstab_instance* instance, int64_t index, int64_t* pts);

/* Live and apply: releases all frames inside and begins anew, as if just created (after a seek). */
RSSTAB_API rsstab_status rsstab_reset(rsstab_instance* instance);

/* Changes an option of a running instance, from the next frame on. Live: "smoothness", "tripod",
 * "crop", "interpolation"; apply: "interpolation". RSSTAB_ERROR_UNSUPPORTED for others. */
RSSTAB_API rsstab_status rsstab_set(rsstab_instance* instance, const char* name, const char* value);

#ifdef __cplusplus
}
#endif

#endif /* RSSTAB_PLUGIN_CAPI_RSSTAB_H_ */
