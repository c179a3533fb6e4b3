/* Services: functions that several plugins share through host->query("NAME/1"). One instance serves a run: the scene's
 * own of that interface (scene:service, with parameters), or else plugins/services/NAME. It is made at the first query
 * in a plugin's `create`; when that fails, `query` returns NULL and the run does not open. */
#ifndef HK_PLUGIN_SERVICE_H
#define HK_PLUGIN_SERVICE_H

#include "core/plugin/model.h"

typedef struct hk_service {
  size_t size;
  const char *interface;            /* "neighbours/1": the name and version that `query` asks for */
  const void *(*table)(void *self); /* the result of `query`, valid as long as the run; called after `create` */
  /* s, wall time that the table's functions have taken in this run, for the summary, where it is also part of the time
   * of the plugins that called them; NULL: not known. */
  double (*seconds)(void *self);
} hk_service;

/* ---- "neighbours/1" -------------------------------------------------------------------------------------------- */

/* Pairs of particles closer than a radius, in a list with a skin that all clients share. The search is repeated only
 * when a particle has moved by half the skin, after births and deaths, or when the radius grew. The pairs within a
 * client's own radius and their order do not depend on when that was, nor on the number of threads: sums over rows that
 * check the distance have the same bits. */
typedef struct hk_neighbour_rows {
  size_t n;
  const size_t *row_start; /* n + 1 */
  const uint32_t *other;   /* row_start[n]: of each i all j != i that were closer than `reach`, rising; both i's row
                              has j and j's row has i */
  double reach;            /* m, the largest radius and its skin */
  uint64_t number;         /* changes when the rows change; to be compared within one topology */
} hk_neighbour_rows;

typedef struct hk_neighbours {
  void *self;
  /* Called in `create`, `topology` or `update`: requests rows with all pairs closer than `radius`, m, 0 or 1e-150 to
   * 1e150. The largest request counts, to the end of the run. HK_BAD_PARAM. */
  hk_status (*reach)(void *self, double radius);
  /* The rows for the positions x (n x 3), valid until the next call of any client. They hold pairs up to `reach` apart
   * and, as x has moved since the search, somewhat more: the caller checks the distance. May be called from `add`,
   * `energy`, `update`, `accepted` and sources, not inside a parallel_for, which it uses. It allocates when there are
   * more pairs than ever before, by half at least. HK_NO_MEMORY; HK_NOT_FINITE, which names the particle. */
  hk_status (*rows)(void *self, const hk_view *view, const double *x, hk_neighbour_rows *rows);
} hk_neighbours;

#endif
