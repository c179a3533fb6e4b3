/* Uniform gravity, F = m g; energy -m g.x. Any direction is allowed, such as upwards for smoke. */
#include "plugins/kit/parts/scaled_sums.h"

typedef struct gravity {
  double g[3];
} gravity;

static const hk_param params[] = {
    {"g", "m/s^2", "acceleration", .vector = HK_AT(gravity, g), .initial = {0, 0, -9.81}, .flags = HK_TIMED},
    {0},
};

static double push(const void *self, const hk_view *view, size_t begin, size_t end, double *F) {
  const gravity *s = self;
  const hk_scaled weight = {.times = 1, .by = view->model->mass, .common = {s->g[0], s->g[1], s->g[2]}};
  return hk_scaled_sums_add(&weight, view, begin, end, F); /* 0: of the conservative force no power is counted */
}

static hk_status add(void *self, const hk_view *view, double *F) {
  hk_particle_sums_add(view, HK_ALL_PARTS, push, self, F);
  return HK_OK;
}

static void add_part(void *self, const hk_view *view, size_t part, double *F) {
  hk_particle_sums_add(view, part, push, self, F);
}

static double energy(void *self, const hk_view *view) {
  const gravity *g = self;
  double sum = 0;
  for (size_t k = 0; k < view->acting; k++) {
    size_t i = hk_acting_particle(view, k);
    const double *x = view->x + 3 * i;
    sum -= view->model->mass[i] * (g->g[0] * x[0] + g->g[1] * x[1] + g->g[2] * x[2]);
  }
  return sum;
}

static void pattern(void *self, const hk_view *view, hk_pattern *p) { (void)self, (void)view, (void)p; }

static hk_status jacobian(void *self, const hk_view *view, const hk_blocks *into) {
  (void)self, (void)view, (void)into; /* the force is constant: no blocks */
  return HK_OK;
}

static hk_status transposed(void *self, const hk_view *view, const double *u, const hk_transposed *into) {
  const gravity *s = self;
  for (size_t k = 0; into->parameter && k < view->acting; k++) {
    size_t i = hk_acting_particle(view, k);
    for (size_t c = 0; c < 3; c++) {
      into->parameter[0][c] += view->model->mass[i] * u[3 * i + c];
      into->mass[i] += s->g[c] * u[3 * i + c];
    }
  }
  return HK_OK;
}

static hk_status along(void *self, const hk_view *view, const hk_tangent *directions, size_t count) {
  const gravity *s = self;
  for (const hk_tangent *t = directions; t < directions + count; t++) {
    const double *g = t->parameter ? t->parameter[0] : NULL;
    for (size_t k = 0; (g || t->mass) && k < view->acting; k++) {
      size_t i = hk_acting_particle(view, k);
      for (size_t c = 0; c < 3; c++)
        t->force[3 * i + c] += (g ? view->model->mass[i] * g[c] : 0) + (t->mass ? t->mass[i] * s->g[c] : 0);
    }
  }
  return HK_OK;
}

static const hk_force force = {
    .size = sizeof(hk_force),
    .flags = HK_SYMMETRIC_JACOBIAN,
    .add = add,
    .add_part = add_part,
    .energy = energy,
    .facets = HK_FACETS(
        HK_IMPLICIT_FACET(.pattern = pattern, .jacobian = jacobian, .transposed = transposed, .along = along)),
};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_FORCE,
    .name = "gravity",
    .summary = "uniform gravity, F = m g",
    .reference = "",
    .instance_size = sizeof(gravity),
    .params = params,
    .force = &force,
};
