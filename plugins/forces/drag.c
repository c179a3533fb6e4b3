/* Drag in proportion to the velocity: F = -d v per particle, F = -rate m v per mass, or, on a small sphere in a viscous
 * fluid, Stokes' law F = -6 pi viscosity r v, with r of the particle's channel 'radius' or one for all (Stokes 1851;
 * Reynolds numbers below 1). No energy; power -d v^2. */
#include "plugins/common/channels/find_channel.h"
#include "plugins/kit/parts/scaled_sums.h"

typedef struct drag {
  double d, rate, viscosity, radius;
  const hk_channel *channel; /* of radii; NULL: none is read */
} drag;

static const double six_pi = 18.84955592153876;

static const hk_param params[] = {
    {"d", "N s/m", "drag coefficient of a particle, F = -d v", .number = HK_AT(drag, d), .limits = HK_AT_LEAST(0),
     .flags = HK_OPTIONAL},
    {"rate", "1/s", "drag rate, F = -rate m v", .number = HK_AT(drag, rate), .limits = HK_AT_LEAST(0),
     .flags = HK_OPTIONAL},
    {"viscosity", "Pa s", "of the fluid, F = -6 pi viscosity radius v; of air 1.8e-5, of water 1e-3",
     .number = HK_AT(drag, viscosity), .limits = HK_AT_LEAST(0), .flags = HK_OPTIONAL},
    {"radius", "m", "of all particles; left out: their channel 'radius'", .number = HK_AT(drag, radius),
     .limits = HK_AT_LEAST(0), .flags = HK_OPTIONAL},
    {0},
};

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  drag *p = self;
  if (isnan(p->d) + isnan(p->rate) + isnan(p->viscosity) != 2)
    return host->fail(host, HK_BAD_PARAM,
                      "give either d (N s/m, per particle), rate (1/s, per mass) or viscosity (Pa s, by radius)");
  if (isnan(p->viscosity))
    return isnan(p->radius) ? HK_OK : host->fail(host, HK_BAD_PARAM, "radius: it is for viscosity, which is not given");
  if (isnan(p->radius)) return hk_find_channel(host, view->model, "radius", "viscosity", 1, &p->channel);
  p->d = six_pi * p->viscosity * p->radius;
  return HK_OK;
}

static double coefficient(const drag *p, const hk_view *view, size_t i) {
  if (p->channel) return six_pi * p->viscosity * view->y[p->channel->offset * view->n + i];
  return isnan(p->d) ? p->rate * view->model->mass[i] : p->d;
}

enum { GRAIN = 4096 }; /* of a Jacobian */

static double push(const void *self, const hk_view *view, size_t begin, size_t end, double *F) {
  const drag *p = self;
  hk_scaled f = {.by = view->model->mass, .u = view->v};
  if (p->channel)
    f.by = view->y + p->channel->offset * view->n, f.times = -six_pi * p->viscosity;
  else if (isnan(p->d))
    f.times = -p->rate;
  else
    f.each = -p->d;
  return hk_scaled_sums_add(&f, view, begin, end, F);
}

static hk_status add(void *self, const hk_view *view, double *F) {
  hk_particle_sums_add(view, HK_ALL_PARTS, push, self, F);
  return HK_OK;
}

static void add_part(void *self, const hk_view *view, size_t part, double *F) {
  hk_particle_sums_add(view, part, push, self, F);
}

static void pattern(void *self, const hk_view *view, hk_pattern *p) {
  (void)self;
  for (size_t k = 0; k < view->acting; k++) {
    uint32_t i = view->active ? view->active[k] : (uint32_t)k;
    p->block(p, i, i);
  }
}

typedef struct damping {
  const void *self;
  const hk_view *view;
  const hk_blocks *into;
} damping;

static void add_damping(void *context, size_t begin, size_t end, size_t chunk) {
  const damping *t = context;
  const uint32_t *active = t->view->active;
  (void)chunk;
  for (size_t k = begin; k < end; k++) {
    double *D = t->into->D + 9 * t->into->slot[k], d = coefficient(t->self, t->view, active ? active[k] : k);
    D[0] += d;
    D[4] += d;
    D[8] += d;
  }
}

/* Every particle has a block of its own. */
static hk_status jacobian(void *self, const hk_view *view, const hk_blocks *into) {
  damping t = {self, view, into};
  view->host->parallel_for(view->host, view->acting, GRAIN, add_damping, &t);
  return HK_OK;
}

enum { EACH, RATE, VISCOSITY }; /* rows of the table */

/* By what F has in proportion to -v, from which the coefficient of particle i is made. */
static void add_slopes(const drag *p, const hk_view *view, size_t i, double uv, const hk_transposed *into) {
  if (p->channel)
    into->parameter[VISCOSITY][0] -= six_pi * view->y[p->channel->offset * view->n + i] * uv;
  else if (isnan(p->d)) {
    into->parameter[RATE][0] -= view->model->mass[i] * uv;
    into->mass[i] -= p->rate * uv;
  } else
    into->parameter[EACH][0] -= uv;
}

static hk_status transposed(void *self, const hk_view *view, const double *u, const hk_transposed *into) {
  for (size_t k = 0; k < view->acting; k++) {
    size_t i = hk_acting_particle(view, k);
    double d = coefficient(self, view, i), uv = 0;
    for (size_t c = 3 * i; c < 3 * i + 3; c++) {
      into->v[c] -= d * u[c];
      uv += u[c] * view->v[c];
    }
    if (into->parameter) add_slopes(self, view, i, uv, into);
  }
  return HK_OK;
}

static double change_of(const hk_tangent *t, int row) {
  return t->parameter && t->parameter[row] ? t->parameter[row][0] : 0;
}

/* How the coefficient of particle i changes. */
static double coefficient_along(const drag *p, const hk_view *view, const hk_tangent *t, size_t i) {
  if (p->channel) return six_pi * change_of(t, VISCOSITY) * view->y[p->channel->offset * view->n + i];
  if (!isnan(p->d)) return change_of(t, EACH);
  return change_of(t, RATE) * view->model->mass[i] + (t->mass ? p->rate * t->mass[i] : 0);
}

static hk_status along(void *self, const hk_view *view, const hk_tangent *directions, size_t count) {
  for (const hk_tangent *t = directions; t < directions + count; t++)
    for (size_t k = 0; k < view->acting; k++) {
      size_t i = hk_acting_particle(view, k);
      double d = coefficient(self, view, i), change = coefficient_along(self, view, t, i);
      for (size_t c = 3 * i; c < 3 * i + 3; c++) t->force[c] -= d * t->v[c] + change * view->v[c];
    }
  return HK_OK;
}

/* D is the coefficient of each particle. */
static void stiffness_bound(void *self, const hk_view *view, hk_stiffness_part part, double (*block)[6]) {
  for (size_t k = 0; part == HK_DAMPING_WHOLE && k < view->acting; k++) {
    size_t i = view->active ? view->active[k] : k;
    double d = coefficient(self, view, i);
    block[i][0] += d, block[i][3] += d, block[i][5] += d;
  }
}

static const hk_force force = {
    .size = sizeof(hk_force),
    .flags = HK_DEPENDS_ON_V | HK_DEPENDS_ON_CHANNELS | HK_SYMMETRIC_JACOBIAN | HK_POWER,
    .add = add,
    .add_part = add_part,
    .facets =
        HK_FACETS(HK_IMPLICIT_FACET(.pattern = pattern, .jacobian = jacobian, .transposed = transposed, .along = along),
                  HK_BOUNDS_FACET(.stiffness_bound = stiffness_bound)),
};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_FORCE,
    .name = "drag",
    .summary = "linear drag, F = -d v, F = -rate m v or, by radius, F = -6 pi viscosity r v",
    .reference = "Stokes, On the effect of the internal friction of fluids on the motion of pendulums, 1851",
    .instance_size = sizeof(drag),
    .params = params,
    .create = create,
    .force = &force,
};
