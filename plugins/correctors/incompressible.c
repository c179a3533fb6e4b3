/* An incompressible liquid by particles: DFSPH (Bender and Koschier 2015, Divergence-free smoothed particle
 * hydrodynamics). After each step of the scene's forces two solves for pressures: of velocities with which the density
 * is that at rest when the particles have moved by them, to `tolerance` on the mean, and, where they have come to, of
 * velocities that do not compress it any more. The steps are those of the flow, 0.4 spacings of the fastest particle,
 * and not those of sound, which the force `sph` takes.
 *
 * Where the liquid fills its room pressures pull as well, and after the step particles are moved apart, by
 * shift dx u h (Lind et al. 2012; Skillen, Lind, Stansby and Rogers 2013, Comput. Methods Appl. Mech. Eng. 265,
 * equation 16: A h u dt with A = 2 and h half of the kernel's radius, which is 3 spacings): without it particles pair
 * where the flow stretches, 27 % of them after 4 s in a vortex of Re 200, and its amplitude is 4 % low then, 1.1 % with
 * it. They keep their velocities, so momentum is kept, and angular momentum to the order of the shift.
 *
 * Order 1 in time, as a splitting. Walls are particles (sph_particles.h); points of rigid bodies and of cloth move by
 * the pressure as it is found, with the liquid's mass that they take along (sph_bodies.h). Its work is not known, nor
 * is then the energy balance of the run. */
#include "plugins/common/sph/sph_pressure.h"
#include "plugins/common/sph/sph_spread.h"

typedef struct incompressible {
  hk_sph common;
  double tolerance, divergence;
  int64_t most;
  double *held, *still; /* n: multipliers of the last step's two solves, first guesses of the next one's */
  double *density, *solved;
  double *excess, *residual, *direction, *trial;
  double *way;   /* n x 3 */
  double shift;  /* of the fastest particle's way in a step */
  double paired; /* of the particles, the most so far */
  hk_sph_list list;
  hk_sph_bodies bodies;
  double last, longest; /* s, steps: the last one and the longest so far */
  double off;           /* of the density at the last step, by that at rest */
  double excess_most;   /* of the steps so far: the density found behind a step, by that at rest */
  double iterations, solves;
  int fills;                    /* whether the liquid fills its room: found, yes, no */
  double counted, enclosed;     /* active particles when that was looked at; 1: they leave no room between them, or 0 */
  double surface;               /* of the density at rest: halfway from that of a particle at a flat surface */
  double given, taken, kinetic; /* J: by pressure in steps in which it gave any; in others; of all, the most so far */
  int64_t said;
} incompressible;

enum { FOUND, YES, NO }; /* incompressible.fills */

static const double courant = 0.4;
static const double often = 8;                    /* steps, from one look at pairs to the next */
static const double full = 0.99, overfull = 1.01; /* of the room in a box that repeats, and of the density at rest */
/* Of a run that is ok: the density's excess, as a liquid's drift of volume on a grid; and the energy that pressure
 * gives. Where vortices keep theirs to a percent that is 0.05, where they are off by a tenth and more 0.7 and 0.9. */
static const double most_excess = 0.01, most_given = 0.5, most_paired = 0.1;

static const hk_param params[] = {
    {"tolerance", "", "mean excess of density that is left, by that at rest, of what is under pressure",
     .number = HK_AT(incompressible, tolerance), .initial = {1e-4}, .limits = HK_ABOVE_TO(0, 0.1)},
    {"divergence", "", "the same of what the density would rise by in a step", .initial = {1e-3},
     .number = HK_AT(incompressible, divergence), .limits = HK_ABOVE_TO(0, 0.1)},
    {"iterations", "", "of either solve, at most", .integer = HK_AT(incompressible, most), .initial = {200},
     .limits = HK_WITHIN(1, 1e6)},
    {"fills", "",
     "whether the liquid fills all of its room, between walls or in a box that repeats: pressure pulls there too, and "
     "keeps the mean density. found: no particle has a surface beside it, nothing floats in it, and it has no weight",
     .choice = HK_AT(incompressible, fills), .choices = "found|yes|no"},
    {"shift", "", "where it fills its room, by how much particles go apart: of what the fastest one goes in a step",
     .number = HK_AT(incompressible, shift), .initial = {3}, .limits = HK_WITHIN(0, 10)},
    HK_SPH_PARAMS(incompressible, common),
    {0},
};

static const hk_field fields[] = {
    HK_SPH_FIELDS(incompressible, common),
    {"held", .per_particle = HK_AT(incompressible, held), .width = 1},
    {"still", .per_particle = HK_AT(incompressible, still), .width = 1},
    {"local_density", .per_particle = HK_AT(incompressible, density), .width = 1, .flags = HK_PUBLISHED},
    {"solved", .per_particle = HK_AT(incompressible, solved), .width = 4, .flags = HK_SCRATCH},
    {"excess", .per_particle = HK_AT(incompressible, excess), .width = 1, .flags = HK_SCRATCH},
    {"residual", .per_particle = HK_AT(incompressible, residual), .width = 1, .flags = HK_SCRATCH},
    {"direction", .per_particle = HK_AT(incompressible, direction), .width = 1, .flags = HK_SCRATCH},
    {"way", .per_particle = HK_AT(incompressible, way), .width = 3, .flags = HK_SCRATCH},
    {"paired", .number = HK_AT(incompressible, paired)},
    {"trial", .per_particle = HK_AT(incompressible, trial), .width = 1, .flags = HK_SCRATCH},
    {"last", .number = HK_AT(incompressible, last)},
    {"longest", .number = HK_AT(incompressible, longest)},
    {"off", .number = HK_AT(incompressible, off)},
    {"excess_most", .number = HK_AT(incompressible, excess_most)},
    {"iterations_sum", .number = HK_AT(incompressible, iterations)},
    {"given", .number = HK_AT(incompressible, given)},
    {"taken", .number = HK_AT(incompressible, taken)},
    {"kinetic", .number = HK_AT(incompressible, kinetic)},
    {"solves", .number = HK_AT(incompressible, solves)},
    {"counted", .number = HK_AT(incompressible, counted)},
    {"enclosed", .number = HK_AT(incompressible, enclosed)},
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

/* By the spacing, what the fastest particle of the liquid, or of a wall, goes in a step. */
static double courant_of(const incompressible *s, const hk_view *view, const hk_correction *c) {
  double most2 = 0;
  for (size_t i = 0; i < view->n; i++) {
    const double *v = c->v + 3 * i;
    if (s->common.role[i] != HK_SPH_NONE) most2 = fmax(most2, v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
  }
  return c->h * sqrt(most2) / s->common.spacing;
}

/* m^3, of a box that repeats along all axes that the liquid has; INFINITY: there is none. */
static double room_of(const incompressible *s, const hk_periodic_box *box) {
  double room = s->common.dimensions == 2 ? s->common.spacing : 1;
  int repeats = 0;
  for (int c = 0; box && c < 3; c++) {
    if (box->repeats[c]) room *= box->high[c] - box->low[c];
    repeats += box->repeats[c];
  }
  return repeats == s->common.dimensions ? room : INFINITY;
}

/* After hk_sph_update. By the room that the box has the liquid and what stands in it; of a layer of walls it is not
 * known what it encloses. */
static double filling_of(const incompressible *s, const hk_view *view) {
  double room = room_of(s, view->model->box), volume = 0;
  bool known = isfinite(room);
  for (size_t i = 0; known && i < view->n; i++) {
    bool acts = !view->is_active || view->is_active[i];
    if (s->common.role[i] == HK_SPH_NONE || !acts) continue;
    known = s->common.role[i] == HK_SPH_LIQUID || s->common.wall_volume > 0;
    volume += s->common.role[i] == HK_SPH_LIQUID ? view->model->mass[i] / s->common.density : s->common.volume[i];
  }
  return known ? volume / room : 0;
}

static hk_status look_at_room(incompressible *s, const hk_view *view, bool *pulls) {
  double filling = filling_of(s, view);
  *pulls = s->fills == YES || (s->fills == FOUND && filling > full);
  if (filling < overfull) return HK_OK;
  return s->common.host->fail(s->common.host, HK_FAILED,
                              "the liquid needs %.4g times the volume of the box that repeats at t = %g s, and is not "
                              "compressed: take fewer particles, a smaller mass, or a larger box or `density`",
                              filling, view->t);
}

/* Between the density at rest and that which a half-space of the lattice has in its outermost layer. */
static double surface_density(const hk_sph *s) {
  int most = (int)ceil(s->reach), deep = s->dimensions == 3 ? most : 0;
  double beyond = 0;
  for (int a = 1; a <= most; a++)
    for (int b = -most; b <= most; b++)
      for (int c = -deep; c <= deep; c++)
        beyond += hk_sph_value(&s->kernel, (a * a + b * b + c * c) * (s->spacing * s->spacing));
  return 1 - beyond * pow(s->spacing, 3) / 2;
}

/* Whether no particle of the liquid has a surface beside it, and what is around it neither presses nor draws it apart.
 */
static bool has_no_surface(const incompressible *s, const hk_view *view) {
  double sum = 0, count = 0, least = INFINITY;
  for (size_t i = 0; i < view->n; i++) {
    if (s->common.role[i] != HK_SPH_LIQUID || !(s->list.density[i] > 0)) continue;
    least = fmin(least, s->list.density[i] / s->common.density);
    sum += s->list.density[i] / s->common.density;
    count++;
  }
  return least > s->surface && sum > full * count && sum < overfull * count;
}

/* Whether a pull on all of the liquid, as weight is, outweighs what its motion does to the pressure, over its size.
 * With such pressures, below and above their mean, particles that are drawn together pair. */
static bool is_heavy(const incompressible *s, const hk_view *view, const hk_correction *c) {
  double dv[3] = {0}, count = 0, fastest = courant_of(s, view, c) * s->common.spacing / c->h;
  for (size_t i = 0; i < view->n; i++) {
    if (!(s->list.density[i] > 0)) continue;
    for (size_t k = 0; k < 3; k++) dv[k] += c->v[3 * i + k] - c->v_before[3 * i + k];
    count++;
  }
  double pull = sqrt(dv[0] * dv[0] + dv[1] * dv[1] + dv[2] * dv[2]) / (count * c->h);
  return pull * s->common.spacing * pow(count, 1.0 / (double)s->common.dimensions) > fastest * fastest;
}

/* After hk_sph_pressure_begin. Looked at where particles come or go; then, while there is none, in each step, whether
 * walls have given way and the liquid has a surface from now on. */
static void look_at_walls(incompressible *s, const hk_view *view, const hk_correction *c, hk_sph_pressure *p) {
  double count = (double)view->acting;
  if (s->fills != FOUND || p->pulls || s->bodies.movers > 0) return;
  if (s->counted != count)
    s->enclosed = has_no_surface(s, view) && !is_heavy(s, view, c);
  else if (s->enclosed > 0)
    s->enclosed = hk_sph_pressure_mean(p) > full * s->common.density;
  s->counted = count;
  if (s->enclosed > 0) hk_sph_pressure_pull(p);
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

/* J */
static double kinetic_of(const hk_view *view, const double *v) {
  double sum = 0;
  for (size_t k = 0; k < 3 * view->n; k++) sum += view->model->mass[k / 3] * v[k] * v[k] / 2;
  return sum;
}

/* Pressure that keeps a volume takes what would change it and gives nothing: what it gives pushes apart what had come
 * too near. */
static void note_energy(incompressible *s, double before, double after) {
  s->given += fmax(0, after - before);
  s->taken += fmax(0, before - after);
  s->kinetic = fmax(s->kinetic, fmax(before, after));
}

/* By what it took and the largest kinetic energy. */
static double part_given(const incompressible *s) { return s->given > 0 ? s->given / (s->taken + s->kinetic) : 0; }

/* The mean of what densities are above that which is kept, of what is there, by that at rest. */
static void note_excess(incompressible *s, const hk_view *view, const hk_sph_pressure *p) {
  double sum = 0, count = 0;
  for (size_t i = 0; i < view->n; i++) {
    sum += fmax(0, s->list.density[i] - p->density);
    count += s->list.density[i] > p->density;
  }
  if (count > 0) s->excess_most = fmax(s->excess_most, sum / count / s->common.density);
}

static void solve(incompressible *s, hk_sph_pressure *p, double *v, double h, double tolerance) {
  hk_sph_pressure_solve(p, v, h, tolerance, (size_t)s->most);
  s->iterations += (double)p->iterations;
  s->solves++;
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

/* Where there is a surface they would leave it. */
static void spread(incompressible *s, const hk_view *view, hk_correction *c, const hk_sph_pressure *p) {
  if (p->pulls && fmod(s->solves, 2 * often) == 0) s->paired = fmax(s->paired, hk_sph_paired(&p->near, view, p->pulls));
  if (!p->pulls || !(s->shift > 0)) return;
  double area = s->shift * s->common.spacing * s->common.spacing * courant_of(s, view, c) / s->common.reach;
  hk_sph_way_apart(&s->common, &s->list, view, (double(*)[3])s->way);
  for (size_t i = 0; i < view->n; i++)
    for (size_t k = 3 * i; k < 3 * i + 3; k++) {
      double to = c->x[k] + area / s->common.spacing * s->way[k];
      c->changed |= to != c->x[k];
      c->x[k] = to;
    }
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
                       .bodies = &s->bodies,
                       .v = (double(*)[4])s->solved,
                       .a = s->held,
                       .excess = s->excess,
                       .residual = s->residual,
                       .direction = s->direction,
                       .trial = s->trial,
                       .h = c->h,
                       .longest = s->longest};
  hk_status status = hk_sph_update(&s->common, &at);
  if (status == HK_OK) status = look_at_room(s, &at, &p.pulls);
  if (status == HK_OK) status = hk_sph_pressure_begin(&p, &at, c);
  if (status != HK_OK) return status;
  look_at_walls(s, &at, c, &p);
  hk_sph_bodies_clear(&s->bodies);
  double kinetic = kinetic_of(view, c->v);
  solve(s, &p, c->v, c->h, s->tolerance);
  s->off = p.off;
  say(s, view, &p);
  bool moved = move(s, view, c);
  status = hk_sph_bodies_move(&s->bodies, view, c, &moved);
  at.x = c->x;
  p.a = s->still, p.h = 0;
  if (status == HK_OK) status = hk_sph_pressure_begin(&p, &at, c);
  if (status != HK_OK) return status;
  note_excess(s, view, &p);
  memcpy(s->density, s->list.density, view->n * sizeof *s->density);
  solve(s, &p, c->v, c->h, s->divergence);
  note_energy(s, kinetic, kinetic_of(view, c->v));
  c->changed = moved || p.changed;
  spread(s, &at, c, &p);
  return HK_OK;
}

/* m: by which a particle's place is too small, on the mean. */
static double violation(void *self, const hk_view *view) {
  const incompressible *s = self;
  (void)view;
  return s->off <= s->tolerance ? 0 : isfinite(s->off) ? s->off * s->common.spacing / 3 : INFINITY;
}

static hk_status topology(void *self, const hk_view *view) {
  hk_sph_list_forget(&((incompressible *)self)->list);
  hk_sph_bodies_forget(&((incompressible *)self)->bodies);
  return hk_sph_topology(&((incompressible *)self)->common, view);
}

static size_t figures(void *self, const hk_view *view, hk_own_figure *figure) {
  const incompressible *s = self;
  (void)view;
  figure[0] = (hk_own_figure){"density_excess", "", s->excess_most, most_excess};
  figure[1] = (hk_own_figure){"energy_given", "", part_given(s), most_given};
  figure[2] = (hk_own_figure){"iterations", "", s->solves > 0 ? s->iterations / s->solves : 0, INFINITY};
  figure[3] = (hk_own_figure){"paired", "of the particles", s->paired, most_paired};
  return 4;
}

static void mean_forces(const void *self, const hk_view *view, double *F) {
  const incompressible *s = self;
  (void)view;
  hk_sph_bodies_forces(&s->bodies, s->last, F);
}

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  incompressible *s = self;
  hk_sph_bodies_open(&s->bodies, host);
  hk_status status = hk_sph_open(&s->common, host, view);
  s->surface = surface_density(&s->common);
  return status;
}

static const hk_corrector corrector = {.size = sizeof(hk_corrector),
                                       .flags = HK_WANTS_BEFORE | HK_MAY_REJECT | HK_PERIODIC | HK_TAKES_BODIES,
                                       .correct = correct,
                                       .violation = violation,
                                       .figures = figures,
                                       .mean_forces = mean_forces};

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
