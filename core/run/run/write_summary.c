/* The last file of a run: its summary, written when the verdict is final, beside the files of the outputs. */
#include "core/run/run/run.h"

#include <limits.h>

static bool write_summary(FILE *file, const void *summary) {
  hk_report_json(file, summary);
  return !ferror(file);
}

hk_status hk_run_write_summary(hk_run *run, const hk_summary *summary, hk_error *error) {
  char path[PATH_MAX];
  hk_summary now;
  if (!hk_folder_restore(run->folder)) return HK_OK;
  if (!summary) hk_run_summary(run, &now);
  hk_status status = hk_folder_path(run->folder, NULL, "summary.json", path, sizeof path, error);
  if (status == HK_OK) status = hk_write_file(path, write_summary, summary ? summary : &now, error);
  hk_folder_release(run->folder);
  return status;
}
