/* Springs that soften as they warm, and break: the stiffness is that of a spring times
 *     s = 1 below `softens`, 0 from there on by `range`, linear between,
 * of the mean of a channel over both ends, a temperature or an enthalpy (Terzopoulos, Platt, Fleischer 1989, Heating
 * and melting deformable models, section 4: stiffness falls linearly, and a spring at its melting point is gone). What
 * has molten stays gone; what has only softened is stiff again when it cools. A spring whose strain is above `breaking`
 * after a step is gone, too.
 *
 * The force on j is -s k (l - L) n. s is that of the last accepted step: it is constant within a step, and
 * what the spring stored and no longer does is dissipated then. So the energy balance closes to the order of the
 * method, and the softening itself is of order 1. */
#include "plugins/common/channels/find_channel.h"
#include "plugins/common/channels/softening.h"
#include "plugins/common/elements/breakage.h"
#include "plugins/common/springs/edge_laws.h"
#include "plugins/kit/springs/edge.h"

enum { LOST, GONE, VARIABLES }; /* per edge: 1 - s; 0 or 1 */

typedef struct melting_springs {
  hk_edge_laws laws; /* with the edges */
  hk_per_tuple k, breaking, rest;
  const char *name;
  const hk_channel *channel;
  double softens, range;
  double *variable; /* edges x VARIABLES */
} melting_springs;

static const hk_param params[] = {
    {"edges", "", "pairs of particles to join", .edges = HK_AT(melting_springs, laws.edges), .flags = HK_REQUIRED},
    {"k", "N/m", "stiffness of the cold spring", .per_tuple = HK_AT(melting_springs, k), .limits = HK_ABOVE(0),
     .flags = HK_REQUIRED},
    {"breaking", "", "strain above which a spring breaks; left out: never",
     .per_tuple = HK_AT(melting_springs, breaking), .limits = HK_ABOVE(0), .flags = HK_OPTIONAL},
    {"rest", "m", "rest length; left out: the initial length", .per_tuple = HK_AT(melting_springs, rest),
     .limits = HK_ABOVE(0), .flags = HK_OPTIONAL},
    {"channel", "", "that the springs follow, a temperature or an enthalpy", .string = HK_AT(melting_springs, name),
     .flags = HK_REQUIRED},
    {"softens", "", "the channel's value up to which springs are as stiff as when cold",
     .number = HK_AT(melting_springs, softens), .flags = HK_REQUIRED},
    {"range", "", "by how much more a spring is gone", .number = HK_AT(melting_springs, range), .limits = HK_ABOVE(0),
     .flags = HK_REQUIRED},
    {0},
};

static const hk_field fields[] = {
    {"variable", .per_tuple = HK_AT(melting_springs, variable), .list = "edges", .width = VARIABLES},
    {0},
};

static double *variables(const melting_springs *s, size_t e) { return s->variable + VARIABLES * e; }
static bool gone(const void *self, size_t e) { return variables(self, e)[GONE] > 0; }
static double stiffest(const void *self, size_t e) { return hk_tuple_value(&((const melting_springs *)self)->k, e); }

static void law(const void *self, const hk_view *view, size_t e, double l, double rate, hk_edge_answer *a) {
  const melting_springs *s = self;
  double k = (1 - variables(s, e)[LOST]) * hk_tuple_value(&s->k, e), x = l - hk_tuple_value(&s->rest, e);
  (void)view, (void)rate;
  *a = (hk_edge_answer){.force = k * x, .energy = k * x * x / 2, .stiffness = k};
}

/* 1 - s of the present state. */
static double softened(const melting_springs *s, const hk_view *view, const uint32_t *pair) {
  const double *y = view->y + s->channel->offset * view->n;
  return hk_softened((y[pair[0]] + y[pair[1]]) / 2, s->softens, s->range);
}

static hk_status evolve(void *self, const hk_view *view, double h, hk_evolution *report) {
  const melting_springs *s = self;
  (void)h;
  for (size_t e = 0; e < s->laws.edges.count; e++) {
    const uint32_t *pair = hk_tuple(&s->laws.edges, e);
    double d[3], *q = variables(s, e);
    if (!hk_edge_acts(view, pair) || q[GONE] > 0) continue;
    double l = hk_edge_difference(view->x, pair, d), x = l - hk_tuple_value(&s->rest, e);
    double lost = hk_edge_breaks(&s->rest, &s->breaking, e, l) ? 1 : softened(s, view, pair);
    if (lost == q[LOST]) continue;
    report->dissipated += (lost - q[LOST]) * hk_tuple_value(&s->k, e) * x * x / 2;
    report->changed = true;
    q[LOST] = lost;
    if (lost < 1) continue;
    q[GONE] = 1;
    report->pattern_changed = true;
  }
  return HK_OK;
}

static void lost(const void *self, hk_lost_elements *out) {
  const melting_springs *s = self;
  *out = (hk_lost_elements){s->laws.edges, s->variable + GONE, VARIABLES};
}

/* ---- tables ---- */

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  melting_springs *s = self;
  hk_status status = hk_find_channel(host, view->model, s->name, "channel", 1, &s->channel);
  if (status == HK_OK) status = hk_edge_rest(host, view, &s->laws.edges, &s->rest);
  s->laws.law = law;
  s->laws.stiffest = stiffest;
  s->laws.gone = gone;
  for (size_t e = 0; e < s->laws.edges.count && status == HK_OK; e++) { /* as it starts, it is as warm as it is */
    double *q = variables(s, e);
    q[LOST] = softened(s, view, hk_tuple(&s->laws.edges, e));
    q[GONE] = q[LOST] >= 1;
  }
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
    .name = "melting_springs",
    .summary = "springs that soften with a channel, melt and break, f = s(T) k (l - L)",
    .reference = "Terzopoulos, Platt, Fleischer 1989, Heating and melting deformable models (from goop to glop)",
    .instance_size = sizeof(melting_springs),
    .params = params,
    .fields = fields,
    .create = create,
    .topology = hk_edge_laws_topology,
    .force = &force,
};
