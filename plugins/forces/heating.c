/* Heat from outside: of each particle it acts on the enthalpy changes by
 *     m dh/dt = power + area (convection (T0 - T) + emissivity sigma (T0^4 - T^4)),
 * a source, Newton's law of cooling at a surface, and grey radiation to surroundings that are large (Incropera and
 * DeWitt 2002, Fundamentals of heat and mass transfer, sections 1.2.2 and 1.2.3), with T by the enthalpy
 * (plugins/common/heat/heat_law.h). With `reach` it is what a hot or cold thing gives to what touches it: to particles
 * no farther than that from the shape, which is an obstacle of the scene, a part of one, or a place, and may move.
 * It is no force: it adds nothing to F. */
#include "plugins/common/channels/no_force.h"
#include "plugins/common/heat/heat_channel.h"
#include "plugins/common/heat/heat_law.h"
#include "plugins/common/obstacles/obstacle_params.h"

static const double stefan = 5.670374419e-8; /* W/(m^2 K^4), CODATA 2018 */
static const double part = 0.1;              /* of the difference to the surroundings, that a step may take */

typedef struct heating {
  hk_heat_channel heat;
  hk_heat_law law;
  hk_tuples particles;
  hk_per_tuple area;
  double power, convection, emissivity, surroundings;
  double reach; /* m; NAN: it has no shape */
  hk_obstacle_params params;
  hk_obstacle obstacle;
  hk_surface surface;
} heating;

static const hk_param params[] = {
    {"particles", "", "that get heat; left out: all", .particles = HK_AT(heating, particles), .flags = HK_OPTIONAL},
    {"power", "W", "that a source gives to each particle", .number = HK_AT(heating, power), .flags = HK_TIMED},
    {"area", "m^2", "of the surface of a particle: one number, or one for each of `particles`",
     .per_tuple = HK_AT(heating, area), .list = "particles", .limits = HK_AT_LEAST(0)},
    {"convection", "W/(m^2 K)", "to the surroundings: still air 5 to 25, water 100 to 1000",
     .number = HK_AT(heating, convection), .limits = HK_AT_LEAST(0), .flags = HK_TIMED},
    {"emissivity", "", "of the surface; 0: it does not radiate", .number = HK_AT(heating, emissivity),
     .limits = HK_WITHIN(0, 1)},
    {"surroundings", "K", "their temperature", .number = HK_AT(heating, surroundings), .initial = {293.15},
     .limits = HK_AT_LEAST(0), .flags = HK_TIMED},
    {"reach", "m", "heat goes to particles alone that are no farther from the `shape`, or inside; left out: to all",
     .number = HK_AT(heating, reach), .limits = HK_AT_LEAST(0), .flags = HK_OPTIONAL},
    HK_OBSTACLE_SHAPE_ROWS(heating),
    HK_HEAT_CAPACITIES(heating, law),
    HK_HEAT_CHANNELS(heating, heat),
    {0},
};

static double fourth_power(double T) { return T * T * T * T; }

/* W/m^2, to a surface of the temperature T. */
static double flux(const heating *s, double T) {
  return s->convection * (s->surroundings - T) +
         s->emissivity * stefan * (fourth_power(s->surroundings) - fourth_power(fmax(0, T)));
}

static size_t count_of(const heating *s, const hk_view *view) {
  return s->particles.count ? s->particles.count : view->acting;
}

/* The index of the k-th particle; view->n: it does not act. */
static size_t particle(const heating *s, const hk_view *view, size_t k) {
  if (!s->particles.count) return view->active ? view->active[k] : k;
  size_t i = *hk_tuple(&s->particles, k);
  return view->is_active && !view->is_active[i] ? view->n : i;
}

static bool is_near(const heating *s, const hk_body_frame *frame, const hk_view *view, size_t i) {
  double n[3];
  return isnan(s->reach) || hk_obstacle_gap(&s->obstacle, frame, view->x + 3 * i, i, n) <= s->reach;
}

static hk_status rates(void *self, const hk_view *view, double *dy) {
  const heating *s = self;
  const double *h = hk_enthalpy(&s->heat, view);
  hk_body_frame frame = hk_obstacle_frame(&s->params, view->t);
  for (size_t k = 0; k < count_of(s, view); k++) {
    size_t i = particle(s, view, k);
    if (i == view->n || !(view->model->mass[i] > 0) || !is_near(s, &frame, view, i)) continue;
    double q = s->power + hk_tuple_value(&s->area, k) * flux(s, hk_heat_temperature(&s->law, h[i]));
    hk_heat_give(&s->heat, view, i, q / view->model->mass[i], dy);
  }
  return HK_OK;
}

/* Of all particles, as any may come near. By the hottest of both sides; so short that what conduction demands beside it
 * needs no more care. */
static double longest_step(void *self, const hk_view *view) {
  const heating *s = self;
  const double *h = hk_enthalpy(&s->heat, view);
  double rate = 0, capacity = hk_heat_least_capacity(&s->law);
  for (size_t k = 0; k < count_of(s, view); k++) {
    size_t i = particle(s, view, k);
    if (i == view->n || !(view->model->mass[i] > 0)) continue;
    double T = fmax(s->surroundings, hk_heat_temperature(&s->law, h[i]));
    double slope = s->convection + 4 * s->emissivity * stefan * T * T * T;
    rate = fmax(rate, hk_tuple_value(&s->area, k) * slope / (capacity * view->model->mass[i]));
  }
  return rate > 0 ? part / rate : INFINITY;
}

/* What touches the surroundings has a surface. */
static hk_status check_area(const heating *s, const hk_host *host) {
  double most = 0;
  if (s->area.count == 0)
    return host->fail(host, HK_BAD_PARAM, "area: the list is empty: give one number, or one for each of `particles`");
  for (size_t k = 0; k < s->area.count; k++) most = fmax(most, s->area.value[k]);
  if (!(most > 0) && (s->convection > 0 || s->emissivity > 0))
    host->warn(host, "area: it is 0, and so is what goes by it, convection and radiation: give the surface of a "
                     "particle, m^2");
  return HK_OK;
}

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  heating *s = self;
  hk_status status = hk_heat_law_check(&s->law, host);
  if (status == HK_OK && isnan(s->reach) && s->params.shape != HK_SHAPE_PLANE)
    return host->fail(host, HK_BAD_PARAM,
                      "reach: a shape heats what is near: give `reach`, the distance from it in metres");
  if (status == HK_OK && !isnan(s->reach)) status = hk_obstacle_open(&s->obstacle, &s->surface, &s->params, host, view);
  if (status == HK_OK) status = check_area(s, host);
  return status == HK_OK ? hk_heat_channel_find(&s->heat, host, view->model) : status;
}

static const hk_force force = {
    .size = sizeof(hk_force),
    .flags = HK_DEPENDS_ON_CHANNELS | HK_CONSERVES_MOMENTUM | HK_CONSERVES_ANGULAR_MOMENTUM | HK_SYMMETRIC_JACOBIAN,
    .add = hk_no_force,
    .energy = hk_no_energy,
    .rates = rates,
    .facets = HK_FACETS(HK_NO_BLOCKS, HK_BOUNDS_FACET(.longest_step = longest_step)),
};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_FORCE,
    .name = "heating",
    .summary =
        "heat from sources and surroundings: m dh/dt = power + area (convection (T0 - T) + e sigma (T0^4 - T^4))",
    .reference = "Incropera and DeWitt 2002, Fundamentals of heat and mass transfer, section 1.2",
    .instance_size = sizeof(heating),
    .params = params,
    .create = create,
    .force = &force,
};
