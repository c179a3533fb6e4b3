/* Cloth and other sheets of triangles as walls without thickness in the grid of a liquid: a line from the centre of a
 * cell to the next one that meets a triangle is a face that the liquid does not pass, and both sides have pressures of
 * their own. Pressure moves the particles of the triangles, each as a body by itself (moving_walls.h).
 * Guendelman, Selle, Losasso, Fedkiw 2005, Coupling water and smoke to thin deformable and rigid shells, with the
 * coupling of Batty, Bertails, Bridson 2007; the flux through a slanting sheet is right to order 1 in the cell.
 *
 * A step: _begin, the solution, _end, then _keep for each particle of the liquid. */
#ifndef HK_THIN_WALLS_H
#define HK_THIN_WALLS_H

#include "plugins/common/mac_grid/liquid_grid.h"

typedef struct hk_thin_crossing {
  uint32_t vertex[3]; /* of the triangle, among those of the walls */
  double weight[3];   /* of these: barycentric */
  double place;       /* m, along the face's axis */
} hk_thin_crossing;

typedef struct hk_thin_vertex {
  uint32_t particle;  /* of the scene */
  double inverse[9];  /* 1/kg, of its mass, in the directions that no pin forbids; 0: it is held */
  double x[3], to[3]; /* m, at the start of the step and at its end */
  double v[3];        /* m/s, with which it comes to the end */
  double came[3];     /* m/s, before pressure acted */
} hk_thin_vertex;

typedef struct hk_thin_walls {
  const hk_host *host;
  size_t triangles, vertices, n; /* n: of the scene's particles */
  double *allowed;               /* n x 3, for directions that pins forbid; NULL: no vertex slides on one */
  uint32_t (*triangle)[3];       /* of vertices */
  hk_thin_vertex *vertex;
  uint32_t *face[3]; /* size of the grid: the crossing of a face, from 1; 0: none */
  size_t crossings, room;
  hk_thin_crossing *crossing;
  uint32_t *bin;    /* size of the grid + 1: the places in `near` of what is near a cell */
  uint32_t *near;   /* triangles that a particle of the cell may meet in the step */
  size_t near_room; /* of `near` */
} hk_thin_walls;

/* Of the triangles (arity 3; none: no walls) but those of rigid bodies, also again for others; size: of the grid's
 * arrays. HK_NO_MEMORY, with a message. */
hk_status hk_thin_walls_open(hk_thin_walls *, const hk_host *, const hk_view *, const hk_tuples *triangles,
                             size_t size);
void hk_thin_walls_close(hk_thin_walls *);
/* Where they are at the start of the step, with what velocities they come to its end, and the faces that they cross.
 * HK_NO_MEMORY, with a message. */
hk_status hk_thin_walls_begin(hk_thin_walls *, const hk_liquid_grid *, const hk_model *, const hk_correction *);
/* The crossing of face i of component c; NULL: none. */
static inline const hk_thin_crossing *hk_thin_walls_at(const hk_thin_walls *s, int c, size_t i) {
  return s->triangles && s->face[c][i] ? &s->crossing[s->face[c][i] - 1] : NULL;
}
/* Whether a triangle crosses a line from the centre of cell i to one beside it, nearer than `part` of the way. */
bool hk_thin_walls_beside(const hk_thin_walls *, const hk_liquid_grid *, size_t i, double part);
/* m/s, of the crossing along axis c. */
double hk_thin_walls_speed(const hk_thin_walls *, const hk_thin_crossing *, int c);
/* x and v of the particles that pressure has moved become those of the end; `reach`: cells that a particle of the
 * liquid moves at most. Sets *moved where any has. HK_NO_MEMORY, with a message. */
hk_status hk_thin_walls_end(hk_thin_walls *, const hk_liquid_grid *, hk_correction *, int reach, bool *moved);
/* Changes x, where a particle of the liquid that was at `from` in the cell has come to, so that it has passed no
 * triangle: it is then a hundredth of a cell from it, on the side that it was on. */
void hk_thin_walls_keep(const hk_thin_walls *, const hk_liquid_grid *, size_t cell, const double from[3], double x[3]);

#endif
