/* "surfaces/1": the surfaces of a run that contact keeps apart. All of them are made of particles, so the state vector
 * holds everything that moves: triangles of cloth, of soft bodies and of obstacles (whose particles are pinned, on a
 * path where they move), edges of strands, and lone particles. Two kinds of pairs cover all ways in which they meet:
 * a particle and a triangle, and two edges. A lone particle is an edge of length 0, from the particle to itself, where
 * it meets a strand or another lone particle. Strands are the edges of the scene that have an end outside of every
 * triangle; lone particles are in no triangle and no edge of the scene.
 *
 * Each surface has a radius: the gap of a pair is the distance of its two members less the sum of their radii. Contact
 * keeps gaps above 0. Pairs that share a particle, and pairs of which no particle can move, are left out.
 *
 * A plugin joins in `create`; all that join must say the same. */
#ifndef HK_SURFACES_H
#define HK_SURFACES_H

#include "core/plugin.h"
#include "plugins/common/collision/distance.h"

#define HK_SURFACES_INTERFACE "surfaces/1"

typedef struct hk_surface_request {
  double thickness;       /* m, of surfaces of triangles whose particles can move: their radius is half of it */
  double body_thickness;  /* m, of surfaces of triangles that are pinned as a whole (obstacles) */
  double radius;          /* m, of strands and lone particles */
  const hk_tuples *leave; /* arity 1: particles that have no part in contact, and no triangle or edge that has one of
                             them; NULL or empty: all have. Particles inside of a solid, and roots of hair that stand on
                             a skin of triangles, belong here. */
} hk_surface_request;

/* HK_POINT_TRIANGLE: vertex[0] against the triangle of vertex[1], [2], [3]; HK_EDGE_EDGE: the edge of vertex[0], [1]
 * against that of vertex[2], [3]. */
enum { HK_MARK_TANGLED = 1, HK_MARK_PINCHED = 2 }; /* see `keep` */

typedef struct hk_surface_pair {
  uint32_t vertex[4]; /* particles */
  hk_pair_kind kind;
  double offset; /* m, sum of the two radii */
} hk_surface_pair;

/* Valid until the next call of `pairs`; its order depends on the positions alone, not on the number of threads. */
typedef struct hk_surface_pairs {
  size_t count;
  const hk_surface_pair *pair;
} hk_surface_pairs;

/* The surfaces as lists. Valid until births and deaths; `number` then changes. */
typedef struct hk_surface_mesh {
  uint64_t number;
  size_t points, edges, triangles;
  const uint32_t *point;     /* particles that are tested against triangles: all of a surface, strand, or alone */
  const uint32_t (*edge)[2]; /* edges of triangles once each, of strands, and lone particles (twice the same) */
  const uint32_t (*triangle)[3];
  const double *radius; /* n, m, of each particle; that of a feature is the largest of its particles */
  const uint32_t *part; /* n: the connected surface, strand or particle to which it belongs, from 0; UINT32_MAX: none */
  size_t parts;
  const uint32_t (*edge_faces)[2]; /* the triangles on the two sides of each edge; UINT32_MAX: none */
} hk_surface_mesh;

/* Patches: the surfaces in pieces of some tens of triangles or edges that hang together, and so move much alike. Every
 * point, edge and triangle belongs to one. They depend on the mesh alone. */
typedef struct hk_surface_patches {
  size_t count;
  size_t *start;    /* count + 1, in `member` */
  uint32_t *member; /* the particles of a patch's features, rising; some are in several patches */
} hk_surface_patches;

typedef struct hk_patch_pair {
  uint32_t a, b; /* a <= b; the same: pairs within a patch */
} hk_patch_pair;

typedef struct hk_near_pair {
  hk_surface_pair pair;
  double gap; /* m: that at the start of the move is not below it */
} hk_near_pair;

/* Valid until the next call of `between`. The pairs of a pair of patches come in an order that the mesh and the pins
 * say, so that two searches at different times have those that both find in the same order. */
typedef struct hk_near_pairs {
  const size_t *start; /* count + 1, in `near` */
  const hk_near_pair *near;
} hk_near_pairs;

/* Edges, of triangles and of strands, that have a point in common with a triangle, at given positions: decided exactly,
 * for all finite doubles. Those that share a particle, and those of which no particle can move, are left out. Two
 * strands that pass through each other leave no trace at one time, as lines have no inside: nothing is counted for
 * them, nor for lone particles. There the certificates of the methods for their moves hold. */
typedef struct hk_surface_intersections {
  size_t count;
  const uint32_t (*pair)[2]; /* edge and triangle of the mesh, rising */
} hk_surface_intersections;

typedef struct hk_surfaces {
  void *self;
  /* Called in `create`, before the others. HK_BAD_PARAM: another plugin asked for something else; the mesh has
   * triangles that are duplicate, degenerate, or more than two at an edge; features that are neighbours in the mesh are
   * nearer at the start than their thickness (surface_thickness.h says which; the message, the largest that fits). */
  hk_status (*join)(void *self, const hk_surface_request *, const hk_view *view);
  const hk_surface_mesh *(*mesh)(void *self);
  /* All pairs whose gap is less than `reach` (m, 0 or more) somewhere on the straight moves from x_from to x_to (n x 3;
   * may be the same), and some that are farther apart: those that none of a few axes separates by more than that. They
   * depend on the positions and pins alone, not on earlier calls. HK_NO_MEMORY; HK_NOT_FINITE, which names the
   * particle. Not inside a parallel_for, which it uses. It allocates when there are more pairs than ever before, by
   * half at least. */
  hk_status (*pairs)(void *self, const double *x_from, const double *x_to, double reach, hk_surface_pairs *out);
  /* Valid until the next call of it. Errors as before. */
  hk_status (*intersections)(void *self, const double *x, hk_surface_intersections *out);
  /* Fills `intersections` and `first` of the report. The count at the same positions is not repeated. */
  hk_status (*report)(void *self, const hk_view *view, struct hk_contact_report *out);
  /* What a plugin that frees surfaces keeps for itself: n numbers, the address of whose array is `mark`, sums of
   * HK_MARK_...; 0: nothing. */
  void (*keep)(void *self, double *const *mark);
  /* Whether contact is to leave a pair alone at present: of particles marked as tangled on both sides, which it would
   * hold where they should not be, or of pinched ones with what is pinned. May be called by several threads. */
  bool (*leaves)(void *self, const hk_surface_pair *);
  /* Valid until births and deaths. */
  const hk_surface_patches *(*patches)(void *self);
  /* As `pairs`, but only those of some pairs of patches. */
  hk_status (*between)(void *self, const double *x_from, const double *x_to, double reach, const hk_patch_pair *,
                       size_t count, hk_near_pairs *out);
} hk_surfaces;

#endif
