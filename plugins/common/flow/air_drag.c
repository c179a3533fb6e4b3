/* Drag towards moving air, block by block: the velocities of HK_AIR_BLOCK places are found together, so that a loop of
 * the air's own can use vectors, and stay in the cache until they are used. */
#include "plugins/common/flow/air_drag.h"

#include <string.h>

hk_status hk_air_check(const hk_air_drag *p, const hk_host *host) {
  if (isnan(p->d) == isnan(p->rate))
    return host->fail(host, HK_BAD_PARAM, "give either d (N s/m, per particle) or rate (1/s, per mass)");
  return HK_OK;
}

double hk_air_coefficient(const hk_air_drag *p, const hk_view *view, size_t i) {
  return isnan(p->d) ? p->rate * view->model->mass[i] : p->d;
}

/* ---- F ---- */

/* F += d (u - v) of `count` particles in a row; with `still` 1, or 0 where v is left to another force. The three
 * components have sums of their own, because additions to a single one would have to wait for each other. */
HK_INLINE double add_row(const hk_air_drag *p, const double *restrict m, const double *restrict u,
                         const double *restrict v, size_t count, double *restrict F) {
  const double each = isnan(p->d) ? 0 : p->d, by_mass = isnan(p->d) ? p->rate : 0, still = p->relative;
  double power[3] = {0};
  for (size_t i = 0; i < count; i++)
    for (size_t c = 0; c < 3; c++) {
      double f = (each + by_mass * m[i]) * (u[3 * i + c] - still * v[3 * i + c]);
      F[3 * i + c] += f;
      power[c] += f * v[3 * i + c];
    }
  return power[0] + power[1] + power[2];
}

HK_VERSIONS(static double, add_rows,
            (const hk_air_drag *p, const double *m, const double *u, const double *v, size_t count, double *F),
            return add_row(p, m, u, v, count, F))

/* Particles of a selection, which do not lie in a row. */
static double add_selected(const hk_air *air, const hk_view *view, size_t begin, size_t count, double *F) {
  double x[3 * HK_AIR_BLOCK], u[3 * HK_AIR_BLOCK], power = 0;
  for (size_t k = 0; k < count; k++) memcpy(x + 3 * k, view->x + 3 * (size_t)view->active[begin + k], 3 * sizeof *x);
  air->velocity(air->self, view->t, x, count, u);
  for (size_t k = 0; k < count; k++) {
    size_t i = view->active[begin + k];
    power += add_row(air->drag, view->model->mass + i, u + 3 * k, view->v + 3 * i, 1, F + 3 * i);
  }
  return power;
}

static double add_range(const void *context, const hk_view *view, size_t begin, size_t end, double *F) {
  const hk_air *air = context;
  double u[3 * HK_AIR_BLOCK], power = 0;
  for (size_t k = begin; k < end; k += HK_AIR_BLOCK) {
    size_t count = end - k < HK_AIR_BLOCK ? end - k : HK_AIR_BLOCK;
    if (view->active) {
      power += add_selected(air, view, k, count, F);
      continue;
    }
    air->velocity(air->self, view->t, view->x + 3 * k, count, u);
    power +=
        HK_WIDEST(view->host->lanes, add_rows)(air->drag, view->model->mass + k, u, view->v + 3 * k, count, F + 3 * k);
  }
  return power;
}

void hk_air_flow(const hk_air *air, double t, const double *x, size_t count, double *u) {
  for (size_t k = 0; k < count; k += HK_AIR_BLOCK)
    air->velocity(air->self, t, x + 3 * k, count - k < HK_AIR_BLOCK ? count - k : HK_AIR_BLOCK, u + 3 * k);
}

void hk_air_add(const hk_air *air, const hk_view *view, size_t part, double *F) {
  hk_particle_sums_add(view, part, add_range, air, F);
}

/* ---- -dF/dx = -d G, -dF/dv = d I ---- */

static uint32_t acting(const hk_view *view, size_t k) { return view->active ? view->active[k] : (uint32_t)k; }

void hk_air_pattern(const hk_view *view, hk_pattern *p) {
  for (size_t k = 0; k < view->acting; k++) p->block(p, acting(view, k), acting(view, k));
}

hk_status hk_air_jacobian(const hk_air *air, const hk_view *view, const hk_blocks *into) {
  for (size_t k = 0; k < view->acting; k++) {
    size_t i = acting(view, k);
    double *K = into->K + 9 * into->slot[k], *D = into->D + 9 * into->slot[k], G[9];
    double d = hk_air_coefficient(air->drag, view, i);
    for (int c = 0; c < 9 && air->drag->relative; c += 4) D[c] += d;
    if (!air->gradient) continue;
    air->gradient(air->self, view->t, view->x + 3 * i, G);
    for (int q = 0; q < 9; q++) K[q] -= d * G[q];
  }
  return HK_OK;
}
