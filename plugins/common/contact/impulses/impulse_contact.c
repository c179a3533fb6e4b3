/* See impulse_contact.h. */
#include "plugins/common/contact/impulses/impulse_contact.h"

#include <string.h>

hk_status hk_impulse_contact_create(hk_impulse_contact *s, const char *plugin, const hk_host *host,
                                    const hk_view *view) {
  hk_status status;
  s->host = host;
  s->settled.closest = s->last.closest = INFINITY;
  s->last_t = view->t;
  s->surfaces = hk_contact_join(&s->params, plugin, host, view, &status);
  s->candidates.cache = &s->cache;
  s->candidates.restitution = s->restitution;
  return status;
}

hk_status hk_impulse_contact_topology(hk_impulse_contact *s, const hk_view *view) {
  s->host->release(s->host, s->free);
  s->free = s->host->allocate(s->host, (6 * view->n + 1) * sizeof *s->free);
  if (!s->free) return s->host->fail(s->host, HK_NO_MEMORY, "no memory for %zu particles", view->n);
  return hk_pair_cache_open(&s->cache, s->host, view, s->surfaces, hk_contact_skin(&s->params));
}

void hk_impulse_contact_begin(hk_impulse_contact *s, const hk_view *view, const hk_correction *c) {
  if (view->t - c->h / 2 > s->last_t) {
    s->settled.impulse += s->last.impulse;
    s->settled.energy += s->last.energy;
    s->settled.closest = fmin(s->settled.closest, s->last.closest);
  }
  s->last = (hk_contact_sums){.closest = INFINITY};
  s->last_t = view->t;
  hk_pair_cache_begin(&s->cache, c->x_before);
  hk_contact_candidates_begin(&s->candidates);
}

void hk_impulse_contact_keep_free(hk_impulse_contact *s, const hk_view *view, const hk_correction *c) {
  memcpy(s->free, c->x, 3 * view->n * sizeof *c->x);
  memcpy(s->free + 3 * view->n, c->v, 3 * view->n * sizeof *c->v);
}

void hk_impulse_contact_end(hk_impulse_contact *s, const hk_view *view, hk_correction *c, const double *x_to) {
  const double *x = s->free, *v = s->free + 3 * view->n, *mass = view->model->mass;
  double sum = 0;
  hk_pair_cache_end(&s->cache, x_to);
  s->last.closest = s->candidates.closest;
  if (!c->changed) return;
  for (size_t i = 0; i < 3 * view->n; i++) {
    if (c->x[i] == x[i] && c->v[i] == v[i]) continue;
    double a = (v[i] - c->v_before[i]) / c->h;
    sum += mass[i / 3] * ((c->v[i] * c->v[i] - v[i] * v[i]) / 2 - a * (c->x[i] - x[i]));
  }
  c->work = sum;
  s->last.energy = -sum;
}

bool hk_impulse_contact_report(void *self, const hk_view *view, hk_contact_report *out) {
  hk_impulse_contact *s = self;
  s->surfaces->report(s->surfaces->self, view, out);
  out->closest = fmin(s->settled.closest, s->last.closest);
  out->impulse = s->settled.impulse + s->last.impulse;
  out->impact_energy = s->settled.energy + s->last.energy;
  s->settled.closest = s->last.closest = INFINITY;
  return true;
}
