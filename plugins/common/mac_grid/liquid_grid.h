/* The grid of a liquid: a MAC grid (Harlow and Welch 1965) that fills a box. Pressures are in the centres of cells, and
 * of velocities the component along an axis in the centres of the faces across it. An axis along which the box has no
 * depth has one cell, and no velocity.
 *
 * All arrays have one layout, with a layer of cells outside the box on either side of each axis: along an axis cells
 * have the numbers 1 to `cells`, and the face of a cell is that on its lower side, so faces have 1 to cells + 1.
 * Outside the box what is at centres is that of the nearest cell inside: walls without friction. */
#ifndef HK_LIQUID_GRID_H
#define HK_LIQUID_GRID_H

#include "core/plugin.h"

#define HK_LIQUID_NONE UINT32_MAX

typedef struct hk_liquid_grid {
  double low[3], high[3], spacing[3]; /* m */
  size_t cells[3], stride[3], size;   /* size: of every array */
  bool flat[3];                       /* without depth: spacing is the depth that is counted for volumes */
  int slab;                           /* the axis whose layers lie one behind the other in memory */
  double *u[3];                       /* m/s, on faces */
  double *weight[3];                  /* kg, on faces: of the particles that gave them their velocity */
  double *before[3];                  /* m/s, on faces: before pressure and walls have acted */
  double *push[3];                    /* m, on faces: displacement that evens the density */
  double *open[3];                    /* on faces: the part that no wall covers, 0 to 1 */
  double *wall[3];                    /* m/s, on faces: velocity of the walls */
  double *filled;                     /* in cells: volume of liquid by that of the cell */
  double *room;     /* in cells: the same if liquid filled all that no wall covers; negative: the centre is in a wall */
  double *distance; /* in cells: to the free surface by the spacing, negative in the liquid */
  double *solid;    /* m, at the lower corner of a cell: distance to the nearest obstacle */
  uint32_t *unknown; /* in cells: number of the pressure, HK_LIQUID_NONE where there is none */
  uint8_t *known[3]; /* on faces: layer that the velocity is from, 1 for what is in the liquid or on the box; 0: none */
  uint8_t *fresh;    /* on faces: what becomes known */
} hk_liquid_grid;

/* Bytes of a grid with that many cells along the axes, with all that a liquid keeps beside it. */
double hk_liquid_bytes(const double cells[3]);
/* A grid over the box with cells of the size `cell`, m, or a little more or less, for whole numbers of them. high ==
 * low: no depth along that axis. HK_BAD_PARAM, with a message: the box has no room, or takes more than `most` bytes. */
hk_status hk_liquid_grid_open(hk_liquid_grid *, const hk_host *, const double low[3], const double high[3], double cell,
                              double most);
/* The same without the arrays, for whoever has their own in that layout. */
hk_status hk_liquid_grid_lay(hk_liquid_grid *, const hk_host *, const double low[3], const double high[3], double cell,
                             double most);
/* HK_BAD_PARAM, with a message: with `more` bytes for what else the liquid needs it is more than `most`. */
hk_status hk_liquid_grid_check(const hk_liquid_grid *, const hk_host *, const char *what, double more, double most);
void hk_liquid_grid_free(hk_liquid_grid *, const hk_host *);

/* m^3 */
static inline double hk_liquid_cell_volume(const hk_liquid_grid *g) {
  return g->spacing[0] * g->spacing[1] * g->spacing[2];
}

/* In a plane grid wherever it is across the plane. */
static inline bool hk_liquid_in_box(const hk_liquid_grid *g, const double x[3]) {
  for (int c = 0; c < 3; c++)
    if (!g->flat[c] && !(x[c] >= g->low[c] && x[c] <= g->high[c])) return false;
  return true;
}

/* Where a point is among faces and among centres: along each axis the number before it, and the part of the way to the
 * next. at_wall: nearer to a wall than the first centre. */
typedef struct hk_liquid_place {
  size_t face[3], centre[3];
  double face_part[3], centre_part[3];
  bool at_wall[3];
} hk_liquid_place;

static inline void hk_liquid_locate(const hk_liquid_grid *g, const double x[3], hk_liquid_place *p) {
  for (int c = 0; c < 3; c++) {
    double most = (double)g->cells[c], s = (x[c] - g->low[c]) / g->spacing[c] + 1;
    s = !(s > 1) ? 1 : s > most + 1 ? most + 1 : s;
    size_t i = (size_t)s;
    p->face[c] = i = i > g->cells[c] ? g->cells[c] : i;
    p->face_part[c] = s - (double)i;
    s -= 0.5;
    p->at_wall[c] = s < 1 || s > most;
    s = s < 1 ? 1 : s > most ? most : s;
    i = (size_t)s;
    p->centre[c] = i;
    p->centre_part[c] = s - (double)i;
  }
}

/* The first of the eight faces of component a about the place, or of the eight centres with a = 3; f: parts of the way
 * to the next along the axes. */
static inline size_t hk_liquid_corner(const hk_liquid_grid *g, const hk_liquid_place *p, int a, double f[3]) {
  size_t at = 0;
  for (int c = 0; c < 3; c++) {
    f[c] = c == a ? p->face_part[c] : p->centre_part[c];
    at += (c == a ? p->face[c] : p->centre[c]) * g->stride[c];
  }
  return at;
}

/* The value at the place of an array on the faces of component a, or at centres with a = 3. */
static inline double hk_liquid_value(const hk_liquid_grid *g, const double *array, const hk_liquid_place *p, int a) {
  double f[3];
  const double *v = array + hk_liquid_corner(g, p, a, f);
  const size_t *s = g->stride;
  double v00 = v[0] + f[0] * (v[s[0]] - v[0]), v10 = v[s[1]] + f[0] * (v[s[1] + s[0]] - v[s[1]]);
  double v01 = v[s[2]] + f[0] * (v[s[2] + s[0]] - v[s[2]]);
  double v11 = v[s[2] + s[1]] + f[0] * (v[s[2] + s[1] + s[0]] - v[s[2] + s[1]]);
  double v0 = v00 + f[1] * (v10 - v00), v1 = v01 + f[1] * (v11 - v01);
  return v0 + f[2] * (v1 - v0);
}

/* m: the centre of face i of component c. */
static inline void hk_liquid_face_place(const hk_liquid_grid *g, size_t i, int c, double x[3]) {
  for (int a = 0; a < 3; a++) {
    size_t at = i / g->stride[a] % (g->cells[a] + 2);
    x[a] = g->flat[a] ? g->low[a] : g->low[a] + g->spacing[a] * ((double)at - (a == c ? 1 : 0.5));
  }
}

/* Cells behind each other in memory. */
typedef struct hk_liquid_row {
  size_t cell[3]; /* numbers of its first cell */
  size_t first;   /* its place in arrays */
} hk_liquid_row;

/* The axis of rows, along which memory is continuous, and the middle one. */
static inline int hk_liquid_inner(const hk_liquid_grid *g) { return g->slab == 0 ? 1 : 0; }
static inline int hk_liquid_middle(const hk_liquid_grid *g) { return 3 - g->slab - hk_liquid_inner(g); }
/* Rows that have a number from 0 to count - 1: those of the cells inside, or with `beyond` one more on the upper side
 * of each axis, where faces are. */
static inline size_t hk_liquid_rows(const hk_liquid_grid *g, size_t beyond) {
  return (g->cells[g->slab] + beyond) * (g->cells[hk_liquid_middle(g)] + beyond);
}
static inline hk_liquid_row hk_liquid_row_at(const hk_liquid_grid *g, size_t k, size_t beyond) {
  int middle = hk_liquid_middle(g);
  size_t rows = g->cells[middle] + beyond;
  hk_liquid_row r = {{1, 1, 1}, 0};
  r.cell[g->slab] = 1 + k / rows;
  r.cell[middle] = 1 + k % rows;
  for (int c = 0; c < 3; c++) r.first += r.cell[c] * g->stride[c];
  return r;
}

/* Whether the face of component c at place i of the row is on the box. */
static inline bool hk_liquid_on_box(const hk_liquid_grid *g, const hk_liquid_row *r, size_t i, int c) {
  size_t at = r->cell[c] + (c == hk_liquid_inner(g) ? i - r->first : 0);
  return at == 1 || at == g->cells[c] + 1;
}

#endif
