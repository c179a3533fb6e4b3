/* measures.csv: a row per frame, flushed, so that an interrupted run keeps its measured values. */
#include "core/run/storage/storage.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <string.h>

static hk_status failed(hk_error *error) {
  return hk_error_set(error, errno == ENOMEM ? HK_NO_MEMORY : HK_IO, "cannot write measures.csv: %s", strerror(errno));
}

/* In quotes where the text has a comma, a quote or a line break (RFC 4180, section 2). Spreadsheets compute what begins
 * with = + - @ or a tab; an apostrophe ahead makes it a text. */
static void write_field(FILE *file, const char *text) {
  bool quoted = strpbrk(text, ",\"\r\n") != NULL;
  if (quoted) fputc('"', file);
  if (*text && strchr("=+-@\t\r", *text)) fputc('\'', file);
  for (; *text; text++) fputs(*text == '"' ? "\"\"" : (char[]){*text, 0}, file);
  if (quoted) fputc('"', file);
}

hk_status hk_measures_open(hk_folder *folder, const hk_scene *scene, FILE **file, hk_error *error) {
  char path[PATH_MAX];
  if (scene->measures == 0) return HK_OK;
  hk_status status = hk_folder_path(folder, NULL, "measures.csv", path, sizeof path, error);
  if (status != HK_OK) return status;
  int descriptor = open(path, O_WRONLY | O_CREAT | O_TRUNC | O_NOFOLLOW | O_CLOEXEC, 0666);
  *file = descriptor < 0 ? NULL : fdopen(descriptor, "w");
  if (!*file) return failed(error);
  fputs("t", *file);
  for (size_t k = 0; k < scene->measures; k++) {
    fputc(',', *file);
    write_field(*file, scene->measure[k].name);
  }
  return fputc('\n', *file) == EOF ? failed(error) : HK_OK;
}

hk_status hk_measures_write(FILE *file, double t, const hk_frame *frame, hk_error *error) {
  if (!file) return HK_OK;
  fprintf(file, "%.17g", t);
  for (size_t k = 0; k < frame->measures; k++) fprintf(file, ",%.17g", frame->measure[k]);
  fputc('\n', file);
  return fflush(file) == 0 ? HK_OK : failed(error);
}

hk_status hk_measures_close(FILE **file, hk_error *error) {
  FILE *open = *file;
  *file = NULL;
  return !open || fclose(open) == 0 ? HK_OK : failed(error);
}
