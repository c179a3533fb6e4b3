/* Tetrahedra of a neo-Hookean material with viscosity: what the force `neo_hookean` is made of. */
#ifndef HK_SOLID_H
#define HK_SOLID_H

#include "core/plugin.h"
#include "plugins/common/elements/living_tuples.h"
#include "plugins/kit/parts/part_sums.h"
#include "plugins/common/solids/neo_hookean.h"
#include "plugins/common/solids/tetrahedron.h"
#include "plugins/common/solids/viscosity.h"

typedef struct hk_solid_params {
  hk_tuples tetrahedra;
  hk_per_tuple E, nu, damping; /* Pa, 1, Pa s */
} hk_solid_params;

/* A tetrahedron of the start. */
typedef struct hk_solid_part {
  hk_tetrahedron shape;
  hk_neo_hookean elastic;
  hk_viscosity viscous;
} hk_solid_part;

enum { HK_SOLID_LISTS = 3, HK_SOLID_GRAIN = 512 }; /* lists of elements; tetrahedra of a chunk, some 50 us */

/* To be zeroed before the first use. The memory belongs to the instance and is released with it. */
typedef struct hk_solid {
  hk_living_tuples tuples;
  hk_part_sums sums;
  hk_solid_part *part; /* of all tetrahedra of the start */
  bool damped;
  double *weight[HK_SOLID_LISTS]; /* of the acting ones: J, J s, J s per square of the lists' numbers */
  double *sum;                    /* per chunk: energy */
  double (*matrix)[2][144];       /* K and D of the tetrahedra of a chunk */
} hk_solid;

/* The part of the acting tetrahedron k. */
static inline const hk_solid_part *hk_solid_part_of(const hk_solid *s, size_t k) {
  return &s->part[s->tuples.number[k]];
}

/* HK_BAD_PARAM names a tetrahedron that has no volume or is inside out. */
hk_status hk_solid_create(hk_solid *, const hk_view *view, const hk_solid_params *given);
hk_status hk_solid_topology(hk_solid *, const hk_view *view);
void hk_solid_add(const hk_solid *, const hk_view *view, size_t part, double *F); /* one, or HK_ALL_PARTS */
double hk_solid_energy(hk_solid *, const hk_view *view);
/* The elastic energy as ten numbers C a tetrahedron, and the viscosity as rates of six and of one. */
void hk_solid_elements(const hk_solid *, hk_elements out[HK_SOLID_LISTS]);
void hk_solid_pattern(const hk_solid *, hk_pattern *pattern);
void hk_solid_jacobian(hk_solid *, const hk_view *view, const hk_blocks *into);
/* As hk_implicit_facet.transposed; row: the derivatives by E, nu and damping of every tetrahedron, NULL: not wanted. */
void hk_solid_transposed(const hk_solid *, const hk_view *view, const hk_solid_params *given, const double *u,
                         const hk_transposed *into, double *const row[3]);
/* How mu and lambda of the elastic and of the viscous stress, Pa and Pa s, change with E or the damping and nu. */
typedef struct hk_solid_moduli {
  double mu, lambda;
} hk_solid_moduli;
hk_solid_moduli hk_solid_moduli_along(double E, double nu, double by_E, double by_nu);
hk_solid_moduli hk_solid_creep_along(double damping, double nu, double by_damping, double by_nu);
/* solid_along.c: as hk_implicit_facet.along; `row` is that of E, which nu and damping follow. */
void hk_solid_along(const hk_solid *, const hk_view *view, const hk_solid_params *given, size_t row,
                    const hk_tangent *directions, size_t count);
void hk_solid_stiffness_bound(const hk_solid *, const hk_view *view, hk_stiffness_part part, double (*block)[6]);

#endif
