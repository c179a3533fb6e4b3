/* A weakly compressible liquid by particles (SPH) from an energy, E = sum m e(rho_i) over the liquid, with the density
 * by summation, rho_i = sum_j m_j W(r_ij), itself included (Monaghan 2005, Rep. Prog. Phys. 68, sections 2 and 3; Price
 * 2012, J. Comput. Phys. 231, section 2.3, derives the same from a Lagrangian). The force is its exact gradient,
 *     F_i = sum_j (e'_i m_i w_j + e'_j m_j w_i) (-W'/r) (x_i - x_j),
 * w the mass that a particle counts with (sph_particles.h), e' = 0 for walls: energy, momentum and angular momentum are
 * kept by every method that keeps them, and what floats is pushed by what holds it. Each particle sums over its own
 * row, in rising order, so threads leave no trace.
 *
 * The pressure ends at 0 (`cavitates`), or particles near a free surface, where neighbours are missing, would pull it
 * together; the outermost layer is therefore a little too dense. Errors are those of sums over particles, which fall
 * with the spacing only as long as the kernel grows against it: the speed of sound on a lattice is off by 4.7 % with a
 * kernel of 2.5 spacings and by 0.8 % with 3 (in space 3.4 and 0.3 %), the half axis of an elliptical drop (Monaghan
 * 1994) by 0.9, 0.3 and 0.1 % with 2.5, 3 and 3.5, whatever the spacing.
 *
 * The stable step follows from c and the kernel: of the waves that a lattice carries the fastest has w = 2.0 to 2.3 c/R
 * for kernels of 2 to 4 spacings, in a plane and in space (R its radius, lattice sums of grad W sin(k d) over all
 * k); 2.7 leaves room for disorder. Where particles are crowded far beyond their density, the sum of all pairs bounds
 * it. Implicit methods get the exact stiffness (sph_hessian.h). */
#include "plugins/common/sph/sph_fluid.h"
#include "plugins/common/sph/sph_hessian.h"
#include "plugins/common/sph/sph_pairs.h"

static const double fastest_wave = 2.7; /* c/R */
static const double crowded = 1.1;      /* by the density at rest: beyond, bounds are those of pairs */
static const double travel = 0.25;      /* of the spacing, in a step */
static const double too_soft = 0.03;    /* compression that is warned of; it is to be 0.01 */

typedef struct sph {
  hk_sph common;
  double c; /* m/s */
  int law;
  bool cavitates;
  double *density; /* n, kg/m^3, of what presses; 0: others */
  double *slope;   /* n, m_i e'_i, J m^3/kg */
  double *bend;    /* n, m_i e''_i, J m^6/kg^2 */
  hk_sph_ring ring;
  int64_t said;
} sph;

static const hk_param params[] = {
    {"c", "m/s", "speed of sound; ten times that of the liquid is compressed by a percent", .number = HK_AT(sph, c),
     .limits = HK_ABOVE(0), .flags = HK_REQUIRED},
    {"law", "", "pressure by density: e = c^2/2 (s - 1)^2, or p = density c^2/7 (s^7 - 1)", .choice = HK_AT(sph, law),
     .choices = HK_SPH_LAWS},
    {"cavitates", "", "whether pressure ends at 0, which a free surface needs; false: it may pull",
     .boolean = HK_AT(sph, cavitates), .initial = {1}},
    HK_SPH_PARAMS(sph, common),
    {0},
};

static const hk_field fields[] = {
    HK_SPH_FIELDS(sph, common),
    {"local_density", .per_particle = HK_AT(sph, density), .width = 1, .flags = HK_PUBLISHED},
    {"slope", .per_particle = HK_AT(sph, slope), .width = 1, .flags = HK_SCRATCH},
    {"bend", .per_particle = HK_AT(sph, bend), .width = 1, .flags = HK_SCRATCH},
    {"said", .integer = HK_AT(sph, said)},
    {0},
};

/* ---- density, force and energy ---- */

typedef struct task {
  sph *self;
  const hk_view *view;
  hk_sph_rows near;
  double *F;
  double (*block)[6];
} task;

static hk_status begin(task *t, sph *s, const hk_view *view) {
  *t = (task){.self = s, .view = view, .near = {.sph = &s->common, .box = view->model->box}};
  return hk_sph_begin(&s->common, view, &t->near.rows);
}

/* 0 below the density at rest where pressure ends at 0. */
HK_INLINE bool gives_way(const sph *s, double compression) { return s->cavitates && compression < 1; }

HK_INLINE void find_densities(const task *t, const hk_periodic_box *box, size_t first, size_t end) {
  sph *s = t->self;
  for (size_t k = first; k < end; k++) {
    size_t i = hk_sph_acting(t->view, k);
    if (!hk_sph_presses(&s->common, i)) continue;
    double rho = hk_sph_density(&t->near, box, i), compression = rho / s->common.density;
    double by = gives_way(s, compression) ? 0 : hk_sph_energy_slope((hk_sph_law)s->law, compression);
    s->density[i] = rho;
    s->slope[i] = s->common.point[i][3] * s->c * s->c / s->common.density * by;
  }
}

HK_INLINE void add_rows(const task *t, const hk_periodic_box *box, size_t first, size_t end) {
  for (size_t k = first; k < end; k++) {
    size_t i = hk_sph_acting(t->view, k);
    double sum[3] = {0};
    if (t->self->common.role[i] == HK_SPH_NONE) continue;
    hk_sph_push(&t->near, box, i, t->self->slope, sum);
    for (size_t c = 0; c < 3; c++) t->F[3 * i + c] += sum[c];
  }
}

/* In open space it is known to the compiler that there is no box. */
HK_VERSIONS(static void, densities, (const task *t, size_t first, size_t end),
            t->near.box ? find_densities(t, t->near.box, first, end) : find_densities(t, NULL, first, end))
HK_VERSIONS(static void, pushes, (const task *t, size_t first, size_t end),
            t->near.box ? add_rows(t, t->near.box, first, end) : add_rows(t, NULL, first, end))

static void density_chunk(void *context, size_t first, size_t end, size_t chunk) {
  const task *t = context;
  (void)chunk;
  HK_WIDEST(t->view->host->lanes, densities)(t, first, end);
}

static void push_chunk(void *context, size_t first, size_t end, size_t chunk) {
  const task *t = context;
  (void)chunk;
  HK_WIDEST(t->view->host->lanes, pushes)(t, first, end);
}

/* Of those that it does not act on nothing is left from before. */
static void find_all(const task *t) {
  sph *s = t->self;
  if (t->view->n == 0) return; /* nor are there arrays then */
  memset(s->density, 0, t->view->n * sizeof *s->density);
  memset(s->slope, 0, t->view->n * sizeof *s->slope);
  t->view->host->parallel_for(t->view->host, t->view->acting, HK_SPH_GRAIN, density_chunk, (void *)t);
}

static hk_status add(void *self, const hk_view *view, double *F) {
  task t;
  hk_status status = begin(&t, self, view);
  if (status != HK_OK) return status;
  t.F = F;
  find_all(&t);
  view->host->parallel_for(view->host, view->acting, HK_SPH_GRAIN, push_chunk, &t);
  return HK_OK;
}

static void energy_chunk(void *context, size_t first, size_t end, size_t chunk) {
  const task *t = context;
  const sph *s = t->self;
  double sum = 0;
  for (size_t k = first; k < end; k++) {
    size_t i = hk_sph_acting(t->view, k);
    if (!hk_sph_presses(&s->common, i)) continue;
    double compression = hk_sph_density(&t->near, t->near.box, i) / s->common.density;
    if (!gives_way(s, compression))
      sum += s->common.point[i][3] * s->c * s->c * hk_sph_energy((hk_sph_law)s->law, compression);
  }
  s->common.sums[chunk] = sum;
}

static double energy(void *self, const hk_view *view) {
  task t;
  if (begin(&t, self, view) != HK_OK) return NAN;
  view->host->parallel_for(view->host, view->acting, HK_SPH_GRAIN, energy_chunk, &t);
  return hk_sph_total(&t.self->common, view);
}

/* ---- implicit methods ---- */

/* m_i e''_i by the densities that were found; 0: it does not press. */
static const double *find_bends(sph *s, const hk_view *view) {
  if (view->n > 0) memset(s->bend, 0, view->n * sizeof *s->bend);
  for (size_t k = 0; k < view->acting; k++) {
    size_t i = hk_sph_acting(view, k);
    double rho0 = s->common.density, compression = s->density[i] / rho0;
    if (!hk_sph_presses(&s->common, i) || gives_way(s, compression)) continue;
    s->bend[i] =
        s->common.point[i][3] * s->c * s->c / (rho0 * rho0) * hk_sph_energy_curvature((hk_sph_law)s->law, compression);
  }
  return s->bend;
}

static void pattern(void *self, const hk_view *view, hk_pattern *into) {
  sph *s = self;
  hk_sph_ring_name(&s->ring, &s->common, view, into);
}

static hk_status jacobian(void *self, const hk_view *view, const hk_blocks *into) {
  sph *s = self;
  task t;
  hk_status status = begin(&t, s, view);
  if (status != HK_OK) return status;
  find_all(&t);
  const hk_sph_bends bends = {s->slope, find_bends(s, view), into->want & HK_WANT_DEFINITE};
  return hk_sph_ring_add(&s->ring, &t.near, &bends, view, into);
}

/* ---- the step ---- */

static double largest_compression(const sph *s, const hk_view *view) {
  double most = 0;
  for (size_t k = 0; k < view->acting; k++) most = fmax(most, s->density[hk_sph_acting(view, k)]);
  return most / s->common.density;
}

static void bound_waves(const task *t, double compression) {
  const sph *s = t->self;
  double w = fastest_wave * s->c / s->common.kernel.radius, most = fmax(1, compression);
  double by = w * w * most * most * hk_sph_energy_curvature((hk_sph_law)s->law, most);
  for (size_t k = 0; k < t->view->acting; k++) {
    size_t i = hk_sph_acting(t->view, k);
    for (int c = 0; c < 6; c += c < 3 ? 3 : 2) t->block[i][c] += by * s->common.point[i][3];
  }
}

static void stiffness_bound(void *self, const hk_view *view, hk_stiffness_part part, double (*block)[6]) {
  task t;
  if (part == HK_DAMPING_WHOLE) return;
  if (begin(&t, self, view) != HK_OK) {
    hk_sph_bound_unknown(view, block);
    return;
  }
  t.block = block;
  find_all(&t);
  double compression = largest_compression(t.self, view);
  if (compression < crowded)
    bound_waves(&t, compression);
  else
    hk_sph_bound_pairs(&t.near, &(hk_sph_bends){t.self->slope, find_bends(t.self, view), false}, view, block);
}

static double longest_step(void *self, const hk_view *view) {
  const sph *s = self;
  double most2 = 0;
  for (size_t k = 0; k < view->acting; k++) {
    const double *v = view->v + 3 * hk_sph_acting(view, k);
    most2 = fmax(most2, v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
  }
  return travel * s->common.spacing / sqrt(most2);
}

/* Of the densities of the last evaluation. */
static hk_status accepted(void *self, const hk_view *view, double h) {
  sph *s = self;
  double off = largest_compression(s, view) - 1;
  (void)h;
  if (s->said || off < too_soft) return HK_OK;
  s->said = 1;
  s->common.host->warn(s->common.host,
                       "c: the liquid is compressed by %.2g %% at t = %g s, more than a liquid is: a speed of sound of "
                       "%.2g m/s, not %g, would keep it below a percent",
                       100 * off, view->t, s->c * sqrt(off / 0.01), s->c);
  return HK_OK;
}

/* ---- the plugin ---- */

static hk_status update(void *self, const hk_view *from, const double *x_to, bool *pattern_changed) {
  sph *s = self;
  if (s->ring.number == 0) return hk_sph_update(&s->common, from);
  return hk_sph_pairs_update(&s->common, s->ring.number, from, x_to, pattern_changed);
}

static hk_status topology(void *self, const hk_view *view) {
  sph *s = self;
  s->ring.number = 0;
  return hk_sph_topology(&s->common, view);
}

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  return hk_sph_open(&((sph *)self)->common, host, view);
}

static const hk_force force = {
    .size = sizeof(hk_force),
    .flags = HK_DEPENDS_ON_X | HK_CONSERVES_MOMENTUM | HK_CONSERVES_ANGULAR_MOMENTUM | HK_STIFFENS | HK_PERIODIC |
             HK_SYMMETRIC_JACOBIAN | HK_OFFERS_DEFINITE,
    .add = add,
    .energy = energy,
    .facets = HK_FACETS(HK_IMPLICIT_FACET(.pattern = pattern, .jacobian = jacobian),
                        HK_BOUNDS_FACET(.stiffness_bound = stiffness_bound, .longest_step = longest_step),
                        HK_STEPS_FACET(.update = update, .accepted = accepted)),
};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_FORCE,
    .name = "sph",
    .summary = "a weakly compressible liquid by particles, E = sum m e(rho), rho_i = sum m W(r), with walls and bodies",
    .reference = "Monaghan 2005, Smoothed particle hydrodynamics; Akinci et al. 2012, Versatile rigid-fluid coupling",
    .instance_size = sizeof(sph),
    .params = params,
    .fields = fields,
    .create = create,
    .topology = topology,
    .force = &force,
};
