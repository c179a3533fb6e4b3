/* The figures of a frame: energies, momenta, measures, and the error against a known solution. Sums run over the
 * particles in order on one thread, so they do not depend on the number of threads. */
#include "core/numerics/constraints/constraints.h"
#include "core/run/judge/judge.h"

#include <stdlib.h>
#include <string.h>

static void momenta(hk_loop *loop, hk_frame *frame) {
  const double *x = loop->state->X, *v = loop->state->X + 3 * loop->state->model.n;
  for (int c = 0; c < 3; c++) frame->momentum[c] = frame->angular_momentum[c] = 0;
  double scale = 0;
  for (size_t i = 0; i < loop->state->model.n; i++) {
    double m = loop->state->inverse_mass[i] > 0 ? loop->state->mass[i] : 0, p[3];
    for (int c = 0; c < 3; c++) {
      p[c] = m * v[3 * i + c];
      frame->momentum[c] += p[c];
      scale += fabs(p[c]);
    }
    for (int c = 0; c < 3; c++)
      frame->angular_momentum[c] += x[3 * i + (c + 1) % 3] * p[(c + 2) % 3] - x[3 * i + (c + 2) % 3] * p[(c + 1) % 3];
  }
  if (scale > loop->record->momentum_scale) loop->record->momentum_scale = scale;
}

hk_status hk_figures_measure(hk_loop *loop, hk_judgement *j, const void *caller) {
  double t = loop->state->t;
  for (size_t k = 0; k < j->scene->measures; k++) {
    const hk_measure *m = &j->scene->measure[k];
    size_t got = 0;
    hk_status status = m->value.call(&m->value, caller, &t, 1, &j->measure[k], 1, &got, loop->error);
    if (status != HK_OK) return status;
    if (got != 1)
      return hk_error_set(loop->error, HK_SCRIPT, "%s: measure '%s': the function must return one number", m->where,
                          m->name);
  }
  return HK_OK;
}

/* m, of what correctors keep. At the start nothing has been corrected yet. */
static double correctors_violation(const hk_loop *loop) {
  const hk_instances *correctors = &loop->plugins->kind[HK_CORRECTOR];
  double most = 0;
  for (size_t k = 0; k < correctors->count; k++) {
    hk_instance *c = correctors->item[k];
    if (!c->plugin->corrector->violation) continue;
    hk_view view = hk_instance_view(c, &loop->state->view);
    const hk_instance *outer = hk_enter(c);
    most = fmax(most, c->plugin->corrector->violation(c->self, &view));
    hk_leave(c, outer);
  }
  return most;
}

hk_status hk_figures_take(hk_loop *loop, hk_judgement *j, const void *caller) {
  hk_record *r = loop->record;
  hk_frame *frame = &j->last_frame;
  bool first = r->frames == 0 && r->steps == 0, found;
  frame->index = r->frames;
  frame->steps = r->steps;
  frame->fps = loop->fps;
  frame->kinetic = hk_state_kinetic(loop->state, loop->state->X);
  frame->potential = hk_query_potential(loop->dynamics, loop->state->t, loop->state->X);
  frame->work = hk_loop_work(loop->state, r);
  momenta(loop, frame);
  if (frame->kinetic > r->kinetic_max) r->kinetic_max = frame->kinetic;
  r->kinetic_sum = (r->frames ? r->kinetic_sum : 0) + frame->kinetic;
  double total = frame->kinetic + frame->potential;
  if (first) {
    r->energy_first = total;
    memcpy(r->momentum_first, frame->momentum, sizeof r->momentum_first);
  }
  double violation, strain = hk_query_strain(loop->dynamics, NULL, &found);
  hk_status asked = hk_constraints_violation(loop->dynamics, &violation);
  if (asked != HK_OK) return asked;
  if (!first) violation = fmax(violation, correctors_violation(loop));
  if (violation > r->violation_max) r->violation_max = violation;
  if (fabs(strain) > fabs(r->strain_max)) r->strain_max = strain;
  hk_by_hand_note(loop);
  hk_force_errors_note(loop);
  asked = hk_contacts_note(loop);
  if (asked != HK_OK) return asked;
  if (j->keeps_trajectory) {
    hk_status noted = hk_trajectory_note(&j->trajectory, loop->state, r->frames, false, loop->error);
    if (noted != HK_OK) return noted;
  }
  bool plausible = isfinite(total) && !(total - r->energy_first - frame->work > r->kinetic_max);
  hk_status status = first || plausible ? hk_snapshot_take(&j->last_good, loop->state, loop->error) : HK_OK;
  return status == HK_OK ? hk_figures_measure(loop, j, caller) : status;
}

/* Positions that the scene's `exact` gives at a time, 3 numbers for each of the first particles. */
static hk_status ask_exact(const hk_scene *scene, double t, double *known, size_t room, size_t *got, hk_error *cause) {
  hk_status status = scene->exact.call(&scene->exact, NULL, &t, 1, known, room, got, cause);
  if (status != HK_OK || *got % 3 == 0) return status;
  return hk_error_set(cause, HK_BAD_PARAM,
                      "%s: exact gave %zu numbers at t = %g s, which are not x, y, z of whole particles: return "
                      "three for each, in the order of their ids",
                      scene->exact_where ? scene->exact_where : scene->name, *got, t);
}

/* RMS over the particles of which they are known; none: it is not known then. */
hk_status hk_figures_exact(const hk_scene *scene, hk_loop *loop, double *error, hk_error *cause) {
  size_t room = 3 * loop->state->model.n, got = 0;
  double *known = scene->exact.call && room ? malloc(room * sizeof *known) : NULL, sum = 0;
  *error = NAN;
  if (!known) return HK_OK;
  hk_status status = ask_exact(scene, loop->state->t, known, room, &got, cause);
  for (size_t k = 0; k < got; k++) {
    double off = loop->state->X[3 * hk_model_nth(&loop->state->model, k / 3) + k % 3] - known[k];
    sum += off * off;
  }
  free(known);
  if (status == HK_OK && got >= 3) *error = sqrt(3 * sum / (double)got);
  return status;
}

hk_status hk_figures_check_exact(const hk_scene *scene, size_t n, double end, hk_error *cause) {
  size_t got = 0;
  double *known = scene->exact.call && n > 0 && isfinite(end) ? malloc(3 * n * sizeof *known) : NULL;
  if (!known) return HK_OK;
  hk_status status = ask_exact(scene, end, known, 3 * n, &got, cause);
  free(known);
  return status;
}

double hk_figures_exact_motion(const hk_scene *scene, hk_loop *loop, double end) {
  enum { MOMENTS = 64 };
  static const double golden = 0.381966011250105; /* not all of them are whole periods of what comes back */
  const hk_function *exact = &scene->exact;
  size_t room = 3 * loop->state->model.n, first = 0, got = 0;
  double *known = exact->call && room ? malloc(2 * room * sizeof *known) : NULL, most = 0, start = 0;
  hk_error error = {0};
  if (!known) return NAN;
  bool evaluated = exact->call(exact, NULL, &start, 1, known, room, &first, &error) == HK_OK && first >= 3;
  for (int m = 1; m <= MOMENTS && evaluated; m++) {
    double t = m < MOMENTS ? end * (m - golden) / MOMENTS : end, sum = 0;
    error = (hk_error){0};
    if (exact->call(exact, NULL, &t, 1, known + room, room, &got, &error) != HK_OK || got != first)
      continue; /* it is the end that it has to be known at */
    for (size_t k = 0; k < got; k++) sum += (known[room + k] - known[k]) * (known[room + k] - known[k]);
    most = fmax(most, sqrt(3 * sum / (double)first));
  }
  free(known);
  return evaluated ? most : NAN;
}
