/* Heat that flows along edges, in triangles and in tetrahedra, of one substance that may melt: the channel of the
 * enthalpy changes by
 *     m_i dh_i/dt = sum over j of g_ij (theta_j - theta_i),
 * with theta the integral of the conductivity over the temperature (plugins/common/heat/heat_law.h) and g_ij a length
 * by the shape of the elements at the start (heat_paths.h): what moves carries its heat and keeps its ways, as cloth,
 * bars and solids do. Edges and triangles that are gone as elements of other plugins, molten, torn or broken, conduct
 * no more from the next step on, by the rules of the scene's surface: a triangle without one of its sides does not, and
 * an edge that only held such triangles together. The sum of m h is kept to rounding by explicit methods, and to their
 * tolerance by implicit ones. It is no force: it adds nothing to F.
 *
 * Of order 2 in space where nothing melts, and of order 1 at melting fronts, whose place is the sum of what is molten.
 * Steps are at most 0.9 m_i/(sum |g_ij| dtheta/dh) of any particle: twice the inverse bounds all rates (Gershgorin), so
 * explicit methods are stable, and no explicit Euler step makes anything warmer than the warmest. */
#include "plugins/common/channels/no_force.h"
#include "plugins/common/elements/breakage.h"
#include "plugins/common/heat/heat_channel.h"
#include "plugins/common/heat/heat_law.h"
#include "plugins/common/heat/heat_paths.h"

#include <string.h>

static const double safe = 0.9; /* of the step that is stable */
static const double most_drift =
    1e-6; /* of the enthalpy, in a run that is ok: implicit methods leave their tolerance */

typedef struct conduction {
  hk_heat_channel heat;
  hk_heat_law law;
  hk_tuples edges, triangles, tetrahedra, held;
  hk_per_tuple section, thickness;
  double *edge_length, *triangle_length, *tetrahedron_length; /* m, per way */
  double *temperature, *molten;                               /* n, K and part */
  double *potential, *flow;                                   /* n, W/m and J/(kg s) */
  double *is_held;                                            /* n, 0 or 1 */
  hk_heat_paths paths;
  const hk_breakage *breakage;
  size_t known;   /* elements of the run that are gone, as `paths` has it */
  double densest; /* m/kg */
  double start;   /* J, what nothing from outside gave, when the run began or particles last came or went */
} conduction;

static const hk_param params[] = {
    {"edges", "", "bars between particles that heat flows along", .edges = HK_AT(conduction, edges),
     .flags = HK_OPTIONAL},
    {"section", "m^2", "of the bars", .per_tuple = HK_AT(conduction, section), .list = "edges",
     .limits = HK_AT_LEAST(0)},
    {"triangles", "", "of sheets that it flows in", .triangles = HK_AT(conduction, triangles), .flags = HK_OPTIONAL},
    {"thickness", "m", "of the sheets", .per_tuple = HK_AT(conduction, thickness), .list = "triangles",
     .limits = HK_AT_LEAST(0)},
    {"tetrahedra", "", "of solids that it flows in", .tetrahedra = HK_AT(conduction, tetrahedra), .flags = HK_OPTIONAL},
    {"held", "", "particles whose temperature stays as it is, whatever flows to them",
     .particles = HK_AT(conduction, held), .flags = HK_OPTIONAL},
    HK_HEAT_CAPACITIES(conduction, law),
    HK_HEAT_CONDUCTIVITIES(conduction, law),
    HK_HEAT_CHANNELS(conduction, heat),
    {0},
};

static const hk_field fields[] = {
    {"edge_length", .per_tuple = HK_AT(conduction, edge_length), .list = "edges", .width = 1},
    {"triangle_length", .per_tuple = HK_AT(conduction, triangle_length), .list = "triangles", .width = 3},
    {"tetrahedron_length", .per_tuple = HK_AT(conduction, tetrahedron_length), .list = "tetrahedra", .width = 6},
    {"temperature", .per_particle = HK_AT(conduction, temperature), .width = 1, .flags = HK_PUBLISHED},
    {"molten", .per_particle = HK_AT(conduction, molten), .width = 1, .flags = HK_PUBLISHED},
    {"potential", .per_particle = HK_AT(conduction, potential), .width = 1, .flags = HK_SCRATCH},
    {"flow", .per_particle = HK_AT(conduction, flow), .width = 1, .flags = HK_SCRATCH},
    {"start", .number = HK_AT(conduction, start)},
    {"is_held", .per_particle = HK_AT(conduction, is_held), .width = 1, .flags = HK_SCRATCH},
    {0},
};

/* ---- shapes ---- */

static hk_status shape(const hk_view *view, const hk_tuples *list, const hk_per_tuple *size, double *length) {
  hk_status status = HK_OK;
  for (size_t k = 0; k < list->count && status == HK_OK; k++)
    status = hk_heat_shape(view, list, k, size ? hk_tuple_value(size, k) : NAN, length + hk_heat_ways(list->arity) * k);
  return status;
}

static hk_status check_sizes(const hk_host *host, const hk_tuples *list, const hk_per_tuple *size, const char *name) {
  for (size_t k = 0; k < list->count; k++)
    if (!(hk_tuple_value(size, k) > 0))
      return host->fail(host, HK_BAD_PARAM, "%s: element %zu has none, and conducts by it: give it above 0", name,
                        k + 1);
  return HK_OK;
}

static hk_status check_lists(const conduction *s, const hk_host *host) {
  hk_status status = check_sizes(host, &s->edges, &s->section, "section");
  if (status == HK_OK) status = check_sizes(host, &s->triangles, &s->thickness, "thickness");
  if (!s->edges.count && !s->triangles.count && !s->tetrahedra.count)
    host->warn(host, "there is nothing that heat could flow in: give `edges`, `triangles` or `tetrahedra`");
  return status;
}

static hk_status check_masses(const conduction *s, const hk_view *view) {
  for (size_t i = 0; i < view->n; i++)
    if (s->paths.start[i] < s->paths.start[i + 1] && !(view->model->mass[i] > 0))
      return view->host->fail(view->host, HK_BAD_PARAM,
                              "particle %u has no mass of its own, and so no heat: heat flows between particles with "
                              "a mass",
                              view->model->id[i]);
  return HK_OK;
}

/* ---- rates ---- */

static void find_temperatures(conduction *s, const hk_view *view) {
  const double *h = hk_enthalpy(&s->heat, view);
  for (size_t i = 0; i < view->n; i++) {
    s->temperature[i] = hk_heat_temperature(&s->law, h[i]);
    s->molten[i] = hk_heat_molten(&s->law, h[i]);
    s->potential[i] = hk_heat_potential(&s->law, h[i]);
  }
}

/* What flows to a particle whose temperature is held goes on to the outside. */
static hk_status rates(void *self, const hk_view *view, double *dy) {
  conduction *s = self;
  double *to = dy + s->heat.enthalpy->offset * view->n;
  find_temperatures(s, view);
  memset(s->flow, 0, view->n * sizeof *s->flow);
  hk_heat_paths_add(&s->paths, view, s->potential, s->flow);
  for (size_t i = 0; i < view->n; i++) {
    to[i] += s->flow[i];
    if (s->is_held[i] > 0) hk_heat_give(&s->heat, view, i, -s->flow[i], dy);
  }
  return HK_OK;
}

/* The steepest phase counts, also where there is none of it yet. */
static double longest_step(void *self, const hk_view *view) {
  const conduction *s = self;
  (void)view;
  double rate = s->densest * hk_heat_steepest_potential(&s->law);
  return rate > 0 ? safe / rate : INFINITY;
}

/* ---- the balance ---- */

/* Of all particles of the channel, by what they hold: known where an account is kept. */
static size_t figures(void *self, const hk_view *view, hk_own_figure *figure) {
  const conduction *s = self;
  double size;
  if (!s->heat.given) return 0;
  double off = hk_heat_kept(&s->heat, view, &size) - s->start;
  figure[0] = (hk_own_figure){"enthalpy_drift", "", size > 0 ? off / size : 0, most_drift};
  return 1;
}

/* ---- the plugin ---- */

/* The ways of those elements that are there. */
static hk_status build(conduction *s, const hk_view *view) {
  const hk_host *host = view->host;
  s->known = hk_breakage_count(s->breakage);
  bool *gone = host->allocate(host, s->edges.count + s->triangles.count + 1);
  if (!gone) return host->fail(host, HK_NO_MEMORY, "no memory for the heat of %zu particles", view->n);
  bool *torn = gone + s->edges.count;
  hk_status status = hk_breakage_mark(s->breakage, host, &s->edges, gone);
  if (status == HK_OK) status = hk_breakage_mark(s->breakage, host, &s->triangles, torn);
  const hk_heat_elements list[] = {{&s->edges, s->edge_length, gone},
                                   {&s->triangles, s->triangle_length, torn},
                                   {&s->tetrahedra, s->tetrahedron_length, NULL}};
  if (status == HK_OK) status = hk_heat_paths_build(&s->paths, view, list, 3);
  host->release(host, gone);
  if (status == HK_OK) s->densest = hk_heat_paths_densest(&s->paths, view);
  return status;
}

/* At the start of every step: what other plugins have lost since. */
static hk_status update(void *self, const hk_view *from, const double *x_to, bool *pattern_changed) {
  conduction *s = self;
  (void)x_to, (void)pattern_changed;
  return hk_breakage_count(s->breakage) == s->known ? HK_OK : build(s, from);
}

static hk_status topology(void *self, const hk_view *view) {
  conduction *s = self;
  hk_status status = build(s, view);
  if (status == HK_OK) status = check_masses(s, view);
  if (status != HK_OK) return status;
  memset(s->is_held, 0, view->n * sizeof *s->is_held);
  for (size_t k = 0; k < s->held.count; k++) s->is_held[*hk_tuple(&s->held, k)] = 1;
  find_temperatures(s, view);
  if (s->heat.given) s->start = hk_heat_kept(&s->heat, view, &(double){0});
  return HK_OK;
}

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  conduction *s = self;
  hk_status status = check_lists(s, host);
  s->breakage = host->query(host, HK_BREAKAGE_INTERFACE);
  if (!s->breakage) return HK_FAILED;
  if (status == HK_OK) status = hk_heat_law_check(&s->law, host);
  if (status == HK_OK) status = hk_heat_channel_find(&s->heat, host, view->model);
  if (status == HK_OK) status = shape(view, &s->edges, &s->section, s->edge_length);
  if (status == HK_OK) status = shape(view, &s->triangles, &s->thickness, s->triangle_length);
  if (status == HK_OK) status = shape(view, &s->tetrahedra, NULL, s->tetrahedron_length);
  return status == HK_OK ? topology(self, view) : status;
}

static const hk_force force = {
    .size = sizeof(hk_force),
    .flags = HK_DEPENDS_ON_CHANNELS | HK_CONSERVES_MOMENTUM | HK_CONSERVES_ANGULAR_MOMENTUM | HK_SYMMETRIC_JACOBIAN,
    .add = hk_no_force,
    .energy = hk_no_energy,
    .rates = rates,
    .facets = HK_FACETS(HK_NO_BLOCKS, HK_BOUNDS_FACET(.longest_step = longest_step), HK_STEPS_FACET(.update = update),
                        HK_FIGURES_FACET(.list = figures)),
};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_FORCE,
    .name = "conduction",
    .summary =
        "heat along edges, in triangles and tetrahedra that may melt: m_i dh_i/dt = sum g_ij (theta_j - theta_i)",
    .reference = "Voller and Cross 1981, Accurate solutions of moving boundary problems using the enthalpy method; "
                 "Carslaw and Jaeger 1959, Conduction of heat in solids; Zienkiewicz and Taylor 2000",
    .instance_size = sizeof(conduction),
    .params = params,
    .fields = fields,
    .create = create,
    .topology = topology,
    .force = &force,
};
