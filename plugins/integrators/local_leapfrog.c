/* Leapfrog with short steps for stiff springs only. One long step h is leapfrog's (leapfrog.c), with the acceleration a
 * of all forces replaced by 2 (q(h) - x)/h^2,   q'' = a + M^-1 (F(q) - F(x)),   q(0) = x,   q'(0) = 0, where F are the
 * stiff springs alone and q is found by p short steps, which cost as much as these springs do. q is even in time, the
 * mean of the ways forwards and backwards, so that velocities are those of leapfrog, the mean over two steps. Order 2
 * and reversible; momentum is kept to rounding. No step is symplectic: 2 (q(h) - x)/h^2 is the gradient of an energy
 * only in other coordinates, and where stiff springs turn in none; with linear ones a quadratic form near the energy is
 * kept. The short steps are Chebyshev's with a shift of the stiff modes, without which long steps in resonance with a
 * stiff mode are unstable (local_filter.h); nothing is damped by that. Damping, also that of stiff springs, acts with
 * the predicted velocity v + h a once a long step.
 *
 * Which springs are stiff follows from stiffnesses and masses (stiff_edges.c): those for which short steps save work.
 * Springs whose own damping ratio is above 0.06 are not taken: damped once a long step, they would leave it no room.
 * Tried for them: explicit damping beyond that ratio, whose stable steps are no interval, so that shorter steps may
 * grow where longer ones do not; and the exponential of the damping for half a step before and after, with which 355 of
 * 3,000 random networks of springs grew, by up to 1.3 % a step, as it is no contraction in the form that a step keeps.
 * What is not plain edges (triangles, joints, contact) stays with the long step, whose length is what it allows. Where
 * nothing is worth short steps the method is leapfrog. */
#include "plugins/common/local/local_filter.h"
#include "plugins/common/local/short_steps.h"
#include "plugins/common/local/stiff_edges.h"
#include "plugins/kit/springs/edge_stiffness.h"
#include "plugins/kit/integrate/leap.h"
#include "plugins/kit/integrate/leapfrog_growth.h"

#include <string.h>

typedef struct local_leapfrog {
  int64_t primed; /* whether the slope is that of X */
  double *slope;  /* (a, dy) */
  hk_stiff_edges stiff;
  hk_short_steps part;
  hk_fast_subset fast;
  bool selected, looked; /* `stiff` is that of the topology; also of the present masses and forces */
  double *inverse_mass;  /* n, of the selection */
  bool *acts;            /* element lists, of the selection */
  size_t n, lists;
} local_leapfrog;

static const hk_field fields[] = {
    {"primed", .integer = HK_AT(local_leapfrog, primed)},
    {"slope", .state = HK_AT(local_leapfrog, slope), .width = 1},
    {0},
};

static double growth(const void *self, const void *method, double hw, double hg, double hb) {
  (void)self, (void)method;
  return hk_leapfrog_growth(hw, hg, hb);
}

/* Leapfrog's, of a mode for which stiff ones leave that much room: the limit is the true one for the worst of them. */
static double coupled_growth(const void *self, double h, double w, double g, double b) {
  const hk_short_steps *part = &((const local_leapfrog *)self)->part;
  double room = 1;
  for (size_t k = 0; k < part->parts; k++) room = fmin(room, hk_local_room(&part->part[k].modes, part->shift, h));
  if (!(room > 0)) return INFINITY;
  return hk_leapfrog_growth(h * w / sqrt(room), h * g / room, h * b / room);
}

/* ---- what is stiff ---- */

static void remove_forces(const void *self, const hk_system *s, const double *x, const double *v, double *a) {
  const hk_stiff_edges *stiff = &((const local_leapfrog *)self)->stiff;
  for (size_t e = 0; e < stiff->count; e++) {
    size_t i = stiff->pair[e][0], j = stiff->pair[e][1];
    double d[3], l2 = 0, along = 0;
    for (size_t c = 0; c < 3; c++) {
      d[c] = x[3 * j + c] - x[3 * i + c];
      l2 += d[c] * d[c];
      along += d[c] * (v[3 * j + c] - v[3 * i + c]);
    }
    double f = l2 > 0 ? stiff->k[e] * (1 - stiff->L[e] / sqrt(l2)) + stiff->c[e] * along / l2 : 0;
    for (size_t c = 0; c < 3; c++) {
      a[3 * i + c] -= s->model->inverse_mass[i] * f * d[c];
      a[3 * j + c] += s->model->inverse_mass[j] * f * d[c];
    }
  }
}

static void remove_bound(const void *self, const hk_system *s, hk_stiffness_part part, double (*block)[6]) {
  const hk_stiff_edges *stiff = &((const local_leapfrog *)self)->stiff;
  const hk_view view = {.x = s->X, .n = s->n, .model = s->model};
  for (size_t e = 0; e < stiff->count; e++) {
    const uint32_t *pair = stiff->pair[e];
    double n[3], l2 = 0, k = stiff->k[e];
    for (size_t c = 0; c < 3; c++) {
      n[c] = s->X[3 * (size_t)pair[1] + c] - s->X[3 * (size_t)pair[0] + c];
      l2 += n[c] * n[c];
    }
    double l = sqrt(l2), across = stiff->L[e] == 0 ? k : l > 0 ? fmax(0, k * (1 - stiff->L[e] / l)) : 0;
    for (size_t c = 0; c < 3; c++) n[c] = l > 0 ? n[c] / l : 0;
    double along = part == HK_DAMPING_WHOLE ? stiff->c[e] : part == HK_STIFFNESS_WHOLE ? k : 0;
    hk_edge_stiffness_add(&view, pair, n, -along, part == HK_DAMPING_WHOLE ? 0 : -across, block);
  }
}

static bool same(const local_leapfrog *m, const hk_model *model) {
  bool same = m->selected && m->n == model->n && m->lists == model->element_lists;
  for (size_t k = 0; same && k < m->lists; k++) same = m->acts[k] == model->element_list[k].acts;
  return same && memcmp(m->inverse_mass, model->inverse_mass, m->n * sizeof *m->inverse_mass) == 0;
}

static hk_status remember(local_leapfrog *m, const hk_host *host, const hk_model *model) {
  host->release(host, m->inverse_mass);
  host->release(host, m->acts);
  m->n = model->n;
  m->lists = model->element_lists;
  m->inverse_mass = host->allocate(host, (m->n + 1) * sizeof *m->inverse_mass);
  m->acts = host->allocate(host, m->lists + 1);
  if (!m->inverse_mass || !m->acts) return HK_NO_MEMORY;
  memcpy(m->inverse_mass, model->inverse_mass, m->n * sizeof *m->inverse_mass);
  for (size_t k = 0; k < m->lists; k++) m->acts[k] = model->element_list[k].acts;
  return HK_OK;
}

static hk_status select_fast(void *self, hk_system *s) {
  local_leapfrog *m = self;
  const hk_host *host = s->host;
  m->looked = true;
  if (same(m, s->model)) return HK_OK;
  m->selected = false; /* a slope from a checkpoint stays; where forces have changed, the host calls reset */
  s->split->fast = NULL;
  hk_status status = remember(m, host, s->model);
  if (status == HK_OK) status = hk_stiff_edges_choose(&m->stiff, host, s->model);
  if (status == HK_OK) status = hk_short_steps_build(&m->part, s, &m->stiff, s->spare);
  if (status != HK_OK) {
    hk_stiff_edges_free(&m->stiff, host);
    return host->fail(host, status, "no memory for the short steps of stiff springs");
  }
  m->selected = true;
  m->fast = (hk_fast_subset){m, remove_forces, remove_bound};
  if (m->stiff.count) s->split->fast = &m->fast;
  if (!m->stiff.count)
    host->warn(host, "short steps would save nothing here, so all steps are leapfrog's: no springs are few and stiff");
  return HK_OK;
}

static hk_status topology(void *self, const hk_view *view) {
  local_leapfrog *m = self;
  (void)view;
  m->selected = m->looked = false;
  return HK_OK;
}

static void reset(void *self, hk_reason why) {
  local_leapfrog *m = self;
  m->primed = 0;
  if (why == HK_PARTICLES_CHANGED || why == HK_STATE_CHANGED) m->looked = false;
}

/* ---- the step ---- */

static hk_status prime(local_leapfrog *m, hk_system *s, double h) {
  size_t v = 3 * s->n;
  hk_status status = m->looked ? HK_OK : select_fast(m, s);
  if (status != HK_OK) return status;
  if (!m->primed) {
    status = s->accelerations(s, s->t, s->X, s->X + v, s->X + 2 * v, m->slope, m->slope + v);
    if (status == HK_OK && m->stiff.count) hk_short_steps_take(&m->part, s->host, s->X, h, m->slope, NULL);
  }
  m->primed = 0; /* until the end of the step, which writes over the slope */
  return status;
}

static hk_status step(void *self, const void *method, hk_system *s, double t_stop, double h, hk_step *out) {
  local_leapfrog *m = self;
  size_t v = 3 * s->n, y = 6 * s->n;
  double *X = s->X, *next = s->spare, *a = m->slope;
  (void)method, (void)out;
  hk_status status = prime(m, s, h);
  if (status != HK_OK) return status;
  hk_leap l = {X, X + v, a, next, next + v, a, h, s->host->lanes};
  for (size_t e = y; e < s->size; e++) next[e] = X[e] + h * a[e - v];
  status = s->fused(s, fmin(t_stop, s->t + h), next, next + v, next + y, a, a + v,
                    &(hk_fused){&l, hk_leap_predict, hk_leap_kick});
  if (status != HK_OK) return status;
  if (m->stiff.count) hk_short_steps_take(&m->part, s->host, next, h, a, next + v);
  for (size_t e = y; e < s->size; e++) next[e] = 0.5 * (X[e] + next[e]) + h / 2 * a[e - v];
  s->exchange(s);
  m->primed = 1;
  return HK_OK;
}

static const hk_split_facet split = {
    .size = sizeof split, .select_fast = select_fast, .coupled_growth = coupled_growth};
static const hk_constrained_facet constrained = {
    .size = sizeof constrained, .refused = "its short steps know nothing of constraints: leapfrog keeps them"};
static const hk_facet facets[] = {{HK_SPLIT_ID, &split}, {HK_CONSTRAINED_ID, &constrained}, {0}};

static const hk_integrator integrator = {.size = sizeof(hk_integrator),
                                         .order = 2,
                                         .stages = 1,
                                         .flags = HK_REVERSIBLE | HK_USES_SPARE,
                                         .step = step,
                                         .reset = reset,
                                         .growth = growth,
                                         .facets = facets};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_INTEGRATOR,
    .name = "local_leapfrog",
    .summary = "leapfrog that takes the few stiff springs of a scene in short steps within each step; order 2",
    .reference = "Diaz and Grote, SIAM J. Sci. Comput. 31 (2009) 1985; Grote, Michel and Sauter, Math. Comp. 90 (2021) "
                 "2603, arXiv 2005.13350",
    .instance_size = sizeof(local_leapfrog),
    .fields = fields,
    .topology = topology,
    .integrator = &integrator,
};
