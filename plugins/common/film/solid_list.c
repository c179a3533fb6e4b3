#include "plugins/common/film/solid_list.h"

#include <string.h>

typedef struct format {
  const char *name, *row;
  hk_shape_kind kind;
  size_t width;
} format;

static const format formats[] = {
    {"spheres", "x, y, z and a radius above 0", HK_SHAPE_SPHERE, 4},
    {"boxes", "x, y, z and three extents above 0", HK_SHAPE_BOX, 6},
    {"planes", "x, y, z and a normal that is not 0", HK_SHAPE_PLANE, 6},
};
enum { FORMATS = sizeof formats / sizeof *formats };

static bool is_body(const format *f, const double *row) {
  if (f->kind == HK_SHAPE_SPHERE) return row[3] > 0;
  if (f->kind == HK_SHAPE_BOX) return row[3] > 0 && row[4] > 0 && row[5] > 0;
  return row[3] != 0 || row[4] != 0 || row[5] != 0;
}

static void read_row(const format *f, const double *row, bool y_up, hk_frame_solid *solid) {
  *solid = (hk_frame_solid){.kind = f->kind};
  hk_to_z_up(y_up, row, solid->centre);
  if (f->kind == HK_SHAPE_PLANE) {
    hk_to_z_up(y_up, row + 3, solid->axis[2]);
    return;
  }
  for (int k = 0; k < 3; k++) {
    double axis[3] = {0};
    axis[k] = f->kind == HK_SHAPE_SPHERE ? row[3] : row[3 + k] / 2;
    hk_to_z_up(y_up, axis, solid->axis[k]);
  }
}

static hk_status read_rows(const hk_host *host, const format *f, const hk_numbers *list, bool y_up,
                           hk_frame_solid *solid) {
  bool fine = list->count % f->width == 0;
  for (size_t k = 0; fine && k < list->count; k += f->width) {
    fine = is_body(f, list->value + k);
    read_row(f, list->value + k, y_up, solid + k / f->width);
  }
  if (fine) return HK_OK;
  return host->fail(host, HK_BAD_PARAM, "%s: expected %s for each", f->name, f->row);
}

hk_status hk_solid_list_make(const hk_host *host, const hk_solid_numbers *numbers, bool y_up, hk_frame_solid **solid,
                             size_t *count) {
  const hk_numbers *list[FORMATS] = {&numbers->spheres, &numbers->boxes, &numbers->planes};
  size_t most = 0;
  for (int k = 0; k < FORMATS; k++) most += list[k]->count / formats[k].width;
  *count = 0;
  *solid = most ? host->allocate(host, most * sizeof **solid) : NULL;
  if (most && !*solid) return host->fail(host, HK_NO_MEMORY, "no memory for %zu solids", most);
  for (int k = 0; k < FORMATS; k++) {
    hk_status status = read_rows(host, formats + k, list[k], y_up, *solid + *count);
    if (status != HK_OK) return status;
    *count += list[k]->count / formats[k].width;
  }
  return HK_OK;
}
