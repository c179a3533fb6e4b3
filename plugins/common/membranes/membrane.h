/* Membranes: the triangles of the force `membrane`, with their shapes at rest. The energies are those of
 * membrane_model.h. */
#ifndef HK_MEMBRANE_H
#define HK_MEMBRANE_H

#include "core/plugin.h"
#include "plugins/common/elements/chunk_rounds.h"
#include "plugins/common/membranes/membrane_model.h"
#include "plugins/kit/parts/part_sums.h"

enum { HK_MEMBRANE_GRAIN = 1024 }; /* triangles of a chunk, some 20 us */

typedef struct hk_membrane_params {
  int model; /* hk_membrane_model */
  hk_tuples triangles;
  hk_per_tuple stiffness, weft, shear; /* N/m */
  double nu, damping, rest;            /* 1, s, 1 */
  double warp[3];                      /* NAN: not given */
  hk_numbers uv;
} hk_membrane_params;

/* Rows of parameters that sheets share. */
/* clang-format off */
#define HK_MEMBRANE_SHEET(type, given)                                                                                 \
  {"model", "", "of the energy: conditions of stretch and shear, Green's strains, rubber",                             \
     .choice = HK_AT(type, given.model), .choices = "baraff_witkin|stvk|neo_hookean"},                                 \
  {"stiffness", "N/m", "membrane stiffness along the warp: Young's modulus times thickness",                           \
     .per_tuple = HK_AT(type, given.stiffness), .limits = HK_ABOVE(0), .flags = HK_REQUIRED, .list = "triangles"},     \
  {"weft", "N/m", "the same along the weft, across the warp; left out: as along the warp",                             \
     .per_tuple = HK_AT(type, given.weft), .limits = HK_ABOVE(0), .flags = HK_OPTIONAL, .list = "triangles"},          \
  {"shear", "N/m", "stiffness against shear between them; left out: sqrt(stiffness weft)/(2 (1 + nu))",                \
     .per_tuple = HK_AT(type, given.shear), .limits = HK_AT_LEAST(0), .flags = HK_OPTIONAL, .list = "triangles"},      \
  {"nu", "", "Poisson's ratio: how much it narrows along the weft when pulled along the warp; baraff_witkin: 0",       \
     .number = HK_AT(type, given.nu), .limits = HK_WITHIN(0, 0.999)},                                                  \
  {"damping", "s", "viscous stress is this times the elasticity at rest times the rate of strain",                     \
     .number = HK_AT(type, given.damping), .limits = HK_AT_LEAST(0)},                                                  \
  {"warp", "", "direction of the warp, laid onto each triangle; left out: x, or y on triangles across x",              \
     .vector = HK_AT(type, given.warp), .flags = HK_OPTIONAL}
/* clang-format on */

/* With the sides e_1 = x_1 - x_0, e_2 = x_2 - x_0 of a triangle, f_u = B[0] e_1 + B[2] e_2, f_v = B[1] e_1 + B[3] e_2.
 */
typedef struct hk_membrane_triangle {
  double B[4]; /* 1/m, the inverse of the sides at rest */
  hk_elasticity times_area;
} hk_membrane_triangle;

/* Rows of numbers of the triangles that act, for loops over many. */
typedef enum hk_membrane_row {
  HK_B0,
  HK_B1,
  HK_B2,
  HK_B3,
  HK_C11,
  HK_C22,
  HK_C12,
  HK_C66,
  HK_MEMBRANE_ROWS
} hk_membrane_row;

/* To be zeroed before the first use. The memory belongs to the instance and is released with it. */
typedef struct hk_membrane {
  hk_membrane_model model;
  double damping;  /* s */
  double exponent; /* n, of neo_hookean */
  size_t count;    /* triangles at the start of the run */
  uint32_t (*id)[3];
  hk_membrane_triangle *triangle; /* of the start */
  uint32_t *listed, *number;      /* as the list has them: of the start, and of `node` */
  hk_tuples node;                 /* of the triangles whose corners all act */
  double *row[HK_MEMBRANE_ROWS];
  hk_part_sums sums;
  hk_chunk_rounds rounds;
  double *energy;       /* J, of the chunks */
  double *creep, one;   /* damping times c11; the strain 1, for the elements */
  hk_elements elements; /* values 0: none */
} hk_membrane;

/* Measures the shapes at rest from the view's positions, or from `uv`. HK_BAD_PARAM names what is no membrane. */
hk_status hk_membrane_create(hk_membrane *, const hk_view *view, const hk_membrane_params *given);
/* Keeps the triangles whose corners live and act. */
hk_status hk_membrane_topology(hk_membrane *, const hk_view *view);

static inline hk_elasticity hk_membrane_elasticity(const hk_membrane *m, size_t k) {
  return (hk_elasticity){m->row[HK_C11][k], m->row[HK_C22][k], m->row[HK_C12][k], m->row[HK_C66][k]};
}

/* [f_u f_v] of triangle k for the positions, or for velocities its rate. */
void hk_membrane_deformation(const hk_membrane *, size_t k, const double *x, double f[2][3]);
hk_metric hk_membrane_metric(const double f[2][3]);

/* membrane_kernel.c: F += the forces of one part or of HK_ALL_PARTS, and their power to view->power. */
void hk_membrane_forces(const hk_membrane *, const hk_view *view, size_t part, double *F);
double hk_membrane_sum_energy(const hk_membrane *, const hk_view *view); /* J */

/* membrane_conditions.c: the numbers C of triangles, and their gradients by the three corners, for hk_elements:
 * E = 1/2 c11 sum C^2, three numbers each. Not for neo_hookean. */
void hk_membrane_conditions(const void *self, const double *x, size_t begin, size_t end, double *C, double (*dC)[3]);

/* membrane_blocks.c: -dF/dx and -dF/dv, nine blocks a triangle. */
void hk_membrane_pattern(const hk_membrane *, hk_pattern *pattern);
void hk_membrane_blocks(const hk_membrane *, const hk_view *view, const hk_blocks *into);

/* membrane_transposed.c: as hk_implicit_facet.transposed; row: the derivatives by the parameters from `stiffness` to
 * `damping`, NULL: not wanted. */
void hk_membrane_transposed(const hk_membrane *, const hk_view *view, const hk_membrane_params *given, const double *u,
                            const hk_transposed *into, double *const row[5]);

/* As hk_implicit_facet.along; `row` is that of `stiffness`, from which the others follow. */
void hk_membrane_along(const hk_membrane *, const hk_view *view, const hk_membrane_params *given, size_t row,
                       const hk_tangent *directions, size_t count);

/* membrane_bound.c: as hk_force.stiffness_bound. */
void hk_membrane_bound(const hk_membrane *, const hk_view *view, hk_stiffness_part part, double (*block)[6]);

/* membrane_tables.c: functions of the tables of a force; `self` is its instance, whose first member is the membrane. */
hk_status hk_membrane_add(void *self, const hk_view *view, double *F);
void hk_membrane_add_part(void *self, const hk_view *view, size_t part, double *F);
void hk_membrane_touch(void *self, const hk_view *view, const hk_part_use *use);
double hk_membrane_potential(void *self, const hk_view *view);
void hk_membrane_name_blocks(void *self, const hk_view *view, hk_pattern *pattern);
hk_status hk_membrane_add_blocks(void *self, const hk_view *view, const hk_blocks *into);
void hk_membrane_add_bound(void *self, const hk_view *view, hk_stiffness_part part, double (*block)[6]);

#endif
