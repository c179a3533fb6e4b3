/* f(X, t): the sum of forces, divided by the masses, with pins and constraints in it; what integrators see.
 *
 * One evaluation: pins and time-dependent parameters of that time are imposed; every force adds to F; one pass divides
 * by the masses and looks for numbers that are not finite, on data that are in the cache anyway; then slides are
 * filtered and constraint forces join. Results do not depend on the number of threads: forces sum in the scene's order
 * and the pass is per particle. Wall time by plugin is sampled at one evaluation in 64. */
#include "core/run/engine.h"

#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { GRAIN = 4096, SAMPLE = 64, LANES = 4 };

double hk_clock(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static hk_run *run_of(hk_system *s) { return (hk_run *)(void *)s; }

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

/* Divides by mass, four particles side by side. The test is on F, so that what a force does to a fixed particle counts
 * too. */
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

static hk_status divide(hk_run *run, double *a) {
  size_t n = run->model.n, chunks = (n + GRAIN - 1) / GRAIN;
  pass p = {run->inverse_mass, a, run->chunk_bad};
  if (n <= GRAIN)
    divide_chunk(&p, 0, n, 0);
  else
    hk_threads_for(run->scene->shared.threads, n, GRAIN, divide_chunk, &p);
  for (size_t k = 0; k < chunks; k++)
    if (run->chunk_bad[k]) return HK_NOT_FINITE;
  return HK_OK;
}

static hk_status add_rate(hk_run *run, size_t k, double t, const double *y, double *dy) {
  const hk_channel_spec *spec = &run->scene->channel[k];
  size_t n = run->model.n, size = spec->size, begin = run->channel[k].offset * n;
  if (!isnan(spec->decay)) {
    for (size_t e = begin; e < begin + size * n; e++) dy[e] += spec->decay * y[e];
    return HK_OK;
  }
  double in[18] = {t}, out[16];
  for (size_t i = 0; spec->rate.call && i < n; i++) {
    size_t got = 0;
    in[1] = run->id[i];
    memcpy(in + 2, y + begin + size * i, size * sizeof *in);
    hk_status status = spec->rate.call(&spec->rate, in, 2 + size, out, 16, &got, &run->error);
    if (status != HK_OK) return status;
    if (got != size)
      return hk_error_set(&run->error, HK_SCRIPT, "channel '%s': rate gave %zu numbers, expected %zu", spec->name, got,
                          size);
    for (size_t c = 0; c < size; c++) dy[begin + size * i + c] += out[c];
  }
  return HK_OK;
}

static void prepare_view(hk_run *run, size_t k, double t, const double *x, const double *v, const double *y,
                         double *power) {
  hk_view *view = &run->force_view[k];
  view->t = t;
  view->x = x;
  view->v = v;
  view->y = y;
  view->power = power;
}

static hk_status add_force(hk_run *run, size_t k, double *F, double *dy) {
  hk_instance *force = run->scene->force.item[k];
  const hk_force *functions = force->plugin->force;
  bool sample = run->evaluations % SAMPLE == 0;
  double begin = sample ? hk_clock() : 0;
  hk_status status = functions->add(force->self, &run->force_view[k], F);
  if (status == HK_OK && functions->rates) status = functions->rates(force->self, &run->force_view[k], dy);
  force->calls++;
  if (sample) {
    force->seconds += hk_clock() - begin;
    force->sampled++;
  }
  return status;
}

/* A force whose energy is not known, or is another one at another time: all that it does counts as work, F.v, which
 * needs its F alone. */
static bool works_unaccounted(const hk_instance *force) {
  const hk_force *functions = force->plugin->force;
  return functions->energy ? force->timed_count > 0 : !(functions->flags & HK_POWER);
}

static hk_status add_with_work(hk_run *run, size_t k, double *F, double *dy, const double *v, double *power) {
  size_t count = 3 * run->model.n;
  double *alone = run->works_unaccounted, sum = 0;
  memset(alone, 0, count * sizeof *alone);
  hk_status status = add_force(run, k, alone, dy);
  for (size_t e = 0; e < count; e++) {
    F[e] += alone[e];
    sum += alone[e] * v[e];
  }
  *power += sum;
  return status;
}

static hk_status sum_forces(hk_run *run, double t, const double *x, const double *v, const double *y, double *F,
                            double *dy, double *power) {
  hk_status status = HK_OK;
  for (size_t k = 0; k < run->scene->force.count && status == HK_OK; k++) {
    if (!run->force_acts[k] || !run->takes[k]) continue;
    bool whole = works_unaccounted(run->scene->force.item[k]);
    prepare_view(run, k, t, x, v, run->width ? y : NULL, whole ? NULL : power);
    status = whole ? add_with_work(run, k, F, dy, v, power) : add_force(run, k, F, dy);
  }
  return status;
}

static hk_status accelerations(hk_system *s, double t, double *x, double *v, const double *y, double *a, double *dy) {
  hk_run *run = run_of(s);
  size_t n = s->n, tail = s->size - 6 * n - 1;
  double power = 0;
  hk_status status = hk_pins_impose(run, t, x, v);
  if (status != HK_OK) return status;
  memset(a, 0, 3 * n * sizeof *a);
  memset(dy, 0, (tail + 1) * sizeof *dy);
  status = sum_forces(run, t, x, v, y, a, dy, &power);
  for (size_t k = 0; s->takes_channels && k < run->scene->channels && status == HK_OK; k++)
    status = add_rate(run, k, t, y, dy);
  if (status != HK_OK) return status;
  if (run->has_paths) power += hk_pins_power(run, a, v);
  dy[tail] = power;
  run->evaluations++;
  status = divide(run, a);
  if (status != HK_OK) return hk_error_set(&run->error, status, "the forces are not finite");
  if (run->has_slides) hk_pins_filter(run, a);
  return run->constraints ? hk_constraints_accelerate(run, t, x, v, a) : HK_OK;
}

static hk_status rates(hk_system *s, double t, double *X, double *dX) {
  size_t n = s->n;
  double *x = X, *v = X + 3 * n;
  hk_status status = s->accelerations(s, t, x, v, X + 6 * n, dX + 3 * n, dX + 6 * n);
  memcpy(dX, v, 3 * n * sizeof *dX);
  return status;
}

double hk_system_kinetic(const hk_run *run, const double *X) {
  const double *v = X + 3 * run->model.n;
  double sum = 0;
  for (size_t i = 0; i < run->model.n; i++)
    if (run->inverse_mass[i] > 0)
      sum += run->mass[i] * (v[3 * i] * v[3 * i] + v[3 * i + 1] * v[3 * i + 1] + v[3 * i + 2] * v[3 * i + 2]);
  return sum / 2;
}

double hk_system_potential(hk_run *run, double t, const double *X) {
  size_t n = run->model.n;
  double sum = 0;
  for (size_t k = 0; k < run->scene->force.count; k++) {
    hk_instance *force = run->scene->force.item[k];
    if (!run->force_acts[k] || !run->takes[k] || !force->plugin->force->energy || works_unaccounted(force)) continue;
    prepare_view(run, k, t, X, X + 3 * n, run->width ? X + 6 * n : NULL, NULL);
    sum += force->plugin->force->energy(force->self, &run->force_view[k]);
  }
  return sum;
}

/* What a scripted pin does through a constraint is not measured. */
bool hk_system_has_energy(const hk_run *run) { return !(run->has_paths && run->constraints); }

static hk_status energy(hk_system *s, double t, const double *X, double *kinetic, double *potential) {
  *kinetic = hk_system_kinetic(run_of(s), X);
  *potential = hk_system_potential(run_of(s), t, X);
  return HK_OK;
}

static void impose(hk_system *s, double t, double *x, double *v) { hk_pins_impose(run_of(s), t, x, v); }

static void filter(hk_system *s, double *vector) { hk_pins_filter(run_of(s), vector); }

hk_status hk_system_resize(hk_run *run) {
  bool meter = false;
  for (size_t k = 0; k < run->scene->force.count; k++) meter |= works_unaccounted(run->scene->force.item[k]);
  free(run->chunk_bad);
  free(run->works_unaccounted);
  run->chunk_bad = calloc(run->model.n / GRAIN + 1, sizeof *run->chunk_bad);
  run->works_unaccounted = meter ? calloc(3 * run->model.n + 1, sizeof *run->works_unaccounted) : NULL;
  if (!run->chunk_bad || (meter && !run->works_unaccounted))
    return hk_error_set(&run->error, HK_NO_MEMORY, "no memory for %zu particles", run->model.n);
  return HK_OK;
}

static hk_status list_forces(hk_run *run) {
  hk_system *s = &run->system;
  s->forces = run->scene->force.count;
  run->takes = calloc(s->forces + 1, sizeof *run->takes);
  run->force_info = calloc(s->forces + 1, sizeof *run->force_info);
  if (!run->takes || !run->force_info)
    return hk_error_set(&run->error, HK_NO_MEMORY, "no memory for %zu forces", s->forces);
  for (size_t k = 0; k < s->forces; k++) {
    const hk_instance *force = run->scene->force.item[k];
    const hk_force *functions = force->plugin->force;
    run->force_info[k] =
        (hk_force_info){force->label, functions->flags, functions->jacobian != NULL, functions->elements != NULL};
  }
  s->force = run->force_info;
  s->takes = run->takes;
  hk_system_take_all(run);
  return HK_OK;
}

void hk_system_take_all(hk_run *run) {
  run->system.takes_channels = true;
  for (size_t k = 0; k < run->system.forces; k++) run->takes[k] = true;
}

hk_status hk_system_open(hk_run *run) {
  hk_system *s = &run->system;
  s->accelerations = accelerations;
  s->rates = rates;
  s->energy = energy;
  s->impose = impose;
  s->filter = filter;
  s->jacobian = hk_jacobian_assemble;
  s->factorize = hk_implicit_factorize;
  s->solve = hk_implicit_solve;
  s->combine = hk_implicit_combine;
  s->solver_flags = hk_implicit_solver_flags;
  s->solve_columns = hk_implicit_solve_columns;
  hk_status status = list_forces(run);
  if (status != HK_OK) return status;
  s->flags = 0;
  for (size_t k = 0; k < run->scene->force.count; k++) {
    const hk_instance *force = run->scene->force.item[k];
    s->flags |=
        force->plugin->force->flags & (HK_DEPENDS_ON_X | HK_DEPENDS_ON_V | HK_DEPENDS_ON_T | HK_DEPENDS_ON_CHANNELS);
    if (force->timed_count) s->flags |= HK_DEPENDS_ON_T;
  }
  if (run->scene->constraint.count) s->flags |= HK_DEPENDS_ON_X | HK_DEPENDS_ON_V;
  if (run->has_paths) s->flags |= HK_DEPENDS_ON_T;
  return hk_system_resize(run);
}

void hk_system_close(hk_run *run) {
  free(run->chunk_bad);
  free(run->works_unaccounted);
  free(run->takes);
  free(run->force_info);
}
