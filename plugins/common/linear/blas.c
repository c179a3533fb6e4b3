/* See blas.h. The order of sums in a threaded BLAS depends on the machine, and the last digits of results with it. */
#define _GNU_SOURCE /* dladdr */
#include "plugins/common/linear/blas.h"
#include "core/plugin.h"

#include <dlfcn.h>

extern void openblas_set_num_threads(int threads) __attribute__((weak)); /* NULL with another BLAS */
extern void omp_set_max_active_levels(int levels) __attribute__((weak)); /* NULL without OpenMP */

void hk_blas_threads(int threads) {
  if (openblas_set_num_threads) openblas_set_num_threads(threads);
  /* 0: parallel loops run on the calling thread */
  if (omp_set_max_active_levels) omp_set_max_active_levels(threads > 1);
}

void hk_blas_stay_loaded(void) {
  Dl_info here;
  if (!dladdr(&hk_plugin_main, &here) || !here.dli_fname) return;
  void *handle = dlopen(here.dli_fname, RTLD_LAZY | RTLD_NODELETE);
  if (handle) dlclose(handle);
}
