/* Uniform gravity, F = m g; energy -m g.x. Any direction is allowed, such as upwards for smoke. */
#include "core/plugin.h"

typedef struct gravity {
  double g[3];
} gravity;

static const hk_param params[] = {
    {"g", "m/s^2", "acceleration", HK_VECTOR, {0, 0, -9.81}, 0, 0, offsetof(gravity, g), HK_TIMED, NULL},
    {0},
};

typedef struct task {
  const gravity *self;
  const hk_view *view;
  double *F;
} task;

/* On the particles begin to end - 1 of those that it acts on. */
static void add_range(const gravity *s, const hk_view *view, size_t begin, size_t end, double *restrict F) {
  const double *restrict m = view->model->mass;
  double gx = s->g[0], gy = s->g[1], gz = s->g[2];
  const uint32_t *active = view->active;
  for (size_t k = begin; k < end; k++) {
    size_t i = active ? active[k] : k;
    F[3 * i] += m[i] * gx;
    F[3 * i + 1] += m[i] * gy;
    F[3 * i + 2] += m[i] * gz;
  }
}

static void add_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  (void)chunk;
  const task *t = context;
  add_range(t->self, t->view, begin, end, t->F);
}

static hk_status add(void *self, const hk_view *view, double *F) {
  task t = {self, view, F};
  view->host->parallel_for(view->host, view->acting, 4096, add_chunk, &t);
  return HK_OK;
}

static void add_part(void *self, const hk_view *view, size_t part, double *F) {
  size_t begin, end;
  hk_part_acting(view, part, &begin, &end);
  add_range(self, view, begin, end, F);
}

static double energy(void *self, const hk_view *view) {
  const gravity *g = self;
  double sum = 0;
  for (size_t k = 0; k < view->acting; k++) {
    size_t i = view->active ? view->active[k] : k;
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

static const hk_force force = {.size = sizeof(hk_force),
                               .flags = HK_SYMMETRIC_JACOBIAN,
                               .add = add,
                               .energy = energy,
                               .pattern = pattern,
                               .jacobian = jacobian,
                               .add_part = add_part};

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
