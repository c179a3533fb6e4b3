/* f(X, t): the sum of forces, divided by the masses, with pins and constraints, as integrators see it.
 *
 * One evaluation: pins and timed parameters of the time t are imposed; every force adds to F; one pass divides by the
 * masses and checks that F is finite, while the data are in the cache; then sliding pins filter the accelerations and
 * constraint forces are added. Results do not depend on the number of threads: forces are summed in the scene's order,
 * and the pass treats each particle alone. Wall time by plugin is sampled at one evaluation in 64. */
#include "core/dynamics/dynamics.h"

#include <stdlib.h>
#include <string.h>

enum { GRAIN = 4096, SAMPLE = 64, LANES = 4 };

static hk_dynamics *dynamics_of(hk_system *s) { return (hk_dynamics *)(void *)s; }

typedef struct pass {
  const double *inverse_mass;
  double *a;
  uint64_t *bad;
} pass;

/* The top bit of (exponent + 1) is set by an exponent of all ones, NaN or infinity. */
static inline uint64_t not_finite(double value) {
  uint64_t bits;
  memcpy(&bits, &value, sizeof bits);
  return (bits & 0x7ff0000000000000u) + 0x0010000000000000u;
}

/* Divides by mass, four particles side by side. F itself is checked, so that a force on a fixed particle is
 * included. */
static void divide_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  const pass *p = context;
  const double *restrict inverse = p->inverse_mass;
  uint64_t bad[3 * LANES] = {0};
  size_t i = begin;
  for (; i + LANES <= end; i += LANES) {
    double *restrict a = p->a + 3 * i, w[3 * LANES];
    for (size_t l = 0; l < 3 * LANES; l++) w[l] = inverse[i + l / 3];
    for (size_t l = 0; l < 3 * LANES; l++) {
      bad[l] |= not_finite(a[l]);
      a[l] *= w[l];
    }
  }
  for (size_t c = 3 * i; c < 3 * end; c++) {
    bad[0] |= not_finite(p->a[c]);
    p->a[c] *= inverse[c / 3];
  }
  for (size_t l = 1; l < 3 * LANES; l++) bad[0] |= bad[l];
  p->bad[chunk] = bad[0] >> 63;
}

static hk_status divide(hk_dynamics *d, double *a) {
  size_t n = d->state->model.n, chunks = (n + GRAIN - 1) / GRAIN;
  pass p = {d->state->inverse_mass, a, d->chunk_bad};
  hk_threads_for(d->shared->threads, n, GRAIN, divide_chunk, &p);
  for (size_t k = 0; k < chunks; k++)
    if (d->chunk_bad[k]) return HK_NOT_FINITE;
  return HK_OK;
}

hk_status hk_evaluate_rate(hk_dynamics *d, size_t k, double t, const double *y, double *dy, size_t first) {
  const hk_channel_spec *spec = &d->scene->channel[k];
  size_t n = d->state->model.n, size = spec->size, begin = d->state->channel[k].offset * n;
  if (!isnan(spec->decay)) {
    for (size_t e = begin + size * first; e < begin + size * n; e++) dy[e] += spec->decay * y[e];
    return HK_OK;
  }
  double in[18] = {t}, out[16];
  for (size_t i = first; spec->rate.call && i < n; i++) {
    size_t got = 0;
    in[1] = d->state->id[i];
    memcpy(in + 2, y + begin + size * i, size * sizeof *in);
    hk_status status = spec->rate.call(&spec->rate, NULL, in, 2 + size, out, 16, &got, d->error);
    if (status != HK_OK) return status;
    if (got != size)
      return hk_error_set(d->error, HK_SCRIPT, "channel '%s': rate gave %zu numbers, expected %zu", spec->name, got,
                          size);
    for (size_t c = 0; c < size; c++) dy[begin + size * i + c] += out[c];
  }
  return HK_OK;
}

static void prepare_view(hk_dynamics *d, size_t k, double t, const double *x, const double *v, const double *y,
                         double *power) {
  hk_view *view = &d->force_view[k];
  view->t = t;
  view->x = x;
  view->v = v;
  view->y = y;
  view->power = power;
}

static hk_status add_force(hk_dynamics *d, size_t k, double *F, double *dy) {
  hk_instance *force = d->plugins->kind[HK_FORCE].item[k];
  const hk_force *functions = force->plugin->force;
  bool sample = d->count.evaluations % SAMPLE == 0;
  double begin = sample ? hk_clock() : 0;
  const hk_instance *outer = hk_enter(force);
  hk_status status = functions->add(force->self, &d->force_view[k], F);
  if (status == HK_OK && functions->rates) status = functions->rates(force->self, &d->force_view[k], dy);
  status = hk_leave_with(force, outer, "add", status);
  force->calls++;
  if (sample) {
    force->seconds += hk_clock() - begin;
    force->sampled++;
  }
  return status;
}

static hk_status add_with_work(hk_dynamics *d, size_t k, double *F, double *dy, const double *v, double *power) {
  size_t count = 3 * d->state->model.n;
  double *alone = d->unaccounted, sum = 0;
  memset(alone, 0, count * sizeof *alone);
  hk_status status = add_force(d, k, alone, dy);
  for (size_t e = 0; e < count; e++) {
    F[e] += alone[e];
    sum += alone[e] * v[e];
  }
  *power += sum;
  return status;
}

static hk_status sum_forces(hk_dynamics *d, double t, const double *x, const double *v, const double *y, double *F,
                            double *dy, double *power) {
  hk_status status = HK_OK;
  for (size_t k = 0; k < d->plugins->kind[HK_FORCE].count && status == HK_OK; k++) {
    if (!d->force_acts[k] || !d->takes[k]) continue;
    bool whole = hk_work_unaccounted(d->plugins->kind[HK_FORCE].item[k]);
    prepare_view(d, k, t, x, v, d->state->width ? y : NULL, whole ? NULL : power);
    status = whole ? add_with_work(d, k, F, dy, v, power) : add_force(d, k, F, dy);
  }
  return status;
}

hk_status hk_evaluate_accelerations(hk_system *s, double t, double *x, double *v, const double *y, double *a,
                                    double *dy) {
  hk_dynamics *d = dynamics_of(s);
  size_t n = s->n, tail = s->size - 6 * n - 1;
  double power = 0;
  hk_status status = hk_dynamics_impose(d, t, x, v);
  if (status != HK_OK) return status;
  memset(a, 0, 3 * n * sizeof *a);
  memset(dy, 0, (tail + 1) * sizeof *dy);
  status = sum_forces(d, t, x, v, y, a, dy, &power);
  for (size_t k = 0; s->takes_channels && k < d->scene->channels && status == HK_OK; k++)
    status = hk_evaluate_rate(d, k, t, y, dy, 0);
  if (status != HK_OK) return status;
  if (d->pins->has_paths) power += hk_pins_power(d->pins, a, v);
  dy[tail] = power;
  d->count.evaluations++;
  status = divide(d, a);
  if (status != HK_OK) return hk_error_set(d->error, status, "the forces are not finite");
  if (d->pins->has_slides) hk_pins_filter(d->pins, a);
  return d->constraints && s->takes_constraints ? hk_constraints_accelerate(d, t, x, v, a, dy + tail) : HK_OK;
}

hk_status hk_evaluate_resize(hk_dynamics *d) {
  const hk_instances *forces = &d->plugins->kind[HK_FORCE];
  size_t n = d->state->model.n;
  bool account = false;
  for (size_t k = 0; k < forces->count; k++) account |= hk_work_unaccounted(forces->item[k]);
  free(d->chunk_bad);
  free(d->unaccounted);
  d->chunk_bad = calloc(n / GRAIN + 1, sizeof *d->chunk_bad);
  d->unaccounted = account ? calloc(3 * n + 1, sizeof *d->unaccounted) : NULL;
  free(d->predicted);
  d->predicted = d->system.contact ? calloc(3 * n + 1, sizeof *d->predicted) : NULL;
  if (d->chunk_bad && (!account || d->unaccounted) && (!d->system.contact || d->predicted)) return HK_OK;
  return hk_error_set(d->error, HK_NO_MEMORY, "no memory for %zu particles", n);
}
