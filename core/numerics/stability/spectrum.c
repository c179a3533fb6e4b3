/* Frequencies, damping rates and channel rates of the scene linearised at its present state, bounded from above.
 *
 * The operators M^-1/2 K M^-1/2 and M^-1/2 D M^-1/2 (K = -dF/dx, D = -dF/dv) are applied by central differences of the
 * accelerations (operation.c), and their largest eigenvalues bounded by Lanczos iteration (lanczos.c) and by the bounds
 * that the forces state (stiffness.c): bound_stiffness.c, bound_damping.c.
 *
 * Constraints leave the motion along them alone: vectors are projected onto the velocities that they allow, and so is
 * what the operators give. Their forces grow with v^2, as in a sling, and stiffen what they hold: K is then that at the
 * present velocities, which adds (v/R)^2 on a path of the radius R. Without constraints K is taken at v = 0: terms
 * proportional to damping times velocity are unsymmetric, and small while no particle moves by the distance to its
 * neighbour in a step.
 *
 * What a method sets aside for shorter steps of its own (hk_integrator.divide) is no part of the scene here. */
#include "core/numerics/stability/channel_rate.h"
#include "core/numerics/stability/uncoupled.h"
#include "core/numerics/stability/operation.h"
#include "core/numerics/stability/stiffness.h"

#include <math.h>
#include <stdlib.h>

static void release(hk_spectrum_work *s) {
  free(s->memory);
  free(s->turn);
  free(s->spare);
}

static hk_status reserve(hk_spectrum_work *s, const hk_system *system) {
  enum { VECTORS = 6 };
  size_t n = system->n, tail = system->size - 6 * n, vector = 3 * n;
  double *m = calloc(VECTORS * vector + 4 * tail + 1, sizeof *m);
  if (!m) return HK_NO_MEMORY;
  *s = (hk_spectrum_work){.n = n, .tail = tail, .memory = m, .moved = m};
  s->a = m + vector;
  s->stiffness = (hk_lanczos){.size = vector, .current = m + 2 * vector, .bound = INFINITY};
  s->stiffness.previous = m + 3 * vector;
  s->stiffness.image = m + 4 * vector;
  s->still = m + 5 * vector;
  s->damping = s->stiffness;
  s->y = m + VECTORS * vector;
  s->dy[0] = s->y + tail;
  s->dy[1] = s->dy[0] + tail;
  s->direction = s->dy[1] + tail;
  return HK_OK;
}

/* Whether pins have a place for a particle: fixed ones only have no velocity. */
static bool pins_impose(const hk_model *model) {
  for (size_t i = 0; i < model->n; i++)
    if (model->pin[i] != HK_FREE && model->pin[i] != HK_PIN_FIXED) return true;
  return false;
}

/* A failed call does not change *spectrum. */
static hk_status bound_all(hk_spectrum_work *s, hk_system *system, hk_spectrum *spectrum) {
  s->bounds = (hk_spectrum){.rigorous = true};
  s->length = s->stiffening_damping = 0;
  s->damps_alone = false;
  s->imposes = pins_impose(system->model);
  hk_status status = hk_bound_stiffness(s, system, true);
  if (status == HK_OK) status = hk_bound_damping(s, system);
  if (status == HK_OK && system->model->channels > 0) {
    hk_channel_scratch scratch = {s->moved, s->damping.current, s->a, s->y, {s->dy[0], s->dy[1]}, s->direction};
    status = hk_bound_channel_rate(system, &scratch, &s->bounds.channel_rate, &s->bounds.evaluations);
  }
  if (status == HK_OK) *spectrum = s->bounds;
  return status;
}

/* Whether the forces' own bounds allow the step: then they are the spectrum, and nothing is iterated. Small scenes are
 * looked at closely: it costs little there, and comparisons of runs want to know which frequency is reached. */
static bool allows(hk_spectrum_work *s, hk_system *system, double step, hk_spectrum *spectrum) {
  enum { MANY = 4096 };
  bool simple =
      !(system->queries->flags & HK_DEPENDS_ON_V) && hk_system_equations(system) == 0 && system->model->channels == 0;
  if (!(step > 0) || !s->method || system->n < MANY || !simple) return false;
  hk_stiffness stated = hk_stiffness_of(system, hk_operation_blocks(s));
  double w = sqrt(stated.whole * HK_INFLATE), switching = sqrt(stated.stiffening * HK_INFLATE);
  hk_spectrum bounds = {.w_max = w, .w_reached = w, .w_switching = switching, .rigorous = true, .covered = true};
  bounds.evaluations = 1; /* takes as long as one */
  if (!stated.covered || !(hk_stable_step(s->method, s->parameters, &bounds).limit >= step)) return false;
  *spectrum = bounds;
  return true;
}

hk_status hk_spectrum_estimate_for(hk_system *system, const hk_integrator *method, const void *parameters, double step,
                                   hk_spectrum *spectrum, hk_error *error) {
  if (hk_uncoupled_spectrum(system, spectrum)) return HK_OK;
  hk_spectrum_work s = {.method = NULL};
  if (reserve(&s, system) != HK_OK) return hk_error_set(error, HK_NO_MEMORY, "no memory to estimate the stable step");
  s.method = method;
  s.parameters = parameters;
  hk_status status = allows(&s, system, step, spectrum) ? HK_OK : bound_all(&s, system, spectrum);
  release(&s);
  return status;
}

hk_status hk_spectrum_estimate(hk_system *system, hk_spectrum *spectrum, hk_error *error) {
  return hk_spectrum_estimate_for(system, NULL, NULL, NAN, spectrum, error);
}

static double length(const double *u, size_t count) {
  double sum = 0;
  for (size_t c = 0; c < count; c++) sum += u[c] * u[c];
  return sqrt(sum);
}

hk_status hk_stiffness_sample(hk_system *system, double *sample) {
  hk_spectrum_work s = {.method = NULL};
  size_t count = 3 * system->n;
  *sample = 0;
  if (reserve(&s, system) != HK_OK) return HK_NO_MEMORY;
  s.imposes = pins_impose(system->model);
  hk_operation_measure(&s, system, hk_stiffness_of(system, hk_operation_blocks(&s)).length);
  hk_operation o = {&s, system, false, hk_operation_step(&s), hk_operation_velocities(&s, system)};
  hk_status status = hk_operation_start(&s.stiffness, system);
  double size = length(s.stiffness.current, count), found = 0;
  if (status == HK_OK && size > 0) status = hk_operation_apply(&o, s.stiffness.current, s.stiffness.image);
  if (status == HK_OK && size > 0) found = length(s.stiffness.image, count) / size;
  if (found > hk_operation_noise(&o)) *sample = sqrt((double)count) * found;
  release(&s);
  return status;
}
