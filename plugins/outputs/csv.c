/* A table of particles, comma-separated: a row for each particle of each frame with position, velocity, mass, strain
 * and channels. Each frame is on file before the next step. */
#include "plugins/common/sequence/csv.h"
#include "plugins/common/sequence/formats.h"
#include "plugins/common/frame_data/gatherer.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <string.h>

typedef struct csv {
  const char *name, *group;
  int64_t every;
  bool forces;
  hk_tuples only;

  const hk_host *host;
  hk_gatherer gatherer;
  FILE *file;
  char path[PATH_MAX];
} csv;

/* clang-format off */
static const hk_param params[] = {
    {"file", "", "name of the table, inside the output folder",
     HK_STRING, {0}, 0, 0, offsetof(csv, name), 0, "particles.csv"},
    HK_GATHERER_ROWS(csv),
    {"forces", "", "keep the force of every plugin on every particle: an evaluation more per frame",
     HK_BOOLEAN, {0}, 0, 0, offsetof(csv, forces), 0, NULL},
    {0},
};
/* clang-format on */

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  csv *p = self;
  p->host = host;
  return hk_gatherer_choose(&p->gatherer, host, view->model, p->group);
}

static hk_status io_error(const csv *p, const char *why) {
  return p->host->fail(p->host, HK_IO, "cannot write %s: %s", p->path, why);
}

static hk_status flush(csv *p) {
  errno = 0;
  return fflush(p->file) == 0 && !ferror(p->file) ? HK_OK : io_error(p, strerror(errno ? errno : EIO));
}

static hk_status open(void *self, const hk_view *view, const hk_frame *now) {
  csv *p = self;
  hk_status status = p->host->path(p->host, p->name, p->path, sizeof p->path);
  if (status == HK_OK) status = hk_gatherer_open(&p->gatherer, view, now, &p->only, p->forces);
  if (status != HK_OK) return status;
  p->file = hk_sequence_file(p->path, "w");
  if (!p->file) return io_error(p, strerror(errno));
  hk_csv_head(p->file, &p->gatherer.data);
  return flush(p);
}

static hk_status frame(void *self, const hk_view *view, const hk_frame *now) {
  csv *p = self;
  if (now->index % (size_t)p->every != 0) return HK_OK;
  hk_status status = hk_gatherer_frame(&p->gatherer, view, now, &p->only);
  if (status != HK_OK) return status;
  hk_csv_rows(p->file, &p->gatherer.data);
  return flush(p);
}

static hk_status close(void *self, hk_verdict verdict) {
  csv *p = self;
  char why[256] = "";
  FILE *file = p->file;
  (void)verdict;
  p->file = NULL;
  return hk_sequence_file_close(file, why, sizeof why) ? HK_OK : io_error(p, why);
}

static void destroy(void *self, const hk_host *host) {
  csv *p = self;
  (void)host;
  if (p->file) fclose(p->file);
  hk_gatherer_free(&p->gatherer);
}

static hk_status topology(void *self, const hk_view *view) {
  csv *p = self;
  (void)view;
  p->gatherer.dirty = true;
  return HK_OK;
}

static const hk_output output = {.size = sizeof(hk_output), .open = open, .frame = frame, .close = close};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_OUTPUT,
    .name = "csv",
    .summary = "a table (CSV) of chosen particles, a row for each at every frame",
    .reference = "RFC 4180",
    .instance_size = sizeof(csv),
    .params = params,
    .create = create,
    .destroy = destroy,
    .topology = topology,
    .output = &output,
};
