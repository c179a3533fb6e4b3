/* Heat between neighbouring particles of a liquid, a melt or a heap, of one substance that may melt: the channel of the
 * enthalpy changes by
 *     m_i dh_i/dt = sum over j of g_ij (theta_j - theta_i),   g_ij = 2 V_i V_j (-W'/r)/M,
 * with theta the integral of the conductivity over the temperature (plugins/common/heat/heat_law.h), V the volumes of
 * the particles and of walls, and W the kernel of liquids by particles (Cleary and Monaghan 1999, Conduction modelling
 * using smoothed particle hydrodynamics, J. Comput. Phys. 148, 227, equation 28, of which the mean of conductivities
 * is here in theta). M, the mean of (-W'/r) x^2 over the lattice (sph_kernel.h), makes the sums of pairs a Laplacian.
 * What one gives the other gets, so the sum of m h is kept to rounding by explicit methods. Walls keep their
 * temperature, which is that of their own enthalpy: they are heaters and coolers. Errors are of the order (k R)^2 at a
 * wavenumber k. It is no force: it adds nothing to F. */
#include "plugins/common/channels/no_force.h"
#include "plugins/common/heat/heat_channel.h"
#include "plugins/common/heat/heat_law.h"
#include "plugins/common/sph/sph_particles.h"

static const double safe = 0.9; /* of the step that is stable */

typedef struct particle_conduction {
  hk_sph common;
  hk_heat_channel heat;
  hk_heat_law law;
  double *temperature, *molten; /* n, K and part */
  double *potential;            /* n, W/m */
} particle_conduction;

static const hk_param params[] = {
    HK_HEAT_CHANNELS(particle_conduction, heat),
    HK_HEAT_CAPACITIES(particle_conduction, law),
    HK_HEAT_CONDUCTIVITIES(particle_conduction, law),
    HK_SPH_PARAMS(particle_conduction, common),
    {0},
};

static const hk_field fields[] = {
    HK_SPH_FIELDS(particle_conduction, common),
    {"temperature", .per_particle = HK_AT(particle_conduction, temperature), .width = 1, .flags = HK_PUBLISHED},
    {"molten", .per_particle = HK_AT(particle_conduction, molten), .width = 1, .flags = HK_PUBLISHED},
    {"potential", .per_particle = HK_AT(particle_conduction, potential), .width = 1, .flags = HK_SCRATCH},
    {0},
};

/* ---- rates ---- */

typedef struct task {
  particle_conduction *self;
  const hk_view *view;
  hk_neighbour_rows rows;
  double *dy;
} task;

static hk_status begin(task *t, particle_conduction *s, const hk_view *view) {
  const double *h = hk_enthalpy(&s->heat, view);
  *t = (task){.self = s, .view = view};
  for (size_t i = 0; i < view->n; i++) {
    s->temperature[i] = hk_heat_temperature(&s->law, h[i]);
    s->molten[i] = hk_heat_molten(&s->law, h[i]);
    s->potential[i] = hk_heat_potential(&s->law, h[i]);
  }
  return hk_sph_begin(&s->common, view, &t->rows);
}

/* W, what flows to particle i; *ways: m, the sum of its g. */
static double flow_to(const task *t, size_t i, double *ways) {
  const hk_sph *s = &t->self->common;
  const double *theta = t->self->potential;
  double by = 2 * s->point[i][3] / (s->density * s->density * s->kernel.second), heat = 0;
  hk_sph_near near;
  *ways = 0;
  for (size_t at = t->rows.row_start[i], end = t->rows.row_start[i + 1]; at < end;) {
    hk_sph_gather(s, t->view->model->box, t->rows.other, end, i, &at, &near);
    for (size_t k = 0; k < near.count; k++) {
      double g = by * near.mass[k] * hk_sph_slope(&s->kernel, near.r2[k]);
      heat += g * (theta[near.other[k]] - theta[i]);
      *ways += g;
    }
  }
  return heat;
}

static void rate_chunk(void *context, size_t first, size_t end, size_t chunk) {
  const task *t = context;
  const particle_conduction *s = t->self;
  double *to = t->dy + s->heat.enthalpy->offset * t->view->n, ways;
  (void)chunk;
  for (size_t k = first; k < end; k++) {
    size_t i = hk_sph_acting(t->view, k);
    if (s->common.role[i] == HK_SPH_NONE) continue;
    double heat = flow_to(t, i, &ways);
    if (s->common.role[i] == HK_SPH_LIQUID)
      to[i] += heat / t->view->model->mass[i];
    else if (s->heat.given && t->view->model->mass[i] > 0) /* a wall gives what the liquid gets */
      t->dy[s->heat.given->offset * t->view->n + i] -= heat / t->view->model->mass[i];
  }
}

static hk_status rates(void *self, const hk_view *view, double *dy) {
  task t;
  hk_status status = begin(&t, self, view);
  if (status != HK_OK) return status;
  t.dy = dy;
  view->host->parallel_for(view->host, view->acting, HK_SPH_GRAIN, rate_chunk, &t);
  return HK_OK;
}

/* ---- the step ---- */

static void ways_chunk(void *context, size_t first, size_t end, size_t chunk) {
  const task *t = context;
  double most = 0, ways;
  for (size_t k = first; k < end; k++) {
    size_t i = hk_sph_acting(t->view, k);
    if (t->self->common.role[i] != HK_SPH_LIQUID) continue;
    flow_to(t, i, &ways);
    most = fmax(most, ways / t->view->model->mass[i]);
  }
  t->self->common.sums[chunk] = most;
}

/* By the particle with the most neighbours, and the steepest phase, also where there is none of it yet. */
static double longest_step(void *self, const hk_view *view) {
  particle_conduction *s = self;
  task t;
  if (begin(&t, s, view) != HK_OK) return INFINITY; /* the evaluation that follows says why */
  view->host->parallel_for(view->host, view->acting, HK_SPH_GRAIN, ways_chunk, &t);
  double most = 0;
  for (size_t k = 0; k * HK_SPH_GRAIN < view->acting; k++) most = fmax(most, s->common.sums[k]);
  double rate = most * hk_heat_steepest_potential(&s->law);
  return rate > 0 ? safe / rate : INFINITY;
}

/* ---- the plugin ---- */

static hk_status update(void *self, const hk_view *from, const double *x_to, bool *pattern_changed) {
  (void)x_to, (void)pattern_changed;
  return hk_sph_update(&((particle_conduction *)self)->common, from);
}

static hk_status topology(void *self, const hk_view *view) {
  return hk_sph_topology(&((particle_conduction *)self)->common, view);
}

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  particle_conduction *s = self;
  hk_status status = hk_heat_law_check(&s->law, host);
  if (status == HK_OK) status = hk_heat_channel_find(&s->heat, host, view->model);
  s->common.takes_joined = true;
  return status == HK_OK ? hk_sph_open(&s->common, host, view) : status;
}

static const hk_force force = {
    .size = sizeof(hk_force),
    .flags = HK_DEPENDS_ON_X | HK_DEPENDS_ON_CHANNELS | HK_CONSERVES_MOMENTUM | HK_CONSERVES_ANGULAR_MOMENTUM |
             HK_SYMMETRIC_JACOBIAN | HK_PERIODIC,
    .add = hk_no_force,
    .energy = hk_no_energy,
    .rates = rates,
    .facets = HK_FACETS(HK_NO_BLOCKS, HK_BOUNDS_FACET(.longest_step = longest_step), HK_STEPS_FACET(.update = update)),
};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_FORCE,
    .name = "particle_conduction",
    .summary =
        "heat between neighbouring particles that may melt, m_i dh_i/dt = sum 2 V_i V_j (-W'/r)/M (theta_j - theta_i)",
    .reference = "Cleary and Monaghan 1999, Conduction modelling using smoothed particle hydrodynamics",
    .instance_size = sizeof(particle_conduction),
    .params = params,
    .fields = fields,
    .create = create,
    .topology = topology,
    .force = &force,
};
