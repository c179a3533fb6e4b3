/* Which step or tolerance would do, where a run is inaccurate: by the order of the method, from how far each figure is
 * above what it may be. It aims at half of that. What is far off is not extrapolated: the error does not follow its
 * order there. */
#include "core/engine/text/text.h"
#include "core/numerics/step_choice/step_choice.h"
#include "core/run/judge/judge.h"

#include <stdio.h>

static const double aim = 0.5, aim_of_tolerance = 0.1 /* errors follow it loosely, and it costs little */,
                    farthest = 1e-3 /* of the step */, far_enough = 0.1, of_limit = 0.9,
                    least_tolerance = 1e-13; /* rounding is 2e-16 a step */

/* The worst finding that a step or a tolerance cures. */
typedef struct need {
  double excess;  /* how far it is above what is allowed */
  double shorten; /* the part of the step that would do */
} need;

static need worst_of(const hk_opinion *o) {
  need n = {1, 1};
  for (size_t k = 0; k < o->count; k++) {
    const hk_finding *f = &o->finding[k];
    if (!(f->excess > 1)) continue;
    n.excess = fmax(n.excess, f->excess);
    n.shorten = fmin(n.shorten, pow(aim / f->excess, 1.0 / f->order));
  }
  return n;
}

/* The next number below with one digit. */
static double rounded(double x) {
  double unit = pow(10, floor(log10(x)));
  return floor(x / unit * (1 + 1e-9)) * unit;
}

static void add(hk_summary *s, const char *format, ...) HK_PRINTF(2, 3);

static void add(hk_summary *s, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  hk_text_append(s->remedy, sizeof s->remedy, "; ", format, arguments);
  va_end(arguments);
}

static void describe_step(const hk_loop *loop, const need *n, hk_summary *s) {
  const hk_step_choice *c = hk_step_choice_of(loop);
  double dt = s->dt_max * n->shorten;
  if (c->dt_limit > 0) dt = fmin(dt, of_limit * c->dt_limit); /* NAN and 0: not known, none */
  if (dt < farthest * s->dt_max) {
    add(s, "try --dt %.1g: the error is too large to tell which step would do", rounded(far_enough * s->dt_max));
    return;
  }
  dt = rounded(dt);
  add(s, "--dt %.1g (%.2g steps) would do, by the order of %s", dt, ceil(s->end / dt), c->integrator->plugin->name);
}

/* What a step may be off by is the tolerance, and h^(p + 1); their sum goes with h^p. */
static void describe_tolerance(const hk_loop *loop, const need *n, hk_summary *s) {
  double tol = loop->dynamics->system.tol, power = 1 + 1.0 / loop->method->order;
  add(s, "--tol %.1g would do, if the error follows the tolerance, which is %.1g",
      rounded(fmax(tol * pow(aim_of_tolerance / n->excess, power), least_tolerance)), tol);
}

void hk_remedy_describe(hk_loop *loop, const hk_judgement *j, hk_summary *s) {
  double w;
  const need n = worst_of(&j->opinion);
  if (!(n.excess > 1) || s->steps == 0) return;
  (loop->method->flags & HK_ADAPTIVE ? describe_tolerance : describe_step)(loop, &n, s);
  const char *label = hk_stiffest_force(loop, &w);
  if (label) add(s, "the fastest swings, of %.2g s, are those of '%s'", 2 * acos(-1) / w, label);
}
