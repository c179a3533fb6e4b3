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

enum { GRAIN = 4096, CHUNKS = 64, LANES = 4 };

typedef struct task {
  const drag *self;
  const hk_view *view;
  double *F;
  double power[CHUNKS]; /* summed in the order of the chunks, for any number of threads */
} task;

static double add_one(const drag *p, const hk_view *view, size_t i, double *restrict F) {
  const double *v = view->v + 3 * i, d = coefficient(p, view, i);
  for (int c = 0; c < 3; c++) F[3 * i + c] -= d * v[c];
  return -d * (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

/* Four particles at a time, with a separate sum for each component: additions to a single sum would have to wait for
 * each other. */
static inline __attribute__((always_inline)) double add_fours(const drag *p, const hk_view *view, size_t begin,
                                                              size_t end, double *restrict F) {
  const double *restrict m = view->model->mass, each = isnan(p->d) ? 0 : p->d, by_mass = isnan(p->d) ? p->rate : 0;
  double power[3 * LANES] = {0}, sum = 0;
  for (size_t i = begin; i < end; i += LANES) {
    const double *restrict v = view->v + 3 * i;
    double d[3 * LANES];
    for (size_t l = 0; l < 3 * LANES; l++) d[l] = each + by_mass * m[i + l / 3];
    double *restrict into = F + 3 * i;
    for (size_t l = 0; l < 3 * LANES; l++) {
      double f = d[l] * v[l];
      into[l] -= f;
      power[l] -= f * v[l];
    }
  }
  for (size_t l = 0; l < 3 * LANES; l++) sum += power[l];
  return sum;
}

static double add_narrow(const drag *p, const hk_view *view, size_t begin, size_t end, double *F) {
  return add_fours(p, view, begin, end, F);
}

#if defined(__x86_64__)
__attribute__((target("avx2"))) static double add_wide(const drag *p, const hk_view *view, size_t begin, size_t end,
                                                       double *F) {
  return add_fours(p, view, begin, end, F);
}
#define ADD_FOURS (__builtin_cpu_supports("avx2") ? add_wide : add_narrow)
#else
#define ADD_FOURS add_narrow
#endif

static void add_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  task *t = context;
  const hk_view *view = t->view;
  size_t fours = view->active ? begin : end - (end - begin) % LANES;
  double power = ADD_FOURS(t->self, view, begin, fours, t->F);
  for (size_t k = fours; k < end; k++) power += add_one(t->self, view, view->active ? view->active[k] : k, t->F);
  t->power[chunk] = power;
}

static hk_status add(void *self, const hk_view *view, double *F) {
  task t;
  size_t grain = view->acting / CHUNKS + 1; /* at most CHUNKS chunks */
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

static const hk_force force = {.size = sizeof(hk_force),
                               .flags = HK_DEPENDS_ON_V | HK_SYMMETRIC_JACOBIAN | HK_POWER,
                               .add = add,
                               .pattern = pattern,
                               .jacobian = jacobian};

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
