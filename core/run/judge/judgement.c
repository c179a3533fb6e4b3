/* A run before its judge: the evidence is gathered here from what the run measured, verdict.c finds the verdict, and
 * the summary has the figures and the verdict in words. */
#include "core/numerics/step_choice/step_choice.h"
#include "core/run/judge/judge.h"

#include <stdio.h>
#include <stdlib.h>

hk_status hk_judgement_open(hk_judgement *j, const hk_scene *scene, hk_error *error) {
  j->scene = scene;
  j->measure = calloc(scene->measures + 1, sizeof *j->measure);
  j->measure_name = calloc(scene->measures + 1, sizeof *j->measure_name);
  j->measure_unit = calloc(scene->measures + 1, sizeof *j->measure_unit);
  if (!j->measure || !j->measure_name || !j->measure_unit)
    return hk_error_set(error, HK_NO_MEMORY, "no memory for the measures");
  for (size_t k = 0; k < scene->measures; k++) {
    j->measure_name[k] = scene->measure[k].name;
    j->measure_unit[k] = scene->measure[k].unit;
  }
  j->last_frame.measures = scene->measures;
  j->last_frame.measure_name = j->measure_name;
  j->last_frame.measure_unit = j->measure_unit;
  j->last_frame.measure = j->measure;
  hk_comparisons *c = &j->comparisons;
  c->error = c->position = c->order = c->channel_error = c->difference = c->wall_s = NAN;
  return HK_OK;
}

void hk_judgement_close(hk_judgement *j) {
  hk_snapshot_free(&j->last_good);
  hk_trajectory_free(&j->trajectory);
  free(j->measure);
  free(j->measure_name);
  free(j->measure_unit);
  free(j->slope[0]);
  free(j->slope[1]);
  free(j->unresolved);
  free(j->plugin_time);
}

/* ---- evidence ---- */

/* m, what the scene extends over, or what its largest kinetic energy takes the particles in the time of the run. */
static double motion(const hk_loop *loop) {
  const hk_state *s = loop->state;
  double mass = 0;
  for (size_t i = 0; i < s->model.n; i++) mass += s->inverse_mass[i] > 0 ? s->mass[i] : 0;
  return fmax(hk_state_extent(s), mass > 0 ? sqrt(2 * loop->record->kinetic_max / mass) * s->t : 0);
}

/* Whether the exact solution can be had; its failure is an error of the scene. */
static hk_status check_exact(hk_loop *loop, hk_judgement *j, bool ignored) {
  double error;
  hk_status status = ignored ? HK_OK : hk_figures_exact(j->scene, loop, &error, loop->error);
  snprintf(j->exact_cause, sizeof j->exact_cause, "%s", status == HK_OK ? "" : loop->error->text);
  return status;
}

bool hk_is_abrupt(const hk_loop *loop) {
  const hk_record *r = loop->record;
  return loop->plugins->kind[HK_CORRECTOR].count > 0 || r->contact_frames > 0 || r->late_impacts > 0 ||
         r->rejected > 0 || r->moved || r->corrected || loop->dynamics->system.contact;
}

hk_status hk_judge(hk_loop *loop, hk_judgement *j, const hk_asked *asked) {
  hk_summary figures;
  hk_by_hand_note(loop);
  hk_summary_measure(loop, j, asked, &figures);
  hk_status status = check_exact(loop, j, asked->ignore_exact || loop->record->by_hand);
  bool known = !asked->ignore_exact && !isnan(figures.exact_error);
  j->exact_motion = known ? hk_figures_exact_motion(j->scene, loop, loop->state->t) : NAN;
  const hk_evidence evidence = {.figures = &figures,
                                .record = loop->record,
                                .method = loop->method->flags,
                                .order = loop->method->order,
                                .growth_expected = hk_step_choice_of(loop)->growth_expected,
                                .ignore_exact = asked->ignore_exact,
                                .exact_failed = status != HK_OK,
                                .abrupt = hk_is_abrupt(loop),
                                .extent = hk_state_extent(loop->state),
                                .motion = motion(loop),
                                .exact_motion = j->exact_motion,
                                .unresolved = hk_under_resolved_error(j),
                                .missed = hk_missed_encounters_error(loop)};
  j->opinion = hk_verdict_find(&evidence, &j->comparisons);
  j->verdict = j->opinion.verdict;
  return status;
}

void hk_summary_take(hk_loop *loop, hk_judgement *j, const hk_asked *asked, hk_summary *s) {
  hk_summary_measure(loop, j, asked, s);
  s->verdict = j->verdict;
  s->verdict_name = hk_verdict_name(j->verdict);
  snprintf(s->reason, sizeof s->reason, "%s", j->reason);
  hk_findings_describe(loop, j, s);
  if (j->verdict == HK_VERDICT_OK) hk_checked_describe(loop, j, s);
  if (j->verdict == HK_INACCURATE) hk_remedy_describe(loop, j, s);
}
