/* Central differences of the accelerations, K u = -(a(x + e u) - a(x - e u))/(2 e) and D in the same way with v, scaled
 * by the roots of the masses, and Lanczos iteration on them. */
#include "core/numerics/stability/operation.h"

#include <stdlib.h>
#include <string.h>

/* The rounding error of an acceleration is `ulps` units in the last place. */
static const double rounding = 2.2e-16, ulps = 64, third = 1.0 / 3;

hk_status hk_operation_need(const hk_spectrum_work *s, double **vector) {
  if (!*vector) *vector = calloc(3 * s->n + 1, sizeof **vector);
  return *vector ? HK_OK : HK_NO_MEMORY;
}

/* moved = x (or v) of X + factor * direction / sqrt(m). */
static void displace(const hk_operation *o, const double *direction, double factor) {
  size_t n = o->system->n;
  const double *base = o->system->X + (o->velocity ? 3 * n : 0), *w = o->system->model->inverse_mass;
  double *into = o->work->moved;
  for (size_t i = 0; i < n; i++) {
    double f = factor * sqrt(w[i]);
    for (size_t c = 3 * i; c < 3 * i + 3; c++) into[c] = base[c] + f * direction[c];
  }
}

static double largest_move(const hk_model *model, const double *direction) {
  double most = 0;
  for (size_t i = 0; i < model->n; i++) {
    double f = sqrt(model->inverse_mass[i]);
    for (size_t c = 3 * i; c < 3 * i + 3; c++)
      if (f * fabs(direction[c]) > most) most = f * fabs(direction[c]);
  }
  return most;
}

hk_status hk_operation_allow(hk_system *system, double *vector) {
  const double *w = system->model->inverse_mass;
  system->filter(system, vector);
  if (!system->queries->project_velocity || hk_system_equations(system) == 0) return HK_OK;
  for (size_t c = 0; c < 3 * system->n; c++) vector[c] *= sqrt(w[c / 3]);
  hk_status status = system->queries->project_velocity(system, vector);
  for (size_t c = 0; c < 3 * system->n; c++) vector[c] = w[c / 3] > 0 ? vector[c] / sqrt(w[c / 3]) : 0;
  return status;
}

hk_status hk_operation_evaluate(hk_operation *o, double *a) {
  hk_spectrum_work *s = o->work;
  hk_system *system = o->system;
  double *x = o->velocity ? o->rest : s->moved, *v = o->velocity ? s->moved : o->rest;
  s->bounds.evaluations++;
  hk_status status = system->accelerations(system, system->t, x, v, system->X + 6 * s->n, a, s->dy[0]);
  const hk_fast_subset *fast = system->split->fast;
  if (status == HK_OK && fast) fast->remove(fast->self, system, x, v, a);
  return status;
}

void hk_operation_difference(const hk_operation *o, double factor, double *out) {
  const double *w = o->system->model->inverse_mass, *a = o->work->a;
  for (size_t i = 0; i < o->system->n; i++) {
    double f = w[i] > 0 && factor > 0 ? -1 / (2 * factor * sqrt(w[i])) : 0;
    for (size_t c = 3 * i; c < 3 * i + 3; c++) out[c] = f * (out[c] - a[c]);
  }
}

hk_status hk_operation_apply(void *context, const double *in, double *out) {
  hk_operation *o = context;
  double most = largest_move(o->system->model, in), factor = most > 0 ? o->step / most : 0;
  displace(o, in, factor);
  hk_status status = hk_operation_evaluate(o, out);
  displace(o, in, -factor);
  if (status == HK_OK) status = hk_operation_evaluate(o, o->work->a);
  if (status != HK_OK) return status;
  hk_operation_difference(o, factor, out);
  if (hk_system_equations(o->system) > 0) o->work->bounds.evaluations++; /* a projection costs as much as one */
  return hk_operation_allow(o->system, out);
}

double *hk_operation_rest(hk_spectrum_work *s, double *from) {
  if (!s->imposes) return from;
  s->written = true;
  return memcpy(s->still, from, 3 * s->n * sizeof *from);
}

double *hk_operation_velocities(hk_spectrum_work *s, const hk_system *system) {
  if (hk_system_equations(system) > 0) return hk_operation_rest(s, system->X + 3 * s->n);
  if (s->written) memset(s->still, 0, 3 * s->n * sizeof *s->still);
  s->written = s->imposes;
  return s->still;
}

hk_status hk_operation_apply_unturned(void *context, const double *in, double *out) {
  const hk_spectrum_work *s = ((hk_operation *)context)->work;
  hk_status status = hk_operation_apply(context, in, out);
  for (size_t i = 0; i < s->n && s->turn && s->bounds.b_max > 0; i++) {
    const double *t = s->turn + 3 * i, *u = in + 3 * i;
    for (int c = 0; c < 3; c++)
      out[3 * i + (size_t)c] -= t[(c + 1) % 3] * u[(c + 2) % 3] - t[(c + 2) % 3] * u[(c + 1) % 3];
  }
  return status;
}

double hk_operation_largest(const double *x, size_t count) {
  double most = 0;
  for (size_t c = 0; c < count; c++)
    if (fabs(x[c]) > most) most = fabs(x[c]);
  return most;
}

void hk_operation_measure(hk_spectrum_work *s, const hk_system *system, double shortest) {
  const double *x = system->X;
  double size = 0;
  for (size_t c = 3; c < 3 * s->n; c++)
    if (fabs(x[c] - x[c % 3]) > size) size = fabs(x[c] - x[c % 3]);
  s->length = fmax(hk_operation_largest(x, 3 * s->n), size);
  if (!(s->length > 0)) s->length = 1;
  s->spacing = isfinite(shortest) ? shortest : size > 0 ? size / pow((double)s->n, third) : s->length;
  s->spacing = fmax(s->spacing, 1e-6 * s->length);
}

hk_status hk_operation_start(hk_lanczos *l, hk_system *system) {
  hk_lanczos_random(l->current, l->size);
  for (size_t i = 0; i < system->n; i++)
    if (!(system->model->inverse_mass[i] > 0)) memset(l->current + 3 * i, 0, 3 * sizeof *l->current);
  return hk_operation_allow(system, l->current);
}

hk_status hk_operation_bound(hk_operation *o, hk_lanczos *l, double known) {
  hk_status status = hk_operation_start(l, o->system);
  hk_lanczos_apply *apply = o->velocity ? hk_operation_apply_unturned : hk_operation_apply;
  return status == HK_OK ? hk_lanczos_run(l, apply, o, known) : status;
}

/* The step at which the truncation error (step/spacing)^2 equals the rounding error 2e-16 length/step; both are below
 * 1e-9 for usual scenes. */
double hk_operation_step(const hk_spectrum_work *s) {
  return pow(rounding * s->length * s->spacing * s->spacing, third);
}

double (*hk_operation_blocks(hk_spectrum_work *s))[6] { return (double(*)[6])(void *)s->moved; }

double hk_operation_noise(const hk_operation *o) {
  return ulps * rounding * hk_operation_largest(o->work->a, 3 * o->work->n) / o->step;
}
