// SPDX-License-Identifier: Apache-2.0
/* The smallest use of the C interface: pictures in memory (here a painted, shaky wall) become
 * steady, first live with a delay of 15 frames, then in two passes by an analysis file. C99. */
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "rsstab.h"

enum { kWidth = 320, kHeight = 180, kFrames = 60, kChroma = kWidth / 2 * kHeight / 2 };

typedef struct Picture {
  uint8_t luma[kWidth * kHeight];
  uint8_t chroma[2][kChroma];
} Picture;

static void Paint(Picture* picture, int index) {
  const double dx = 6.0 * sin(1.9 * index);
  const double dy = 4.0 * cos(2.3 * index);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const double wave = sin((x + dx) * 0.31) * sin((y + dy) * 0.23) +
                          0.5 * sin((x + dx) * 0.07 + (y + dy) * 0.11);
      picture->luma[y * kWidth + x] = (uint8_t)(128.0 + 60.0 * wave);
    }
  }
  memset(picture->chroma, 128, sizeof picture->chroma);
}

static rsstab_picture ToRead(const Picture* picture) {
  const rsstab_picture view = {{picture->luma, picture->chroma[0], picture->chroma[1], NULL},
                               {kWidth, kWidth / 2, kWidth / 2, 0}};
  return view;
}

static rsstab_buffer ToWrite(Picture* picture) {
  const rsstab_buffer view = {{picture->luma, picture->chroma[0], picture->chroma[1], NULL},
                              {kWidth, kWidth / 2, kWidth / 2, 0}};
  return view;
}

static Picture g_input;
static Picture g_output;

/* Takes every frame that is ready; each one would be shown or encoded here. */
static int PullAll(rsstab_instance* instance, int* count) {
  const rsstab_buffer buffer = ToWrite(&g_output);
  int64_t pts = 0;
  rsstab_status status;
  while ((status = rsstab_pull(instance, &buffer, &pts, NULL)) == RSSTAB_OK) {
    if (pts != *count) {
      fprintf(stderr, "frame %d came out with the time %" PRId64 "\n", *count, pts);
      return 0;
    }
    ++*count;
  }
  return status == RSSTAB_AGAIN || status == RSSTAB_END;
}

static int RunLive(rsstab_options* options, const rsstab_video* video) {
  rsstab_instance* instance = NULL;
  int count = 0;
  int ok = rsstab_create_live(options, video, &instance) == RSSTAB_OK;
  if (!ok) {
    fprintf(stderr, "live: %s\n", rsstab_options_error(options));
    return 0;
  }
  for (int i = 0; ok && i < kFrames; ++i) {
    Paint(&g_input, i);
    const rsstab_picture picture = ToRead(&g_input);
    ok = rsstab_push(instance, &picture, i, NULL, NULL) == RSSTAB_OK && PullAll(instance, &count);
  }
  ok = ok && rsstab_flush(instance) == RSSTAB_OK && PullAll(instance, &count) && count == kFrames;
  if (!ok) {
    fprintf(stderr, "live: %s\n", rsstab_error(instance));
  }
  rsstab_destroy(instance);
  return ok;
}

static int Analyze(rsstab_options* options, const rsstab_video* video, const char* path) {
  rsstab_instance* instance = NULL;
  int ok = rsstab_create_analyze(options, video, path, &instance) == RSSTAB_OK;
  if (!ok) {
    fprintf(stderr, "analyze: %s\n", rsstab_options_error(options));
    return 0;
  }
  for (int i = 0; ok && i < kFrames; ++i) {
    Paint(&g_input, i);
    const rsstab_picture picture = ToRead(&g_input);
    ok = rsstab_push(instance, &picture, i, NULL, NULL) == RSSTAB_OK;
  }
  ok = ok && rsstab_flush(instance) == RSSTAB_OK;
  if (!ok) {
    fprintf(stderr, "analyze: %s\n", rsstab_error(instance));
  }
  rsstab_destroy(instance);
  return ok;
}

static int Apply(rsstab_options* options, const rsstab_video* video, const char* path) {
  rsstab_instance* instance = NULL;
  int ok = rsstab_create_apply(options, video, path, &instance) == RSSTAB_OK;
  if (!ok) {
    fprintf(stderr, "apply: %s\n", rsstab_options_error(options));
    return 0;
  }
  /* Any order: here backwards. */
  for (int i = kFrames - 1; ok && i >= 0; --i) {
    Paint(&g_input, i);
    const rsstab_picture picture = ToRead(&g_input);
    const rsstab_buffer buffer = ToWrite(&g_output);
    ok = rsstab_render(instance, &picture, i, &buffer) == RSSTAB_OK;
  }
  if (!ok) {
    fprintf(stderr, "apply: %s\n", rsstab_error(instance));
  }
  rsstab_destroy(instance);
  return ok;
}

int main(int argc, char** argv) {
  const char* analysis = argc > 1 ? argv[1] : "minimal_capi.rsstab";
  if (rsstab_version() >> 16 != RSSTAB_VERSION_MAJOR) {
    fprintf(stderr, "librsstab speaks another version of this interface\n");
    return 1;
  }
  rsstab_video video = RSSTAB_VIDEO_INIT;
  video.width = kWidth;
  video.height = kHeight;
  video.format = RSSTAB_PIXEL_YUV420P;
  video.time_base_num = 1; /* ticks of 1/30 s: the time of frame i is i */
  video.time_base_den = 30;

  rsstab_options* options = rsstab_options_create();
  int ok = options != NULL && rsstab_options_set(options, "smoothness", "0.8") == RSSTAB_OK &&
           rsstab_options_set(options, "lookahead", "15") == RSSTAB_OK;
  ok = ok && RunLive(options, &video) && Analyze(options, &video, analysis) &&
       Apply(options, &video, analysis);
  rsstab_options_destroy(options);
  remove(analysis);
  if (ok) {
    printf("%d frames steadied live and in two passes\n", kFrames);
  }
  return ok ? 0 : 1;
}
