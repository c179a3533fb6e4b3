/* Cells: volumes that closed surfaces enclose, or tetrahedra, each of which is four triangles. */
#ifndef HK_CELLS_H
#define HK_CELLS_H

#include "core/plugin.h"
#include "plugins/common/elements/living_tuples.h"

/* A cell all of whose triangles act. */
typedef struct hk_cell {
  uint32_t number;         /* of the start */
  size_t first, triangles; /* acting triangles */
  size_t member, members;  /* its particles: hk_cells.member[member], ... */
  double volume, rate;     /* m^3, m^3/s: of the last hk_cells_measure */
} hk_cell;

/* To be zeroed before the first use. The memory belongs to the instance and is released with it. */
typedef struct hk_cells {
  hk_living_tuples triangles;
  size_t count, acting; /* cells at the start, and at present */
  uint32_t *cell_of;    /* of all triangles of the start */
  size_t *size;         /* triangles of the cells of the start */
  double *rest;         /* m^3, volumes at the start, of the triangles' sign */
  hk_cell *cell;        /* `acting` of them */
  uint32_t *member;     /* particles of the acting cells, each once */
  uint32_t *local;      /* per corner of an acting triangle: its position among its cell's members */
  uint32_t *mark;       /* n: 1 + that position while a cell is looked at */
  double *part[2];      /* per acting triangle: share of volume and rate */
} hk_cells;

/* Surfaces, of which particles that triangles share join the pieces. HK_BAD_PARAM names an edge at which they are not
 * closed, or a cell without volume. */
hk_status hk_cells_of_surfaces(hk_cells *, const hk_view *view, const hk_tuples *triangles);
hk_status hk_cells_of_tetrahedra(hk_cells *, const hk_view *view, const hk_tuples *tetrahedra);
hk_status hk_cells_topology(hk_cells *, const hk_view *view); /* a surface that lost a triangle is no cell any more */

/* Volumes and, where they are asked for, rates; the gradients of the volume go to the triangles' loads. */
void hk_cells_measure(hk_cells *, const hk_view *view, bool rates);

#endif
