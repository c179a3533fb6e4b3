/* Services: what several plugins share through host->query("NAME/1"). The plugin is plugins/services/NAME; one instance
 * serves a run, made when it is first asked for. */
#ifndef HK_PLUGIN_SERVICE_H
#define HK_PLUGIN_SERVICE_H

#include "core/plugin/model.h"

typedef struct hk_service {
  size_t size;
  const char *interface;            /* "neighbours/1": the name and version that `query` asks for */
  const void *(*table)(void *self); /* what `query` answers, valid as long as the run; after `create` */
} hk_service;

/* ---- "neighbours/1" -------------------------------------------------------------------------------------------- */

/* Pairs of particles closer than a radius, by cell lists with a skin: found again only when a particle has moved by
 * half the skin. The same for any number of threads. */
typedef struct hk_neighbour_rows {
  size_t n;
  const size_t *row_start; /* n + 1 */
  const uint32_t *other;   /* row_start[n]: of each i all j != i with |x_i - x_j| < radius + skin, rising; both i's row
                              has j and j's row has i */
  double reach;            /* m, radius + skin */
  uint64_t number;         /* changes when the rows do */
} hk_neighbour_rows;

typedef struct hk_neighbours {
  void *self;
  /* In `create` or `topology`: rows are to reach as far as `radius`, m. The largest that was asked for counts. */
  hk_status (*reach)(void *self, double radius);
  /* The rows for the positions x (n x 3), valid until the next call; pairs may be up to `reach` apart, so look at the
   * distance. Callable from `add`, `update` and sources. HK_NO_MEMORY; HK_NOT_FINITE. */
  hk_status (*rows)(void *self, const hk_view *view, const double *x, hk_neighbour_rows *rows);
} hk_neighbours;

#endif
