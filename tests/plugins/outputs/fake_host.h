/* A host just large enough for one output plugin: it fills the parameter defaults, has fields for FAKE_MOST particles
 * (zeroed once: it knows nothing of births), hands out memory and paths inside a temporary folder, and keeps the
 * messages. */
#ifndef HK_TEST_FAKE_HOST_H
#define HK_TEST_FAKE_HOST_H

#include "core/engine/contract/contract.h"

#include <dlfcn.h>
#include <errno.h>
#include <limits.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { FAKE_MOST = 4096 };

typedef struct fake {
  hk_host host; /* first member */
  void *library;
  const hk_plugin *plugin;
  void *self;
  char folder[256];
  char error[512], warning[1024];
  void *memory[4096];
  size_t blocks;
  long allocations_left; /* negative: no limit */
} fake;

static inline fake *fake_of(const hk_host *host) { return (fake *)(uintptr_t)host; }

static inline hk_status fake_fail(const hk_host *host, hk_status status, const char *format, ...) {
  fake *f = fake_of(host);
  va_list list;
  va_start(list, format);
  vsnprintf(f->error, sizeof f->error, format, list);
  va_end(list);
  return status;
}

static inline void fake_warn(const hk_host *host, const char *format, ...) {
  fake *f = fake_of(host);
  va_list list;
  va_start(list, format);
  vsnprintf(f->warning, sizeof f->warning, format, list);
  va_end(list);
}

/* It serves nothing. */
static inline const void *fake_query(const hk_host *host, const char *service) {
  (void)host, (void)service;
  return NULL;
}

static inline void *fake_allocate(const hk_host *host, size_t bytes) {
  fake *f = fake_of(host);
  if (f->allocations_left == 0) return NULL;
  if (f->allocations_left > 0) f->allocations_left--;
  size_t size = (bytes + 63) / 64 * 64 + 64;
  void *memory = f->blocks < 4096 ? aligned_alloc(64, size) : NULL;
  if (memory) f->memory[f->blocks++] = memset(memory, 0, size);
  return memory;
}

static inline void fake_release(const hk_host *host, void *memory) {
  fake *f = fake_of(host);
  for (size_t k = 0; k < f->blocks; k++)
    if (f->memory[k] == memory && memory) f->memory[k] = f->memory[--f->blocks];
  free(memory);
}

static inline void fake_parallel_for(const hk_host *host, size_t count, size_t grain,
                                     void (*body)(void *, size_t, size_t, size_t), void *context) {
  (void)host;
  for (size_t k = 0; k * grain < count; k++)
    body(context, k * grain, (k + 1) * grain < count ? (k + 1) * grain : count, k);
}

static inline hk_status fake_path(const hk_host *host, const char *name, char *buffer, size_t size) {
  snprintf(buffer, size, "%s/%s", fake_of(host)->folder, name);
  for (char *slash = strchr(buffer + 1, '/'); slash; slash = strchr(slash + 1, '/')) {
    *slash = 0;
    int failed = mkdir(buffer, 0777) != 0 && errno != EEXIST;
    *slash = '/';
    if (failed) return fake_fail(host, HK_IO, "%s: %s", buffer, strerror(errno));
  }
  return HK_OK;
}

/* The field of a parameter. */
static inline void *fake_field(fake *f, const char *name) {
  for (const hk_param *p = f->plugin->params; p->name; p++)
    if (strcmp(p->name, name) == 0) return hk_param_in(p, f->self);
  fprintf(stderr, "no parameter '%s'\n", name);
  abort();
}

static inline void fake_default(char *self, const hk_param *p) {
  bool optional = p->flags & HK_OPTIONAL;
  void *to = hk_param_in(p, self);
  switch (hk_param_type(p)) {
  case HK_NUMBER:
    *(double *)to = optional ? NAN : p->initial[0];
    break;
  case HK_INTEGER:
    *(int64_t *)to = (int64_t)p->initial[0];
    break;
  case HK_BOOLEAN:
    *(bool *)to = p->initial[0] != 0;
    break;
  case HK_STRING:
    *(const char **)to = p->text;
    break;
  case HK_CHOICE:
    *(int *)to = (int)p->initial[0];
    break;
  case HK_VECTOR:
    for (size_t c = 0; c < 3; c++) ((double *)to)[c] = optional ? NAN : p->initial[c];
    break;
  default:
    break;
  }
}

/* Loads HK_BUILD/plugins/outputs/NAME.so (or `name` itself when it has a slash) and makes an instance in a new
 * temporary folder. */
static inline void fake_open(fake *f, const char *name) {
  char path[512];
  *f = (fake){.host = {.abi = HK_ABI,
                       .fail = fake_fail,
                       .warn = fake_warn,
                       .allocate = fake_allocate,
                       .release = fake_release,
                       .parallel_for = fake_parallel_for,
                       .path = fake_path,
                       .query = fake_query},
              .allocations_left = -1};
  snprintf(path, sizeof path, strchr(name, '/') ? "%s" : HK_BUILD "/plugins/outputs/%s.so", name);
  f->library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
  f->plugin = f->library ? dlsym(f->library, "hk_plugin_main") : NULL;
  if (!f->plugin) {
    fprintf(stderr, "%s\n", dlerror());
    abort();
  }
  f->self = calloc(1, f->plugin->instance_size);
  for (const hk_param *p = f->plugin->params; p->name; p++) fake_default(f->self, p);
  for (const hk_field *p = f->plugin->fields; p && p->name; p++)
    *(void **)hk_field_in(p, f->self) = calloc(FAKE_MOST * p->width, sizeof(double));
  snprintf(f->folder, sizeof f->folder, "/tmp/hooke-test-XXXXXX");
  if (!mkdtemp(f->folder)) abort();
}

static inline void fake_remove_files(const char *folder) {
  char command[600];
  snprintf(command, sizeof command, "rm -rf '%s'", folder);
  if (system(command) != 0) fprintf(stderr, "cannot remove %s\n", folder);
}

/* Destroys the instance. The library stays loaded, as the engine leaves it. */
static inline void fake_close(fake *f) {
  if (f->plugin->destroy) f->plugin->destroy(f->self, &f->host);
  for (const hk_field *p = f->plugin->fields; p && p->name; p++) free(*(void **)hk_field_in(p, f->self));
  while (f->blocks) free(f->memory[--f->blocks]);
  free(f->self);
  if (strncmp(f->folder, "/tmp/hooke-test-", 16) == 0) fake_remove_files(f->folder);
}

#endif
