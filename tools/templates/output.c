/* NAME: writes the centre of mass of every frame as a line of NAME.csv in the run's folder. Describe here what it
 * writes. */
#include "core/plugin.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

typedef struct NAME {
  const hk_host *host;
  FILE *file;
  char path[4096];
} NAME;

static hk_status failed(const NAME *p) {
  return p->host->fail(p->host, HK_IO, "cannot write %s: %s", p->path, strerror(errno));
}

/* Before frame 0. */
static hk_status begin(void *self, const hk_view *view, const hk_frame *now) {
  NAME *p = self;
  (void)now;
  p->host = view->host;
  hk_status status = p->host->path(p->host, "NAME.csv", p->path, sizeof p->path);
  if (status != HK_OK) return status;
  p->file = fopen(p->path, "w");
  return p->file && fputs("t [s],x [m],y [m],z [m]\n", p->file) >= 0 ? HK_OK : failed(p);
}

static hk_status frame(void *self, const hk_view *view, const hk_frame *now) {
  NAME *p = self;
  double mass = 0, sum[3] = {0};
  (void)now;
  for (size_t i = 0; i < view->n; i++) {
    mass += view->model->mass[i];
    for (int c = 0; c < 3; c++) sum[c] += view->model->mass[i] * view->x[3 * i + c];
  }
  if (mass == 0) mass = 1; /* nobody is there */
  return fprintf(p->file, "%.17g,%.17g,%.17g,%.17g\n", view->t, sum[0] / mass, sum[1] / mass, sum[2] / mass) > 0
             ? HK_OK
             : failed(p);
}

/* Once for each `open` that succeeded, however the run ended. */
static hk_status end(void *self, hk_verdict verdict) {
  NAME *p = self;
  FILE *file = p->file;
  (void)verdict;
  p->file = NULL;
  return fclose(file) == 0 ? HK_OK : failed(p);
}

/* A run may fail between. */
static void destroy(void *self, const hk_host *host) {
  NAME *p = self;
  (void)host;
  if (p->file) fclose(p->file);
}

static const hk_output output = {.size = sizeof(hk_output), .open = begin, .frame = frame, .close = end};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_OUTPUT,
    .name = "NAME",
    .summary = "the centre of mass of every frame, in NAME.csv",
    .reference = "",
    .instance_size = sizeof(NAME),
    .destroy = destroy,
    .output = &output,
};
