/* Which step or tolerance would do where a run is inaccurate, or which method may: by the order of the method, from how
 * far each figure is above what it may be. It aims at half of that. What is far off is not extrapolated: the error does
 * not follow its order there. Where another run has tried it (run/verify.c), what that showed is said. */
#include "core/engine/contract/contract.h"
#include "core/engine/text/text.h"
#include "core/numerics/step_choice/step_choice.h"
#include "core/run/judge/judge.h"

#include <stdio.h>

static const double aim = 0.5, aim_of_tolerance = 0.1 /* errors follow it loosely, and it costs little */,
                    farthest = 1e-3 /* of the step */, far_enough = 0.1, of_limit = 0.9,
                    usual_finest = 1e-13; /* rounding is 2e-16 a step */

/* The worst finding that a step or a tolerance cures. */
typedef struct need {
  double excess;  /* how far it is above what is allowed */
  double shorten; /* the part of the step that would do */
  double order;   /* of the finding that asks for that part */
} need;

static need worst_of(const hk_opinion *o) {
  need n = {1, 1, 1};
  for (size_t k = 0; k < o->count; k++) {
    const hk_finding *f = &o->finding[k];
    if (!(f->excess > 1)) continue;
    n.excess = fmax(n.excess, f->excess);
    double part = pow(aim / f->excess, 1.0 / f->order);
    if (part < n.shorten) n.shorten = part, n.order = f->order;
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

/* Of the order on which the step rests: what half the step showed, or an assumption. */
static void describe_order(const hk_loop *loop, const hk_judgement *j, double order, char *text, size_t size) {
  const char *name = loop->integrator->plugin->name;
  if (j->comparisons.order > 0 && order != loop->method->order)
    snprintf(text, size, "the error falls with the step to the power %.2g, as half the step shows", order);
  else if (order != loop->method->order)
    snprintf(text, size, "the error falls with the step to the power %.2g, as impacts leave it (not tried)", order);
  else
    snprintf(text, size, "the error falls with the step to the power %.2g, the order of %s (%s)", order, name,
             j->comparisons.order > 0 ? "and half the step shows it" : "not tried");
}

/* 0: too far off to tell. */
static double wanted_step(const hk_loop *loop, const need *n, const hk_summary *s) {
  const hk_step_choice *c = hk_step_choice_of(loop);
  double dt = s->dt_max * n->shorten;
  if (c->dt_limit > 0) dt = fmin(dt, of_limit * c->dt_limit); /* NAN and 0: not known, none */
  return dt < farthest * s->dt_max ? 0 : rounded(dt);
}

static void describe_step(const hk_loop *loop, const hk_judgement *j, const need *n, hk_summary *s) {
  char order[160];
  double dt = wanted_step(loop, n, s);
  if (dt == 0) {
    add(s, "try --dt %.1g: the error is too large to tell which step would do", rounded(far_enough * s->dt_max));
    return;
  }
  if (s->contact_frames > 0) {
    add(s, "try --dt %.1g (%.2g steps, not tried): errors of surfaces in contact follow no order", dt,
        ceil(s->end / dt));
    return;
  }
  describe_order(loop, j, n->order, order, sizeof order);
  add(s, "--dt %.1g (%.2g steps) would do if %s", dt, ceil(s->end / dt), order);
}

double hk_finest_tolerance(const hk_integrator *method) {
  double stated = hk_integrator_tables_of(method)->adaptive.finest;
  return stated > 0 ? stated : usual_finest;
}

static bool is_finer(const hk_plugin *plugin, const void *than) {
  const hk_integrator *m = plugin->integrator;
  bool plain = !(m->flags & (HK_IMPLICIT | HK_NEEDS_SOLVER | HK_NEEDS_JACOBIAN));
  return plain && m->flags & HK_ADAPTIVE && hk_finest_tolerance(m) < hk_finest_tolerance(than);
}

/* Where no tolerance of the method would do. Another method need not do either, and is not tried here. */
static void describe_method(const hk_loop *loop, const hk_judgement *j, hk_summary *s) {
  const hk_plugin *finer;
  hk_error none = {0};
  const char *name = loop->integrator->plugin->name;
  double finest = hk_finest_tolerance(loop->method);
  bool found = j->scene->plugin[HK_CONSTRAINT].count == 0 &&
               hk_registry_prefer(j->scene->registry, HK_INTEGRATOR, is_finer, loop->method, &finer, &none) == HK_OK;
  if (found)
    add(s, "no --tol would do, as errors of %s fall to tolerances of %.1g: try --integrator %s", name, finest,
        finer->name);
  else
    add(s, "no --tol would do, as errors of %s fall to tolerances of %.1g: what is left are rounding errors", name,
        finest);
}

/* What a step may be off by is the tolerance, and h^(p + 1); their sum goes with h^p. */
static double wanted_tolerance(const hk_loop *loop, const need *n) {
  double power = 1 + 1.0 / loop->method->order;
  return loop->dynamics->system.tol * pow(aim_of_tolerance / n->excess, power);
}

static void describe_tolerance(const hk_loop *loop, const hk_judgement *j, const need *n, hk_summary *s) {
  double tol = loop->dynamics->system.tol, wanted = wanted_tolerance(loop, n),
         finest = hk_finest_tolerance(loop->method);
  if (wanted < finest && !(finest < aim_of_tolerance * tol))
    describe_method(loop, j, s);
  else if (wanted < finest)
    add(s, "try --tol %.1g, the smallest that %s makes use of: the error is too large to tell which would do", finest,
        loop->integrator->plugin->name);
  else
    add(s, "--tol %.1g would do, if the error follows the tolerance, which is %.1g", rounded(wanted), tol);
}

hk_remedy hk_remedy_propose(const hk_loop *loop, const hk_judgement *j, const hk_summary *s) {
  const need n = worst_of(&j->opinion);
  hk_remedy r = {0};
  if (!(n.excess > 1) || s->steps == 0) return r;
  bool adaptive = loop->method->flags & HK_ADAPTIVE;
  double wanted = adaptive ? wanted_tolerance(loop, &n) : wanted_step(loop, &n, s);
  if (!adaptive)
    r.dt = wanted;
  else if (!(wanted < hk_finest_tolerance(loop->method)))
    r.tol = rounded(wanted);
  return r;
}

/* False: none was tried. */
static bool describe_trial(const hk_remedy *r, hk_summary *s) {
  const char *found = r->ok ? "would do: a run with it is ok" : "was tried, and is not enough";
  if (r->tried && r->dt > 0) add(s, "--dt %.1g (%.2g steps) %s", r->dt, ceil(s->end / r->dt), found);
  if (r->tried && r->tol > 0) add(s, "--tol %.1g %s", r->tol, found);
  return r->tried;
}

void hk_remedy_describe(hk_loop *loop, const hk_judgement *j, hk_summary *s) {
  double w;
  const need n = worst_of(&j->opinion);
  if (!(n.excess > 1) || s->steps == 0) return;
  bool tried = describe_trial(&j->comparisons.remedy, s);
  if (!tried && loop->method->flags & HK_ADAPTIVE)
    describe_tolerance(loop, j, &n, s);
  else if (!tried)
    describe_step(loop, j, &n, s);
  const char *label = hk_stiffest_force(loop, &w);
  if (label) add(s, "the fastest swings, of %.2g s, are those of '%s'", 2 * acos(-1) / w, label);
}
