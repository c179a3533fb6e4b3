/* A table of the motion, comma-separated: one line per frame with time, energies, momentum and the scene's measures, in
 * 17 significant digits, which restore every double. Each line is written to the file before the next step. */
#include "core/plugin.h"
#include "plugins/common/frame_data/csv_name.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <string.h>

typedef struct table {
  const char *name;
  int64_t every;

  const hk_host *host;
  FILE *file;
  char path[PATH_MAX];
} table;

static const hk_param params[] = {
    {"file", "", "name of the table, inside the output folder", .string = HK_AT(table, name), .text = "table.csv"},
    {"every", "frames", "a line every so many frames", .integer = HK_AT(table, every), .initial = {1},
     .limits = HK_WITHIN(1, 1e9)},
    {0},
};

static hk_status io_error(const table *t, const char *doing) {
  return t->host->fail(t->host, errno == ENOMEM ? HK_NO_MEMORY : HK_IO, "cannot %s %s: %s", doing, t->path,
                       strerror(errno));
}

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  table *t = self;
  (void)view;
  t->host = host;
  return HK_OK;
}

static hk_status open(void *self, const hk_view *view, const hk_frame *frame) {
  table *t = self;
  (void)view;
  hk_status status = t->host->path(t->host, t->name, t->path, sizeof t->path);
  if (status != HK_OK) return status;
  t->file = fopen(t->path, "w");
  if (!t->file) return io_error(t, "create");
  fputs(
      "t [s],kinetic [J],potential [J],work [J],energy [J],momentum x [kg m/s],momentum y [kg m/s],momentum z [kg m/s]",
      t->file);
  for (size_t k = 0; k < frame->measures; k++) {
    putc(',', t->file);
    hk_put_csv_name(t->file, "", frame->measure_name[k], "", false);
  }
  putc('\n', t->file);
  return fflush(t->file) == 0 ? HK_OK : io_error(t, "write");
}

static hk_status frame(void *self, const hk_view *view, const hk_frame *now) {
  table *t = self;
  if (now->index % (size_t)t->every != 0) return HK_OK;
  double number[] = {view->t,          now->kinetic,     now->potential,  now->work, now->kinetic + now->potential,
                     now->momentum[0], now->momentum[1], now->momentum[2]};
  for (size_t k = 0; k < sizeof number / sizeof *number; k++) fprintf(t->file, k ? ",%.17g" : "%.17g", number[k]);
  for (size_t k = 0; k < now->measures; k++) fprintf(t->file, ",%.17g", now->measure[k]);
  putc('\n', t->file);
  return fflush(t->file) == 0 ? HK_OK : io_error(t, "write");
}

static hk_status close(void *self, hk_verdict verdict) {
  table *t = self;
  (void)verdict;
  FILE *file = t->file;
  t->file = NULL;
  return fclose(file) == 0 ? HK_OK : io_error(t, "write");
}

static void destroy(void *self, const hk_host *host) {
  table *t = self;
  (void)host;
  if (t->file) fclose(t->file);
}

static const hk_output output = {.size = sizeof(hk_output), .open = open, .frame = frame, .close = close};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_OUTPUT,
    .name = "table",
    .summary = "a table (CSV) of energies, momentum and measures, one line per frame",
    .reference = "",
    .instance_size = sizeof(table),
    .params = params,
    .create = create,
    .destroy = destroy,
    .output = &output,
};
