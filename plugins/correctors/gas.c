/* A gas in a box, smoke and flame: its velocity, temperature, smoke and fuel are on a grid (plugins/common/gas/gas.h
 * has the method), and are what this plugin saves in checkpoints. Particles of the scene are tracers that it carries;
 * those that are named as its sources, mostly pinned ones, make the gas about them hot, or smoky, or give it fuel. The
 * box's faces are walls, or open; obstacles of the scene are walls that cover parts of faces, at rest or moving.
 *
 * The method is of order 1 in time, of order 2 in space where the gas is smooth. What it is not: the gas does not
 * expand where it burns, and moves nothing but tracers; conduction and no-slip at obstacles are of order 1; confinement
 * adds momentum that is not there. Its work is not known, so the energy balance of such a run is not either. */
#include "plugins/common/gas/gas_balance.h"
#include "plugins/common/gas/gas_pace.h"
#include "plugins/common/gas/gas_start.h"
#include "plugins/common/mac_grid/carried.h"
#include "plugins/common/obstacles/obstacles_service.h"
#include "plugins/common/volume/volume.h"

#include <string.h>

enum { KEPT = HK_GAS_FIELDS + 3 + 1 /* arrays of the grid: the fields, the velocity before, pressure's impulse */ };

static const double most_drift = 0.1;    /* of heat, smoke or fuel, by carrying */
static const double most_swelled = 0.01; /* of a cell's volume, in all of a run that is ok */

typedef struct gas {
  double low[3], high[3], cell, memory, courant, tolerance;
  double gravity[3], wind[3], lid[3], floor, ceiling, expansion;
  int openings, sticks;
  hk_tuples particles, sources;
  double source_radius, source_time, source_temperature, source_smoke, source_fuel, ignition;
  hk_gas_start start;
  hk_array state;                     /* KEPT x size of the grid */
  double *temperature, *smoke, *fuel; /* n: of the gas at particles */
  double *flow;                       /* n x 3 */
  double reached, last;               /* s, the end of the last step, and its length, 0: there is none; */
  double earlier;                     /* s, the length of the one before */
  double left, passed;                /* the largest: part of a cell's volume that a step gained; cells passed in one */
  hk_gas_balance balance, balance_before; /* now; as the last step began */
  int64_t said;
  uint32_t *index;
  size_t count, obstacles; /* tracers; obstacles that were entered before */
  hk_gas method;
  hk_volume shown; /* for pictures */
  const hk_host *host;
} gas;

static const hk_param params[] = {
    {"low", "m", "lower corner of the box that the gas is in", .vector = HK_AT(gas, low), .flags = HK_REQUIRED},
    {"high", "m", "upper corner; along an axis where both are the same the gas is a plane one",
     .vector = HK_AT(gas, high), .flags = HK_REQUIRED},
    {"cell", "m", "size of a cell", .number = HK_AT(gas, cell), .limits = HK_ABOVE(0), .flags = HK_REQUIRED},
    {"open", "", "faces of the box through which gas goes in and out: none; top; sides and top; all",
     .choice = HK_AT(gas, openings), .choices = HK_GAS_OPENINGS},
    {"wind", "m/s", "of the ambient air: it blows in through open faces, and the gas has it at the start",
     .vector = HK_AT(gas, wind)},
    {"particles", "", "tracers that the gas carries; left out: all that move and are in no edge or triangle",
     .particles = HK_AT(gas, particles), .flags = HK_OPTIONAL | HK_NOT_EMPTY},
    {"ambient", "K", "temperature of the ambient air", .number = HK_AT(gas, start.ambient), .initial = {293},
     .limits = HK_ABOVE(0)},
    {"density", "kg/m^3", "of the ambient air, which smoke makes heavier", .number = HK_AT(gas, method.density),
     .initial = {1.2}, .limits = HK_ABOVE(0)},
    {"g", "m/s^2", "gravity, by which hot gas rises (Boussinesq)", .vector = HK_AT(gas, gravity),
     .initial = {0, 0, -9.81}},
    {"expansion", "1/K", "of the gas by heat; left out: 1/ambient, of an ideal gas", .number = HK_AT(gas, expansion),
     .limits = HK_AT_LEAST(0), .flags = HK_OPTIONAL},
    {"viscosity", "m^2/s", "kinematic; 1.5e-5 is air", .number = HK_AT(gas, method.viscosity),
     .limits = HK_AT_LEAST(0)},
    {"diffusivity", "m^2/s", "of heat; 2.1e-5 is air", .number = HK_AT(gas, method.diffusivity),
     .limits = HK_AT_LEAST(0)},
    {"sticks", "",
     "walls at which the gas has their velocity, if it is viscous: floors: the box's lower and upper face",
     .choice = HK_AT(gas, sticks), .choices = HK_GAS_STICKING},
    {"lid", "m/s", "velocity of the box's upper face, where it sticks", .vector = HK_AT(gas, lid)},
    {"floor", "K", "temperature of the box's lower face; left out: no heat passes", .number = HK_AT(gas, floor),
     .limits = HK_AT_LEAST(0), .flags = HK_OPTIONAL},
    {"ceiling", "K", "temperature of the upper face; left out: no heat passes", .number = HK_AT(gas, ceiling),
     .limits = HK_AT_LEAST(0), .flags = HK_OPTIONAL},
    {"confinement", "", "of vortices, which brings back whirls that the grid smears; it breaks the law of momentum",
     .number = HK_AT(gas, method.confinement), .limits = HK_WITHIN(0, 100)},
    {"cooling", "1/s", "rate at which heat is lost", .number = HK_AT(gas, method.cooling), .limits = HK_AT_LEAST(0)},
    {"radiation", "K/s", "heat lost at 1000 K above the ambient, by the fourth power",
     .number = HK_AT(gas, method.radiation), .limits = HK_AT_LEAST(0)},
    {"burn_rate", "1/s", "at which fuel burns", .number = HK_AT(gas, method.burn_rate), .limits = HK_AT_LEAST(0)},
    {"burn_heat", "K", "by which the gas gets hotter when all is fuel and burns",
     .number = HK_AT(gas, method.burn_heat), .initial = {2000}, .limits = HK_AT_LEAST(0)},
    {"soot", "kg/m^3", "smoke of the same", .number = HK_AT(gas, method.soot), .limits = HK_AT_LEAST(0)},
    {"ignition", "K", "fuel burns where it is hotter", .number = HK_AT(gas, ignition), .limits = HK_AT_LEAST(0)},
    {"sources", "", "particles about which the gas becomes what the next parameters say",
     .particles = HK_AT(gas, sources), .flags = HK_OPTIONAL},
    {"source_radius", "m", "of the ball about each; left out: two cells", .number = HK_AT(gas, source_radius),
     .limits = HK_ABOVE(0), .flags = HK_OPTIONAL},
    {"source_time", "s", "within which the gas in it becomes that", .number = HK_AT(gas, source_time),
     .initial = {0.02}, .limits = HK_ABOVE(0)},
    {"source_temperature", "K", "left out: ambient", .number = HK_AT(gas, source_temperature), .limits = HK_AT_LEAST(0),
     .flags = HK_OPTIONAL},
    {"source_smoke", "kg/m^3", "density of smoke", .number = HK_AT(gas, source_smoke), .limits = HK_AT_LEAST(0)},
    {"source_fuel", "", "part that is fuel", .number = HK_AT(gas, source_fuel), .limits = HK_WITHIN(0, 1)},
    {"start_velocity", "m/s", "of the gas at the start; id: of the cell", .function = HK_AT(gas, start.velocity),
     .signature = "function(t, x, y, z, id) -> u, v, w"},
    {"start_temperature", "K", "at the start", .function = HK_AT(gas, start.temperature),
     .signature = "function(t, x, y, z, id) -> T"},
    {"start_smoke", "kg/m^3", "at the start", .function = HK_AT(gas, start.smoke),
     .signature = "function(t, x, y, z, id) -> density"},
    {"start_fuel", "", "at the start", .function = HK_AT(gas, start.fuel),
     .signature = "function(t, x, y, z, id) -> part"},
    {"courant", "", "cells that the gas passes in a step, at most: longer steps are divided",
     .number = HK_AT(gas, courant), .initial = {2}, .limits = HK_ABOVE_TO(0, 20)},
    {"tolerance", "", "divergence that is left, by the largest before", .number = HK_AT(gas, tolerance),
     .initial = {1e-6}, .limits = HK_ABOVE_TO(0, 0.1)},
    {"memory", "GB", "that the grid may take", .number = HK_AT(gas, memory), .initial = {4}, .limits = HK_ABOVE(0)},
    {0},
};

static const hk_field fields[] = {
    {"state", .array = HK_AT(gas, state), .width = sizeof(double), .flags = HK_COUNTED},
    {"temperature", .per_particle = HK_AT(gas, temperature), .width = 1, .flags = HK_PUBLISHED},
    {"smoke", .per_particle = HK_AT(gas, smoke), .width = 1, .flags = HK_PUBLISHED},
    {"fuel", .per_particle = HK_AT(gas, fuel), .width = 1, .flags = HK_PUBLISHED},
    {"flow", .per_particle = HK_AT(gas, flow), .width = 3, .flags = HK_PUBLISHED},
    {"reached", .number = HK_AT(gas, reached)},
    {"last", .number = HK_AT(gas, last)},
    {"left", .number = HK_AT(gas, left)},
    {"passed", .number = HK_AT(gas, passed)},
    {"moved_heat", .number = HK_AT(gas, balance.moved[0])},
    {"moved_smoke", .number = HK_AT(gas, balance.moved[1])},
    {"moved_fuel", .number = HK_AT(gas, balance.moved[2])},
    {"whole_heat", .number = HK_AT(gas, balance.whole[0])},
    {"whole_smoke", .number = HK_AT(gas, balance.whole[1])},
    {"whole_fuel", .number = HK_AT(gas, balance.whole[2])},
    {"swelled", .number = HK_AT(gas, balance.swelled)},
    {"said", .integer = HK_AT(gas, said)},
    {0},
};

/* ---- the start ---- */

static hk_status choose_tracers(gas *s, const hk_view *view) {
  s->host->release(s->host, s->index);
  s->index = s->host->allocate(s->host, (view->n + 1) * sizeof *s->index);
  if (!s->index) return s->host->fail(s->host, HK_NO_MEMORY, "no memory for %zu particles", view->n);
  return hk_carried_find(s->host, view, &s->particles, &s->sources, s->index, &s->count);
}

static void choose_fields(gas *s) {
  hk_gas *m = &s->method;
  const hk_gas_start *start = &s->start;
  bool fuel = start->fuel || s->source_fuel > 0;
  for (int c = 0; c < 3; c++) m->carried[c] = !m->flow.grid.flat[c];
  m->carried[HK_GAS_FUEL] = fuel;
  m->carried[HK_GAS_SMOKE] = start->smoke || s->source_smoke > 0 || (fuel && m->soot > 0);
  m->carried[HK_GAS_HEAT] =
      start->temperature || !isnan(s->source_temperature) || !isnan(s->floor) || !isnan(s->ceiling) || fuel;
}

static void set_method(gas *s) {
  hk_gas *m = &s->method;
  memcpy(m->gravity, s->gravity, sizeof m->gravity);
  memcpy(m->wind, s->wind, sizeof m->wind);
  memcpy(m->lid, s->lid, sizeof m->lid);
  m->expansion = isnan(s->expansion) ? 1 / s->start.ambient : s->expansion;
  m->floor = s->floor - s->start.ambient;
  m->ceiling = s->ceiling - s->start.ambient;
  m->ignition = s->ignition - s->start.ambient;
  m->flow.tolerance = s->tolerance;
  m->flow.clings = true;
  m->sticks = (hk_gas_sticks)s->sticks;
  if (isnan(s->source_radius)) s->source_radius = 2 * s->cell;
  double *at = s->state.item;
  for (int f = 0; f < HK_GAS_FIELDS; f++, at += m->flow.grid.size) m->now[f] = at;
  for (int c = 0; c < 3; c++, at += m->flow.grid.size) m->before[c] = at;
  m->impulse = at;
}

static hk_status offer_volume(gas *s) {
  const hk_liquid_grid *g = &s->method.flow.grid;
  hk_volume *v = &s->shown;
  memcpy(v->low, g->low, sizeof v->low);
  memcpy(v->spacing, g->spacing, sizeof v->spacing);
  memcpy(v->cells, g->cells, sizeof v->cells);
  memcpy(v->stride, g->stride, sizeof v->stride);
  v->size = g->size;
  v->smoke = s->method.now[HK_GAS_SMOKE], v->heat = s->method.now[HK_GAS_HEAT];
  v->ambient = s->start.ambient;
  const hk_volumes *all = s->host->query(s->host, HK_VOLUMES_INTERFACE);
  return all ? all->show(all->self, v) : HK_FAILED;
}

/* What particles show of the gas. */
static void show(gas *s, const hk_view *view, const double *x) {
  const hk_gas *m = &s->method;
  for (size_t i = 0; i < view->n; i++) {
    const double *at = x + 3 * i;
    s->temperature[i] = s->start.ambient + hk_gas_value(m, m->now[HK_GAS_HEAT], HK_GAS_HEAT, at);
    s->smoke[i] = hk_gas_value(m, m->now[HK_GAS_SMOKE], HK_GAS_SMOKE, at);
    s->fuel[i] = hk_gas_value(m, m->now[HK_GAS_FUEL], HK_GAS_FUEL, at);
    hk_gas_flow(m, at, s->flow + 3 * i);
  }
}

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  gas *s = self;
  hk_gas *m = &s->method;
  s->host = host;
  m->host = m->flow.host = host;
  hk_status status = hk_gas_check_box(host, s->low, s->high, s->cell, 1e9 * s->memory);
  if (status == HK_OK) status = choose_tracers(s, view);
  if (status == HK_OK) status = hk_liquid_grid_open(&m->flow.grid, host, s->low, s->high, s->cell, 1e9 * s->memory);
  if (status == HK_OK) status = hk_liquid_open(&m->flow, host, 0);
  if (status == HK_OK) status = hk_gas_open_fields(m, host);
  if (status == HK_OK) status = host->resize(host, &s->state, KEPT * m->flow.grid.size);
  if (status != HK_OK) return status;
  const hk_obstacles *all = host->query(host, HK_OBSTACLES_INTERFACE);
  if (!all) return HK_FAILED;
  m->flow.obstacles = all->set;
  s->obstacles = all->set->count;
  s->reached = view->t;
  set_method(s);
  choose_fields(s);
  hk_gas_open_sides(m, (hk_gas_open)s->openings);
  hk_gas_warn_of_cells(m, s->sources.count ? s->source_radius : INFINITY);
  status = hk_gas_start_fields(m, &s->start, view->t);
  if (status == HK_OK) show(s, view, view->x);
  return status == HK_OK ? offer_volume(s) : status;
}

static void destroy(void *self, const hk_host *host) {
  gas *s = self;
  (void)host;
  hk_gas_close(&s->method);
}

static hk_status topology(void *self, const hk_view *view) { return choose_tracers(self, view); }

/* ---- a step ---- */

static hk_gas_source source_of(const gas *s) {
  return (hk_gas_source){s->source_radius,
                         s->source_time,
                         {[HK_GAS_HEAT] = isnan(s->source_temperature) ? 0 : s->source_temperature - s->start.ambient,
                          [HK_GAS_SMOKE] = s->source_smoke,
                          [HK_GAS_FUEL] = s->source_fuel}};
}

static void feed(gas *s, const hk_correction *c) {
  const hk_gas_source source = source_of(s);
  for (size_t k = 0; k < s->sources.count; k++)
    hk_gas_feed(&s->method, &source, c->x + 3 * (size_t)*hk_tuple(&s->sources, k), c->h);
}

/* From where they were before the step, whatever forces have made of them in it. */
static bool carry_tracer(gas *s, const hk_correction *c, size_t i) {
  double *x = c->x + 3 * i, *v = c->v + 3 * i, came[6];
  memcpy(came, x, 3 * sizeof *x);
  memcpy(came + 3, v, 3 * sizeof *v);
  memcpy(x, c->x_before + 3 * i, 3 * sizeof *x);
  hk_gas_move(&s->method, i, c->h, x);
  hk_gas_flow(&s->method, x, v);
  return memcmp(came, x, 3 * sizeof *x) || memcmp(came + 3, v, 3 * sizeof *v);
}

static void say(gas *s, const hk_view *view, double courant) {
  if (s->said || courant <= s->courant) return;
  s->said = 1;
  s->host->warn(s->host,
                "the gas passes %.3g cells in a step at t = %g s, and the step cannot be shorter: take a smaller --dt, "
                "or larger cells",
                courant, view->t);
}

static hk_status step(gas *s, const hk_correction *c) {
  hk_gas *m = &s->method;
  hk_gas_walls(m);
  hk_gas_prepare(m, c->h, s->earlier);
  hk_gas_balance_before(&s->balance, m);
  hk_gas_carry(m, c->h);
  hk_gas_balance_after(&s->balance, m);
  feed(s, c);
  hk_gas_burn(m, c->h);
  hk_gas_push(m, c->h);
  hk_status status = hk_gas_spread(m, c->h);
  return status == HK_OK ? hk_gas_project(m, c->h, s->earlier) : status;
}

static hk_status correct(void *self, const hk_view *view, hk_correction *c) {
  gas *s = self;
  hk_gas *m = &s->method;
  if (m->flow.obstacles->count > s->obstacles)
    return s->host->fail(
        s->host, HK_BAD_PARAM,
        "obstacles come after the gas in the scene, and would strike tracers that it has moved: put the "
        "corrector gas behind all obstacles");
  bool again = view->t - c->h < s->reached - 1e-9 * c->h; /* after one that was taken back */
  double courant = hk_gas_courant(m, again ? m->before : m->now, c->h);
  if (courant > s->courant && !c->last) {
    c->reject = true;
    return HK_OK;
  }
  if (!again) {
    hk_gas_begin(m, s->last);
    s->earlier = s->last;
    s->balance_before = s->balance;
  }
  s->balance = s->balance_before;
  s->reached = view->t;
  s->last = c->h;
  hk_status status = step(s, c);
  if (status != HK_OK) return status;
  for (size_t k = 0; k < s->count; k++) c->changed |= carry_tracer(s, c, s->index[k]);
  s->left = fmax(s->left, m->flow.left * c->h);
  s->balance.swelled += m->flow.left * c->h;
  s->passed = fmax(s->passed, courant);
  show(s, view, c->x);
  say(s, view, courant);
  return HK_OK;
}

static double longest_step(void *self, const hk_view *view, const double *a) {
  const gas *s = self;
  const hk_gas_source source = source_of(s);
  (void)view, (void)a;
  double lift = hk_gas_fastest_lift(&s->method, s->sources.count ? &source : NULL);
  return hk_gas_longest_step(&s->method, lift, s->courant);
}

static size_t figures(void *self, const hk_view *view, hk_own_figure *figure) {
  const gas *s = self;
  (void)view;
  figure[0] = (hk_own_figure){"divergence_left", "of a cell", s->left, INFINITY};
  figure[1] = (hk_own_figure){"courant", "cells", s->passed, INFINITY};
  figure[2] = (hk_own_figure){"carried_drift", "", hk_gas_drift(&s->balance, &s->method), most_drift};
  figure[3] = (hk_own_figure){"swelled", "of a cell", s->balance.swelled, most_swelled};
  return 4;
}

/* m: the tracer that is farthest in a wall. */
static double violation(void *self, const hk_view *view) {
  const gas *s = self;
  double most = 0;
  for (size_t k = 0; k < s->count; k++) {
    const double *x = view->x + 3 * (size_t)s->index[k];
    double kept[3] = {x[0], x[1], x[2]};
    hk_gas_keep(&s->method, s->index[k], kept);
    most = fmax(most, sqrt(pow(x[0] - kept[0], 2) + pow(x[1] - kept[1], 2) + pow(x[2] - kept[2], 2)));
  }
  return most;
}

static const hk_corrector corrector = {.size = sizeof(hk_corrector),
                                       .flags = HK_WANTS_BEFORE | HK_MAY_REJECT,
                                       .correct = correct,
                                       .violation = violation,
                                       .longest_step = longest_step,
                                       .figures = figures};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_CORRECTOR,
    .name = "gas",
    .summary = "smoke and flame in a box: a gas on a grid that carries particles, with buoyancy and fire: div u = 0",
    .reference =
        "Fedkiw, Stam, Jensen 2001, Visual simulation of smoke; Selle, Fedkiw, Kim, Liu, Rossignac 2008, An "
        "unconditionally stable MacCormack method; Bridson 2015, Fluid simulation for computer graphics, chapter 6",
    .instance_size = sizeof(gas),
    .params = params,
    .fields = fields,
    .create = create,
    .destroy = destroy,
    .topology = topology,
    .corrector = &corrector,
};
