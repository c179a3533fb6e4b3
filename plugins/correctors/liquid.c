/* A liquid of particles that neither gains nor loses volume, in a box and between obstacles: after each step the
 * velocities that its forces have given to the particles go to a grid, pressure takes away their divergence there, and
 * the particles get them back and move along them (plugins/common/liquid/liquid.h has the method). Mass, momentum and
 * all channels stay on the particles. The box's faces are walls; obstacles of the scene are walls that cover
 * parts of faces, at rest or moving. Without a viscosity they have no friction. Rigid bodies that are free are walls
 * whose motion is solved for with the pressure (plugins/common/liquid/couple.h): they float, sink and are carried. So
 * are triangles of cloth, as walls without thickness (plugins/common/thin_walls/thin_walls.h): they hold water, sag
 * under it and float.
 *
 * The method is of order 1 in time, and of order 2 in space where the liquid is smooth. What it is not: obstacles, and
 * bodies that are held, move the liquid, and the liquid does not move them; strands are not felt, and a viscosity does
 * not drag cloth; obstacles thinner than two cells leak; drops of less than half a cell fly freely, without pressure.
 * Its work is not known, so the energy balance of such a run is not either. */
#include "plugins/common/liquid/liquid_balance.h"
#include "plugins/common/liquid/liquid_pace.h"
#include "plugins/common/liquid/liquid_start.h"
#include "plugins/common/liquid/tension.h"
#include "plugins/common/liquid_viscosity/viscous_flow.h"
#include "plugins/common/mac_grid/carried.h"
#include "plugins/common/mac_grid/cell_viscosity.h"

#include <string.h>

typedef struct liquid {
  double low[3], high[3], cell, density, flip, courant, tolerance, memory, viscosity, tension;
  int transfer, walls;
  bool even, heats;
  hk_tuples particles, cloth;
  double *affine; /* n x 18, for each two slots, so that a step that is taken back begins with what it began with */
  double *full;   /* n */
  double *dissipation; /* n, W/kg, of the last step */
  double *counted;     /* n, kg: of each, as the balance has it */
  hk_array guess;      /* m^2/s, the last pressure, on the grid */
  double reached;      /* s, the end of the last step */
  double off;          /* by which the density within was off, at most */
  double left;         /* of the divergence, by the step: what a cell gained or lost, at most */
  double drift;        /* of the volume, mean of the last steps; NAN: not known */
  hk_liquid_pace pace;
  hk_liquid_balance balance;
  int64_t slot, said;
  uint32_t *index;
  bool *carried;           /* n: those that are the liquid, which obstacles leave to it */
  double (*came)[6];       /* x and v of those as they came, to know whether they change */
  size_t count, obstacles; /* those that were entered before */
  hk_liquid method;
  hk_liquid_viscosity viscous;
  const char *viscosity_of;
  const double *const *viscosities; /* n, Pa s, published by the plugin of that label; NULL: it is one number */
  hk_tension surface;
  hk_array second; /* m^2/s, as `guess`, of the projection after viscosity */
  const hk_host *host;
} liquid;

enum { NO_SLIP, FREE_SLIP };
static const double most_drift = 0.01;  /* of the volume, in a run that is ok */
static const double most_passed = 2.01; /* cells, by particle or wave: a slosh in 32 cells is 6 % off then */
static const double most_leaked = 0.01; /* of all the mass that was the liquid */
static const double most_thin = 0.5;    /* of the cells with liquid, on the mean of the run: scenes have up to 0.13 */
static const double beyond_foretold = 1.5; /* of the Courant number: such a step is taken back */

static const hk_param params[] = {
    {"low", "m", "lower corner of the box that the liquid is in; its faces are walls", .vector = HK_AT(liquid, low),
     .flags = HK_REQUIRED},
    {"high", "m", "upper corner; along an axis where both are the same the liquid is a plane one",
     .vector = HK_AT(liquid, high), .flags = HK_REQUIRED},
    {"cell", "m", "size of a cell; left out: twice the distance of the particles, by their volume",
     .number = HK_AT(liquid, cell), .limits = HK_ABOVE(0), .flags = HK_OPTIONAL},
    {"density", "kg/m^3", "of the liquid; in a plane the depth of the box is one cell",
     .number = HK_AT(liquid, density), .initial = {1000}, .limits = HK_ABOVE(0)},
    {"particles", "", "that are the liquid; left out: all that move and are in no edge or triangle of the scene",
     .particles = HK_AT(liquid, particles), .flags = HK_OPTIONAL | HK_NOT_EMPTY},
    {"cloth", "", "triangles that the liquid does not pass and pushes; left out: all of the scene",
     .triangles = HK_AT(liquid, cloth), .flags = HK_OPTIONAL | HK_NOT_EMPTY},
    {"transfer", "",
     "how velocities come back: with their gradients (Jiang 2015); as changes (Zhu and Bridson 2005); "
     "plainly, which is the most viscous",
     .choice = HK_AT(liquid, transfer), .choices = HK_LIQUID_TRANSFERS},
    {"viscosity", "Pa s", "of the liquid: water 0.001, oil 0.1, honey 10", .number = HK_AT(liquid, viscosity),
     .limits = HK_AT_LEAST(0)},
    {"viscosity_of", "",
     "in place of one viscosity the label of a plugin that publishes one of each particle, as melt does",
     .string = HK_AT(liquid, viscosity_of)},
    {"heats", "", "whether what viscosity takes is published, as `dissipation`, W/kg, for the force viscous_heating",
     .boolean = HK_AT(liquid, heats)},
    {"tension", "N/m", "of its surface: water 0.072; bends of less than two cells are not seen",
     .number = HK_AT(liquid, tension), .limits = HK_AT_LEAST(0)},
    {"walls", "", "with a viscosity, whether walls and obstacles hold the liquid back", .choice = HK_AT(liquid, walls),
     .choices = "no_slip|free_slip"},
    {"flip", "", "with transfer = \"flip\": part of a particle's own velocity that is kept",
     .number = HK_AT(liquid, flip), .initial = {0.97}, .limits = HK_WITHIN(0, 1)},
    {"even", "", "whether places that are denser or thinner than the liquid are evened, which keeps its volume",
     .boolean = HK_AT(liquid, even), .initial = {1}},
    {"courant", "",
     "cells that a particle, or a wave as long as the liquid is deep, passes in a step, at most: steps are that short; "
     "waves that viscosity holds back count as they creep",
     .number = HK_AT(liquid, courant), .initial = {0.5}, .limits = HK_ABOVE_TO(0, 20)},
    {"tolerance", "", "divergence that is left, by the largest before", .number = HK_AT(liquid, tolerance),
     .initial = {1e-8}, .limits = HK_ABOVE_TO(0, 0.1)},
    {"memory", "GB", "that the grid may take", .number = HK_AT(liquid, memory), .initial = {4}, .limits = HK_ABOVE(0)},
    {0},
};

static const hk_field fields[] = {
    {"affine", .per_particle = HK_AT(liquid, affine), .width = 18},
    {"full", .per_particle = HK_AT(liquid, full), .width = 1, .flags = HK_PUBLISHED},
    {"dissipation", .per_particle = HK_AT(liquid, dissipation), .width = 1, .flags = HK_PUBLISHED},
    {"counted", .per_particle = HK_AT(liquid, counted), .width = 1},
    {"pressure", .array = HK_AT(liquid, guess), .width = sizeof(double), .flags = HK_COUNTED},
    {"second_pressure", .array = HK_AT(liquid, second), .width = sizeof(double), .flags = HK_COUNTED},
    {"reached", .number = HK_AT(liquid, reached)},
    {"off", .number = HK_AT(liquid, off)},
    {"left", .number = HK_AT(liquid, left)},
    {"drift", .number = HK_AT(liquid, drift)},
    {"pull_x", .number = HK_AT(liquid, pace.pull[0])},
    {"pull_y", .number = HK_AT(liquid, pace.pull[1])},
    {"pull_z", .number = HK_AT(liquid, pace.pull[2])},
    {"passed", .number = HK_AT(liquid, pace.passed)},
    {"gain", .number = HK_AT(liquid, pace.gain)},
    {"wave", .number = HK_AT(liquid, pace.wave)},
    {"waved", .number = HK_AT(liquid, pace.waved)},
    {"thin", .number = HK_AT(liquid, pace.thin)},
    {"steps", .number = HK_AT(liquid, pace.steps)},
    {"held", .number = HK_AT(liquid, balance.held)},
    {"came", .number = HK_AT(liquid, balance.came)},
    {"went", .number = HK_AT(liquid, balance.went)},
    {"leaked", .number = HK_AT(liquid, balance.leaked)},
    {"leaked_before", .number = HK_AT(liquid, balance.leaked_before)},
    {"number", .integer = HK_AT(liquid, balance.number)},
    {"slot", .integer = HK_AT(liquid, slot)},
    {"said", .integer = HK_AT(liquid, said)},
    {0},
};

static bool is_viscous(const liquid *s) { return s->viscosity > 0 || s->viscosities; }

static hk_status choose(liquid *s, const hk_view *view) {
  s->host->release(s->host, s->index);
  s->host->release(s->host, s->carried);
  s->host->release(s->host, s->came);
  s->carried = s->host->allocate(s->host, view->n + 1);
  s->index = s->host->allocate(s->host, (view->n + 1) * sizeof *s->index);
  s->came = s->host->allocate(s->host, (view->n + 1) * sizeof *s->came);
  if (!s->index || !s->carried || !s->came)
    return s->host->fail(s->host, HK_NO_MEMORY, "no memory for %zu particles", view->n);
  hk_status status = hk_carried_find(s->host, view, &s->particles, NULL, s->index, &s->count);
  for (size_t k = 0; k < s->count && status == HK_OK; k++) s->carried[s->index[k]] = true;
  return status;
}

static hk_liquid_particles particles_at(const liquid *s, const hk_view *view) {
  return (hk_liquid_particles){
      .count = s->count, .index = s->index, .mass = view->model->mass, .x = (double *)view->x, .v = (double *)view->v};
}

static void count(liquid *s, const hk_view *view, bool first) {
  const hk_liquid_particles p = particles_at(s, view);
  hk_liquid_balance_count(&s->balance, &p, view->n, first, s->counted);
}

static hk_status open_cloth(liquid *s, const hk_view *view) {
  const hk_tuples *cloth = s->cloth.count ? &s->cloth : &view->model->triangles;
  return hk_thin_walls_open(&s->method.thin, s->host, view, cloth, s->method.grid.size);
}

/* What is not computed is no number, not 0. */
static void mark_dissipation(liquid *s, size_t n) {
  for (size_t i = 0; i < n && !s->heats; i++) s->dissipation[i] = NAN;
}

static hk_status topology(void *self, const hk_view *view) {
  liquid *s = self;
  mark_dissipation(s, view->n);
  hk_status status = choose(s, view);
  hk_liquid_bodies_topology(&s->method.bodies);
  if (status == HK_OK) count(s, view, false);
  if (status == HK_OK) hk_liquid_warn_of_births(&s->method, view, s->index, s->count);
  if (status == HK_OK) status = open_cloth(s, view);
  return status == HK_OK ? hk_liquid_open(&s->method, s->host, s->count) : status;
}

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  liquid *s = self;
  s->host = host;
  mark_dissipation(s, view->n);
  hk_status status = choose(s, view);
  if (status != HK_OK) return status;
  count(s, view, true);
  if (s->count == 0 && isnan(s->cell))
    return host->fail(host, HK_BAD_PARAM,
                      "there are no particles that could be a liquid and say how large cells are: "
                      "give `cell`");
  hk_liquid *m = &s->method;
  m->host = host;
  m->transfer = (hk_liquid_transfer)s->transfer;
  m->density = s->density;
  m->flip = s->flip;
  m->tolerance = s->tolerance;
  m->viscous = s->viscosity > 0 || s->viscosity_of;
  m->clings = s->tension > 0 || m->viscous;
  m->sticks = s->walls == NO_SLIP && s->transfer == HK_LIQUID_APIC && m->viscous;
  s->surface = (hk_tension){.tension = s->tension};
  s->viscous =
      (hk_liquid_viscosity){.viscosity = s->viscosity, .tolerance = s->tolerance, .slip = s->walls == FREE_SLIP};
  double cell = s->cell;
  if (isnan(cell)) cell = hk_liquid_default_cell(view, s->index, s->count, s->density, s->low, s->high);
  status = hk_liquid_grid_open(&m->grid, host, s->low, s->high, cell, 1e9 * s->memory);
  if (status == HK_OK && m->viscous)
    status = hk_liquid_grid_check(&m->grid, host, "its viscosity", hk_liquid_viscosity_bytes(&m->grid, s->viscosity_of),
                                  1e9 * s->memory);
  if (status == HK_OK) status = hk_liquid_check_start(m, view, s->index, s->count);
  if (status == HK_OK) status = host->resize(host, &s->guess, m->grid.size);
  if (status == HK_OK && s->viscosity_of)
    status = hk_cell_viscosity_open(host, view->model, s->viscosity_of, s->viscosity, m->grid.size, &s->viscosities,
                                    &s->viscous.cell);
  if (status == HK_OK && is_viscous(s)) status = host->resize(host, &s->second, m->grid.size);
  if (status == HK_OK && s->viscosities) status = hk_liquid_pace_open(&s->pace, host, &m->grid);
  if (status == HK_OK)
    status = hk_liquid_bodies_open(&m->bodies, host, view, m->grid.size,
                                   (const double[]){m->grid.flat[0], m->grid.flat[1], m->grid.flat[2]});
  if (status == HK_OK) status = open_cloth(s, view);
  if (status != HK_OK) return status;
  status = hk_liquid_find_walls(m, (const bool *const *)&s->carried);
  if (status != HK_OK) return status;
  s->obstacles = m->obstacles->count;
  s->reached = view->t;
  s->drift = NAN;
  s->pace.gain = INFINITY;
  hk_liquid_warn_of_walls(m);
  return hk_liquid_open(m, host, s->count);
}

static void destroy(void *self, const hk_host *host) {
  liquid *s = self;
  (void)host;
  if (!s->host) return;
  hk_liquid_viscosity_close(&s->viscous, s->host);
  hk_tension_close(&s->surface, s->host);
  hk_liquid_close(&s->method);
}

/* By how much the density within is off, and with it the volume; 0: by less than is seen, or the cells are few. */
static double density_off(const liquid *s) {
  double off = s->method.mean - 1;
  return s->method.inside > (size_t)HK_LIQUID_ENOUGH && fabs(off) > 0.05 ? off : 0;
}

/* A mean of the last steps: the density of some hundred cells of particles at random trembles by parts of a percent. */
static void note_drift(liquid *s) {
  const double weight = 1.0 / 32;
  double now = 1 / s->method.mean - 1;
  if (s->method.inside > (size_t)HK_LIQUID_ENOUGH)
    s->drift = isnan(s->drift) ? now : s->drift + weight * (now - s->drift);
}

static hk_status reject(hk_correction *c) { return c->reject = true, HK_OK; }
static bool is_too_fast(const liquid *s, double courant) { return courant > beyond_foretold * s->courant; }

static void say(liquid *s, const hk_view *view, double courant) {
  if (s->said) return;
  double off = density_off(s);
  if (is_too_fast(s, courant) && ++s->said)
    s->host->warn(s->host,
                  "particles of the liquid pass %.3g cells in a step at t = %g s, and the step cannot be "
                  "shorter: take a smaller --dt, or larger cells",
                  courant, view->t);
  else if (off != 0 && ++s->said)
    s->host->warn(s->host,
                  "within the liquid the density is off by %.3g %% at t = %g s, and so is its volume: take "
                  "shorter steps, more particles, or a `density` and masses that fill the space they are in",
                  100 * off, view->t);
}

/* Velocities of the particles go to the grid, where viscosity and pressure act. part: of the density that is evened. */
static hk_status flow(liquid *s, const hk_view *view, double h, const hk_liquid_particles *p, double part) {
  hk_liquid *m = &s->method;
  hk_liquid_sort(m, p);
  hk_liquid_scatter(m, p);
  hk_liquid_walls(m);
  hk_status status = hk_liquid_let_in(m, view->t, h);
  if (status != HK_OK) return status;
  hk_liquid_find_surface(m);
  status = s->tension > 0 ? hk_liquid_draw_in(m, &s->surface, h) : HK_OK;
  if (status == HK_OK) status = hk_liquid_project(m, s->guess.item);
  const hk_cell_particles by_cell = {m->start, m->sorted, s->index};
  if (s->viscosities) hk_cell_viscosity(&m->grid, s->host, &by_cell, *s->viscosities, s->viscous.cell);
  if (status == HK_OK && is_viscous(s)) status = hk_viscous_flow(m, &s->viscous, h, s->second.item);
  if (status == HK_OK && is_viscous(s) && s->heats) status = hk_liquid_dissipation(m, &s->viscous, p, s->dissipation);
  if (status == HK_OK && s->even) status = hk_liquid_even(m, part);
  if (status == HK_OK) hk_liquid_extend(m, (int)ceil(s->courant) + 2);
  return status;
}

static hk_status correct(void *self, const hk_view *view, hk_correction *c) {
  liquid *s = self;
  hk_liquid *m = &s->method;
  if (m->obstacles->count > s->obstacles)
    return s->host->fail(
        s->host, HK_BAD_PARAM,
        "obstacles come after the liquid in the scene, and would strike particles that its pressure has "
        "moved: put the corrector liquid behind all obstacles");
  hk_liquid_particles p = {s->count, s->index, view->model->mass, c->x, c->v, NULL, 18};
  double courant = hk_liquid_courant(m, &p, c->h);
  hk_liquid_pull_between(&s->pace, &p, c->v_before, c->h);
  if (is_too_fast(s, courant) && !is_viscous(s) && !c->last) return reject(c);
  bool again = view->t - c->h < s->reached - 1e-9 * c->h;
  if (!again) s->slot = 1 - s->slot;
  s->reached = view->t;
  double *after = s->affine + (s->slot ? 9 : 0);
  p.affine = s->affine + (s->slot ? 0 : 9);
  hk_liquid_step_back(&p, c, s->came);
  double part = hk_liquid_part_to_even(m, &s->pace, &p, c->h, s->drift / most_drift);
  hk_status status = hk_liquid_bodies_begin(&m->bodies, view, c);
  if (status == HK_OK) status = hk_thin_walls_begin(&m->thin, &m->grid, view->model, c);
  if (status == HK_OK) status = hk_liquid_check_isolated(m, (const bool *const *)&s->carried, view, c->x_before);
  bool first = isnan(s->drift) && s->left == 0;
  if (status == HK_OK) status = flow(s, view, c->h, &p, part);
  if (status != HK_OK) return status;
  if (first) s->off = hk_liquid_off_at_start(m, &p);
  hk_liquid_gather(m, &p, after, s->full);
  if (is_viscous(s)) { /* what forces alone would have made of it says nothing */
    courant = hk_liquid_courant(m, &p, c->h);
    if (is_too_fast(s, courant) && !c->last) return reject(c);
    hk_liquid_gain(&s->pace, &p, c->v_before, c->h);
  }
  bool moved = hk_liquid_bodies_end(&m->bodies, view, c);
  status = hk_thin_walls_end(&m->thin, &m->grid, c, 1 + (int)ceil(courant), &moved);
  if (status != HK_OK) return status;
  hk_liquid_move(m, &p, c->h);
  hk_liquid_balance_leak(&s->balance, m, &p, again);
  c->changed = moved || hk_liquid_differs(&p, s->came);
  s->off = fmax(s->off, fabs(density_off(s)));
  s->left = fmax(s->left, m->left * c->h);
  s->pace.passed = fmax(s->pace.passed, courant);
  hk_liquid_note_wave(m, &s->pace, c->h);
  note_drift(s);
  if (!again) hk_liquid_note_thin(m, &s->pace);
  say(s, view, courant);
  return HK_OK;
}

static double longest_step(void *self, const hk_view *view, const double *a) {
  liquid *s = self;
  const hk_liquid_particles p = particles_at(s, view);
  if (a) hk_liquid_pull(&s->pace, &p, a);
  const hk_liquid_thickness thickness = {s->viscosities ? *s->viscosities : NULL, s->viscosity};
  s->pace.wave = hk_liquid_wave(&s->method, &s->pace, &p, thickness);
  return hk_liquid_longest_step(&s->method, &s->pace, &p, s->courant, s->tension, s->pace.wave, is_viscous(s));
}

static size_t figures(void *self, const hk_view *view, hk_own_figure *figure) {
  const liquid *s = self;
  const hk_liquid_particles p = particles_at(s, view);
  figure[0] = (hk_own_figure){"volume_drift", "", s->drift, most_drift};
  figure[1] = (hk_own_figure){"below_3_cells", "of the liquid", hk_liquid_mean_thin(&s->pace), most_thin};
  figure[2] = (hk_own_figure){"courant", "cells", fmax(s->pace.passed, s->pace.waved), most_passed};
  const hk_liquid_balance *b = &s->balance;
  figure[3] = (hk_own_figure){"in_walls", "particles", (double)hk_liquid_count_beyond(&s->method, &p), 0};
  double all = b->held + b->went, flow = b->came + b->went; /* kg: what was ever in it, and what passed its ends */
  figure[4] = (hk_own_figure){"leaked", "of the mass", all > 0 ? b->leaked / all : 0, most_leaked};
  figure[5] = (hk_own_figure){"occupied", "m^3", hk_liquid_volume(&s->method), INFINITY};
  figure[6] = (hk_own_figure){"divergence_left", "of a cell", s->left, INFINITY};
  if (flow > 0) figure[6] = (hk_own_figure){"mass_in", "kg", b->came, INFINITY};
  if (flow > 0) figure[7] = (hk_own_figure){"mass_out", "kg", b->went, INFINITY};
  return flow > 0 ? 8 : 7;
}

/* m: a particle beyond a wall, what a cell had too much, or what a gap that holds liquid lacks of a cell, at most. */
static double violation(void *self, const hk_view *view) {
  const liquid *s = self;
  const hk_liquid_particles p = particles_at(s, view);
  const double *spacing = s->method.grid.spacing;
  double wrong = fmax(hk_liquid_beyond(&s->method, &p), hk_liquid_squeezed(&s->method, &p));
  return fmax(wrong, s->off * fmin(spacing[0], fmin(spacing[1], spacing[2])));
}

static const hk_corrector corrector = {.size = sizeof(hk_corrector),
                                       .flags = HK_WANTS_BEFORE | HK_MAY_REJECT | HK_TAKES_SKINS,
                                       .correct = correct,
                                       .violation = violation,
                                       .longest_step = longest_step,
                                       .figures = figures};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_CORRECTOR,
    .name = "liquid",
    .summary = "keeps particles an incompressible liquid with a free surface, by pressure on a grid: div u = 0",
    .reference =
        "Jiang, Schroeder, Selle, Teran, Stomakhin 2015, The affine particle-in-cell method; Bridson 2015, Fluid "
        "simulation for computer graphics, chapters 5 to 7; Batty and Bridson 2008, Accurate viscous free surfaces; "
        "Kang, Fedkiw, Liu 2000, A boundary condition capturing method; Kugelstadt et al. 2019, Implicit density "
        "projection; Batty, Bertails, Bridson 2007, A fast variational framework for accurate solid-fluid coupling",
    .instance_size = sizeof(liquid),
    .params = params,
    .fields = fields,
    .create = create,
    .destroy = destroy,
    .topology = topology,
    .corrector = &corrector,
};
