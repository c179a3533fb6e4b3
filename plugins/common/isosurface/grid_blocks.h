/* The grid in blocks of 8 x 8 x 8 cells, with a layer of points around it that are outside. A point of this lattice has
 * numbers from 0 to points + 1 on each axis; those of the layer have the place and the value of the nearest point of
 * the grid. A block has 9 x 9 x 9 points, of which it shares the last on each axis with the next block. An edge of the
 * lattice belongs to the block that has the edge's lower end among its first 8 x 8 x 8. */
#ifndef HK_GRID_BLOCKS_H
#define HK_GRID_BLOCKS_H

#include "plugins/common/isosurface/cell_cases.h"
#include "plugins/common/isosurface/surface_parts.h"

enum { HK_SIDE = 8, HK_POINTS = HK_SIDE + 1, HK_BLOCK_CELLS = 512, HK_BLOCK_ROWS = 81, HK_BLOCK_POINTS = 729 };

static const uint32_t hk_no_slot = UINT32_MAX; /* the slot of a block without a surface */

typedef struct hk_surface_block { /* a block that the surface crosses */
  size_t number;                  /* (z blocks[1] + y) blocks[0] + x */
  size_t first_vertex, first_triangle;
  uint32_t vertices, triangles;
  bool not_finite; /* the field, at `place`, where a vertex was moved to */
  double place[3];
  uint16_t inside[HK_BLOCK_ROWS];  /* of each row along x, y before z: bit k of point k */
  uint16_t before[HK_BLOCK_CELLS]; /* vertices of the block on edges from points before this one */
  uint8_t crossed[HK_BLOCK_CELLS]; /* bit d - 1: the surface crosses the edge in direction d */
} hk_surface_block;

typedef struct hk_known_points { /* values of a function that is asked for near the surface only (surface_search.c) */
  uint32_t *slot;                /* of each block: its place in `value`, or hk_no_slot */
  bool *visited;                 /* of each block: all its points are known */
  size_t count, seeds;
  double (*value)[HK_BLOCK_CELLS]; /* count: of a block's first 8 x 8 x 8 points */
  uint64_t (*is_known)[HK_BLOCK_CELLS / 64];
  double *seed; /* of the coarse points */
} hk_known_points;

typedef struct hk_surface_work {
  const hk_host *host;
  const hk_isosurface_grid *grid;
  const hk_isosurface_field *field;
  const hk_isosurface_options *options;
  size_t blocks[3], bytes; /* allocated up to now */
  uint32_t *slot;          /* of each block: its place in `block`, or hk_no_slot */
  uint8_t *bits;           /* of arrays (inside_bits.c) */
  size_t count;
  hk_surface_block *block; /* count, numbers rise */
  double *kept;            /* count x HK_BLOCK_POINTS, of fields that are evaluated */
  hk_cell_case *cases;     /* 256 */
  hk_isosurface found;
  hk_known_points points;
  const hk_known_points *known; /* `points` once they are there, NULL: all blocks are evaluated */
} hk_surface_work;

/* Differences of two values do not overflow. */
static inline bool hk_value_allowed(double value) { return fabs(value) <= 1e300; }

static inline void hk_block_corner(const hk_surface_work *w, size_t number, size_t point[3]) {
  point[0] = number % w->blocks[0] * HK_SIDE;
  point[1] = number / w->blocks[0] % w->blocks[1] * HK_SIDE;
  point[2] = number / w->blocks[0] / w->blocks[1] * HK_SIDE;
}

static inline bool hk_in_layer(const hk_surface_work *w, int axis, size_t point) {
  return point == 0 || point > w->grid->points[axis];
}

/* The number on the grid of the nearest point there. */
static inline size_t hk_grid_point(const hk_surface_work *w, int axis, size_t point) {
  size_t last = w->grid->points[axis] - 1, i = point > 0 ? point - 1 : 0;
  return i < last ? i : last;
}

static inline double hk_point_place(const hk_surface_work *w, int axis, size_t point) {
  return w->grid->origin[axis] + (double)hk_grid_point(w, axis, point) * w->grid->spacing[axis];
}

static inline size_t hk_grid_index(const hk_surface_work *w, const size_t i[3]) {
  return (i[2] * w->grid->points[1] + i[1]) * w->grid->points[0] + i[0];
}

/* The eight corners of the cell at point x of row r = 9 z + y. */
static inline unsigned hk_cell_mask(const uint16_t *inside, unsigned r, unsigned x) {
  return (inside[r] >> x & 3U) | (inside[r + 1] >> x & 3U) << 2 | (inside[r + HK_POINTS] >> x & 3U) << 4 |
         (inside[r + HK_POINTS + 1] >> x & 3U) << 6;
}

/* For arrays: the bytes of `bits`; fills them, false: a value is not allowed, the first is at point `bad` of the grid;
 * what they say of a block. */
size_t hk_inside_bytes(const hk_surface_work *);
bool hk_inside_pack(hk_surface_work *, size_t bad[3]);
void hk_inside_read(const hk_surface_work *, size_t number, uint16_t inside[HK_BLOCK_ROWS]);
/* For functions: the values of a block and which are inside; false: one is not allowed, the first is value[*bad]. */
bool hk_block_evaluate(const hk_surface_work *, size_t number, double value[HK_BLOCK_POINTS],
                       uint16_t inside[HK_BLOCK_ROWS], size_t *bad);
/* Finds the blocks along the surface and their values, of which the first that is not allowed ends the search (to be
 * found by hk_block_evaluate). */
hk_status hk_surface_seek(hk_surface_work *);
/* A point of the lattice among the known values of its block. The layer around the grid has the nearest point of the
 * grid. */
size_t hk_known_place(const hk_surface_work *, const size_t point[3], size_t *block);
/* An array of `count` items, *array, counted in `bytes`; `what` is their name. */
hk_status hk_surface_allocate(hk_surface_work *, void *array, size_t count, size_t size, const char *what);
/* The sentence for a value, at a point of the grid, that is not allowed. */
hk_status hk_surface_refuse(const hk_surface_work *, const size_t point[3], double value);
/* Whether the bounds of the field, or a search, exclude a surface in the block. */
bool hk_block_excluded(const hk_surface_work *, size_t number);
/* The first inside point at the border of the grid; false: there is none in this block. */
bool hk_block_at_border(const hk_surface_work *, size_t number, const uint16_t *inside, size_t *point);
bool hk_block_mixed(const uint16_t *inside); /* has points inside and points outside */
/* Fills `crossed`, `before` and the numbers of vertices and triangles, from `inside`. */
void hk_block_count(const hk_surface_work *, hk_surface_block *);
/* Vertices of a block, with normals (block_vertices.c), and its triangles. */
void hk_block_vertices(const hk_surface_work *, size_t slot);
void hk_block_triangles(const hk_surface_work *, size_t slot);
/* Before that, for a field that is evaluated: HK_FAILED where blocks disagree on points that they share
 * (shared_faces.c). */
hk_status hk_blocks_agree(const hk_surface_work *);

#endif
