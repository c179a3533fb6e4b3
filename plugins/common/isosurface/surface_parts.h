/* What a search for an implicit surface is given, and what it finds (isosurface.h). */
#ifndef HK_SURFACE_PARTS_H
#define HK_SURFACE_PARTS_H

#include "core/plugin.h"

typedef struct hk_isosurface_grid { /* point (i, j, k) lies at origin + (i, j, k) spacing */
  size_t points[3];                 /* from 2 to 1e9 along x, y, z */
  double origin[3], spacing[3];     /* m; finite, spacing > 0 */
} hk_isosurface_grid;

typedef struct hk_isosurface_field { /* `values` or `evaluate`; f is finite, at most 1e300 in size */
  const double *values;              /* points[2] x points[1] x points[0], x fastest: values[i + nx (j + ny k)] */
  /* f at `count` places within the box of the grid, from several threads at the same time; for the same place it has to
   * give the same bits. */
  void (*evaluate)(const void *self, const double (*x)[3], size_t count, double *value);
  /* Optional, beside `evaluate`: range[0] <= f <= range[1] in the whole box from low to high. Blocks that cannot hold
   * the surface are not evaluated then. Bounds that cut off a surface next to a block that was evaluated are refused.
   */
  void (*bounds)(const void *self, const double low[3], const double high[3], double range[2]);
  /* Optional, beside `evaluate`: f at 9 x 9 x 9 places (x[i], y[j], z[k]), value[(9 k + j) 9 + i], in its stead for the
   * points of the grid, where many at once cost less. */
  void (*lattice)(const void *self, const double x[9], const double y[9], const double z[9], double value[729]);
  const void *self;
} hk_isosurface_field;

typedef enum hk_isosurface_method {
  HK_MARCHING_TETRAHEDRA, /* one case for each way to cut a tetrahedron; about three times the triangles */
  HK_MARCHING_CUBES       /* on a face with two inside corners across, these are kept apart, in both of its cubes */
} hk_isosurface_method;

typedef struct hk_isosurface_options { /* zeroed ones are valid */
  double level;                        /* at most 1e300 in size */
  hk_isosurface_method method;
  /* Beyond the box all is outside: the surface is closed along the faces of the box, where triangles may have no area.
   * Without it a surface that leaves the box is an error. */
  bool close;
  /* With `evaluate`: steps of a bracketed Muller's method (Muller 1956), of one evaluation each and one more in all,
   * that move a vertex along its edge onto f = level; 0 leaves it where linear interpolation has it, off by the order
   * of spacing^2. */
  unsigned steps;
  /* Vertices keep this part of their edge away from both ends, 0 to 0.5: with 0 triangles may have no area where
   * values equal the level. */
  double margin;
  /* With `evaluate`, for a function that costs much, 1 or more: it is asked at every point `coarse` of the grid, along
   * each axis, and then in the blocks of 8 x 8 x 8 cells along the surface from what was found there, once a point. A
   * piece of the surface that passes between those points and touches nothing that was found is missed
   * (surface_search.c); `bounds` are not used. 0: all blocks are evaluated that the bounds leave. */
  unsigned coarse;
  bool may_be_empty;    /* no surface in the box is one without vertices, and no error */
  bool without_normals; /* the surface has none, and a function is not asked for them, six times a vertex */
  size_t most_bytes;    /* an error before more than this is allocated; 0: no limit */
} hk_isosurface_options;

typedef struct hk_isosurface { /* a zeroed one is empty */
  size_t vertices, triangles;
  double (*x)[3];      /* vertices x 3, m */
  double (*normal)[3]; /* of length 1, outwards: -grad f / |grad f|, by central differences; along the edge of the grid
                          where the gradient vanishes; that of the box where the surface is closed along it; NULL where
                          none are asked for */
  uint32_t (*triangle)[3];
} hk_isosurface;

typedef struct hk_filling { /* a zeroed one is empty */
  size_t vertices, tetrahedra;
  double (*x)[3];             /* vertices x 3, m */
  uint32_t (*tetrahedron)[4]; /* right-handed: the edges from the first corner have a positive determinant */
} hk_filling;

#endif
