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
    {"model", "", "of the energy: conditions of stretch and shear, Green's strains, rubber",
     .choice = HK_AT(membrane, given.model), .choices = "baraff_witkin|stvk|neo_hookean"},
    {"stiffness", "N/m", "membrane stiffness along the warp: Young's modulus times thickness",
     .per_tuple = HK_AT(membrane, given.stiffness), .limits = HK_ABOVE(0), .flags = HK_REQUIRED, .list = "triangles"},
    {"weft", "N/m", "the same along the weft, across the warp; left out: as along the warp",
     .per_tuple = HK_AT(membrane, given.weft), .limits = HK_ABOVE(0), .flags = HK_OPTIONAL, .list = "triangles"},
    {"shear", "N/m", "stiffness against shear between them; left out: sqrt(stiffness weft)/(2 (1 + nu))",
     .per_tuple = HK_AT(membrane, given.shear), .limits = HK_AT_LEAST(0), .flags = HK_OPTIONAL, .list = "triangles"},
    {"nu", "", "Poisson's ratio: how much it narrows along the weft when pulled along the warp; baraff_witkin: 0",
     .number = HK_AT(membrane, given.nu), .limits = HK_WITHIN(0, 0.999)},
    {"damping", "s", "viscous stress is this times the elasticity at rest times the rate of strain",
     .number = HK_AT(membrane, given.damping), .limits = HK_AT_LEAST(0)},
    {"warp", "", "direction of the warp, laid onto each triangle; left out: x, or y on triangles across x",
     .vector = HK_AT(membrane, given.warp), .flags = HK_OPTIONAL},
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

static hk_status add(void *self, const hk_view *view, double *F) {
  hk_membrane_forces(self, view, HK_ALL_PARTS, F);
  return HK_OK;
}

static void add_part(void *self, const hk_view *view, size_t part, double *F) {
  hk_membrane_forces(self, view, part, F);
}

static void parts(void *self, const hk_view *view, const hk_part_use *use) {
  const hk_membrane *m = self;
  (void)view;
  hk_part_lists_touch(&m->sums.lists, &m->node, use);
}

static double energy(void *self, const hk_view *view) { return hk_membrane_sum_energy(self, view); }

static void elements(void *self, const hk_view *view, hk_elements *out) {
  (void)view;
  *out = ((const hk_membrane *)self)->elements;
}

static void pattern(void *self, const hk_view *view, hk_pattern *pattern) {
  (void)view;
  hk_membrane_pattern(self, pattern);
}

static hk_status jacobian(void *self, const hk_view *view, const hk_blocks *into) {
  hk_membrane_blocks(self, view, into);
  return HK_OK;
}

enum { STIFFNESS = 2, WARP = 7, REST = 9 }; /* rows of the table; from the first on five have derivatives */

static hk_status transposed(void *self, const hk_view *view, const double *u, const hk_transposed *into) {
  const membrane *m = self;
  hk_membrane_transposed(&m->sheet, view, &m->given, u, into, into->parameter ? into->parameter + STIFFNESS : NULL);
  return HK_OK;
}

static void stiffness_bound(void *self, const hk_view *view, hk_stiffness_part part, double (*block)[6]) {
  hk_membrane_bound(self, view, part, block);
}

static const hk_force force = {
    .size = sizeof(hk_force),
    .flags = HK_DEPENDS_ON_X | HK_DEPENDS_ON_V | HK_CONSERVES_MOMENTUM | HK_CONSERVES_ANGULAR_MOMENTUM | HK_POWER |
             HK_OFFERS_SYMMETRIC | HK_OFFERS_DEFINITE,
    .add = add,
    .add_part = add_part,
    .energy = energy,
    .facets = HK_FACETS(HK_IMPLICIT_FACET(.pattern = pattern, .jacobian = jacobian, .transposed = transposed,
                                          .not_by = 1 << WARP | 1 << REST, .of_start = true),
                        HK_BOUNDS_FACET(.stiffness_bound = stiffness_bound), HK_ELEMENTS_FACET(.list = elements),
                        HK_PARTS_FACET(.touch = parts)),
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
