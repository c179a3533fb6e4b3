/* Triangles that resist stretching and shear in their plane, by an energy per area of the sheet at rest, so that a
 * finer mesh of the same sheet has the same energy. Stiffnesses are those of the sheet: Young's modulus times
 * thickness, N/m, the force per width for a strain of 1. The energies, their sources and the viscous stress are in
 * plugins/common/membranes/membrane_model.h, their projected second derivatives in membrane_curvature.h. Resistance to
 * bending is another force, `hinges`.
 *
 * Invariant: forces are F S, of a symmetric stress S, so every triangle keeps momentum and angular momentum, and a
 * triangle without area has a finite force. */
#include "plugins/common/membranes/membrane.h"

typedef struct membrane {
  hk_membrane sheet; /* first member */
  hk_membrane_params given;
} membrane;

static const hk_param params[] = {
    {"triangles", "", "of the sheet; left out: those of the scene's grids and meshes",
     .triangles = HK_AT(membrane, given.triangles), .flags = HK_OPTIONAL | HK_NOT_EMPTY},
    HK_MEMBRANE_SHEET(membrane, given),
    {"uv", "m", "in its place the pattern: u, v of the three corners of each of `triangles`, u along the warp",
     .numbers = HK_AT(membrane, given.uv), .flags = HK_OPTIONAL},
    {"rest", "", "scale of the shape at rest, which is that of the start or of the pattern",
     .number = HK_AT(membrane, given.rest), .initial = {1}, .limits = HK_ABOVE(0)},
    {0},
};

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  membrane *m = self;
  (void)host;
  return hk_membrane_create(&m->sheet, view, &m->given);
}

static hk_status topology(void *self, const hk_view *view) { return hk_membrane_topology(self, view); }

static void elements(void *self, const hk_view *view, hk_elements *out) {
  (void)view;
  *out = ((const hk_membrane *)self)->elements;
}

enum { STIFFNESS = 2, WARP = 7, REST = 9 }; /* rows of the table; from the first on five have derivatives */

static hk_status transposed(void *self, const hk_view *view, const double *u, const hk_transposed *into) {
  const membrane *m = self;
  hk_membrane_transposed(&m->sheet, view, &m->given, u, into, into->parameter ? into->parameter + STIFFNESS : NULL);
  return HK_OK;
}

static hk_status along(void *self, const hk_view *view, const hk_tangent *directions, size_t count) {
  const membrane *m = self;
  hk_membrane_along(&m->sheet, view, &m->given, STIFFNESS, directions, count);
  return HK_OK;
}

static const hk_force force = {
    .size = sizeof(hk_force),
    .flags = HK_DEPENDS_ON_X | HK_DEPENDS_ON_V | HK_CONSERVES_MOMENTUM | HK_CONSERVES_ANGULAR_MOMENTUM | HK_POWER |
             HK_OFFERS_SYMMETRIC | HK_OFFERS_DEFINITE,
    .add = hk_membrane_add,
    .add_part = hk_membrane_add_part,
    .energy = hk_membrane_potential,
    .facets = HK_FACETS(HK_IMPLICIT_FACET(.pattern = hk_membrane_name_blocks, .jacobian = hk_membrane_add_blocks,
                                          .transposed = transposed, .not_by = 1 << WARP | 1 << REST, .of_start = true,
                                          .along = along),
                        HK_BOUNDS_FACET(.stiffness_bound = hk_membrane_add_bound), HK_ELEMENTS_FACET(.list = elements),
                        HK_PARTS_FACET(.touch = hk_membrane_touch)),
};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_FORCE,
    .name = "membrane",
    .summary = "triangles resist stretching and shear by an energy per area: Baraff-Witkin, StVK or neo-Hookean",
    .reference = "Baraff and Witkin 1998, Large steps in cloth simulation, section 4; Kim 2020, A finite element "
                 "formulation of Baraff-Witkin cloth; Smith, de Goes and Kim 2019, Analytic eigensystems for isotropic "
                 "distortion energies",
    .instance_size = sizeof(membrane),
    .params = params,
    .create = create,
    .topology = topology,
    .force = &force,
};
