/* The start state of a run: random offsets where the run is compared with another one, pins, constraints. */
#include "core/numerics/constraints/constraints.h"
#include "core/run/run/run.h"

#include <float.h>
#include <stdlib.h>
#include <string.h>

/* Moves particles that are not fixed or scripted at random; sliding ones return to their line or plane when pins are
 * imposed. */
static void perturb(hk_state *s, double distance, uint64_t seed) {
  uint64_t random[4];
  hk_random_seed(random, seed);
  for (size_t i = 0; i < s->model.n; i++)
    for (int c = 0; c < 3; c++) {
      double off = distance * (2 * hk_random_uniform(random) - 1);
      if (s->inverse_mass[i] > 0) s->X[3 * i + (size_t)c] += off;
    }
}

static double apart(const double *a, const double *b) {
  return sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2]));
}

/* The row, of n rows of three numbers, that changed most. */
static size_t most_changed(const double *before, const double *now, size_t n) {
  size_t most = 0;
  for (size_t i = 1; i < n; i++)
    if (apart(before + 3 * i, now + 3 * i) > apart(before + 3 * most, now + 3 * most)) most = i;
  return most;
}

static double largest(const double *list, size_t count) {
  double most = 0;
  for (size_t k = 0; k < count; k++) most = fmax(most, fabs(list[k]));
  return most;
}

/* Says what constraints changed of the start, where that is more than how a script rounds its numbers. */
static void say_changes(hk_run *run, const double *before, const double *now) {
  const double rounded = 1e-6;
  size_t n = run->state.model.n, i = most_changed(before, now, n), j = most_changed(before + 3 * n, now + 3 * n, n);
  double move = apart(before + 3 * i, now + 3 * i), jump = apart(before + 3 * (n + j), now + 3 * (n + j));
  double size = largest(before, 3 * n), speed = fmax(largest(before + 3 * n, 3 * n), size /* in a second */);
  if (move > rounded * size)
    hk_warn(&run->warnings,
            "the start is off the constraints: particle %u is moved onto them by %.3g m, others by less",
            run->state.id[i], move);
  if (jump > rounded * speed)
    hk_warn(&run->warnings,
            "the start is off the constraints: the velocity of particle %u is changed by %.3g m/s, of others by less",
            run->state.id[j], jump);
}

static hk_status keep_constraints(hk_run *run) {
  hk_state *s = &run->state;
  size_t n = s->model.n;
  double *before = malloc((6 * n + 1) * sizeof *before);
  if (!before) return hk_error_set(&run->error, HK_NO_MEMORY, "no memory for the start");
  memcpy(before, s->X, 6 * n * sizeof *before);
  /* Equations that follow from others are known before, so that lengths rounded to some digits do not contradict. */
  hk_status status = hk_constraints_review(&run->dynamics);
  if (status == HK_OK) status = hk_constraints_project(&run->dynamics, s->t, s->X, s->X + 3 * n);
  if (status == HK_OK && n > 0) say_changes(run, before, s->X);
  free(before);
  return status;
}

/* The pins of a checkpoint have been imposed. A projection onto an inclined line changes last digits each time, so that
 * only what another script's pins move by more than rounding is taken. */
static hk_status impose_again(hk_run *run) {
  const double rounding = 64 * DBL_EPSILON; /* some operations on each number */
  hk_state *s = &run->state;
  size_t n = s->model.n;
  double *imposed = malloc((6 * n + 1) * sizeof *imposed), size = largest(s->X, 3 * n);
  double speed = largest(s->X + 3 * n, 3 * n);
  if (!imposed) return hk_error_set(&run->error, HK_NO_MEMORY, "no memory for the start");
  memcpy(imposed, s->X, 6 * n * sizeof *imposed);
  hk_status status = hk_dynamics_impose(&run->dynamics, s->t, imposed, imposed + 3 * n);
  size_t most = n > 0 ? most_changed(s->X, imposed, n) : 0;
  run->pins_jump = n > 0 ? apart(s->X + 3 * most, imposed + 3 * most) : 0;
  for (size_t e = 0; e < 6 * n && status == HK_OK; e++)
    if (fabs(imposed[e] - s->X[e]) > rounding * (e < 3 * n ? size : speed)) s->X[e] = imposed[e];
  free(imposed);
  return status;
}

hk_status hk_run_impose_start(hk_run *run) {
  hk_state *s = &run->state;
  double *x = s->X, *v = s->X + 3 * s->model.n;
  if (run->options.perturb > 0) perturb(s, run->options.perturb * hk_state_extent(s), run->options.perturb_seed);
  hk_status status = run->resumed ? impose_again(run) : hk_dynamics_impose(&run->dynamics, s->t, x, v);
  if (status == HK_OK && run->dynamics.constraints && !run->resumed) status = keep_constraints(run);
  if (status == HK_OK) status = hk_constraints_review(&run->dynamics);
  hk_constraints_jumped(&run->dynamics); /* nobody has a history yet, or it is the checkpoint's */
  return status;
}
