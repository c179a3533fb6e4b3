/* The memory of a host, for tests of what runs without an engine. */
#ifndef HK_TEST_PLAIN_HOST_H
#define HK_TEST_PLAIN_HOST_H

#include "core/plugin.h"

#include <stdlib.h>

/* hk_host.allocate: zeros. */
static inline void *test_allocate(const hk_host *host, size_t bytes) {
  (void)host;
  return calloc(1, bytes + 1);
}

/* hk_host.release */
static inline void test_release(const hk_host *host, void *memory) {
  (void)host;
  free(memory);
}

#endif
