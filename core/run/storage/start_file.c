/* Reads the file that a run begins with; its first bytes tell a checkpoint from a state table. */
#include "core/run/storage/files.h"

#include <errno.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>

/* Beside the script, or in the output folder, unless the script is trusted. */
static FILE *open_start(const hk_scene *scene, const hk_folder *output, const char *path) {
  char folder[PATH_MAX] = ".";
  const char *slash = strrchr(scene->script, '/'), *within[3] = {folder, hk_folder_place(output), NULL};
  if (scene->trusted) return hk_file_read(path, NULL);
  if (slash)
    snprintf(folder, sizeof folder, "%.*s", slash == scene->script ? 1 : (int)(slash - scene->script), scene->script);
  return hk_file_read(path, within);
}

static hk_status read_start(hk_loop *loop, hk_judgement *j, const hk_folder *output, const char *path,
                            const char *origin, hk_origin_changes *changes, bool *resumed) {
  char line[4096] = "";
  errno = 0;
  *resumed = false;
  /* With an origin the user has named the file, not the script. */
  FILE *file = origin ? hk_file_read(path, NULL) : open_start(j->scene, output, path);
  if (!file) return hk_error_set(loop->error, HK_IO, "cannot read %s: %s", path, hk_file_reason(errno));
  hk_status status;
  if (!fgets(line, sizeof line, file))
    status = hk_error_set(loop->error, HK_IO, "%s is empty", path);
  else if (origin || strncmp(line, hk_checkpoint_magic, strlen(hk_checkpoint_magic) - 2) == 0) {
    status = hk_checkpoint_read(loop, j, path, origin, changes);
    *resumed = status == HK_OK;
  } else if (strncmp(line, "id,x,", 5) == 0)
    status = hk_state_table_read(j->scene, loop, file, line, path);
  else
    status = hk_error_set(loop->error, HK_IO,
                          "%s is neither a checkpoint nor a table that begins with id,x,y,z,vx,vy,vz,mass", path);
  fclose(file);
  return status;
}

/* What is wrong with a file that the script names is said with the script's line. */
hk_status hk_start_file_read(hk_loop *loop, hk_judgement *j, const hk_folder *output, const char *path,
                             const char *origin, hk_origin_changes *changes, bool *resumed) {
  const char *where = origin ? NULL : j->scene->start_where;
  hk_status status = read_start(loop, j, output, path, origin, changes, resumed);
  if (status == HK_OK || !where) return status;
  hk_error cause = *loop->error;
  *loop->error = (hk_error){0};
  return hk_error_set(loop->error, status, "%s: start: %s", where, cause.text);
}
