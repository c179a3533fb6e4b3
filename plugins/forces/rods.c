/* Rods that bend and twist: discrete elastic rods (Bergou, Wardetzky, Robinson, Audoly and Grinspun 2008; Bergou,
 * Audoly, Vouga, Wardetzky and Grinspun 2010), for hair, strings with stiffness, cables, springs wound of wire. Edges
 * in a list, each beginning where the one before ends, form a rod; one that ends where it began is a ring. Stretching
 * is left to other forces (springs) or constraints.
 *
 * At a joint, edges with the directions t0 and t1 have the curvature binormal kb = 2 t0 x t1/(1 + t0.t1), of size
 * 2 tan(turn/2), and l = (L0 + L1)/2 of the rod belongs to it. With k the components of kb on the axes of the cross
 * section there and m the twist between its edges,
 *     E = 1/2 sum (EI |k_1 - k0_1|^2 + EI2 |k_2 - k0_2|^2 + GJ (m - m0)^2)/l.
 * EI resists bending towards the first axis, about the second. EI and GJ are the material's, so that refinement changes
 * the energy at second order in l alone. Twist waves are much faster than bending and have no inertia here: the angles
 * of the sections are always those of least energy (quasi-static twist). An edge between two pinned particles is a
 * clamp, which holds its section as well; `turn` turns the last clamp of a rod, or the ends of a ring against each
 * other, by any number of turns.
 *
 * With `retardation` moments follow the rates of curvature and twist, too (common/rods/rod_damping.c).
 *
 * A free rod that is straight, but not at rest, can curl in any direction: it is infinitely stiff there against turning
 * that direction. Clamp an end, or start it curved.
 *
 * A joint that is folded to within 1.4e-3 rad has an infinite curvature: forces stay finite, and a step that ends there
 * ends the run with the particle's number. */
#include "plugins/common/rods/rods.h"

static const hk_param params[] = {
    {"edges", "", "the edges of rods, each from the end of the one before; a rod that ends where it began is a ring",
     .edges = HK_AT(hk_rods, edges), .flags = HK_REQUIRED},
    {"EI", "N m^2", "stiffness of bending; with EI2, of bending towards the first axis",
     .per_tuple = HK_AT(hk_rods, EI), .limits = HK_AT_LEAST(0), .flags = HK_REQUIRED},
    {"EI2", "N m^2", "stiffness of bending towards the second axis; left out: EI", .per_tuple = HK_AT(hk_rods, EI2),
     .limits = HK_AT_LEAST(0), .flags = HK_OPTIONAL},
    {"GJ", "N m^2", "stiffness in twist", .per_tuple = HK_AT(hk_rods, GJ), .limits = HK_AT_LEAST(0)},
    {"axis", "", "direction of the first axis on the first edge of each rod; left out: any",
     .vector = HK_AT(hk_rods, axis), .flags = HK_OPTIONAL},
    {"rest", "", "shape without energy, where curvature and torsion do not say it", .choice = HK_AT(hk_rods, rest),
     .choices = "initial|straight"},
    {"curvature", "1/m", "of the shape without energy, towards the first axis", .per_tuple = HK_AT(hk_rods, curvature),
     .flags = HK_OPTIONAL},
    {"torsion", "rad/m", "of the shape without energy", .per_tuple = HK_AT(hk_rods, torsion), .flags = HK_OPTIONAL},
    {"length", "m", "of an edge without strain; left out: the initial length", .per_tuple = HK_AT(hk_rods, length),
     .limits = HK_ABOVE(0), .flags = HK_OPTIONAL},
    {"turn", "rad", "angle by which the last clamp of a rod is turned about it, or a ring's ends against each other",
     .number = HK_AT(hk_rods, turn), .flags = HK_TIMED},
    {"retardation", "s",
     "damping as a time (Kelvin and Voigt): moments are EI (k + retardation dk/dt), and so in twist: "
     "a mode of frequency w is damped at the rate retardation w^2; above 0 there are no elements (xpbd, local_global)",
     .number = HK_AT(hk_rods, retardation), .limits = HK_AT_LEAST(0)},
    {"spins", "",
     "particles that are the angles of sections, one for each edge, which slide along x; left out: "
     "quasi-static twist",
     .particles = HK_AT(hk_rods, spins), .flags = HK_OPTIONAL},
    {"radius", "m",
     "x of a particle of spins over the angle of its section: its mass is the section's moment of inertia "
     "over the square of this",
     .number = HK_AT(hk_rods, radius), .initial = {1}, .limits = HK_ABOVE(0)},
    {"jacobian", "",
     "blocks for implicit methods: of joints only, without what the twist that follows softens, or exact, "
     "which joins all particles of a rod with sides or twist",
     .choice = HK_AT(hk_rods, jacobian), .choices = "banded|exact"},
    {0},
};

static const hk_field fields[] = {
    {"frames", .array = HK_AT(hk_rods, frames), .width = sizeof(hk_rod_frame), .flags = HK_COUNTED},
    {"turned", .number = HK_AT(hk_rods, turned)},
    {0},
};

static hk_status create(void *self, const hk_host *host, const hk_view *view) { return hk_rods_open(self, host, view); }

static hk_status topology(void *self, const hk_view *view) { return hk_rods_follow(self, view); }

static hk_status add(void *self, const hk_view *view, double *F) {
  hk_rods *r = self;
  hk_status status = hk_rods_evaluate(r, view, NULL);
  if (status != HK_OK) return status;
  double power = r->retardation > 0 ? hk_rod_damping_add(r, view) : 0;
  hk_rods_scatter(r, view->host, F);
  if (r->retardation > 0) hk_rod_damping_turn(r, F);
  if (view->power) *view->power += power;
  return HK_OK;
}

static double energy(void *self, const hk_view *view) {
  double E = NAN;
  return hk_rods_evaluate(self, view, &E) == HK_OK ? E : NAN;
}

static void elements(void *self, const hk_view *view, hk_elements *out) {
  const hk_rods *r = self;
  (void)view;
  hk_rod_elements_offer(&r->elements, r->batch, r->batches, out);
  if (r->retardation > 0) out->values = 0; /* the damping of a joint belongs to the whole rod */
}

static void pattern(void *self, const hk_view *view, hk_pattern *p) {
  (void)view;
  hk_rod_blocks_pattern(self, p);
}

static hk_status jacobian(void *self, const hk_view *view, const hk_blocks *into) {
  hk_status status = hk_rods_evaluate(self, view, NULL);
  if (status == HK_OK) hk_rod_blocks_add(self, view->host, into);
  return status;
}

static void stiffness_bound(void *self, const hk_view *view, hk_stiffness_part part, double (*block)[6]) {
  const hk_rods *r = self;
  if (part == HK_DAMPING_WHOLE && !(r->retardation > 0)) return;
  if (hk_rods_evaluate(self, view, NULL) == HK_OK)
    hk_rod_blocks_bound(self, view, part, block);
  else
    for (size_t k = 0; k < view->acting; k++) block[view->active ? view->active[k] : k][0] = INFINITY;
}

static hk_status accepted(void *self, const hk_view *view, double h) {
  (void)h;
  return hk_rods_accept(self, view);
}

static const hk_force force = {
    .size = sizeof(hk_force),
    .flags = HK_DEPENDS_ON_X | HK_DEPENDS_ON_V | HK_POWER | HK_CONSERVES_MOMENTUM | HK_CONSERVES_ANGULAR_MOMENTUM |
             HK_SYMMETRIC_JACOBIAN | HK_OFFERS_DEFINITE | HK_STIFFER_BLOCKS,
    .add = add,
    .energy = energy,
    .facets = HK_FACETS(HK_IMPLICIT_FACET(.pattern = pattern, .jacobian = jacobian),
                        HK_BOUNDS_FACET(.stiffness_bound = stiffness_bound), HK_ELEMENTS_FACET(.list = elements),
                        HK_STEPS_FACET(.accepted = accepted)),
};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_FORCE,
    .name = "rods",
    .summary = "rods that bend and twist, straight or curled at rest: E = 1/2 sum (EI |k - k0|^2 + GJ (m - m0)^2)/l",
    .reference =
        "Bergou, Wardetzky, Robinson, Audoly and Grinspun 2008, ACM Trans. Graph. 27 (3); Bergou and others 2010, "
        "ACM Trans. Graph. 29 (4)",
    .instance_size = sizeof(hk_rods),
    .params = params,
    .fields = fields,
    .create = create,
    .topology = topology,
    .force = &force,
};
