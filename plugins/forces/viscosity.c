/* Viscosity of a liquid by particles: neighbours i and j damp the speed at which they approach,
 *     F_i = -f(r) ((v_i - v_j).d) d,   d = x_i - x_j,   f = 2 mu V_i V_j (-W'/r) / M,
 * after Monaghan 2005 (Rep. Prog. Phys. 68, section 4.3), whose (v.d) d / r^2 has its r^2 in the weight here: the force
 * stays smooth where particles meet, and so do its blocks. It lies along the line of the two, so momentum and angular
 * momentum are kept, and it takes energy: power -f ((v_i - v_j).d)^2. V is the volume at rest; M, the mean of
 * (-W'/r) x^2 y^2 over the lattice (sph_kernel.h), makes mu the viscosity in Pa s: sums of pairs become
 * mu (laplacian v + 2 grad div v) (Espanol and Revenga 2003, Phys. Rev. E 67, 026705, equation 54), which is mu
 * laplacian v where the volume is kept. The error at a wavenumber k is of the order (k R)^2, and on a lattice a percent
 * more by its axes. Walls hold the liquid fast, with volumes of Akinci et al. 2012 (sph_particles.h).
 * Where the liquid slips along them, they rub no one, and what they cover of a kernel is made up for by the rest of it:
 * f of a pair is times the mean of both ends' sums of V (-W'/r) r^4 over all, by that over the liquid. Without it a
 * vortex between walls died down too slowly, by 23 % with 16 particles on its side and 10 % with 32.
 *
 * What it takes from the motion is published as `dissipation`, each end of a pair having half of it, for the force
 * viscous_heating. With `viscosity_of` mu is that of the particles, by its harmonic mean.
 *
 * The blocks f d d^T are definite; that they change with the positions is left out where a method wants them symmetric,
 * and that what walls cover does always.
 * Methods with an implicit part (imex) take the liquid's pressure explicitly and this implicitly. */
#include "plugins/common/channels/find_published.h"
#include "plugins/common/sph/sph_pairs.h"
#include "plugins/kit/vector3.h"

#include <string.h>

typedef struct viscosity {
  hk_sph common;
  double mu;
  bool slip;
  const char *viscosity_of;
  const double *const *viscosities; /* n, Pa s, published by the plugin of that label; NULL: it is one number */
  double factor;                    /* 2 mu / M, N s/m / (m^2 m^6 1/m^5); with `viscosities` 2 / M */
  double *beside;                   /* n, where it slips: what the kernel holds, by what of it is liquid */
  double *dissipation;              /* n, W/kg, of the last evaluation; NAN: there was none */
  bool evaluated;
  hk_sph_pairs pairs;
} viscosity;

static const hk_param params[] = {
    {"mu", "Pa s", "dynamic viscosity; of water 1e-3, of honey 10", .number = HK_AT(viscosity, mu),
     .limits = HK_AT_LEAST(0), .flags = HK_OPTIONAL},
    {"viscosity_of", "",
     "in place of `mu` the label of a plugin that publishes a viscosity of each particle, as melt does",
     .string = HK_AT(viscosity, viscosity_of)},
    {"slip", "", "whether the liquid slides along walls; false: they hold it fast", .boolean = HK_AT(viscosity, slip)},
    HK_SPH_PARAMS(viscosity, common),
    {0},
};

static const hk_field fields[] = {
    HK_SPH_FIELDS(viscosity, common),
    {"beside", .per_particle = HK_AT(viscosity, beside), .width = 1, .flags = HK_SCRATCH},
    {"dissipation", .per_particle = HK_AT(viscosity, dissipation), .width = 1, .flags = HK_PUBLISHED},
    {0},
};

typedef struct task {
  viscosity *self;
  const hk_view *view;
  hk_neighbour_rows rows;
  const hk_periodic_box *box;
  double *F;
  double (*block)[6];
} task;

/* Of sums of V (-W'/r) r^4, which M is the mean of. Behind a wall is at most the image of the liquid before it. */
static double find_beside(const task *t, size_t i) {
  double liquid = 0, all = 0;
  hk_sph_near near;
  for (size_t at = t->rows.row_start[i], end = t->rows.row_start[i + 1]; at < end;) {
    hk_sph_gather(&t->self->common, t->box, t->rows.other, end, i, &at, &near);
    for (size_t k = 0; k < near.count; k++) {
      double part = near.mass[k] * hk_sph_slope(&t->self->common.kernel, near.r2[k]) * near.r2[k] * near.r2[k];
      all += part;
      liquid += t->self->common.role[near.other[k]] == HK_SPH_LIQUID ? part : 0;
    }
  }
  return liquid > 0 ? fmin(2, all / liquid) : 1;
}

static void beside_chunk(void *context, size_t first, size_t end, size_t chunk) {
  const task *t = context;
  (void)chunk;
  for (size_t k = first; k < end; k++) {
    size_t i = hk_sph_acting(t->view, k);
    t->self->beside[i] = t->self->common.role[i] == HK_SPH_LIQUID ? find_beside(t, i) : 1;
  }
}

static hk_status begin(task *t, viscosity *p, const hk_view *view) {
  *t = (task){.self = p, .view = view, .box = view->model->box};
  p->factor = 2 * (p->viscosities ? 1 : p->mu) / p->common.kernel.fourth;
  hk_status status = hk_sph_begin(&p->common, view, &t->rows);
  if (status == HK_OK && p->slip) view->host->parallel_for(view->host, view->acting, HK_SPH_GRAIN, beside_chunk, t);
  return status;
}

/* Two walls do not, and none where the liquid slides along them. */
HK_INLINE bool rub(const viscosity *p, size_t i, size_t j) {
  bool is_wall = p->common.role[i] == HK_SPH_WALL, other_is = p->common.role[j] == HK_SPH_WALL;
  return p->slip ? !is_wall && !other_is : !(is_wall && other_is);
}

/* Pa s: the harmonic mean, by which the stress between two layers is right (Cleary and Monaghan 1999, equation 27, for
 * heat); a wall has none of its own. */
static double viscosity_between(const viscosity *p, size_t i, size_t j) {
  double a = (*p->viscosities)[i], b = (*p->viscosities)[j];
  if (p->common.role[i] == HK_SPH_WALL) return b;
  return p->common.role[j] == HK_SPH_WALL ? a : 2 * a * b / (a + b);
}

/* f, N s/m^3 */
static double weight(const viscosity *p, size_t i, size_t j, double r2) {
  if (!rub(p, i, j)) return 0;
  double f =
      p->factor * hk_sph_volume(&p->common, i) * hk_sph_volume(&p->common, j) * hk_sph_slope(&p->common.kernel, r2);
  if (p->slip) f *= (p->beside[i] + p->beside[j]) / 2;
  return p->viscosities ? viscosity_between(p, i, j) * f : f;
}

/* ---- the force ---- */

/* Returns its power by half, W: of a pair each end has one. */
static double add_row(const task *t, size_t i) {
  const double *v = t->view->v;
  double power = 0;
  hk_sph_near near;
  for (size_t at = t->rows.row_start[i], end = t->rows.row_start[i + 1]; at < end;) {
    hk_sph_gather(&t->self->common, t->box, t->rows.other, end, i, &at, &near);
    for (size_t k = 0; k < near.count; k++) {
      const double d[3] = {near.d[0][k], near.d[1][k], near.d[2][k]}, *w = v + 3 * (size_t)near.other[k];
      double speed = (v[3 * i] - w[0]) * d[0] + (v[3 * i + 1] - w[1]) * d[1] + (v[3 * i + 2] - w[2]) * d[2];
      double f = weight(t->self, i, near.other[k], near.r2[k]);
      hk_add_scaled(t->F + 3 * i, -f * speed, d);
      power -= f * speed * speed / 2;
    }
  }
  return power;
}

static void add_chunk(void *context, size_t first, size_t end, size_t chunk) {
  const task *t = context;
  double power = 0;
  for (size_t k = first; k < end; k++) {
    size_t i = hk_sph_acting(t->view, k);
    if (t->self->common.role[i] == HK_SPH_NONE) continue;
    double own = add_row(t, i);
    power += own;
    t->self->dissipation[i] = t->view->model->mass[i] > 0 ? -own / t->view->model->mass[i] : 0;
  }
  t->self->common.sums[chunk] = power;
}

static hk_status add(void *self, const hk_view *view, double *F) {
  task t;
  viscosity *p = self;
  if (!p->evaluated) memset(p->dissipation, 0, view->n * sizeof *p->dissipation); /* also of who is not of the liquid */
  p->evaluated = true;
  hk_status status = begin(&t, self, view);
  if (status != HK_OK) return status;
  t.F = F;
  view->host->parallel_for(view->host, view->acting, HK_SPH_GRAIN, add_chunk, &t);
  if (view->power) *view->power += hk_sph_total(&t.self->common, view);
  return HK_OK;
}

/* ---- implicit methods ---- */

static bool pair_rubs(const void *self, size_t i, size_t j) { return rub(self, i, j); }

static void pattern(void *self, const hk_view *view, hk_pattern *into) {
  viscosity *p = self;
  hk_sph_pairs_name(&p->pairs, &p->common, view, pair_rubs, p, into);
}

/* -dF_i/dd: F_i = -f (u.d) d, f' / r = -factor V V W'''... by the kernel's slope, -60 amplitude/R^2 (1 - t)^2 / (R r).
 */
static void add_turn(const viscosity *p, double f, double r2, const double d[3], const double u[3], double K[9]) {
  double r = sqrt(r2), t = hk_sph_part(&p->common.kernel, r2), speed = hk_dot(u, d);
  double fall = t < 1 && r > 0 ? -3 * f * p->common.kernel.inverse / ((1 - t) * r) : 0;
  for (int a = 0; a < 3; a++)
    for (int b = 0; b < 3; b++) K[3 * a + b] += fall * speed * d[a] * d[b] + f * (d[a] * u[b] + speed * (a == b));
}

static hk_status jacobian(void *self, const hk_view *view, const hk_blocks *into) {
  viscosity *p = self;
  const size_t *slot = into->slot;
  if (p->pairs.failed != HK_OK) return p->pairs.failed;
  for (size_t k = 0; k < p->pairs.count; k++, slot += 4) {
    size_t i = p->pairs.pair[k][0], j = p->pairs.pair[k][1];
    double d[3], u[3], K[9] = {0}, D[9], r2 = hk_sph_between(view, i, j, d), f = weight(p, i, j, r2);
    if (!(f > 0)) continue;
    hk_subtract(u, view->v + 3 * i, view->v + 3 * j);
    for (int q = 0; q < 9; q++) D[q] = f * d[q / 3] * d[q % 3];
    if (!(into->want & HK_WANT_SYMMETRIC)) add_turn(p, f, r2, d, u, K);
    hk_sph_pair_add(into->D, slot, D);
    hk_sph_pair_add(into->K, slot, K);
  }
  return HK_OK;
}

/* ---- the step ---- */

/* f ((u_i - u_j).d)^2 <= 2 f (u_i.d)^2 + 2 f (u_j.d)^2; each end adds its own. */
static void bound_chunk(void *context, size_t first, size_t end, size_t chunk) {
  const task *t = context;
  hk_sph_near near;
  (void)chunk;
  for (size_t m = first; m < end; m++) {
    size_t i = hk_sph_acting(t->view, m);
    for (size_t at = t->rows.row_start[i], last = t->rows.row_start[i + 1]; at < last;) {
      hk_sph_gather(&t->self->common, t->box, t->rows.other, last, i, &at, &near);
      for (size_t k = 0; k < near.count; k++) {
        double f = 2 * weight(t->self, i, near.other[k], near.r2[k]);
        for (int a = 0, q = 0; a < 3; a++)
          for (int b = a; b < 3; b++, q++) t->block[i][q] += f * near.d[a][k] * near.d[b][k];
      }
    }
  }
}

static void stiffness_bound(void *self, const hk_view *view, hk_stiffness_part part, double (*block)[6]) {
  task t;
  if (part != HK_DAMPING_WHOLE) return;
  if (begin(&t, self, view) != HK_OK) {
    hk_sph_bound_unknown(view, block);
    return;
  }
  t.block = block;
  view->host->parallel_for(view->host, view->acting, HK_SPH_GRAIN, bound_chunk, &t);
}

static hk_status update(void *self, const hk_view *from, const double *x_to, bool *pattern_changed) {
  viscosity *p = self;
  return hk_sph_pairs_update(&p->common, p->pairs.number, from, x_to, pattern_changed);
}

/* ---- the plugin ---- */

static hk_status topology(void *self, const hk_view *view) {
  viscosity *p = self;
  p->pairs.number = 0;
  return hk_sph_topology(&p->common, view);
}

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  viscosity *p = self;
  if (!isnan(p->mu) == (p->viscosity_of != NULL))
    return host->fail(host, HK_BAD_PARAM,
                      "mu: there is %s: give `mu`, Pa s, or the label of a plugin that publishes one of each particle, "
                      "`viscosity_of`",
                      p->viscosity_of ? "one, and those of `viscosity_of`" : "none");
  hk_status status = HK_OK;
  for (size_t i = 0; i < view->n; i++) p->dissipation[i] = NAN;
  if (p->viscosity_of)
    status =
        hk_find_published(host, view->model, p->viscosity_of, "local_viscosity", "viscosity_of", true, &p->viscosities);
  return status == HK_OK ? hk_sph_open(&p->common, host, view) : status;
}

static const hk_force force = {
    .size = sizeof(hk_force),
    .flags = HK_DEPENDS_ON_X | HK_DEPENDS_ON_V | HK_POWER | HK_CONSERVES_MOMENTUM | HK_CONSERVES_ANGULAR_MOMENTUM |
             HK_OFFERS_SYMMETRIC | HK_PERIODIC,
    .add = add,
    .facets = HK_FACETS(HK_IMPLICIT_FACET(.pattern = pattern, .jacobian = jacobian),
                        HK_BOUNDS_FACET(.stiffness_bound = stiffness_bound), HK_STEPS_FACET(.update = update)),
};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_FORCE,
    .name = "viscosity",
    .summary = "viscosity of a liquid by particles, F_i = -2 mu V_i V_j (-W'/r)/M (v_ij.d) d between neighbours",
    .reference = "Monaghan 2005, Smoothed particle hydrodynamics, section 4.3; Espanol and Revenga 2003, equation 54",
    .instance_size = sizeof(viscosity),
    .params = params,
    .fields = fields,
    .create = create,
    .topology = topology,
    .force = &force,
};
