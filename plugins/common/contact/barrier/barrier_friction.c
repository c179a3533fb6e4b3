/* See barrier_friction.h. */
#include "plugins/common/contact/barrier/barrier_friction.h"
#include "plugins/kit/vector3.h"

#include <string.h>

static hk_barrier_touch *touches_of(const hk_barrier_friction *f) { return f->touches.item; }

/* ---- force ---- */

/* The velocity across the normal; returns its size. */
static double slip(const hk_barrier_touch *t, const double *v, double u[3]) {
  double along = 0;
  for (size_t c = 0; c < 3; c++) {
    u[c] = 0;
    for (int a = 0; a < 4; a++) u[c] += t->frame.w[a] * v[3 * (size_t)t->pair.vertex[a] + c];
  }
  along = hk_dot(u, t->frame.n);
  for (int c = 0; c < 3; c++) u[c] -= along * t->frame.n[c];
  return hk_length(u);
}

/* mu l f(y)/|u|, N s/m */
static double ratio(const hk_barrier_friction *f, const hk_barrier_touch *t, double size) {
  double y = size / f->speed;
  return f->coefficient * t->load * (y < 1 ? (2 - y) / f->speed : 1 / size);
}

double hk_friction_add(const hk_barrier_friction *f, const double *v, double *F) {
  double u[3], power = 0;
  for (size_t k = 0; k < f->touches.count; k++) {
    const hk_barrier_touch *t = &touches_of(f)[k];
    double size = slip(t, v, u), r = ratio(f, t, size);
    for (size_t e = 0; e < 12; e++) F[3 * (size_t)t->pair.vertex[e / 3] + e % 3] -= r * t->frame.w[e / 3] * u[e % 3];
    power -= r * size * size;
  }
  return power;
}

double hk_friction_power(const hk_barrier_friction *f, const double *v) {
  double u[3], power = 0;
  for (size_t k = 0; k < f->touches.count; k++) {
    double size = slip(&touches_of(f)[k], v, u);
    power -= ratio(f, &touches_of(f)[k], size) * size * size;
  }
  return power;
}

/* r (P - e e^T) + s e e^T, P the projection across the normal, e = u/|u|, s the slope of the force. */
static void damping_of(const hk_barrier_friction *f, const hk_barrier_touch *t, const double *v, double D[9]) {
  double u[3], size = slip(t, v, u), r = ratio(f, t, size), y = size / f->speed;
  double slope = y < 1 ? 2 * f->coefficient * t->load * (1 - y) / f->speed : 0;
  for (int p = 0; p < 9; p++) {
    double ee = size > 0 ? u[p / 3] * u[p % 3] / (size * size) : 0;
    D[p] = r * ((p % 4 == 0) - t->frame.n[p / 3] * t->frame.n[p % 3] - ee) + slope * ee;
  }
}

void hk_friction_damping(const hk_barrier_friction *f, const double *v, const hk_blocks *into) {
  double D[9];
  for (size_t k = 0; k < f->touches.count; k++) {
    const hk_barrier_touch *t = &touches_of(f)[k];
    const size_t *slot = into->slot + 16 * (size_t)t->name;
    damping_of(f, t, v, D);
    for (size_t b = 0; b < 16; b++)
      for (size_t p = 0; p < 9; p++) into->D[9 * slot[b] + p] += t->frame.w[b / 4] * t->frame.w[b % 4] * D[p];
  }
}

/* ---- what is remembered ---- */

static void remember(const hk_barrier_pair *p, const hk_barrier_value *v, const hk_view *view, hk_barrier_touch *t) {
  *t = (hk_barrier_touch){p->pair, .frame = hk_pair_frame_of(&v->nearest), .load = hk_barrier_load(v), .name = p->name};
  for (int a = 0; a < 4; a++) t->id[a] = view->model->id[p->pair.vertex[a]];
}

hk_status hk_friction_take(hk_barrier_friction *f, hk_barrier_contacts *c, const hk_view *view) {
  const hk_barrier_pair *near = c->near.item;
  size_t count = 0;
  if (!(f->coefficient > 0)) return c->host->resize(c->host, &f->touches, 0);
  hk_barrier_values_at(c, view);
  hk_status status = c->host->resize(c->host, &f->touches, c->acting_count);
  if (status != HK_OK) return status;
  for (size_t k = 0; k < c->acting_count; k++) {
    const hk_barrier_value *v = hk_barrier_acting(c, k);
    if (near[v->near].name != UINT32_MAX) remember(&near[v->near], v, view, &touches_of(f)[count++]);
  }
  return c->host->resize(c->host, &f->touches, count);
}

/* The index of a particle; UINT32_MAX: it is dead. */
static uint32_t index_of(const hk_model *model, uint32_t id) {
  size_t i = hk_model_find(model, id);
  return i < model->n ? (uint32_t)i : UINT32_MAX;
}

hk_status hk_friction_renumber(hk_barrier_friction *f, const hk_view *view) {
  size_t kept = 0;
  for (size_t k = 0; k < f->touches.count; k++) {
    hk_barrier_touch t = touches_of(f)[k];
    bool live = true;
    for (int a = 0; a < 4; a++) {
      t.pair.vertex[a] = index_of(view->model, t.id[a]);
      live = live && t.pair.vertex[a] != UINT32_MAX;
    }
    if (live) touches_of(f)[kept++] = t;
  }
  return view->host->resize(view->host, &f->touches, kept);
}

hk_status hk_friction_list(hk_barrier_friction *f, const hk_host *host) {
  hk_status status = host->resize(host, &f->pairs, f->touches.count);
  for (size_t k = 0; k < f->touches.count && status == HK_OK; k++)
    ((hk_feature_pair *)f->pairs.item)[k] = touches_of(f)[k].pair;
  return status;
}

void hk_friction_update_names(hk_barrier_friction *f, const hk_barrier_contacts *c) {
  const hk_feature_pair *named = c->named.item;
  size_t k = 0;
  for (size_t e = 0; e < f->touches.count; e++) {
    while (k < c->named.count && hk_pair_compare(&named[k], &touches_of(f)[e].pair) < 0) k++;
    touches_of(f)[e].name = (uint32_t)k;
  }
}
