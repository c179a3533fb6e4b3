/* The arrays of bodies. */
#include "plugins/common/gravity/gravity_bodies.h"

enum { BLOCK = HK_GRAVITY_BLOCK };

hk_status hk_gravity_reserve(hk_gravity_bodies *g, const hk_host *host, size_t n) {
  if (g->room && n <= g->room) return HK_OK;
  hk_gravity_release(g);
  size_t room = n + n / 2 + BLOCK, each = room + BLOCK;
  g->host = host;
  if (!g->path) g->path = hk_gravity_path_of(host->lanes);
  g->order = host->allocate(host, room * sizeof *g->order);
  g->at.x = host->allocate(host, 7 * each * sizeof(double));
  g->parts = room + 1;
  g->part = host->allocate(host, g->parts * sizeof *g->part);
  if (!g->order || !g->at.x || !g->part) {
    hk_gravity_release(g);
    return HK_NO_MEMORY;
  }
  g->at = (hk_bodies){g->at.x, g->at.x + each, g->at.x + 2 * each, g->at.x + 3 * each};
  for (size_t c = 0; c < 3; c++) g->pull[c] = g->at.x + (4 + c) * each;
  g->room = room;
  return HK_OK;
}

void hk_gravity_release(hk_gravity_bodies *g) {
  if (!g->host) return;
  g->host->release(g->host, g->order);
  g->host->release(g->host, g->at.x);
  g->host->release(g->host, g->part);
  g->order = NULL;
  g->at = (hk_bodies){0};
  g->part = NULL;
  g->room = g->count = 0;
}

/* 1/m, a power of two near the inverse of the extent; the softening counts where it is larger. */
static double scale_of(const hk_gravity_bodies *g, const double *x, double softening) {
  double most = softening;
  const double *first = g->count ? x + 3 * (size_t)g->order[0] : NULL;
  for (size_t k = 1; k < g->count; k++)
    for (size_t c = 0; c < 3; c++) most = fmax(most, fabs(x[3 * (size_t)g->order[k] + c] - first[c]));
  int exponent;
  if (!(most > 0) || !isfinite(most)) return 1;
  frexp(most, &exponent);
  return ldexp(1, exponent < -1000 ? 1000 : -exponent);
}

void hk_gravity_gather(hk_gravity_bodies *g, const double *x, const double *mass, double softening) {
  g->scale = scale_of(g, x, softening);
  g->eps2 = softening * g->scale * (softening * g->scale);
  for (size_t k = 0; k < g->count; k++) {
    const double *at = x + 3 * (size_t)g->order[k];
    g->at.x[k] = at[0] * g->scale;
    g->at.y[k] = at[1] * g->scale;
    g->at.z[k] = at[2] * g->scale;
    g->at.m[k] = mass[g->order[k]];
  }
}

void hk_gravity_targets(const hk_gravity_bodies *g, size_t first, size_t count, hk_targets *t) {
  for (size_t l = 0; l < BLOCK; l++) {
    size_t k = l < count ? first + l : first;
    t->x[0][l] = g->at.x[k];
    t->x[1][l] = g->at.y[k];
    t->x[2][l] = g->at.z[k];
  }
}
