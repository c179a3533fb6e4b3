/* Shared objects of a program that has none, as a browser runs it: dlopen of build/plugins/KIND/NAME.so finds the
 * plugin in the table that is linked in, and the segments of loaded files are the program's one block of constants and
 * variables, from 1024 to where the heap begins (WebAssembly: "tool conventions", Linking). The registry looks for
 * files before it opens them, and these are in the file system of the page (engine.js); so nothing of the engine is
 * another one in a browser. Nor has a page a clock of the processor's time: limits of a script's time do not hold in
 * it, those of its instructions do, and whoever has enough of it ends its thread. */
#define _GNU_SOURCE
#include "tools/browser/linked.h"

#include <dlfcn.h>
#include <emscripten.h>
#include <errno.h>
#include <link.h>
#include <string.h>
#include <time.h>

extern char __heap_base[]; /* by the linker */

static const char *reason; /* of the last failure, as dlerror gives it */

void *dlopen(const char *path, int flags) {
  (void)flags;
  for (const hk_linked_plugin *p = hk_linked_plugins; path && p->file; p++) {
    size_t length = strlen(path), tail = strlen(p->file) + strlen(".so");
    if (length > tail && path[length - tail - 1] == '/' && strncmp(path + length - tail, p->file, strlen(p->file)) == 0)
      return (void *)(uintptr_t)p->plugin;
  }
  reason = "a page has the plugins that it was built with: build it again with `make browser`";
  return NULL;
}

void *dlsym(void *restrict handle, const char *restrict name) {
  return strcmp(name, "hk_plugin_main") == 0 ? handle : NULL;
}

int dlclose(void *handle) { return (void)handle, 0; }

char *dlerror(void) { return (char *)(uintptr_t)reason; }

int dladdr(const void *address, Dl_info *info) {
  (void)address;
  *info = (Dl_info){.dli_fname = "/hooke/build/libhooke.so"};
  return 1;
}

int dl_iterate_phdr(int (*visit)(struct dl_phdr_info *, size_t, void *), void *context) {
  enum { BEGIN = 1024 };
  ElfW(Phdr)
      segment = {.p_type = PT_LOAD, .p_flags = PF_R, .p_vaddr = BEGIN, .p_memsz = (uintptr_t)__heap_base - BEGIN};
  struct dl_phdr_info program = {.dlpi_name = "", .dlpi_phdr = &segment, .dlpi_phnum = 1};
  return visit(&program, sizeof program, context);
}

EM_JS(double, date, (void), { return Date.now(); });

int clock_gettime(clockid_t clock, struct timespec *t) {
  if (clock != CLOCK_REALTIME && clock != CLOCK_MONOTONIC) {
    errno = EINVAL;
    return -1;
  }
  double ms = clock == CLOCK_REALTIME ? date() : emscripten_get_now();
  t->tv_sec = (time_t)(ms / 1000);
  t->tv_nsec = (long)(1e6 * (ms - 1000 * (double)t->tv_sec));
  return 0;
}
