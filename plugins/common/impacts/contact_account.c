#include "plugins/common/impacts/contact_account.h"

#include <string.h>

void hk_contact_account_begin(hk_contact_account *s, double t) {
  s->settled.closest = s->last.closest = INFINITY;
  s->last_t = t;
}

hk_status hk_contact_account_open(hk_contact_account *s, const hk_host *host, size_t n) {
  host->release(host, s->free);
  s->free = host->allocate(host, (6 * n + 1) * sizeof *s->free);
  return s->free ? HK_OK : host->fail(host, HK_NO_MEMORY, "no memory for %zu particles", n);
}

void hk_contact_account_step(hk_contact_account *s, double t, double h) {
  if (t - h / 2 > s->last_t) {
    s->settled.impulse += s->last.impulse;
    s->settled.energy += s->last.energy;
    s->settled.closest = fmin(s->settled.closest, s->last.closest);
  }
  s->last = (hk_contact_sums){.closest = INFINITY};
  s->last_t = t;
}

void hk_contact_account_free(hk_contact_account *s, const hk_view *view, const hk_correction *c) {
  memcpy(s->free, c->x, 3 * view->n * sizeof *c->x);
  memcpy(s->free + 3 * view->n, c->v, 3 * view->n * sizeof *c->v);
}

void hk_contact_account_work(hk_contact_account *s, const hk_view *view, hk_correction *c) {
  const double *x = s->free, *v = s->free + 3 * view->n, *mass = view->model->mass;
  double sum = 0;
  for (size_t i = 0; i < 3 * view->n; i++) {
    if (c->x[i] == x[i] && c->v[i] == v[i]) continue;
    double a = (v[i] - c->v_before[i]) / c->h;
    sum += mass[i / 3] * ((c->v[i] * c->v[i] - v[i] * v[i]) / 2 - a * (c->x[i] - x[i]));
  }
  c->work = sum;
  s->last.energy = -sum;
}

bool hk_contact_account_report(hk_contact_account *s, const hk_surfaces *surfaces, const hk_view *view,
                               hk_contact_report *out) {
  surfaces->report(surfaces->self, view, out);
  out->closest = fmin(s->settled.closest, s->last.closest);
  out->impulse = s->settled.impulse + s->last.impulse;
  out->impact_energy = s->settled.energy + s->last.energy;
  s->settled.closest = s->last.closest = INFINITY;
  return true;
}
