/* The arrays of a liquid's grid. */
#include "plugins/common/mac_grid/liquid_grid.h"
#include "plugins/common/mac_grid/vcycle.h"

#include <string.h>

/* Of a cell: 22 numbers of the grid, its unknown and layers, bodies and cloth beside it; those of the pressure's
 * matrix.
 */
static const double bytes_of_cell = 22 * 8 + 4 + 4 + 4 * 2 + 4 * 4 + 12 * 8 + 7 * 4 + 4;

double hk_liquid_bytes(const double cells[3]) {
  return (bytes_of_cell + hk_vcycle_bytes()) * (cells[0] + 2) * (cells[1] + 2) * (cells[2] + 2);
}

static hk_status measure(hk_liquid_grid *g, const hk_host *host, double cell, double most) {
  double cells[3];
  for (int c = 0; c < 3; c++) {
    double length = g->high[c] - g->low[c];
    if (!(length >= 0))
      return host->fail(host, HK_BAD_PARAM,
                        "high: %g m is below low, %g m, along %c: the liquid has no room; give the "
                        "box's upper corner",
                        g->high[c], g->low[c], "xyz"[c]);
    if (length > 0 && length <= cell / 2)
      return host->fail(host, HK_BAD_PARAM,
                        "cell: %g m is twice the box along %c, %g m, or more: take smaller cells, or for a plane a box "
                        "without depth there, high = low",
                        cell, "xyz"[c], length);
    g->flat[c] = length == 0;
    cells[c] = g->flat[c] ? 1 : fmax(1, round(length / cell));
    g->spacing[c] = g->flat[c] ? cell : length / cells[c];
  }
  if (g->flat[0] + g->flat[1] + g->flat[2] > 1)
    return host->fail(host, HK_BAD_PARAM,
                      "low, high: the box has no depth along two axes or more: a liquid needs a plane "
                      "or space; give it room along another one");
  double bytes = hk_liquid_bytes(cells);
  if (bytes > most)
    return host->fail(host, HK_BAD_PARAM,
                      "cell: a grid of %.0f x %.0f x %.0f cells of %g m takes %.3g GB, and `memory` allows %.3g: take "
                      "larger cells or a smaller box, or allow more",
                      cells[0], cells[1], cells[2], cell, bytes / 1e9, most / 1e9);
  for (int c = 0; c < 3; c++) g->cells[c] = (size_t)cells[c];
  return HK_OK;
}

static void lay_out(hk_liquid_grid *g) {
  g->slab = 2;
  for (int c = 1; c >= 0; c--)
    if (g->cells[c] > g->cells[g->slab]) g->slab = c;
  int inner = hk_liquid_inner(g), middle = hk_liquid_middle(g);
  g->stride[inner] = 1;
  g->stride[middle] = g->cells[inner] + 2;
  g->stride[g->slab] = g->stride[middle] * (g->cells[middle] + 2);
  g->size = g->stride[g->slab] * (g->cells[g->slab] + 2);
}

enum { ARRAYS = 22 };

static void arrays_of(hk_liquid_grid *g, double **list[ARRAYS]) {
  int k = 0;
  for (int c = 0; c < 3; c++) {
    list[k++] = &g->u[c];
    list[k++] = &g->weight[c];
    list[k++] = &g->before[c];
    list[k++] = &g->push[c];
    list[k++] = &g->open[c];
    list[k++] = &g->wall[c];
  }
  list[k++] = &g->filled;
  list[k++] = &g->room;
  list[k++] = &g->distance;
  list[k++] = &g->solid;
}

hk_status hk_liquid_grid_lay(hk_liquid_grid *g, const hk_host *host, const double low[3], const double high[3],
                             double cell, double most) {
  memset(g, 0, sizeof *g);
  memcpy(g->low, low, sizeof g->low);
  memcpy(g->high, high, sizeof g->high);
  hk_status status = measure(g, host, cell, most);
  if (status == HK_OK) lay_out(g);
  return status;
}

hk_status hk_liquid_grid_open(hk_liquid_grid *g, const hk_host *host, const double low[3], const double high[3],
                              double cell, double most) {
  hk_status status = hk_liquid_grid_lay(g, host, low, high, cell, most);
  if (status != HK_OK) return status;
  double **list[ARRAYS];
  arrays_of(g, list);
  bool all = true;
  for (int k = 0; k < ARRAYS; k++) all &= (*list[k] = host->allocate(host, g->size * sizeof(double))) != NULL;
  for (int c = 0; c < 3; c++) all &= (g->known[c] = host->allocate(host, g->size)) != NULL;
  all &= (g->fresh = host->allocate(host, g->size)) != NULL;
  all &= (g->unknown = host->allocate(host, g->size * sizeof *g->unknown)) != NULL;
  if (all) {
    memset(g->unknown, 0xff, g->size * sizeof *g->unknown);
    return HK_OK;
  }
  hk_liquid_grid_free(g, host);
  return host->fail(host, HK_NO_MEMORY, "no memory for a grid of %zu x %zu x %zu cells: take larger ones", g->cells[0],
                    g->cells[1], g->cells[2]);
}

hk_status hk_liquid_grid_check(const hk_liquid_grid *g, const hk_host *host, const char *what, double more,
                               double most) {
  double bytes = hk_liquid_bytes((const double[]){(double)g->cells[0], (double)g->cells[1], (double)g->cells[2]});
  if (bytes + more <= most) return HK_OK;
  return host->fail(host, HK_BAD_PARAM,
                    "cell: a grid of %zu x %zu x %zu cells takes %.3g GB, and %s up to %.3g more, and `memory` allows "
                    "%.3g: take larger cells or a smaller box, or allow more",
                    g->cells[0], g->cells[1], g->cells[2], bytes / 1e9, what, more / 1e9, most / 1e9);
}

void hk_liquid_grid_free(hk_liquid_grid *g, const hk_host *host) {
  double **list[ARRAYS];
  arrays_of(g, list);
  for (int k = 0; k < ARRAYS; k++) {
    host->release(host, *list[k]);
    *list[k] = NULL;
  }
  for (int c = 0; c < 3; c++) {
    host->release(host, g->known[c]);
    g->known[c] = NULL;
  }
  host->release(host, g->fresh);
  host->release(host, g->unknown);
  g->fresh = NULL;
  g->unknown = NULL;
}
