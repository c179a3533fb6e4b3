/* From rest at x, with the acceleration a(q) = a + w (F(q) - F(x)), where F are the stiff springs alone and a is that
 * of all forces at x, the particles move by d_p in p steps, d_1 = g_0 a(x),   d_{k+1} = d_k + f_k (d_k - d_{k-1}) + g_k
 * a(x + d_k), f_k = T_{k-1}/T_{k+1},   g_k = 2 h^2 T_k/(omega T_{k+1}),   T_k = T_k(delta) = cosh(k s/p)
 * (local_filter.h) and 2 d_p/h^2 is the acceleration of the long step: a itself where no stiff spring acts. What moves
 * evenly from rest, forwards and backwards in time, has no velocity in it. The forces of every short step sum to zero,
 * so that momentum is kept to rounding. */
#include "plugins/common/local/short_steps.h"
#include "plugins/common/local/local_filter.h"

#include <string.h>

enum { GRAIN = 2048, ARRAYS = 6 };

typedef struct pass {
  hk_short_steps *s;
  double f, g;
} pass;

static void filter(const hk_short_steps *s, size_t i, double a[3]) {
  const double *P = s->projector[i], b[3] = {a[0], a[1], a[2]};
  for (int r = 0; r < 3; r++) a[r] = P[3 * r] * b[0] + P[3 * r + 1] * b[1] + P[3 * r + 2] * b[2];
}

/* One short step of the particles, with the forces F at q; F is cleared. */
static void advance(void *context, size_t begin, size_t end, size_t chunk) {
  const pass *p = context;
  const hk_short_steps *s = p->s;
  (void)chunk;
  for (size_t i = begin; i < end; i++) {
    double b[3], w = s->inverse_mass[i];
    for (size_t c = 0; c < 3; c++) b[c] = w * (s->F[3 * i + c] - s->F_start[3 * i + c]);
    if (s->projector) filter(s, i, b);
    for (size_t c = 0; c < 3; c++) {
      size_t e = 3 * i + c;
      s->change[e] = p->f * s->change[e] + p->g * (s->a[e] + b[c]);
      s->q[e] += s->change[e];
      s->F[e] = 0;
    }
  }
}

static void add_forces(hk_short_steps *s, const hk_host *host, double *F) {
  hk_spring_forces(&s->layout, host, s->q, s->q, F, NULL);
}

static void gather(hk_short_steps *s, const double *x, const double *a) {
  for (size_t i = 0; i < s->n; i++) {
    size_t from = 3 * (size_t)s->index[i];
    memcpy(s->x + 3 * i, x + from, 3 * sizeof *x);
    memcpy(s->a + 3 * i, a + from, 3 * sizeof *a);
  }
  memcpy(s->q, s->x, 3 * s->n * sizeof *s->q);
  memset(s->change, 0, 3 * s->n * sizeof *s->change);
  memset(s->F_start, 0, 3 * s->n * sizeof *s->F_start);
  memset(s->F, 0, 3 * s->n * sizeof *s->F);
}

void hk_short_steps_take(hk_short_steps *s, const hk_host *host, const double *x, double h, int p, double *a) {
  double delta = hk_local_delta(p), scale = 2 * h * h / hk_local_omega(p), before = delta, T = 1;
  gather(s, x, a);
  add_forces(s, host, s->F_start);
  memcpy(s->F, s->F_start, 3 * s->n * sizeof *s->F);
  for (int k = 0; k < p; k++) { /* T_{-1} = T_1; the first step is half of the rule, as d is even */
    double next = k == 0 ? delta : 2 * delta * T - before;
    pass step = {s, k == 0 ? 0 : before / next, (k == 0 ? 0.5 : 1) * scale * T / next};
    if (k > 0) add_forces(s, host, s->F);
    host->parallel_for(host, s->n, GRAIN, advance, &step);
    before = T;
    T = next;
  }
  for (size_t i = 0; i < s->n; i++)
    for (size_t c = 0; c < 3; c++) a[3 * (size_t)s->index[i] + c] = 2 / (h * h) * (s->q[3 * i + c] - s->x[3 * i + c]);
}

/* ---- building ---- */

static hk_status number_particles(hk_short_steps *s, const hk_host *host, const hk_model *model,
                                  const hk_stiff_edges *edges, uint32_t *place) {
  for (size_t i = 0; i < model->n; i++) place[i] = UINT32_MAX;
  for (size_t e = 0; e < edges->count; e++) place[edges->pair[e][0]] = place[edges->pair[e][1]] = 0;
  for (size_t i = 0; i < model->n; i++)
    if (place[i] == 0) place[i] = (uint32_t)s->n++;
  s->index = host->allocate(host, (s->n + 1) * sizeof *s->index);
  s->inverse_mass = host->allocate(host, (s->n + 1) * sizeof *s->inverse_mass);
  s->memory = host->allocate(host, (ARRAYS * 3 * s->n + 1) * sizeof *s->memory);
  if (!s->index || !s->inverse_mass || !s->memory) return HK_NO_MEMORY;
  double **array[ARRAYS] = {&s->x, &s->q, &s->change, &s->a, &s->F_start, &s->F};
  for (size_t k = 0; k < ARRAYS; k++) *array[k] = s->memory + 3 * s->n * k;
  for (size_t i = 0; i < model->n; i++) {
    if (place[i] == UINT32_MAX) continue;
    s->index[place[i]] = (uint32_t)i;
    s->inverse_mass[place[i]] = model->inverse_mass[i];
  }
  return HK_OK;
}

static hk_status lay_out(hk_short_steps *s, const hk_host *host, const hk_stiff_edges *edges, const uint32_t *place) {
  uint32_t(*pair)[2] = host->allocate(host, edges->count * sizeof *pair);
  double none = 0;
  if (!pair) return HK_NO_MEMORY;
  for (size_t e = 0; e < edges->count; e++)
    for (int end = 0; end < 2; end++) pair[e][end] = place[edges->pair[e][end]];
  const hk_tuples list = {edges->count, 2, &pair[0][0]};
  const hk_per_tuple k = {edges->count, edges->k}, c = {1, &none}, L = {edges->count, edges->L};
  hk_status status = hk_spring_layout_build(&s->layout, host, s->n, &list, &k, &c, &L, NULL);
  host->release(host, pair);
  return status;
}

/* The projector of a sliding particle has as columns what `filter` leaves of the unit vectors. */
static hk_status read_projectors(hk_short_steps *s, hk_system *system, double *scratch) {
  const hk_model *model = system->model;
  bool any = false;
  for (size_t i = 0; i < s->n; i++)
    any |= model->pin[s->index[i]] == HK_PIN_LINE || model->pin[s->index[i]] == HK_PIN_PLANE;
  if (!any) return HK_OK;
  s->projector = system->host->allocate(system->host, s->n * sizeof *s->projector);
  if (!s->projector) return HK_NO_MEMORY;
  for (size_t c = 0; c < 3; c++) {
    for (size_t e = 0; e < 3 * model->n; e++) scratch[e] = e % 3 == c;
    system->filter(system, scratch);
    for (size_t i = 0; i < s->n; i++)
      for (size_t r = 0; r < 3; r++) s->projector[i][3 * r + c] = scratch[3 * (size_t)s->index[i] + r];
  }
  return HK_OK;
}

hk_status hk_short_steps_build(hk_short_steps *s, hk_system *system, const hk_stiff_edges *edges, double *scratch) {
  const hk_host *host = system->host;
  hk_short_steps_free(s, host);
  if (edges->count == 0) return HK_OK;
  uint32_t *place = host->allocate(host, system->model->n * sizeof *place);
  if (!place) return HK_NO_MEMORY;
  hk_status status = number_particles(s, host, system->model, edges, place);
  if (status == HK_OK) status = lay_out(s, host, edges, place);
  if (status == HK_OK) status = read_projectors(s, system, scratch);
  host->release(host, place);
  return status;
}

void hk_short_steps_free(hk_short_steps *s, const hk_host *host) {
  hk_spring_layout_free(&s->layout, host);
  host->release(host, s->index);
  host->release(host, s->inverse_mass);
  host->release(host, s->projector);
  host->release(host, s->memory);
  *s = (hk_short_steps){0};
}
