/* measures.csv: a row per frame, flushed, so that an interrupted run keeps what it measured. */
#include "core/run/engine.h"

#include <errno.h>
#include <limits.h>
#include <string.h>

static hk_status failed(hk_run *run) {
  return hk_error_set(&run->error, HK_IO, "cannot write measures.csv: %s", strerror(errno));
}

hk_status hk_measures_open(hk_run *run) {
  char path[PATH_MAX];
  if (run->scene->measures == 0 || run->options.no_output) return HK_OK;
  hk_status status = hk_folder_path(&run->scene->shared, "measures.csv", path, sizeof path);
  if (status != HK_OK) return status;
  run->measures_file = fopen(path, "w");
  if (!run->measures_file) return failed(run);
  fputs("t", run->measures_file);
  for (size_t k = 0; k < run->scene->measures; k++) fprintf(run->measures_file, ",%s", run->scene->measure[k].name);
  return fputc('\n', run->measures_file) == EOF ? failed(run) : HK_OK;
}

hk_status hk_measures_write(hk_run *run) {
  if (!run->measures_file) return HK_OK;
  fprintf(run->measures_file, "%.17g", run->system.t);
  for (size_t k = 0; k < run->scene->measures; k++) fprintf(run->measures_file, ",%.17g", run->measure[k]);
  fputc('\n', run->measures_file);
  return fflush(run->measures_file) == 0 ? HK_OK : failed(run);
}

hk_status hk_measures_close(hk_run *run) {
  FILE *file = run->measures_file;
  run->measures_file = NULL;
  return !file || fclose(file) == 0 ? HK_OK : failed(run);
}
