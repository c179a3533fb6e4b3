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

/* clang-format off */
static const hk_param params[] = {
    {"triangles", "", "of the sheet; left out: those of the scene's grids and meshes",
     HK_TRIANGLES, {0}, 0, 0, offsetof(membrane, given.triangles), HK_OPTIONAL, NULL},
    {"model", "", "of the energy: conditions of stretch and shear, Green's strains, rubber",
     HK_CHOICE, {0}, 0, 0, offsetof(membrane, given.model), 0, "baraff_witkin|stvk|neo_hookean"},
    {"stiffness", "N/m", "membrane stiffness along the warp: Young's modulus times thickness",
     HK_PER_TUPLE, {0}, 0, INFINITY, offsetof(membrane, given.stiffness), HK_REQUIRED | HK_ABOVE_MIN, "triangles"},
    {"weft", "N/m", "the same along the weft, across the warp; left out: as along the warp",
     HK_PER_TUPLE, {0}, 0, INFINITY, offsetof(membrane, given.weft), HK_OPTIONAL | HK_ABOVE_MIN, "triangles"},
    {"shear", "N/m", "stiffness against shear between them; left out: sqrt(stiffness weft)/(2 (1 + nu))",
     HK_PER_TUPLE, {0}, 0, INFINITY, offsetof(membrane, given.shear), HK_OPTIONAL, "triangles"},
    {"nu", "", "Poisson's ratio: how much it narrows along the weft when pulled along the warp; baraff_witkin: 0",
     HK_NUMBER, {0}, 0, 0.999, offsetof(membrane, given.nu), 0, NULL},
    {"damping", "s", "viscous stress is this times the elasticity at rest times the rate of strain",
     HK_NUMBER, {0}, 0, INFINITY, offsetof(membrane, given.damping), 0, NULL},
    {"warp", "", "direction of the warp, laid onto each triangle; left out: x, or y on triangles across x",
     HK_VECTOR, {0}, 0, 0, offsetof(membrane, given.warp), HK_OPTIONAL, NULL},
    {"uv", "m", "in its place the pattern: u, v of the three corners of each of `triangles`, u along the warp",
     HK_NUMBERS, {0}, 0, 0, offsetof(membrane, given.uv), HK_OPTIONAL, NULL},
    {"rest", "", "scale of the shape at rest, which is that of the start or of the pattern",
     HK_NUMBER, {1}, 0, INFINITY, offsetof(membrane, given.rest), HK_ABOVE_MIN, NULL},
    {0},
};
/* clang-format on */

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

static void stiffness_bound(void *self, const hk_view *view, hk_stiffness_part part, double (*block)[6]) {
  hk_membrane_bound(self, view, part, block);
}

static const hk_force force = {
    .size = sizeof(hk_force),
    .flags = HK_DEPENDS_ON_X | HK_DEPENDS_ON_V | HK_CONSERVES_MOMENTUM | HK_CONSERVES_ANGULAR_MOMENTUM | HK_POWER |
             HK_OFFERS_SYMMETRIC | HK_OFFERS_DEFINITE,
    .add = add,
    .energy = energy,
    .elements = elements,
    .pattern = pattern,
    .jacobian = jacobian,
    .stiffness_bound = stiffness_bound,
    .add_part = add_part,
    .parts = parts,
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
