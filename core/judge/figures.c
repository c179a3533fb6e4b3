/* The figures of a frame: energies, momenta, measures; strain; the error against a known solution. Sums run over the
 * particles in order on one thread, so they are the same whatever the number of threads. */
#include "core/run/engine.h"

#include <stdlib.h>
#include <string.h>

static void momenta(hk_run *run, hk_frame *frame) {
  const double *x = run->X, *v = run->X + 3 * run->model.n;
  for (int c = 0; c < 3; c++) frame->momentum[c] = frame->angular_momentum[c] = 0;
  double scale = 0;
  for (size_t i = 0; i < run->model.n; i++) {
    double m = run->inverse_mass[i] > 0 ? run->mass[i] : 0, p[3];
    for (int c = 0; c < 3; c++) {
      p[c] = m * v[3 * i + c];
      frame->momentum[c] += p[c];
      scale += fabs(p[c]);
    }
    for (int c = 0; c < 3; c++)
      frame->angular_momentum[c] += x[3 * i + (c + 1) % 3] * p[(c + 2) % 3] - x[3 * i + (c + 2) % 3] * p[(c + 1) % 3];
  }
  if (scale > run->momentum_scale) run->momentum_scale = scale;
}

static hk_status measure(hk_run *run) {
  double t = run->system.t;
  for (size_t k = 0; k < run->scene->measures; k++) {
    const hk_measure *m = &run->scene->measure[k];
    size_t got = 0;
    hk_status status = m->value.call(&m->value, &t, 1, &run->measure[k], 1, &got, &run->error);
    if (status != HK_OK) return status;
    if (got != 1)
      return hk_error_set(&run->error, HK_SCRIPT, "%s: measure '%s': the function must return one number", m->where,
                          m->name);
  }
  return HK_OK;
}

hk_status hk_frame_figures(hk_run *run, hk_frame *frame) {
  bool first = run->frame == 0 && run->steps == 0;
  frame->index = run->frame;
  frame->steps = run->steps;
  frame->fps = run->scene->fps;
  frame->kinetic = hk_system_kinetic(run, run->X);
  frame->potential = hk_system_potential(run, run->system.t, run->X);
  frame->work = run->X[run->system.size - 1];
  momenta(run, frame);
  if (frame->kinetic > run->kinetic_max) run->kinetic_max = frame->kinetic;
  double total = frame->kinetic + frame->potential;
  if (first) {
    run->energy_first = total;
    memcpy(run->momentum_first, frame->momentum, sizeof run->momentum_first);
  }
  double violation = hk_constraints_violation(run);
  if (violation > run->violation_max) run->violation_max = violation;
  bool found;
  double strain = hk_strain_largest(run, NULL, &found);
  if (fabs(strain) > fabs(run->strain_max)) run->strain_max = strain;
  bool sane = isfinite(total) && !(total - run->energy_first - frame->work > run->kinetic_max);
  hk_status status = first || sane ? hk_snapshot_take(run, &run->last_good) : HK_OK;
  return status == HK_OK ? measure(run) : status;
}

static double edge_length(const double *x, const uint32_t pair[2]) {
  double dx = x[3 * pair[1]] - x[3 * pair[0]], dy = x[3 * pair[1] + 1] - x[3 * pair[0] + 1],
         dz = x[3 * pair[1] + 2] - x[3 * pair[0] + 2];
  return sqrt(dx * dx + dy * dy + dz * dz);
}

double hk_strain_largest(hk_run *run, const char *label, bool *found) {
  double largest = 0;
  *found = false;
  for (size_t k = 0; k < run->model.element_lists; k++) {
    const hk_elements *e = &run->element_list[k].elements;
    if (label && strcmp(run->element_list[k].force, label) != 0) continue;
    *found = true;
    for (size_t j = 0; j < e->count; j++) {
      double rest = hk_edge_value(&e->rest, j);
      double strain = rest > 0 ? (edge_length(run->X, e->pair[j]) - rest) / rest : 0;
      if (fabs(strain) > fabs(largest)) largest = strain;
    }
  }
  return largest;
}

/* RMS over the particles whose positions the scene's `exact` gives. */
double hk_exact_error(hk_run *run) {
  const hk_function *exact = &run->scene->exact;
  size_t room = 3 * run->model.n, got = 0;
  double *known = exact->call && room ? malloc(room * sizeof *known) : NULL, t = run->system.t, sum = 0;
  if (!known) return NAN;
  hk_error kept = run->error;
  run->error = (hk_error){0};
  hk_status status = exact->call(exact, &t, 1, known, room, &got, &run->error);
  for (size_t k = 0; k < got; k++) sum += (run->X[k] - known[k]) * (run->X[k] - known[k]);
  free(known);
  if (status != HK_OK) {
    hk_run_warn(run, "the exact solution is not known: %.900s", run->error.text);
  }
  run->error = kept;
  return status == HK_OK && got >= 3 ? sqrt(3 * sum / (double)got) : NAN;
}
