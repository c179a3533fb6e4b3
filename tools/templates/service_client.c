/* NAME_client: an output for the test of the service NAME, which it asks at every frame; what is answered becomes a
 * line of NAME.csv in the run's folder. */
#include "NAME.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

typedef struct NAME_client {
  double height; /* m */
  const hk_host *host;
  const NAME_table *service;
  FILE *file;
  char path[4096];
} NAME_client;

static const hk_param params[] = {
    {"height", "m", "of which the service is asked", .number = HK_AT(NAME_client, height)},
    {0},
};

static hk_status failed(const NAME_client *p) {
  return p->host->fail(p->host, HK_IO, "cannot write %s: %s", p->path, strerror(errno));
}

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  NAME_client *p = self;
  (void)view;
  p->host = host;
  p->service = host->query(host, NAME_INTERFACE);
  return p->service ? HK_OK
                    : host->fail(host, HK_FAILED, "the scene has no service NAME: add scene:service(\"./NAME.so\")");
}

static hk_status begin(void *self, const hk_view *view, const hk_frame *now) {
  NAME_client *p = self;
  (void)view, (void)now;
  hk_status status = p->host->path(p->host, "NAME.csv", p->path, sizeof p->path);
  if (status != HK_OK) return status;
  p->file = fopen(p->path, "w");
  return p->file && fputs("t [s],below\n", p->file) >= 0 ? HK_OK : failed(p);
}

static hk_status frame(void *self, const hk_view *view, const hk_frame *now) {
  NAME_client *p = self;
  (void)now;
  size_t below = p->service->below(p->service->self, view, p->height);
  return fprintf(p->file, "%.17g,%zu\n", view->t, below) > 0 ? HK_OK : failed(p);
}

static hk_status end(void *self, hk_verdict verdict) {
  NAME_client *p = self;
  FILE *file = p->file;
  (void)verdict;
  p->file = NULL;
  return fclose(file) == 0 ? HK_OK : failed(p);
}

/* A run may fail between. */
static void destroy(void *self, const hk_host *host) {
  NAME_client *p = self;
  (void)host;
  if (p->file) fclose(p->file);
}

static const hk_output output = {.size = sizeof(hk_output), .open = begin, .frame = frame, .close = end};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_OUTPUT,
    .name = "NAME_client",
    .summary = "what the service NAME answers at every frame, in NAME.csv",
    .reference = "",
    .instance_size = sizeof(NAME_client),
    .params = params,
    .create = create,
    .destroy = destroy,
    .output = &output,
};
