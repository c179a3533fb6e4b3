/* Checkpoints: files from which `hooke run --resume FILE` goes on, bit by bit as if the run had not stopped. The newest
 * two are kept, newest.checkpoint and before.checkpoint; each is written under another name first, so that whatever
 * happens one of them is whole. A run that is interrupted or diverges leaves the last point from which it can go on. */
#include "core/plugin.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>

typedef struct checkpoint {
  int64_t every;
  double seconds;

  const hk_host *host;
  const hk_checkpoints *service;
  double written_at; /* s, wall; 0: not yet */
  char newest[PATH_MAX], before[PATH_MAX];
} checkpoint;

static const hk_param params[] = {
    {"every", "frames",
     "a point from which the run can go on, every so many frames; methods that keep factors or a history renew them "
     "there",
     .integer = HK_AT(checkpoint, every), .initial = {60}, .limits = HK_WITHIN(1, 1e9)},
    {"seconds", "s",
     "wall time after which such a point is written to the file; until then it is kept in memory. 0: every one",
     .number = HK_AT(checkpoint, seconds), .limits = HK_WITHIN(0, 1e9)},
    {0},
};

static double now(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  checkpoint *c = self;
  (void)view;
  c->host = host;
  c->service = host->query(host, "checkpoint/1");
  return c->service ? HK_OK : host->fail(host, HK_FAILED, "this hooke has no checkpoints for outputs");
}

/* What could not be written after hours is said before them. */
static hk_status try_to_write(const checkpoint *c) {
  struct stat info = {0};
  errno = 0;
  FILE *file = fopen(c->newest, "wb");
  bool fine = file && fstat(fileno(file), &info) == 0 && fputs(c->newest, file) >= 0 && fflush(file) == 0;
  int cause = errno;
  if (file && fclose(file) != 0 && fine) fine = false, cause = errno;
  if (S_ISREG(info.st_mode)) remove(c->newest);
  return fine ? HK_OK : c->host->fail(c->host, HK_IO, "cannot write %s: %s", c->newest, strerror(cause));
}

static hk_status open(void *self, const hk_view *view, const hk_frame *frame) {
  checkpoint *c = self;
  (void)view, (void)frame;
  c->written_at = now();
  hk_status status = c->host->path(c->host, "before.checkpoint", c->before, sizeof c->before);
  if (status == HK_OK) status = c->host->path(c->host, "newest.checkpoint", c->newest, sizeof c->newest);
  return status == HK_OK ? try_to_write(c) : status;
}

/* The newest one so far becomes the one before. */
static hk_status make_way(const checkpoint *c) {
  if (rename(c->newest, c->before) == 0 || errno == ENOENT) return HK_OK;
  return c->host->fail(c->host, HK_IO, "cannot rename %s: %s", c->newest, strerror(errno));
}

static hk_status frame(void *self, const hk_view *view, const hk_frame *frame) {
  checkpoint *c = self;
  (void)view;
  if (frame->index == 0 || frame->index % (size_t)c->every != 0) return HK_OK;
  if (now() - c->written_at < c->seconds) return c->service->ask(c->service->self, NULL);
  c->written_at = now();
  hk_status status = make_way(c);
  return status == HK_OK ? c->service->ask(c->service->self, c->newest) : status;
}

static hk_status close(void *self, hk_verdict verdict) {
  const checkpoint *c = self;
  bool newer = false;
  if (verdict != HK_STOPPED && verdict != HK_DIVERGED) return HK_OK;
  hk_status status = c->service->newest(c->service->self, &newer);
  if (status != HK_OK || !newer) return status;
  status = make_way(c);
  return status == HK_OK ? c->service->write(c->service->self, c->newest) : status;
}

static const hk_output output = {.size = sizeof(hk_output), .open = open, .frame = frame, .close = close};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_OUTPUT,
    .name = "checkpoint",
    .summary = "files from which hooke run --resume goes on, bit by bit; the newest two are kept",
    .reference = "",
    .instance_size = sizeof(checkpoint),
    .params = params,
    .create = create,
    .output = &output,
};
