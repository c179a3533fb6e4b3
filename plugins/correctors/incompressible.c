/* An incompressible liquid by particles: DFSPH (Bender and Koschier 2015, Divergence-free smoothed particle
 * hydrodynamics). After each step of the scene's forces two solves for pressures: of velocities with which the density
 * is that at rest when the particles have moved by them, to `tolerance` on the mean, and, where they have come to, of
 * velocities that do not compress it any more. The steps are those of the flow, 0.4 spacings of the fastest particle,
 * and not those of sound, which the force `sph` takes.
 *
 * Order 1 in time, as a splitting. Walls are particles (sph_particles.h), and do not move by the liquid's pressure;
 * bodies float with the force `sph` only. Its work is not known, nor is then the energy balance of the run. */
#include "plugins/common/sph/sph_pressure.h"

typedef struct incompressible {
  hk_sph common;
  double tolerance, divergence;
  int64_t most;
  double *held, *still; /* n: multipliers of the last step's two solves, first guesses of the next one's */
  double *density, *solved;
  hk_sph_list list;
  double last, longest; /* s, steps: the last one and the longest so far */
  double off;           /* of the density at the last step, by that at rest */
  int64_t said;
} incompressible;

static const double courant = 0.4;

static const hk_param params[] = {
    {"tolerance", "", "mean excess of density that is left, by that at rest, of what is under pressure",
     .number = HK_AT(incompressible, tolerance), .initial = {1e-4}, .limits = HK_ABOVE_TO(0, 0.1)},
    {"divergence", "", "the same of what the density would rise by in a step", .initial = {1e-3},
     .number = HK_AT(incompressible, divergence), .limits = HK_ABOVE_TO(0, 0.1)},
    {"iterations", "", "of either solve, at most", .integer = HK_AT(incompressible, most), .initial = {200},
     .limits = HK_WITHIN(1, 1e6)},
    HK_SPH_PARAMS(incompressible, common),
    {0},
};

static const hk_field fields[] = {
    HK_SPH_FIELDS(incompressible, common),
    {"held", .per_particle = HK_AT(incompressible, held), .width = 1},
    {"still", .per_particle = HK_AT(incompressible, still), .width = 1},
    {"local_density", .per_particle = HK_AT(incompressible, density), .width = 1, .flags = HK_PUBLISHED},
    {"solved", .per_particle = HK_AT(incompressible, solved), .width = 4, .flags = HK_SCRATCH},
    {"last", .number = HK_AT(incompressible, last)},
    {"longest", .number = HK_AT(incompressible, longest)},
    {"off", .number = HK_AT(incompressible, off)},
    {"said", .integer = HK_AT(incompressible, said)},
    {0},
};

/* Impulses of a step are as its length: the guess is that of the last one, in proportion. */
static void scale_guess(incompressible *s, const hk_view *view, double h) {
  double by = s->last > 0 ? h / s->last : 0;
  for (size_t i = 0; i < view->n; i++) s->held[i] *= by;
  s->last = h;
  s->longest = fmax(s->longest, h);
}

/* By the spacing, what the fastest particle of the liquid goes in a step. */
static double courant_of(const incompressible *s, const hk_view *view, const hk_correction *c) {
  double most2 = 0;
  for (size_t i = 0; i < view->n; i++) {
    const double *v = c->v + 3 * i;
    if (s->common.role[i] == HK_SPH_LIQUID) most2 = fmax(most2, v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
  }
  return c->h * sqrt(most2) / s->common.spacing;
}

/* Once a run. */
static void say(incompressible *s, const hk_view *view, const hk_sph_pressure *p) {
  if (s->said || p->iterations < (size_t)s->most) return;
  s->said = 1;
  s->common.host->warn(s->common.host,
                       "the density is still off by %.2g %% on the mean after %zu iterations at t = %g s: take shorter "
                       "steps, more `iterations`, or a larger `tolerance`",
                       100 * p->off, p->iterations, view->t);
}

/* The liquid goes from where it was before the step with the velocities that were solved for. Whether anything moves.
 */
static bool move(const incompressible *s, const hk_view *view, hk_correction *c) {
  bool moved = false;
  for (size_t i = 0; i < view->n; i++)
    for (size_t k = 3 * i; s->common.role[i] == HK_SPH_LIQUID && k < 3 * i + 3; k++) {
      double to = c->x_before[k] + c->h * c->v[k];
      moved |= to != c->x[k];
      c->x[k] = to;
    }
  return moved;
}

static hk_status correct(void *self, const hk_view *view, hk_correction *c) {
  incompressible *s = self;
  if (courant_of(s, view, c) > courant && !c->last) {
    c->reject = true;
    return HK_OK;
  }
  hk_view at = *view;
  at.x = c->x_before;
  scale_guess(s, view, c->h);
  hk_sph_pressure p = {.sph = &s->common,
                       .list = &s->list,
                       .v = (double(*)[4])s->solved,
                       .a = s->held,
                       .h = c->h,
                       .longest = s->longest};
  hk_status status = hk_sph_update(&s->common, &at);
  if (status == HK_OK) status = hk_sph_pressure_begin(&p, &at);
  if (status != HK_OK) return status;
  hk_sph_pressure_solve(&p, c->v, c->h, s->tolerance, (size_t)s->most);
  s->off = p.off;
  say(s, view, &p);
  bool moved = move(s, view, c);
  at.x = c->x;
  p.a = s->still, p.h = 0;
  status = hk_sph_pressure_begin(&p, &at);
  if (status != HK_OK) return status;
  memcpy(s->density, s->list.density, view->n * sizeof *s->density);
  hk_sph_pressure_solve(&p, c->v, c->h, s->divergence, (size_t)s->most);
  c->changed = moved || p.changed;
  return HK_OK;
}

/* m: by which a particle's place is too small, on the mean. */
static double violation(void *self, const hk_view *view) {
  const incompressible *s = self;
  (void)view;
  return s->off > s->tolerance ? s->off * s->common.spacing / 3 : 0;
}

static hk_status topology(void *self, const hk_view *view) {
  hk_sph_list_forget(&((incompressible *)self)->list);
  return hk_sph_topology(&((incompressible *)self)->common, view);
}

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  return hk_sph_open(&((incompressible *)self)->common, host, view);
}

static const hk_corrector corrector = {.size = sizeof(hk_corrector),
                                       .flags = HK_WANTS_BEFORE | HK_MAY_REJECT | HK_PERIODIC,
                                       .correct = correct,
                                       .violation = violation};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_CORRECTOR,
    .name = "incompressible",
    .summary = "keeps a liquid by particles at its density, by two solves for pressures a step (DFSPH)",
    .reference = "Bender and Koschier 2015, Divergence-free smoothed particle hydrodynamics, section 3",
    .instance_size = sizeof(incompressible),
    .params = params,
    .fields = fields,
    .create = create,
    .topology = topology,
    .corrector = &corrector,
};
