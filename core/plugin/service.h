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
  const uint32_t *other;   /* row_start[n]: of each i all j != i that were closer than `reach`, in a periodic box their
                              nearest images, rising; both i's row has j and j's row has i */
  double reach;            /* m, the largest radius and its skin */
  uint64_t number;         /* changes when the rows change; to be compared within one topology */
} hk_neighbour_rows;

typedef struct hk_neighbours {
  void *self;
  /* Called in `create`, `topology` or `update`: requests rows with all pairs closer than `radius`, m, 0 or 1e-150 to
   * 1e150. The largest request counts, to the end of the run. HK_BAD_PARAM; also in a periodic box, see below. */
  hk_status (*reach)(void *self, double radius);
  /* The rows for the positions x (n x 3), valid until the next call of any client. They hold pairs up to `reach` apart
   * and, as x has moved since the search, somewhat more: the caller checks the distance. May be called from `add`,
   * `energy`, `update`, `accepted` and sources, not inside a parallel_for, which it uses. It allocates when there are
   * more pairs than ever before, by half at least. HK_NO_MEMORY; HK_NOT_FINITE, which names the particle. */
  hk_status (*rows)(void *self, const hk_view *view, const double *x, hk_neighbour_rows *rows);
  /* `reach` of a caller that knows of periodic boxes (core/plugin/model.h): it takes the differences of pairs in the
   * rows to the nearest image, and has the flag HK_PERIODIC. HK_BAD_PARAM also where the box is shorter than two radii
   * along an axis that repeats: a particle would meet two images of another. Since minor 1. */
  hk_status (*reach_images)(void *self, double radius);
} hk_neighbours;

/* ---- "interruption/1", which the host serves itself -------------------------------------------------------------- */

/* For outputs whose `close` takes long. */
typedef struct hk_interruption {
  void *self;
  bool (*again)(void *self); /* whether the user has asked to stop since the outputs began to be closed */
} hk_interruption;

/* ---- "draft/1", which the host serves itself --------------------------------------------------------------------- */

/* Whether the user wants a quick look: pictures of half the size. */
typedef bool hk_draft;

/* ---- "strands/1", which the host serves itself ------------------------------------------------------------------- */

/* Particles with the ids first, first + 1, ..., first + count - 1: strands or hairs of one section. */
typedef struct hk_strand {
  uint32_t first, count;
  double radius; /* m; of an ellipse that of the circle with its area */
} hk_strand;

/* Those whose radius the script gives, with rising ids. */
typedef struct hk_strands {
  size_t count;
  hk_strand *item;
} hk_strands;

/* ---- "checkpoint/1", which the host serves itself ---------------------------------------------------------------- */

/* Points from which the run can go on, bit by bit as if it had not stopped (hooke run --resume). */
typedef struct hk_checkpoints {
  void *self;
  /* Called in an output's `frame`: once this frame is done with, the methods drop what checkpoints cannot hold
   * (HK_CHECKPOINT), and the point is kept in memory and, where `path` is not NULL, written there. Frames are to be
   * asked for by their number alone, never by a clock: the run goes on a little differently from each. */
  hk_status (*ask)(void *self, const char *path);
  /* Called in an output's `close`. *newer: a point is known that is on no file: of a run that was interrupted the
   * present one where its method has nothing to drop, else the last that was asked for. */
  hk_status (*newest)(void *self, bool *newer);
  hk_status (*write)(void *self, const char *path); /* after `newest` said so: writes that point */
} hk_checkpoints;

/* ---- "octree/1" ------------------------------------------------------------------------------------------------- */

/* A cell of an octree. Cells stand in the order of a walk from the root that enters a cell before those inside it, so
 * that a walk is a loop: from cell k to k + 1, which is its first part, or, past all that is inside it, to `next`. */
typedef struct hk_octree_cell {
  uint32_t begin, count;  /* its points are order[begin] to order[begin + count - 1] */
  uint32_t next;          /* k + 1: it has no parts */
  double low[3], high[3]; /* m, the box of its points */
} hk_octree_cell;

typedef struct hk_octree {
  size_t points, cells;
  const uint32_t *order;      /* points: particles, those near each other mostly near in the list */
  const hk_octree_cell *cell; /* cells; the first is the root, which has all points */
} hk_octree;

typedef struct hk_octrees {
  void *self;
  /* The octree of the particles in `list` (`count` of them; NULL: all) at the places x (n x 3), valid until the next
   * call of any client. A cell that has no parts has at most 8 points, or more that are too near to each other to be
   * told apart by 2^-21 of the extent. It is built anew unless x and the list are those of the last call, so it depends
   * on nothing else. Not inside a parallel_for, which it uses. HK_NOT_FINITE, which names the particle. */
  hk_status (*tree)(void *self, const hk_view *view, const double *x, const uint32_t *list, size_t count,
                    hk_octree *tree);
} hk_octrees;

/* ---- "isosurface/1" --------------------------------------------------------------------------------------------- */

/* The surface where a function f(x, y, z) falls through a level, as triangles, or what it holds, as tetrahedra. The
 * host asks for it while a script is read, without particles. */
typedef struct hk_implicit_request {
  /* f at `count` places of the box, from several threads where the host has them; the same bits for the same place. */
  void (*evaluate)(const void *self, const double (*x)[3], size_t count, double *value);
  /* range[0] <= f <= range[1] in the whole box from low to high, for functions that know; NULL: the function costs much
   * and is asked at every point `coarse` of the grid (1 or more) and from there along the surface. */
  void (*bounds)(const void *self, const double low[3], const double high[3], double range[2]);
  const void *self;
  double low[3], high[3]; /* m: the box that is searched */
  double cell;            /* m: cells are as large, or less, so that a whole number of them fills the box */
  bool cubes;             /* by marching cubes; else by marching tetrahedra, with about three times the triangles */
  bool close;             /* a surface that leaves the box is closed along its faces, else it is an error */
  bool solid;             /* tetrahedra that fill the surface, and no triangles; cubes and close do not count */
  unsigned coarse;
  size_t most_bytes; /* an error before more than this is allocated; 0: no limit */
} hk_implicit_request;

typedef struct hk_implicit_mesh { /* valid until the next call; inside is where f >= 0 */
  size_t vertices, triangles, tetrahedra;
  const double (*x)[3];             /* vertices x 3, m, where f = 0 to some 1e-6 of a cell */
  const uint32_t (*triangle)[3];    /* from 0, counterclockwise from outside */
  const uint32_t (*tetrahedron)[4]; /* from 0; the edges from the first corner are right-handed */
} hk_implicit_mesh;

typedef struct hk_isosurfaces {
  void *self;
  /* HK_BAD_PARAM (no surface, one that leaves the box, a cell that is none), HK_NOT_FINITE, HK_FAILED, HK_NO_MEMORY. */
  hk_status (*find)(void *self, const hk_implicit_request *, hk_implicit_mesh *);
} hk_isosurfaces;

#endif
