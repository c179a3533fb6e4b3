/* Surface tension of a liquid by particles, from an energy of cohesion of all pairs within one and a half kernels,
 *     E = sum over pairs of s V_i V_j phi(r),   F_i = sum_j s V_i V_j (-phi'/r) (x_i - x_j)
 * (sph_cohesion.h has phi, by which a free surface has the energy `tension` an area). V is the volume at rest.
 * Momentum, angular momentum and energy are kept, surfaces need not be found, and drops part and meet by themselves. Of
 * pairs of liquid and wall s = (1 + cos angle)/2, which makes `angle` the angle of contact (Young and Dupre: the work
 * of adhesion is tension (1 + cos angle)) at walls as thick as that.
 *
 * The force `sph` beside it keeps the density against an inner pressure of tension/spacing, which presses a liquid by
 * a percent with c = 10 sqrt(tension/(density spacing)). What the surface's own layers rearrange is not in the sums
 * over the lattice, and a liquid on its lattice resists until it has been stirred: drops of 8 to 16 particles on the
 * radius become round and keep their area to 2.5 %, but their swings are up to a quarter too fast and die down within
 * some periods. The tension of the corrector `liquid`, on a grid, has Rayleigh's frequency to 2 %. */
#include "plugins/common/sph/sph_cohesion.h"
#include "plugins/common/sph/sph_pairs.h"
#include "plugins/kit/vector3.h"

typedef struct surface_tension {
  hk_sph common;
  double tension, angle;
  double adhesion; /* s of liquid and wall */
  hk_sph_cohesion cohesion;
  hk_sph_pairs pairs;
} surface_tension;

static const hk_param params[] = {
    {"tension", "N/m", "surface tension; of water 0.072", .number = HK_AT(surface_tension, tension),
     .limits = HK_AT_LEAST(0), .flags = HK_REQUIRED},
    {"angle", "deg", "of contact with walls: 0: they are wetted, 180: they repel",
     .number = HK_AT(surface_tension, angle), .initial = {90}, .limits = HK_WITHIN(0, 180)},
    HK_SPH_PARAMS(surface_tension, common),
    {0},
};

static const hk_field fields[] = {
    HK_SPH_FIELDS(surface_tension, common),
    {0},
};

typedef struct task {
  surface_tension *self;
  const hk_view *view;
  hk_neighbour_rows rows;
  const hk_periodic_box *box;
  double *F;
  double (*block)[6];
} task;

static hk_status begin(task *t, surface_tension *p, const hk_view *view) {
  *t = (task){.self = p, .view = view, .box = view->model->box};
  return hk_sph_begin(&p->common, view, &t->rows);
}

/* m^6: s V_i V_j, of a pair */
HK_INLINE double strength(const surface_tension *p, size_t i, size_t j) {
  int walls = (p->common.role[i] == HK_SPH_WALL) + (p->common.role[j] == HK_SPH_WALL);
  double by = walls == 0 ? 1 : walls == 1 ? p->adhesion : 0;
  return by * hk_sph_volume(&p->common, i) * hk_sph_volume(&p->common, j);
}

/* ---- force and energy ---- */

static void add_row(const task *t, size_t i) {
  const surface_tension *p = t->self;
  double sum[3] = {0};
  hk_sph_near near;
  for (size_t at = t->rows.row_start[i], end = t->rows.row_start[i + 1]; at < end;) {
    hk_sph_gather(&p->common, t->box, t->rows.other, end, i, &at, &near);
    for (size_t k = 0; k < near.count; k++) {
      double f = strength(p, i, near.other[k]) * hk_sph_cohesion_slope(&p->cohesion, near.r2[k]);
      for (int c = 0; c < 3; c++) sum[c] += f * near.d[c][k];
    }
  }
  hk_add_scaled(t->F + 3 * i, 1, sum);
}

static void add_chunk(void *context, size_t first, size_t end, size_t chunk) {
  const task *t = context;
  (void)chunk;
  for (size_t k = first; k < end; k++) {
    size_t i = hk_sph_acting(t->view, k);
    if (t->self->common.role[i] != HK_SPH_NONE) add_row(t, i);
  }
}

static hk_status add(void *self, const hk_view *view, double *F) {
  task t;
  hk_status status = begin(&t, self, view);
  if (status != HK_OK) return status;
  t.F = F;
  view->host->parallel_for(view->host, view->acting, HK_SPH_GRAIN, add_chunk, &t);
  return HK_OK;
}

/* Half of each pair at each end. */
static void energy_chunk(void *context, size_t first, size_t end, size_t chunk) {
  const task *t = context;
  const surface_tension *p = t->self;
  double sum = 0;
  hk_sph_near near;
  for (size_t m = first; m < end; m++) {
    size_t i = hk_sph_acting(t->view, m);
    for (size_t at = t->rows.row_start[i], last = t->rows.row_start[i + 1]; at < last;) {
      hk_sph_gather(&p->common, t->box, t->rows.other, last, i, &at, &near);
      for (size_t k = 0; k < near.count; k++)
        sum += strength(p, i, near.other[k]) * hk_sph_cohesion_energy(&p->cohesion, near.r2[k]) / 2;
    }
  }
  p->common.sums[chunk] = sum;
}

static double energy(void *self, const hk_view *view) {
  task t;
  if (begin(&t, self, view) != HK_OK) return NAN;
  view->host->parallel_for(view->host, view->acting, HK_SPH_GRAIN, energy_chunk, &t);
  return hk_sph_total(&t.self->common, view);
}

/* ---- implicit methods ---- */

static bool attract(const void *self, size_t i, size_t j) { return strength(self, i, j) > 0; }

static void pattern(void *self, const hk_view *view, hk_pattern *into) {
  surface_tension *p = self;
  hk_sph_pairs_name(&p->pairs, &p->common, view, attract, p, into);
}

/* N/m: of a pair's energy, or with `definite` its part above 0, of which there is none where the pair pushes. */
static void hessian(const surface_tension *p, double by, const double d[3], double r2, bool definite, double H[9]) {
  double along = by * hk_sph_cohesion_curvature(&p->cohesion, r2),
         across = -by * hk_sph_cohesion_slope(&p->cohesion, r2);
  if (definite) along = fmax(0, along), across = fmax(0, across);
  hk_sph_pair_hessian(along, across, d, r2, H);
}

static hk_status jacobian(void *self, const hk_view *view, const hk_blocks *into) {
  surface_tension *p = self;
  const size_t *slot = into->slot;
  if (p->pairs.failed != HK_OK) return p->pairs.failed;
  for (size_t k = 0; k < p->pairs.count; k++, slot += 4) {
    size_t i = p->pairs.pair[k][0], j = p->pairs.pair[k][1];
    double d[3], H[9], r2 = hk_sph_between(view, i, j, d);
    if (!(r2 < p->common.kernel.radius2)) continue;
    hessian(p, strength(p, i, j), d, r2, false, H);
    hk_sph_pair_add(into->K, slot, H);
  }
  return HK_OK;
}

/* ---- the step ---- */

/* (u_i - u_j).H (u_i - u_j) <= 2 u_i.P u_i + 2 u_j.P u_j with the part P of H above 0. */
static void bound_chunk(void *context, size_t first, size_t end, size_t chunk) {
  const task *t = context;
  hk_sph_near near;
  (void)chunk;
  for (size_t m = first; m < end; m++) {
    size_t i = hk_sph_acting(t->view, m);
    for (size_t at = t->rows.row_start[i], last = t->rows.row_start[i + 1]; at < last;) {
      hk_sph_gather(&t->self->common, t->box, t->rows.other, last, i, &at, &near);
      for (size_t k = 0; k < near.count; k++) {
        const double d[3] = {near.d[0][k], near.d[1][k], near.d[2][k]};
        double H[9];
        hessian(t->self, 2 * strength(t->self, i, near.other[k]), d, near.r2[k], true, H);
        for (int a = 0, q = 0; a < 3; a++)
          for (int b = a; b < 3; b++, q++) t->block[i][q] += H[3 * a + b];
      }
    }
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
  view->host->parallel_for(view->host, view->acting, HK_SPH_GRAIN, bound_chunk, &t);
}

static hk_status update(void *self, const hk_view *from, const double *x_to, bool *pattern_changed) {
  surface_tension *p = self;
  return hk_sph_pairs_update(&p->common, p->pairs.number, from, x_to, pattern_changed);
}

/* ---- the plugin ---- */

static hk_status topology(void *self, const hk_view *view) {
  surface_tension *p = self;
  p->pairs.number = 0;
  return hk_sph_topology(&p->common, view);
}

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  surface_tension *p = self;
  const double degree = 3.14159265358979323846 / 180;
  p->adhesion = (1 + cos(p->angle * degree)) / 2;
  hk_sph_cohesion_prepare(&p->cohesion, p->common.spacing, p->common.reach, (int)p->common.dimensions, p->tension);
  p->common.reach *= HK_SPH_COHESION_WIDER; /* rows, and volumes of walls */
  return hk_sph_open(&p->common, host, view);
}

static const hk_force force = {
    .size = sizeof(hk_force),
    .flags = HK_DEPENDS_ON_X | HK_CONSERVES_MOMENTUM | HK_CONSERVES_ANGULAR_MOMENTUM | HK_STIFFENS |
             HK_SYMMETRIC_JACOBIAN | HK_PERIODIC,
    .add = add,
    .energy = energy,
    .facets = HK_FACETS(HK_IMPLICIT_FACET(.pattern = pattern, .jacobian = jacobian),
                        HK_BOUNDS_FACET(.stiffness_bound = stiffness_bound), HK_STEPS_FACET(.update = update)),
};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_FORCE,
    .name = "surface_tension",
    .summary = "surface tension of a liquid by particles, from an energy of cohesion between neighbours",
    .reference = "Tartakovsky and Panchenko 2016, Pairwise force smoothed particle hydrodynamics model, section 3; "
                 "Fowler 1937, A tentative statistical theory of Macleod's equation for surface tension",
    .instance_size = sizeof(surface_tension),
    .params = params,
    .fields = fields,
    .create = create,
    .topology = topology,
    .force = &force,
};
