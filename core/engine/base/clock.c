/* The clock for wall times: monotonic, so that a change of the system's date does not affect it. */
#include "core/engine/base/base.h"

#include <time.h>

double hk_clock(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}
