/* Heat between the particles of a liquid, a melt or a heap in a box, of one substance that may melt, implicitly through
 * the cells of a grid (plugins/common/heat/grid_heat.h), so that no conductivity makes steps short: the channel of the
 * enthalpy changes by m dh/dt = div(grad theta), theta the integral of the conductivity over the temperature. The
 * particles carry their enthalpy; those of the corrector liquid do so at the velocity of its grid. Faces of the box
 * have a temperature, or give heat, or let none pass; the liquid's surface lets none pass, which is for the force
 * heating.
 *
 * Of a step the heat is found at its start, from where the particles are then, for as long as the step before was, and
 * then flows at a constant rate: steps are at most twice as long as the one before, and the first one's heat flows in
 * the second. That is of order 1 in time, and of order 2 in space where nothing melts; fronts, whose place is the sum
 * of what is molten, are of order 1. Obstacles thinner than a cell do not keep heat from passing. It is no force: it
 * adds nothing to F. */
#include "plugins/common/channels/no_force.h"
#include "plugins/common/heat/grid_heat.h"
#include "plugins/common/heat/heat_channel.h"
#include "plugins/common/mac_grid/carried.h"

#include <string.h>

static const double a_rest =
    1e-6; /* of a step: a shorter one is what rounding leaves to a frame, and limits no others */
static const double most_growth = 2;   /* of a step: rates that hold for twice their time are stable still */
static const double most_drift = 1e-9; /* of the enthalpy, in a run that is ok: it is kept to rounding */

typedef struct grid_conduction {
  hk_heat_channel heat;
  hk_grid_heat method;
  double low[3], high[3], cell, memory;
  hk_numbers temperatures, fluxes; /* of the six faces */
  hk_tuples particles;
  uint32_t *index;
  size_t count;
  double *temperature, *molten; /* n, K and part */
  double *rate, *given;         /* n, J/(kg s), of this step */
  double *over;                 /* n, J/kg, of hk_grid_heat_step */
  double last, behind;          /* s: the step before; by how much time heat is behind the rest */
  double found;                 /* s, for when `rate` was found; NAN: it was not */
  double start; /* J, what nothing from outside gave, when the run began or particles last came or went */
  double most_iterations;
  const hk_host *host;
} grid_conduction;

static const hk_param params[] = {
    {"low", "m", "lower corner of the box, as that of the liquid", .vector = HK_AT(grid_conduction, low),
     .flags = HK_REQUIRED},
    {"high", "m", "upper corner; along an axis where both are the same heat flows in a plane",
     .vector = HK_AT(grid_conduction, high), .flags = HK_REQUIRED},
    {"cell", "m", "size of a cell, which should have four particles in a plane and eight in space",
     .number = HK_AT(grid_conduction, cell), .limits = HK_ABOVE(0), .flags = HK_REQUIRED},
    {"density", "kg/m^3", "of the substance; what a cell has less of it conducts less",
     .number = HK_AT(grid_conduction, method.density), .initial = {1000}, .limits = HK_ABOVE(0)},
    {"particles", "", "that heat flows between; left out: all that move and are in no edge or triangle of the scene",
     .particles = HK_AT(grid_conduction, particles), .flags = HK_OPTIONAL | HK_NOT_EMPTY},
    {"temperatures", "K", "of the box's faces: low x, high x, low y, high y, low z, high z; 0: no heat passes",
     .numbers = HK_AT(grid_conduction, temperatures), .limits = HK_AT_LEAST(0), .flags = HK_OPTIONAL},
    {"fluxes", "W/m^2", "that come through these faces", .numbers = HK_AT(grid_conduction, fluxes),
     .flags = HK_OPTIONAL},
    {"tolerance", "", "of what a cell's balance is off by, by the largest at the start of the step",
     .number = HK_AT(grid_conduction, method.tolerance), .initial = {1e-9}, .limits = HK_ABOVE_TO(0, 0.1)},
    {"memory", "GB", "that the grid may take", .number = HK_AT(grid_conduction, memory), .initial = {4},
     .limits = HK_ABOVE(0)},
    HK_HEAT_CHANNELS(grid_conduction, heat),
    HK_HEAT_CAPACITIES(grid_conduction, method.law),
    HK_HEAT_CONDUCTIVITIES(grid_conduction, method.law),
    {0},
};

static const hk_field fields[] = {
    {"temperature", .per_particle = HK_AT(grid_conduction, temperature), .width = 1, .flags = HK_PUBLISHED},
    {"molten", .per_particle = HK_AT(grid_conduction, molten), .width = 1, .flags = HK_PUBLISHED},
    {"rate", .per_particle = HK_AT(grid_conduction, rate), .width = 1},
    {"given", .per_particle = HK_AT(grid_conduction, given), .width = 1},
    {"over", .per_particle = HK_AT(grid_conduction, over), .width = 1},
    {"last", .number = HK_AT(grid_conduction, last)},
    {"behind", .number = HK_AT(grid_conduction, behind)},
    {"start", .number = HK_AT(grid_conduction, start)},
    {"most_iterations", .number = HK_AT(grid_conduction, most_iterations)},
    {0},
};

/* ---- faces ---- */

static const char *const face_name[] = {"low x", "high x", "low y", "high y", "low z", "high z"};

static hk_status check_count(const hk_host *host, const hk_numbers *list, const char *name, const char *none) {
  if (list->count == 0 || list->count == 6) return HK_OK;
  return host->fail(
      host, HK_BAD_PARAM,
      "%s: there are %zu, and a box has six faces: give low x, high x, low y, high y, low z, high z, with "
      "0 where %s",
      name, list->count, none);
}

static hk_status set_faces(grid_conduction *s) {
  const hk_host *host = s->host;
  hk_status status = check_count(host, &s->temperatures, "temperatures", "no heat passes");
  if (status == HK_OK) status = check_count(host, &s->fluxes, "fluxes", "none is given");
  for (size_t k = 0; k < 6 && status == HK_OK; k++) {
    hk_heat_face *face = &s->method.face[k];
    if (s->temperatures.count) face->temperature = s->temperatures.value[k];
    if (s->fluxes.count) face->flux = s->fluxes.value[k];
    if (face->temperature > 0 && face->flux != 0)
      return host->fail(host, HK_BAD_PARAM,
                        "fluxes: the face at %s has a temperature, %g K, and a flux, %g W/m^2: of one place only one "
                        "can be given; make the other 0",
                        face_name[k], face->temperature, face->flux);
    if (s->method.grid.flat[k / 2] && (face->temperature > 0 || face->flux != 0))
      return host->fail(host, HK_BAD_PARAM,
                        "temperatures, fluxes: the box has no depth between the faces at %c, and no heat passes them: "
                        "make theirs 0",
                        "xyz"[k / 2]);
  }
  return status;
}

/* ---- the step ---- */

static void find_temperatures(grid_conduction *s, const hk_view *view) {
  const double *h = hk_enthalpy(&s->heat, view);
  for (size_t i = 0; i < view->n; i++) {
    s->temperature[i] = hk_heat_temperature(&s->method.law, h[i]);
    s->molten[i] = hk_heat_molten(&s->method.law, h[i]);
  }
}

static hk_status find_rates(grid_conduction *s, const hk_view *view) {
  double tau = s->last + s->behind;
  memset(s->rate, 0, view->n * sizeof *s->rate);
  memset(s->given, 0, view->n * sizeof *s->given);
  if (!(s->last > 0)) return HK_OK;
  hk_status status = hk_grid_heat_step(&s->method, s->index, s->count, view->x, view->model->mass,
                                       hk_enthalpy(&s->heat, view), tau, s->rate, s->given, s->over);
  for (size_t k = 0; k < s->count; k++) {
    s->rate[s->index[k]] /= s->last;
    s->given[s->index[k]] /= s->last;
  }
  s->most_iterations = fmax(s->most_iterations, s->method.cells.sweeps + s->method.cells.iterations);
  return status;
}

/* At the start of every step; within one, and where nothing came of it, what was found holds. */
static hk_status update(void *self, const hk_view *from, const double *x_to, bool *pattern_changed) {
  grid_conduction *s = self;
  (void)x_to, (void)pattern_changed;
  if (s->found == from->model->t) return HK_OK;
  hk_status status = find_rates(s, from);
  s->found = status == HK_OK ? from->model->t : NAN;
  return status;
}

static hk_status accepted(void *self, const hk_view *view, double h) {
  grid_conduction *s = self;
  (void)view;
  double flown = s->last > 0 ? (s->last + s->behind) * (h / s->last) : 0;
  s->behind = fmax(s->behind + h - flown, -h / 2);
  if (h > a_rest * s->last) s->last = h;
  s->found = NAN;
  return HK_OK;
}

static hk_status rates(void *self, const hk_view *view, double *dy) {
  grid_conduction *s = self;
  find_temperatures(s, view);
  for (size_t k = 0; k < s->count; k++) {
    size_t i = s->index[k];
    dy[s->heat.enthalpy->offset * view->n + i] += s->rate[i];
    if (s->heat.given) dy[s->heat.given->offset * view->n + i] += s->given[i];
  }
  return HK_OK;
}

static double longest_step(void *self, const hk_view *view) {
  const grid_conduction *s = self;
  (void)view;
  return s->last > 0 ? most_growth * s->last : INFINITY;
}

static size_t figures(void *self, const hk_view *view, hk_own_figure *figure) {
  const grid_conduction *s = self;
  double size;
  figure[0] = (hk_own_figure){"heat_iterations", "at most", s->most_iterations, INFINITY};
  if (!s->heat.given) return 1;
  double off = hk_heat_kept(&s->heat, view, &size) - s->start;
  figure[1] = (hk_own_figure){"enthalpy_drift", "", size > 0 ? off / size : 0, most_drift};
  return 2;
}

/* ---- the plugin ---- */

static hk_status topology(void *self, const hk_view *view) {
  grid_conduction *s = self;
  s->host->release(s->host, s->index);
  s->index = s->host->allocate(s->host, (view->n + 1) * sizeof *s->index);
  if (!s->index) return s->host->fail(s->host, HK_NO_MEMORY, "no memory for %zu particles", view->n);
  hk_status status = hk_carried_find(s->host, view, &s->particles, NULL, s->index, &s->count);
  if (status != HK_OK) return status;
  s->found = NAN;
  find_temperatures(s, view);
  if (s->heat.given) s->start = hk_heat_kept(&s->heat, view, &(double){0});
  return HK_OK;
}

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  grid_conduction *s = self;
  s->host = host;
  hk_status status = hk_heat_law_check(&s->method.law, host);
  if (status == HK_OK) status = hk_heat_channel_find(&s->heat, host, view->model);
  if (status == HK_OK) status = hk_liquid_grid_lay(&s->method.grid, host, s->low, s->high, s->cell, 1e9 * s->memory);
  if (status == HK_OK) status = set_faces(s);
  if (status == HK_OK) status = hk_grid_heat_open(&s->method, host);
  return status == HK_OK ? topology(self, view) : status;
}

static void destroy(void *self, const hk_host *host) {
  grid_conduction *s = self;
  if (s->host) hk_grid_heat_close(&s->method, host);
}

static const hk_force force = {
    .size = sizeof(hk_force),
    .flags = HK_DEPENDS_ON_CHANNELS | HK_CONSERVES_MOMENTUM | HK_CONSERVES_ANGULAR_MOMENTUM | HK_SYMMETRIC_JACOBIAN,
    .add = hk_no_force,
    .energy = hk_no_energy,
    .rates = rates,
    .facets = HK_FACETS(HK_NO_BLOCKS, HK_BOUNDS_FACET(.longest_step = longest_step),
                        HK_STEPS_FACET(.update = update, .accepted = accepted), HK_FIGURES_FACET(.list = figures)),
};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_FORCE,
    .name = "grid_conduction",
    .summary = "heat between particles in a box that may melt, implicitly on a grid: m dh/dt = div(grad theta)",
    .reference =
        "Carlson, Mucha, Van Horn, Turk 2002, Melting and flowing; Voller and Cross 1981, Accurate solutions of "
        "moving boundary problems using the enthalpy method; Elliott 1981, IMA J. Numer. Anal. 1, 115",
    .instance_size = sizeof(grid_conduction),
    .params = params,
    .fields = fields,
    .create = create,
    .destroy = destroy,
    .topology = topology,
    .force = &force,
};
