/* A step that is granted is stable for every mode that a scene may have, and not only for those at the ends of its
 * spectrum: without damping, in a drag, and with damping that rises with the square of the frequency, none of 4,000
 * frequencies grows at a step up to the limit, for every explicit method. */
#include "core/numerics/stability/stability.h"
#include "tests/support/fake_system.h"

#include <setjmp.h>
#include <stdarg.h>
#include <string.h>
#include <cmocka.h>

enum { MODES = 4000, PARTS = 4 };

/* Growth a step that counts as none: five times what largest_step.c allows at the frequencies of its grid. Between them
 * it is up to 7e-7, in domains without a sharp end (stoermer5). */
static const double excess = 1e-6;

static void spring(const void *context, double t, const double *x, const double *v, const double *y, double *a,
                   double *dy) {
  (void)context, (void)t, (void)v, (void)y, (void)dy;
  for (int c = 0; c < 3; c++) a[c] = -x[c];
}

/* The frequency of 1/s to which the growth is the largest at a step h; *growth: that. */
static double worst_mode(const fake_method *m, const hk_spectrum *s, double h, double *growth) {
  const hk_split_facet *split = &hk_integrator_of(m->plugin)->split;
  double worst = 0;
  *growth = 0;
  for (int k = 1; k <= MODES; k++) {
    double w = s->w_max * k / MODES, g = fmin(hk_spectrum_floor(s, w), s->g_max);
    double here =
        split->coupled_growth ? split->coupled_growth(m->self, h, w, g, 0) : fake_method_growth(m, h * w, h * g, 0);
    if (here > *growth) *growth = here, worst = w;
  }
  return worst;
}

static void try_method(const fake_method *m, const hk_spectrum *s) {
  hk_stable stable = hk_stable_step(m->plugin->integrator, m->self, s);
  if (!(stable.limit > 0) || !isfinite(stable.limit)) return;
  for (int k = PARTS; k > 0; k--) {
    double growth, h = stable.limit * k / PARTS, w = worst_mode(m, s, h, &growth);
    if (growth > 1 + excess)
      fail_msg("%s, drag %g, damping %g: at h w_max = %g the mode of h w = %g grows by %g a step", m->plugin->name,
               s->alpha, s->beta, h * s->w_max, h * w, growth - 1);
  }
}

static void no_mode_grows_at_a_step_that_is_granted(void **state) {
  (void)state;
  static const double damping[][2] = {{0, 0},    {1e-3, 0}, {1e-2, 0},   {0, 1e-5},
                                      {0, 1e-3}, {0, 1e-2}, {0.03, 1e-3}}; /* of w_max = 1/s */
  const char *names[FAKE_METHODS];
  size_t count = fake_integrator_names(names);
  fake_system *f = fake_system_create(&(fake_problem){1, 0, HK_DEPENDS_ON_X, spring, NULL});
  for (size_t k = 0; k < count; k++) {
    fake_method m = fake_method_open(names[k], f);
    for (size_t d = 0; d < sizeof damping / sizeof *damping; d++) {
      double alpha = damping[d][0], beta = damping[d][1];
      hk_spectrum s = {.w_max = 1, .w_reached = 1, .g_max = alpha + beta, .alpha = alpha, .beta = beta};
      if (fake_method_explicit(&m) && m.plugin->integrator->growth) try_method(&m, &s);
    }
    fake_method_close(&m);
  }
  fake_system_destroy(f);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(no_mode_grows_at_a_step_that_is_granted)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
