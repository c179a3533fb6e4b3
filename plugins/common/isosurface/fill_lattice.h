/* The lattice of a filling (surface_fill.h): points have numbers, the corners of cells first, x fastest, then the
 * centres in the same order. */
#ifndef HK_FILL_LATTICE_H
#define HK_FILL_LATTICE_H

#include "plugins/common/isosurface/surface_parts.h"

static const uint32_t hk_fill_none = UINT32_MAX;

typedef struct hk_fill_cut { /* where the surface crosses an edge of the lattice */
  uint32_t inside, outside;  /* points */
  uint32_t next[2];          /* the next cut at either of them, or hk_fill_none */
  uint32_t number;           /* of its vertex in the filling, or hk_fill_none */
  double x[3];
} hk_fill_cut;

typedef struct hk_fill_work {
  const hk_host *host;
  const hk_isosurface_grid *grid;
  const hk_isosurface_field *field;
  const hk_isosurface_options *options;
  size_t bytes, corners, points, cuts;
  double *value;    /* points: f - level */
  int8_t *side;     /* points: 1 inside, 0 on the surface, -1 outside */
  uint32_t *first;  /* points: the first cut at it, or hk_fill_none */
  uint32_t *moved;  /* points: the cut to which it was moved, or hk_fill_none */
  uint32_t *number; /* points: of its vertex in the filling, or hk_fill_none */
  hk_fill_cut *cut; /* cuts */
  hk_filling found;
} hk_fill_work;

hk_status hk_fill_allocate(hk_fill_work *, void *array, size_t count, size_t size, const char *what);
void hk_fill_place(const hk_fill_work *, size_t point, double x[3]); /* in the lattice, where nothing is moved */
/* The neighbours of a point with higher numbers or higher places, each edge once: up to 11 edges, from `point`. Returns
 * how many. */
unsigned hk_fill_edges(const hk_fill_work *, size_t point, uint32_t end[11]);
bool hk_fill_is_long(const hk_fill_work *, uint32_t p, uint32_t q); /* between two corners or two centres */
/* Values, sides and cuts; then moves points onto the surface. */
hk_status hk_fill_survey(hk_fill_work *);
void hk_fill_move_points(hk_fill_work *);
/* Fills `found` (fill_cells.c). */
hk_status hk_fill_cells(hk_fill_work *);

#endif
