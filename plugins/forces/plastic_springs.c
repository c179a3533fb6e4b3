/* Springs that yield and break. Of the elongation l - L a part p is plastic; the force f = k (l - L - p) along the
 * spring never exceeds f_y + H a, where a is the sum of all plastic elongation so far, in either sense (linear
 * isotropic hardening). Return mapping: with the trial force f* = k (l - L - p_n) and the excess q = |f*| - f_y - H a_n
 * > 0, g = q / (k + H),   p = p_n + g sign f*,   a = a_n + g,   f = f* - k g sign f*,   df/dl = k H / (k + H) (Simo and
 * Hughes 1998, Computational Inelasticity, box 1.4). p_n and a_n are those of the last accepted step; the force within
 * a step foresees the flow, so it does not jump when the step is accepted, and it is the derivative of f^2 / 2k + f_y g
 * + H (a_n g + g^2 / 2), of which the first part is stored and the others are dissipated then. The method's own order
 * holds but for the kink at the yield point.
 *
 * A spring whose strain (l - L)/L is above `breaking` after a step is gone: what it stored is dissipated, and its force
 * ends within a step, so that the time of the break is known to a step. */
#include "plugins/common/elements/breakage.h"
#include "plugins/common/springs/edge_laws.h"
#include "plugins/kit/springs/edge.h"

enum { PLASTIC, HARDENED, BROKEN, VARIABLES }; /* per edge: m, m, 0 or 1 */

typedef struct plastic_springs {
  hk_edge_laws laws; /* with the edges */
  hk_per_tuple k, yield, hardening, breaking, rest;
  double *variable; /* edges x VARIABLES */
} plastic_springs;

static const hk_param params[] = {
    {"edges", "", "pairs of particles to join", .edges = HK_AT(plastic_springs, laws.edges), .flags = HK_REQUIRED},
    {"k", "N/m", "stiffness", .per_tuple = HK_AT(plastic_springs, k), .limits = HK_ABOVE(0), .flags = HK_REQUIRED},
    {"yield", "", "strain at which a spring first flows", .per_tuple = HK_AT(plastic_springs, yield),
     .limits = HK_ABOVE(0), .flags = HK_REQUIRED},
    {"hardening", "N/m", "rise of the yield force with plastic elongation",
     .per_tuple = HK_AT(plastic_springs, hardening), .limits = HK_AT_LEAST(0)},
    {"breaking", "", "strain above which a spring breaks; left out: never",
     .per_tuple = HK_AT(plastic_springs, breaking), .limits = HK_ABOVE(0), .flags = HK_OPTIONAL},
    {"rest", "m", "rest length; left out: the initial length", .per_tuple = HK_AT(plastic_springs, rest),
     .limits = HK_ABOVE(0), .flags = HK_OPTIONAL},
    {0},
};

static const hk_field fields[] = {
    {"variable", .per_tuple = HK_AT(plastic_springs, variable), .list = "edges", .width = VARIABLES},
    {0},
};

static double *variables(const plastic_springs *s, size_t e) { return s->variable + VARIABLES * e; }

static bool gone(const void *self, size_t e) { return variables(self, e)[BROKEN] > 0; }

static double stiffest(const void *self, size_t e) { return hk_tuple_value(&((const plastic_springs *)self)->k, e); }

/* ---- the law ---- */

typedef struct flow {
  double force, plastic; /* N; m, the change of p */
  double stored, lost;   /* J, after the flow and by it */
  double stiffness;      /* N/m */
} flow;

static flow return_map(const plastic_springs *s, size_t e, double l) {
  const double *q = variables(s, e), k = hk_tuple_value(&s->k, e), H = hk_tuple_value(&s->hardening, e);
  double L = hk_tuple_value(&s->rest, e), f = k * (l - L - q[PLASTIC]), sense = f < 0 ? -1 : 1;
  double limit = k * hk_tuple_value(&s->yield, e) * L + H * q[HARDENED], excess = fabs(f) - limit;
  flow r = {.force = f, .stiffness = k};
  if (excess > 0) {
    double g = excess / (k + H);
    r.force = f - k * g * sense;
    r.plastic = g * sense;
    r.lost = limit * g + H * g * g / 2;
    r.stiffness = k * H / (k + H);
  }
  r.stored = r.force * r.force / (2 * k);
  return r;
}

static void law(const void *self, const hk_view *view, size_t e, double l, double rate, hk_edge_answer *a) {
  const flow r = return_map(self, e, l);
  (void)view, (void)rate;
  *a = (hk_edge_answer){.force = r.force, .energy = r.stored + r.lost, .stiffness = r.stiffness};
}

static hk_status evolve(void *self, const hk_view *view, double h, hk_evolution *report) {
  const plastic_springs *s = self;
  (void)h;
  for (size_t e = 0; e < s->laws.edges.count; e++) {
    const uint32_t *pair = hk_tuple(&s->laws.edges, e);
    double d[3], *q = variables(s, e);
    if (!hk_edge_acts(view, pair) || q[BROKEN] > 0) continue;
    double l = hk_edge_difference(view->x, pair, d);
    const flow r = return_map(s, e, l);
    q[PLASTIC] += r.plastic;
    q[HARDENED] += fabs(r.plastic);
    report->dissipated += r.lost;
    if (!hk_edge_breaks(&s->rest, &s->breaking, e, l)) continue;
    q[BROKEN] = 1;
    report->dissipated += r.stored;
    report->changed = report->pattern_changed = true;
  }
  return HK_OK;
}

static void lost(const void *self, hk_lost_elements *out) {
  const plastic_springs *s = self;
  *out = (hk_lost_elements){s->laws.edges, s->variable + BROKEN, VARIABLES};
}

/* ---- tables ---- */

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  plastic_springs *s = self;
  hk_status status = hk_edge_rest(host, view, &s->laws.edges, &s->rest);
  for (size_t e = 0; e < s->rest.count && status == HK_OK; e++)
    if (!(s->rest.value[e] > 0))
      status = host->fail(host, HK_BAD_PARAM,
                          "rest: spring %zu has the length 0 at the start, of which a strain says nothing: give its "
                          "rest length or move its ends apart",
                          e + 1);
  s->laws.law = law;
  s->laws.stiffest = stiffest;
  s->laws.gone = gone;
  if (status == HK_OK) status = hk_breakage_enter(host, &(hk_breakable){lost, self});
  return status == HK_OK ? hk_edge_laws_topology(self, view) : status;
}

static const hk_force force = {
    .size = sizeof(hk_force),
    .flags = HK_DEPENDS_ON_X | HK_CONSERVES_MOMENTUM | HK_CONSERVES_ANGULAR_MOMENTUM | HK_SYMMETRIC_JACOBIAN |
             HK_OFFERS_DEFINITE,
    .add_part = hk_edge_laws_add_part,
    .energy = hk_edge_laws_energy,
    .facets = HK_FACETS(HK_IMPLICIT_FACET(.pattern = hk_edge_laws_pattern, .jacobian = hk_edge_laws_jacobian),
                        HK_BOUNDS_FACET(.stiffness_bound = hk_edge_laws_bound),
                        HK_PARTS_FACET(.touch = hk_edge_laws_touch), HK_INTERNAL_FACET(.evolve = evolve, .lost = lost)),
};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_FORCE,
    .name = "plastic_springs",
    .summary = "springs that yield, harden and break, f = k (l - L - p), |f| <= k yield L + hardening a",
    .reference = "Simo and Hughes 1998, Computational Inelasticity, box 1.4",
    .instance_size = sizeof(plastic_springs),
    .params = params,
    .fields = fields,
    .create = create,
    .topology = hk_edge_laws_topology,
    .force = &force,
};
