/* Drag in proportion to the velocity: F = -d v per particle, or F = -rate m v per mass. No energy; power -d v^2. */
#include "core/plugin.h"

typedef struct drag {
  double d, rate;
} drag;

static const hk_param params[] = {
    {"d",
     "N s/m",
     "drag coefficient of a particle, F = -d v",
     HK_NUMBER,
     {0},
     0,
     INFINITY,
     offsetof(drag, d),
     HK_OPTIONAL,
     NULL},
    {"rate", "1/s", "drag rate, F = -rate m v", HK_NUMBER, {0}, 0, INFINITY, offsetof(drag, rate), HK_OPTIONAL, NULL},
    {0},
};

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  (void)view;
  const drag *p = self;
  if (isnan(p->d) == isnan(p->rate))
    return host->fail(host, HK_BAD_PARAM, "give either d (N s/m, per particle) or rate (1/s, per mass)");
  return HK_OK;
}

static double coefficient(const drag *p, const hk_view *view, size_t i) {
  return isnan(p->d) ? p->rate * view->model->mass[i] : p->d;
}

enum { GRAIN = 4096, CHUNKS = 64 };

typedef struct task {
  const drag *self;
  const hk_view *view;
  double *F;
  double power[CHUNKS]; /* summed in the order of the chunks, whatever thread took them */
} task;

static void add_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  task *t = context;
  const hk_view *view = t->view;
  const double *restrict v = view->v, *restrict m = view->model->mass;
  double *restrict F = t->F, power = 0;
  bool per_mass = isnan(t->self->d);
  for (size_t k = begin; k < end; k++) {
    size_t i = view->active ? view->active[k] : k;
    double d = per_mass ? t->self->rate * m[i] : t->self->d;
    for (int c = 0; c < 3; c++) F[3 * i + c] -= d * v[3 * i + c];
    power -= d * (v[3 * i] * v[3 * i] + v[3 * i + 1] * v[3 * i + 1] + v[3 * i + 2] * v[3 * i + 2]);
  }
  t->power[chunk] = power;
}

static hk_status add(void *self, const hk_view *view, double *F) {
  task t;
  size_t grain = view->acting / CHUNKS + 1; /* never more than CHUNKS of them */
  if (grain < GRAIN) grain = GRAIN;
  t.self = self, t.view = view, t.F = F;
  view->host->parallel_for(view->host, view->acting, grain, add_chunk, &t);
  for (size_t c = 0; view->power && c * grain < view->acting; c++) *view->power += t.power[c];
  return HK_OK;
}

static void pattern(void *self, const hk_view *view, hk_pattern *p) {
  (void)self;
  for (size_t k = 0; k < view->acting; k++) {
    uint32_t i = view->active ? view->active[k] : (uint32_t)k;
    p->block(p, i, i);
  }
}

static hk_status jacobian(void *self, const hk_view *view, const hk_blocks *into) {
  for (size_t k = 0; k < view->acting; k++) {
    double *D = into->D + 9 * into->slot[k], d = coefficient(self, view, view->active ? view->active[k] : k);
    D[0] += d;
    D[4] += d;
    D[8] += d;
  }
  return HK_OK;
}

static const hk_force force = {
    .flags = HK_DEPENDS_ON_V | HK_SYMMETRIC_JACOBIAN | HK_POWER, .add = add, .pattern = pattern, .jacobian = jacobian};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_FORCE,
    .name = "drag",
    .summary = "linear drag, F = -d v or F = -rate m v",
    .reference = "",
    .instance_size = sizeof(drag),
    .params = params,
    .create = create,
    .force = &force,
};
