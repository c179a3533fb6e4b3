/* Soft bodies: tetrahedra of a stable neo-Hookean material (plugins/common/solids/neo_hookean.c, with its formula),
 * each with one deformation gradient F, so that the energy is E = sum of volume W(F). At rest is the shape of the
 * start. It is Hooke's law of Young's modulus E and Poisson's ratio nu for small strains, and finite for any
 * deformation: what is turned inside out is pushed back. Damping is the viscosity of Kelvin's and Voigt's solid
 * (viscosity.c).
 *
 * Linear tetrahedra are too stiff where they bend and, for nu near 0.5, everywhere: bent bars want several of them
 * across, and nu above 0.45 fine meshes (scripts/validation/solids shows both converge). Explicit steps follow the
 * speed of sound, which rises with nu without bound. */
#include "plugins/common/solids/solid.h"

typedef struct neo_hookean {
  hk_solid body;
  hk_solid_params given;
} neo_hookean;

static const hk_param params[] = {
    {"tetrahedra", "", "quadruples of particles: three edges from the first one are right-handed",
     .tetrahedra = HK_AT(neo_hookean, given.tetrahedra), .flags = HK_REQUIRED},
    {"E", "Pa", "Young's modulus", .per_tuple = HK_AT(neo_hookean, given.E), .limits = HK_ABOVE(0),
     .flags = HK_REQUIRED},
    {"nu", "", "Poisson's ratio, below 0.5", .per_tuple = HK_AT(neo_hookean, given.nu), .initial = {0.3},
     .limits = HK_WITHIN(0, 0.5)},
    {"damping", "Pa s", "the same as E for the rate of strain: E times the time in which the material creeps",
     .per_tuple = HK_AT(neo_hookean, given.damping), .limits = HK_AT_LEAST(0)},
    {0},
};

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  neo_hookean *s = self;
  (void)host;
  return hk_solid_create(&s->body, view, &s->given);
}

static hk_status topology(void *self, const hk_view *view) {
  return hk_solid_topology(&((neo_hookean *)self)->body, view);
}

static void add_part(void *self, const hk_view *view, size_t part, double *F) {
  hk_solid_add(&((neo_hookean *)self)->body, view, part, F);
}

static hk_status add(void *self, const hk_view *view, double *F) {
  add_part(self, view, HK_ALL_PARTS, F);
  return HK_OK;
}

static void parts(void *self, const hk_view *view, const hk_part_use *use) {
  const hk_solid *s = &((neo_hookean *)self)->body;
  (void)view;
  hk_part_lists_touch(&s->sums.lists, &s->tuples.acting, use);
}

static double energy(void *self, const hk_view *view) { return hk_solid_energy(&((neo_hookean *)self)->body, view); }

static void elements(void *self, const hk_view *view, hk_elements *out) {
  (void)view;
  hk_solid_elements(&((neo_hookean *)self)->body, out);
}

static void pattern(void *self, const hk_view *view, hk_pattern *p) {
  (void)view;
  hk_solid_pattern(&((neo_hookean *)self)->body, p);
}

static hk_status jacobian(void *self, const hk_view *view, const hk_blocks *into) {
  hk_solid_jacobian(&((neo_hookean *)self)->body, view, into);
  return HK_OK;
}

enum { MODULUS = 1 }; /* row of the table, before nu and damping */

static hk_status transposed(void *self, const hk_view *view, const double *u, const hk_transposed *into) {
  const neo_hookean *s = self;
  hk_solid_transposed(&s->body, view, &s->given, u, into, into->parameter ? into->parameter + MODULUS : NULL);
  return HK_OK;
}

static hk_status along(void *self, const hk_view *view, const hk_tangent *directions, size_t count) {
  const neo_hookean *s = self;
  hk_solid_along(&s->body, view, &s->given, MODULUS, directions, count);
  return HK_OK;
}

static void stiffness_bound(void *self, const hk_view *view, hk_stiffness_part part, double (*block)[6]) {
  hk_solid_stiffness_bound(&((neo_hookean *)self)->body, view, part, block);
}

static const hk_force force = {
    .size = sizeof(hk_force),
    .flags = HK_DEPENDS_ON_X | HK_DEPENDS_ON_V | HK_CONSERVES_MOMENTUM | HK_CONSERVES_ANGULAR_MOMENTUM | HK_POWER |
             HK_OFFERS_SYMMETRIC | HK_OFFERS_DEFINITE,
    .add = add,
    .add_part = add_part,
    .energy = energy,
    .facets = HK_FACETS(HK_IMPLICIT_FACET(.pattern = pattern, .jacobian = jacobian, .transposed = transposed,
                                          .of_start = true, .along = along),
                        HK_BOUNDS_FACET(.stiffness_bound = stiffness_bound),
                        HK_ELEMENTS_FACET(.lists = HK_SOLID_LISTS, .list = elements), HK_PARTS_FACET(.touch = parts)),
};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_FORCE,
    .name = "neo_hookean",
    .summary = "soft bodies of tetrahedra, a stable neo-Hookean material: E = sum volume W(F)",
    .reference = "Smith, de Goes and Kim 2018, Stable neo-Hookean flesh simulation, (14) and (16), section 4.5",
    .instance_size = sizeof(neo_hookean),
    .params = params,
    .create = create,
    .topology = topology,
    .force = &force,
};
