/* What a method damps by itself. Implicit methods that are stable at any step and take energy from what they do not
 * resolve (backward Euler, BDF) are chosen for that: the growth factor of an undamped oscillator falls below 1 as
 * h w grows, and stays there. Of backward Euler it is (1 + (h w)^2)^(-1/2) (Hairer and Wanner, Solving Ordinary
 * Differential Equations II, 1996, IV.3). */
#include "core/engine/contract/contract.h"
#include "core/numerics/step_choice/step_choice.h"
#include "core/run/judge/judge.h"

static const double unresolved = 1e3, taken = 0.999, first = 1e-4, ratio = 1.02, pi = 3.14159265358979324;

/* The factor of the amplitude in so many steps. */
static double kept(const hk_step_choice *c, double hw, double steps) {
  return pow(c->method->growth(c->parameters, c->method->method, hw, 0, 0), steps);
}

/* s, the longest period of which half is left after `steps`, 0: after a swing. */
static double halved(const hk_loop *loop, double steps) {
  const hk_step_choice *c = hk_step_choice_of(loop);
  const hk_integrator *m = c->method;
  bool states = m->growth && !hk_integrator_tables_of(m)->split.coupled_growth && !(loop->record->worst_error > 0);
  if (!states || loop->record->steps == 0) return NAN;
  const hk_instance *outer = hk_enter(c->integrator);
  double hw = m->growth(c->parameters, m->method, unresolved, 0, 0) < taken ? first : INFINITY;
  while (hw < unresolved && kept(c, hw, steps > 0 ? steps : 2 * pi / hw) > 0.5) hw *= ratio;
  hk_leave(c->integrator, outer);
  return hw < unresolved ? 2 * pi * loop->record->dt_max / hw : NAN;
}

double hk_damps_below(const hk_loop *loop) { return halved(loop, 0); }

double hk_damps_by_now(const hk_loop *loop) { return halved(loop, (double)loop->record->steps); }
