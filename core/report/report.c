/* The summary as text for people and as JSON for programs: the same figures, the same names. */
#include "core/report/report.h"

#include <math.h>
#include <string.h>

const char *hk_verdict_name(hk_verdict verdict) {
  switch (verdict) {
  case HK_VERDICT_OK:
    return "ok";
  case HK_INACCURATE:
    return "inaccurate";
  case HK_DIVERGED:
    return "diverged";
  case HK_STOPPED:
    return "interrupted";
  case HK_RUNNING:
    break;
  }
  return "running";
}

static void text_step(FILE *f, const hk_summary *s) {
  if (s->steps == 0) return;
  fprintf(f, "  step              ");
  if (s->dt_max - s->dt_min > 1e-9 * s->dt_max)
    fprintf(f, "%.4g to %.4g s", s->dt_min, s->dt_max);
  else
    fprintf(f, "%.6g s", s->dt_max);
  if (isfinite(s->dt_limit))
    fprintf(f, " (%s; largest stable step %.4g s)", s->dt_chosen ? "chosen" : "given", s->dt_limit);
  else if (s->dt_chosen)
    fprintf(f, " (chosen)");
  fputc('\n', f);
}

static void text_accuracy(FILE *f, const hk_summary *s) {
  fprintf(f, "  energy            %.6g J first, %.6g J last", s->energy_first, s->energy_last);
  if (isfinite(s->energy_work)) fprintf(f, ", work %.6g J", s->energy_work);
  if (isfinite(s->energy_drift))
    fprintf(f, ", drift %.3g of the largest kinetic energy\n", s->energy_drift);
  else
    fprintf(f, ", drift not known\n");
  if (isfinite(s->momentum_drift)) fprintf(f, "  momentum drift    %.3g\n", s->momentum_drift);
  if (!isnan(s->max_strain)) fprintf(f, "  largest strain    %.4g\n", s->max_strain);
  if (s->constraint_violation > 0)
    fprintf(f, "  constraints       violated by at most %.3g m\n", s->constraint_violation);
  if (isfinite(s->exact_error))
    fprintf(f, "  error             %.4g m RMS against the exact solution\n", s->exact_error);
  if (isfinite(s->verify_difference))
    fprintf(f, "  half the step     differs by %.4g m RMS (from a start off by 1e-10 of the extent)\n",
            s->verify_difference);
}

static void text_times(FILE *f, const hk_summary *s) {
  fprintf(f, "  wall time         %.4g s, of it %.4g s in the time loop", s->wall_s, s->step_wall_s);
  if (s->step_wall_s > 0) fprintf(f, " (%.4g steps/s)", (double)s->steps / s->step_wall_s);
  fputc('\n', f);
  for (size_t k = 0; k < s->plugins; k++)
    if (s->plugin[k].seconds > 0)
      fprintf(f, "    %-11s %-18s %9.4f s\n", s->plugin[k].kind, s->plugin[k].label, s->plugin[k].seconds);
}

void hk_report_text(FILE *f, const hk_summary *s, const char *out) {
  fprintf(f, "%s: %zu particles, %s, t = %.9g s\n", s->scene, s->n, s->integrator, s->t);
  fprintf(f, "  steps             %zu, force evaluations %zu", s->steps, s->force_evaluations);
  if (s->jacobian_evaluations)
    fprintf(f, ", Jacobians %zu, factorisations %zu", s->jacobian_evaluations, s->factorizations);
  if (s->linear_iterations) fprintf(f, ", linear iterations %zu", s->linear_iterations);
  fputc('\n', f);
  text_step(f, s);
  if (s->solver)
    fprintf(f, "  solver            %s%s\n", s->solver,
            s->solver_chosen ? " (chosen for the forces and the size)" : "");
  if (*s->solver_libraries) fprintf(f, "  solver libraries  %s\n", s->solver_libraries);
  text_accuracy(f, s);
  for (size_t k = 0; k < s->measures; k++) fprintf(f, "  %-17s %.9g\n", s->measure_name[k], s->measure[k]);
  text_times(f, s);
  if (out) fprintf(f, "  output            %s\n", out);
  fprintf(f, "  verdict           %s%s%s\n", hk_verdict_name(s->verdict), *s->reason ? ": " : "", s->reason);
}

static void json_string(FILE *f, const char *text) {
  fputc('"', f);
  for (const unsigned char *c = (const unsigned char *)text; *c; c++) {
    if (*c == '"' || *c == '\\')
      fprintf(f, "\\%c", *c);
    else if (*c < 0x20)
      fprintf(f, "\\u%04x", *c);
    else
      fputc(*c, f);
  }
  fputc('"', f);
}

static void json_number(FILE *f, const char *key, double value) {
  json_string(f, key);
  if (isfinite(value))
    fprintf(f, ":%.17g", value);
  else
    fputs(":null", f);
}

static void json_text(FILE *f, const char *key, const char *value) {
  fprintf(f, "\"%s\":", key);
  json_string(f, value);
  fputc(',', f);
}

static void json_count(FILE *f, const char *key, size_t value) { fprintf(f, "\"%s\":%zu,", key, value); }

static void json_measured(FILE *f, const char *key, double value) {
  json_number(f, key, value);
  fputc(',', f);
}

static void json_energy(FILE *f, const hk_summary *s) {
  fputs("\"energy\":{", f);
  json_measured(f, "first", s->energy_first);
  json_measured(f, "last", s->energy_last);
  json_measured(f, "work", s->energy_work);
  json_number(f, "drift", s->energy_drift);
  fputs("},", f);
}

static void json_plugins(FILE *f, const hk_summary *s) {
  fputs("\"plugins\":[", f);
  for (size_t k = 0; k < s->plugins; k++) {
    fputs(k ? ",{" : "{", f);
    json_text(f, "kind", s->plugin[k].kind);
    json_text(f, "name", s->plugin[k].name);
    json_text(f, "label", s->plugin[k].label);
    json_number(f, "seconds", s->plugin[k].seconds);
    fputc('}', f);
  }
  fputs("],", f);
}

void hk_report_json(FILE *f, const hk_summary *s) {
  fputc('{', f);
  json_text(f, "scene", s->scene);
  json_text(f, "integrator", s->integrator);
  json_text(f, "solver", s->solver ? s->solver : "");
  json_text(f, "solver_libraries", s->solver_libraries);
  json_text(f, "verdict", hk_verdict_name(s->verdict));
  json_text(f, "reason", s->reason);
  json_count(f, "particles", s->n);
  json_measured(f, "t", s->t);
  json_count(f, "steps", s->steps);
  json_count(f, "frames", s->frames);
  json_measured(f, "dt_min", s->dt_min);
  json_measured(f, "dt_max", s->dt_max);
  json_measured(f, "dt_limit", s->dt_limit);
  json_count(f, "force_evaluations", s->force_evaluations);
  json_count(f, "jacobian_evaluations", s->jacobian_evaluations);
  json_count(f, "factorizations", s->factorizations);
  json_count(f, "linear_iterations", s->linear_iterations);
  json_measured(f, "wall_s", s->wall_s);
  json_measured(f, "start_wall_s", s->start_wall_s);
  json_measured(f, "step_wall_s", s->step_wall_s);
  json_energy(f, s);
  json_measured(f, "momentum_drift", s->momentum_drift);
  json_measured(f, "constraint_violation", s->constraint_violation);
  json_measured(f, "max_strain", s->max_strain);
  json_measured(f, "exact_error", s->exact_error);
  json_measured(f, "accuracy", s->accuracy);
  json_measured(f, "verify_difference", s->verify_difference);
  json_plugins(f, s);
  fputs("\"measures\":{", f);
  for (size_t k = 0; k < s->measures; k++) {
    if (k) fputc(',', f);
    json_number(f, s->measure_name[k], s->measure[k]);
  }
  fputs("},\"warnings\":[", f);
  for (size_t k = 0; k < s->warnings; k++) {
    if (k) fputc(',', f);
    json_string(f, s->warning[k]);
  }
  fputs("]}\n", f);
}
