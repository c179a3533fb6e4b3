/* The largest stable step of scenes with ropes, slack, exactly as long as at rest, or taut, against the step from which
 * on the energy grows: the estimate is never above it, nor far below. */
#include "core/numerics/step_choice/step_choice.h"
#include "tests/support/engine.h"

#include <setjmp.h>
#include <stdarg.h>

#include <cmocka.h>

enum { N = 12, PART = 50, PARTS = 200 }; /* 10^4 steps */

/* A chain of ropes along x, 0.1 m long at rest, with particles of 10 g that are jolted at random; with a zigzag it
 * moves in space. It hangs from one end, or is stretched between two. */
typedef struct chain {
  double stretch, damping, jolt, zigzag; /* 1, N s/m, m/s, m */
} chain;

static const double stiffness = 1000, rest = 0.1, mass = 0.01;

static void open_chain(test_engine *e, const chain *c, const char *method) {
  uint32_t edge[N - 1][2];
  test_engine_open(e);
  for (uint32_t i = 0; i < N; i++) test_particle(e, i * rest * c->stretch, c->zigzag * sin(2.0 * i), 0, mass);
  for (uint32_t i = 0; i + 1 < N; i++) edge[i][0] = i + 1, edge[i][1] = i + 2;
  hk_plugin_spec *ropes = test_plugin(e, HK_FORCE, "ropes");
  test_edges(e, ropes, (const uint32_t(*)[2])edge, N - 1);
  test_number(e, ropes, "k", stiffness);
  test_number(e, ropes, "damping", c->damping);
  test_number(e, ropes, "rest", rest);
  test_pin(e, HK_PIN_FIXED, 1, NULL);
  if (c->stretch > 1) test_pin(e, HK_PIN_FIXED, N, NULL);
  for (int i = 1; i < N - (c->stretch > 1); i++)
    for (int axis = 0; axis < (c->zigzag > 0 ? 3 : 1); axis++)
      e->scene->particles.velocity[3 * i + axis] = c->jolt * sin(7.3 * i + axis);
  e->scene->duration = 1e9;
  e->scene->fps = 1;
  test_plugin(e, HK_INTEGRATOR, method);
}

/* J above that of the chain at rest between its ends. */
static double energy_of(test_engine *e, const chain *c) {
  double kinetic, potential, work, stretched = c->stretch > 1 ? rest * (c->stretch - 1) : 0;
  hk_run_energy(e->run, &kinetic, &potential, &work);
  return kinetic + potential - (N - 1) * stiffness * stretched * stretched / 2;
}

static double estimate(const chain *c, const char *method) {
  test_engine e;
  open_chain(&e, c, method);
  test_run(&e);
  double limit = e.run->step->dt_limit;
  test_engine_close(&e);
  return limit;
}

/* To three times what it was, which no rounding and no phase of a swing does. */
static bool grows(const chain *c, const char *method, double dt) {
  test_engine e;
  bool grown = false;
  open_chain(&e, c, method);
  e.options.dt = dt;
  e.scene->fps = 1 / (PART * dt);
  test_run(&e);
  double first = energy_of(&e, c);
  for (int k = 1; k <= PARTS && !grown; k++)
    grown = hk_run_advance(e.run, (k - 0.5) * PART * dt, &e.error) != HK_OK || !(energy_of(&e, c) < 3 * first);
  test_engine_close(&e);
  return grown;
}

static const chain undamped[] = {{0.9, 0, 1, 0},    {1, 0, 1, 0},    {1.001, 0, 0.01, 0},    {1.2, 0, 0.01, 0},
                                 {0.9, 0, 1, 0.02}, {1, 0, 1, 0.02}, {1.001, 0, 0.01, 0.02}, {1.2, 0, 1, 0.02}};
static const chain damped[] = {
    {0.9, 1, 1, 0}, {1, 1, 1, 0.02}, {1.2, 1, 0.01, 0}, {0.9, 3, 1, 0.02}, {1.2, 3, 0.01, 0}};

/* The estimate, and nine tenths and less of it, do not let the energy grow; `beyond` times it does. */
static void expect(const chain *c, const char *method, double beyond) {
  double limit = estimate(c, method), dt;
  assert_true(isfinite(limit) && limit > 0);
  for (dt = 0.5 * limit; dt < limit; dt *= 1.09)
    if (grows(c, method, dt))
      fail_msg("%s, stretch %g, damping %g, zigzag %g: grows at %.3g of the estimate %g s", method, c->stretch,
               c->damping, c->zigzag, dt / limit, limit);
  for (dt = limit; dt < beyond * limit && !grows(c, method, dt); dt *= 1.03) continue;
  if (dt >= beyond * limit)
    fail_msg("%s, stretch %g, damping %g, zigzag %g: %.3g times the estimate %g s is stable", method, c->stretch,
             c->damping, c->zigzag, beyond, limit);
}

/* Symplectic methods are granted 0.45 of the limit of taut ropes, which is what those need that turn slack and taut:
 * what stays taut would bear 1 / 0.45 = 2.22 times the estimate, 6 % being the steps of the
 * search and what grows too slowly to show. */
static void undamped_ropes_with_symplectic_methods(void **state) {
  (void)state;
  for (size_t k = 0; k < sizeof undamped / sizeof *undamped; k++) {
    expect(&undamped[k], "leapfrog", 1.06 * 2.22);
    expect(&undamped[k], "symplectic_euler", 1.06 * 2.22);
  }
}

/* Between the limit of taut ropes and twice that. */
static void undamped_ropes_with_stoermer(void **state) {
  (void)state;
  for (size_t k = 0; k < sizeof undamped / sizeof *undamped; k++) expect(&undamped[k], "stoermer", 2);
}

/* Damping that is there only while a rope is taut counts whole. It also takes what switching gives, and a chain that is
 * slack most of the time bears up to three times the step of one that is taut. */
static void damped_ropes(void **state) {
  (void)state;
  static const char *const methods[] = {"leapfrog", "symplectic_euler", "stoermer"};
  for (size_t k = 0; k < sizeof damped / sizeof *damped; k++)
    for (size_t m = 0; m < sizeof methods / sizeof *methods; m++) expect(&damped[k], methods[m], 3);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(undamped_ropes_with_symplectic_methods),
      cmocka_unit_test(undamped_ropes_with_stoermer),
      cmocka_unit_test(damped_ropes),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
