/* Brouwer's law over a million orbits: the energy error of gauss_radau grows like the root of time. Orbits of
 * eccentricity 0.3 are followed for a million turns, 1.5 minutes; every tenfold time prints the largest error so far of
 * the turns' ends, and what one rounding error of 1.1e-16 in a step would add up to by a random walk. The program fails
 * where the error is beyond 1.5 times that, as one that grows with time would be by 1e3.
 *
 * Measured at 1e2, 1e3, 1e4, 1e5 and 1e6 turns: 1.8e-15, 6.4e-15, 3.8e-14, 1.3e-13 and 1.3e-12, where one rounding a
 * step makes 1.2e-14, 3.8e-14, 1.2e-13, 3.8e-13 and 1.2e-12: up to 1e5 turns it is the root, beyond it a part
 * of 1.3e-18 a turn shows that has one sign. Usage: brouwer [TURNS [ECCENTRICITY]] */
#include "tests/support/fake_system.h"

#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

static void kepler(const void *context, double t, const double *x, const double *v, const double *y, double *a,
                   double *dy) {
  (void)context, (void)t, (void)v, (void)y, (void)dy;
  double r2 = x[0] * x[0] + x[1] * x[1], r3 = r2 * sqrt(r2);
  a[0] = -x[0] / r3;
  a[1] = -x[1] / r3;
}

static double energy(const double *X) { return (X[3] * X[3] + X[4] * X[4]) / 2 - 1 / sqrt(X[0] * X[0] + X[1] * X[1]); }

/* Steps of the method's choice to the time `until`; the first one is h. Returns how many. */
static size_t turn(fake_system *f, fake_method *m, double until, double *h) {
  const hk_integrator *method = m->plugin->integrator;
  size_t steps = 0;
  for (; f->system.t < until; steps++) {
    hk_step out = {0, 0, NAN};
    double left = until - f->system.t;
    if (method->step(m->self, method->method, &f->system, until, fmin(*h, left), &out) != HK_OK) {
      fprintf(stderr, "brouwer: %s\n", f->message);
      exit(1);
    }
    f->system.t = out.h >= left ? until : f->system.t + out.h;
    *h = out.h_next;
  }
  return steps;
}

int main(int count, char **argument) {
  size_t turns = count > 1 ? strtoull(argument[1], NULL, 10) : 1000000, steps = 0, next = 100;
  double e = count > 2 ? strtod(argument[2], NULL) : 0.3, most = 0, h = INFINITY, period = 2 * acos(-1);
  bool held = true;
  fake_system *f = fake_system_create(&(fake_problem){1, 0, HK_DEPENDS_ON_X, kepler, NULL});
  f->system.X[0] = 1 - e;
  f->system.X[4] = sqrt((1 + e) / (1 - e));
  f->system.tol = DBL_EPSILON;
  fake_method m = fake_method_open("gauss_radau", f);
  double first = energy(f->system.X);
  for (size_t k = 1; k <= turns; k++) {
    steps += turn(f, &m, period * (double)k, &h);
    most = fmax(most, fabs(energy(f->system.X) / first - 1));
    if (k != next && k != turns) continue;
    double walk = DBL_EPSILON / 2 * sqrt((double)steps) * (1 + e) / (1 - e);
    printf("%8zu turns, %10zu steps: energy off by %.2e; one rounding a step: %.2e\n", k, steps, most, walk);
    fflush(stdout);
    held = held && most < 1.5 * walk;
    next *= 10;
  }
  fake_method_close(&m);
  fake_system_destroy(f);
  return held ? 0 : 1;
}
