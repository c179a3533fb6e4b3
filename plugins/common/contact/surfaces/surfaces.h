/* "surfaces/1": the surfaces of a run for contact. Their features are made of particles, so the state vector holds all
 * motion: triangles of cloth, of soft bodies and of obstacles (pinned particles, on paths if they move), edges of
 * strands, and isolated particles. Two kinds of pairs cover all contacts: particle and triangle, edge and edge. Against
 * strands and other isolated particles, an isolated particle is an edge of length 0, from the particle to itself.
 * Strands are the edges of the scene that have an end outside of every triangle; isolated particles are in no triangle
 * and no edge of the scene.
 *
 * Each surface has a radius: the gap of a pair is the distance of its two members less the sum of their radii. Contact
 * keeps gaps above 0. Pairs that share a particle and pairs without a free particle are left out.
 *
 * Plugins join in `create`, all with the same request. */
#ifndef HK_SURFACES_H
#define HK_SURFACES_H

#include "core/plugin.h"
#include "plugins/common/contact/geometry/feature_pair.h"

#define HK_SURFACES_INTERFACE "surfaces/1"

typedef struct hk_surface_request {
  double thickness;       /* m, of surfaces of triangles whose particles can move: their radius is half of it */
  double body_thickness;  /* m, of surfaces of triangles that are pinned as a whole (obstacles) */
  double radius;          /* m, of strands, bars and isolated particles */
  const hk_tuples *leave; /* arity 1: particles excluded from contact, with all their triangles and edges; NULL or
                             empty: none. For particles inside of a solid, and roots of hair on a skin of triangles. */
  const char *plugin; /* the name of the plugin that joins: another of that name with another friction is refused. It
                         outlives the run; NULL: any may join */
  double friction;    /* Coulomb's coefficient of that plugin */
} hk_surface_request;

enum { HK_MARK_TANGLED = 1, HK_MARK_PINCHED = 2 }; /* see `keep` */

/* Valid until the next call of `pairs`; the order depends on the positions, not on the number of threads. */
typedef struct hk_feature_pairs {
  size_t count;
  const hk_feature_pair *pair;
} hk_feature_pairs;

/* The surfaces as lists. Valid until births and deaths; `number` then changes. */
typedef struct hk_surface_mesh {
  uint64_t number;
  size_t points, edges, triangles;
  const uint32_t *point;     /* particles for pairs with triangles: all of surfaces and strands, and isolated ones */
  const uint32_t (*edge)[2]; /* edges of triangles once each, of strands, and isolated particles (twice the same) */
  const uint32_t (*triangle)[3];
  const double *radius; /* n, m, per particle; a feature's radius is the largest of its particles' */
  const uint32_t *part; /* n: the connected surface, strand or particle to which it belongs, from 0; UINT32_MAX: none */
  size_t parts;
  const uint32_t (*edge_faces)[2]; /* the triangles on the two sides of each edge; UINT32_MAX: none */
} hk_surface_mesh;

/* A partition of the surfaces into connected patches of some tens of triangles or edges, which move nearly alike. It
 * depends on the mesh only. */
typedef struct hk_surface_patches {
  size_t count;
  size_t *start;    /* count + 1, in `member` */
  uint32_t *member; /* the particles of a patch's features, ascending; a particle may be in several patches */
} hk_surface_patches;

typedef struct hk_patch_pair {
  uint32_t a, b; /* a <= b; a = b: pairs within a patch */
} hk_patch_pair;

/* Valid until the next call of `between`. Within a pair of patches the order follows from mesh and pins, so that pairs
 * common to two searches have the same order in both. */
typedef struct hk_patch_feature_pairs {
  const size_t *start; /* count + 1, in `pair` */
  const hk_feature_pair *pair;
} hk_patch_feature_pairs;

/* Intersections of edges (of triangles and strands) with triangles at given positions, by exact predicates for all
 * finite doubles. Pairs that share a particle or have no free particle are left out. Strands against strands and
 * isolated particles are not counted: lines have no inside, so a past crossing is not visible in the positions; for
 * them the methods' certificates of each move hold. */
typedef struct hk_surface_intersections {
  size_t count;
  const uint32_t (*pair)[2]; /* edge and triangle of the mesh, rising */
} hk_surface_intersections;

typedef struct hk_surfaces {
  void *self;
  /* Called in `create`, before the others. HK_BAD_PARAM: another plugin asked for something else; the mesh has
   * triangles that are duplicate, degenerate, or more than two at an edge; features that are neighbours in the mesh are
   * nearer at the start than their thickness (start_check.h says which; the message, the largest that fits). */
  hk_status (*join)(void *self, const hk_surface_request *, const hk_view *view);
  const hk_surface_mesh *(*mesh)(void *self);
  /* All pairs whose gap is less than `reach` (m, 0 or more) somewhere on the straight moves from x_from to x_to (n x 3;
   * may be the same), and some that are farther apart: those that none of a few axes separates by more than that. They
   * depend on the positions and pins alone, not on earlier calls. HK_NO_MEMORY; HK_NOT_FINITE, which names the
   * particle. Not inside a parallel_for, which it uses. It allocates when there are more pairs than ever before, by
   * half at least. */
  hk_status (*pairs)(void *self, const double *x_from, const double *x_to, double reach, hk_feature_pairs *out);
  /* Valid until the next call of it. Errors as before. */
  hk_status (*intersections)(void *self, const double *x, hk_surface_intersections *out);
  /* Fills `intersections` and `first` of the report. The count at the same positions is not repeated. */
  hk_status (*report)(void *self, const hk_view *view, struct hk_contact_report *out);
  /* What a plugin that frees surfaces keeps for itself: n numbers, the address of whose array is `mark`, sums of
   * HK_MARK_...; 0: nothing. */
  void (*keep)(void *self, double *const *mark);
  /* Whether contact is to leave a pair alone at present: of particles marked as tangled on both sides, which it would
   * hold where they should not be, or of pinched ones with what is pinned. May be called by several threads. */
  bool (*leaves)(void *self, const hk_feature_pair *);
  /* Valid until births and deaths. */
  const hk_surface_patches *(*patches)(void *self);
  /* As `pairs`, but only those of some pairs of patches. */
  hk_status (*between)(void *self, const double *x_from, const double *x_to, double reach, const hk_patch_pair *,
                       size_t count, hk_patch_feature_pairs *out);
} hk_surfaces;

#endif
