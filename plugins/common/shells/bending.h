/* What the forces that bend surfaces share: their parameters, the hinges with their numbers per hinge, and what of that
 * is left when particles die. Where it stands that a rigidity is B, N m, see bending.c. */
#ifndef HK_BENDING_H
#define HK_BENDING_H

#include "plugins/common/elements/chunk_rounds.h"
#include "plugins/common/elements/element_force.h"
#include "plugins/kit/parts/part_sums.h"
#include "plugins/common/shells/hinge.h"

enum { HK_BENDING_GRAIN = 1024 }; /* elements of a chunk, some 50 us */

typedef struct hk_bending_params {
  hk_tuples triangles, hinges; /* at most one of them is given */
  hk_per_tuple rigidity, damping, rest;
} hk_bending_params;

/* clang-format off */
/* The rows of a parameter table for the member `given` of `type`. */
#define HK_BENDING_PARAMS(type, given)                                                                                 \
  {"triangles", "", "of which neighbours are joined; left out: those of the scene's grids and meshes",                 \
     .triangles = HK_AT(type, given.triangles), .flags = HK_OPTIONAL | HK_NOT_EMPTY},                                  \
  {"hinges", "",                                                                                                       \
     "in their place, by hand: quadruples {a, b, c, d} of the edge a b and the corners c, d opposite to it",           \
     .tetrahedra = HK_AT(type, given.hinges), .flags = HK_OPTIONAL | HK_NOT_EMPTY},                                    \
  {"rigidity", "N m", "bending rigidity B of the surface, E h^3/(12 (1 - nu^2)) of a plate of thickness h",            \
     .per_tuple = HK_AT(type, given.rigidity), .limits = HK_AT_LEAST(0), .flags = HK_REQUIRED, .list = "hinges"}
/* clang-format on */

/* To be zeroed before the first use. The memory belongs to the instance and is released with it. */
typedef struct hk_bending {
  size_t count;                /* hinges at the start of the run */
  uint32_t (*id)[4];           /* of their members */
  bool *torn;                  /* it was one of the scene's triangles and is no more; NULL: these are not the scene's */
  size_t triangles;            /* of the scene, when that was last looked at */
  double *stiffness, *damping; /* J and J s per square of the angle */
  hk_hinge_shape *shape;       /* at rest: of the start */
  double *per_rigidity;        /* stiffness of a rigidity of 1 N m */
  uint32_t *number;            /* the element k is the hinge number[k] */
  hk_element_force element;    /* of the hinges all of whose members live */
  hk_part_sums sums;
  hk_chunk_rounds rounds;
  double (*weight)[4]; /* 1/m, of the members of all hinges of the start: C = sum weight x, a vector; NULL: C is
                          none of that kind */
} hk_bending;

/* Finds the hinges and computes their numbers from the shape at the view's positions. The caller has set
 * element.acting.values, .evaluate, .self, element.hessian, and
 * sets weight afterwards. HK_BAD_PARAM names a hinge that cannot bend. */
hk_status hk_bending_create(hk_bending *, const hk_view *view, const hk_bending_params *given);
/* Functions of the plugin and of hk_force. The instance `self` begins with its hk_bending. Elements are summed
 * part by part; `topology` drops the hinges of the dead, and of triangles that have left the scene's surface. */
hk_status hk_bending_topology(void *self, const hk_view *view);
hk_status hk_bending_add(void *self, const hk_view *view, double *F);
void hk_bending_add_part(void *self, const hk_view *view, size_t part, double *F);
void hk_bending_parts(void *self, const hk_view *view, const hk_part_use *use);
double hk_bending_energy(void *self, const hk_view *view);
void hk_bending_elements(void *self, const hk_view *view, hk_elements *out);
void hk_bending_pattern(void *self, const hk_view *view, hk_pattern *pattern);
hk_status hk_bending_jacobian(void *self, const hk_view *view, const hk_blocks *into);
/* As hk_implicit_facet.transposed, of a force with weights; the rows of `hinges` follow HK_BENDING_PARAMS. */
enum { HK_BENDING_RIGIDITY = 2, HK_BENDING_DAMPING, HK_BENDING_REST };
void hk_bending_transposed(const hk_bending *, const hk_view *view, const hk_bending_params *given, const double *u,
                           const hk_transposed *into);
/* As hk_implicit_facet.along, of such a force. */
void hk_bending_along(const hk_bending *, const hk_view *view, const hk_bending_params *given,
                      const hk_tangent *directions, size_t count);
void hk_bending_stiffness_bound(void *self, const hk_view *view, hk_stiffness_part part, double (*block)[6]);

#endif
