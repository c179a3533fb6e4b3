/* The pull to a point, at rest and moving, against closed forms; and by the user's hand: continuous, and its work. */
#include "plugins/common/hand/hand.h"
#include "tests/support/force_check.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static hk_plugin_spec *open_scene(test_engine *e, double k, double damping) {
  test_engine_open(e);
  test_particle(e, 1, 0, 0, 2);
  test_particle(e, 0, 3, -1, 0.5);
  e->options.dt = 1e-3;
  hk_plugin_spec *pull = test_plugin(e, HK_FORCE, "pull");
  test_number(e, pull, "k", k);
  test_number(e, pull, "damping", damping);
  test_vector(e, pull, "target", 0, 0, 1);
  return pull;
}

static void by_hand_on_paper(void **state) {
  (void)state;
  test_engine e;
  hk_plugin_spec *spec = open_scene(&e, 10, 0);
  const double one[] = {2};
  test_list(&e, spec, "particles", one, 1);
  test_run(&e);
  hk_instance *pull = test_instance(&e, spec);
  hk_view view = force_view(&e, pull);
  double F[6];
  force_evaluate(pull, &view, F);
  const double wanted[] = {0, 0, 0, 0, -30, 20};
  for (int c = 0; c < 6; c++) assert_true(fabs(F[c] - wanted[c]) < 1e-13);
  test_engine_close(&e);
}

static void the_jacobian_is_the_forces(void **state) {
  (void)state;
  test_engine e;
  hk_plugin_spec *spec = open_scene(&e, 10, 0.7);
  test_run(&e);
  hk_instance *pull = test_instance(&e, spec);
  hk_view view = force_view(&e, pull);
  assert_true(force_stiffness_error(pull, &view) < FORCE_DIFFERENCES);
  test_engine_close(&e);
}

static hk_status circle(const hk_function *f, const void *caller, const double *in, size_t n_in, double *out,
                        size_t room, size_t *got, hk_error *error) {
  (void)f, (void)caller, (void)n_in, (void)room, (void)error;
  out[0] = cos(3 * in[0]);
  out[1] = out[2] = 0;
  *got = 3;
  return HK_OK;
}

/* m x'' = k (cos 3t - x) from (1, 0, 0) at rest, m = 2, k = 10, w^2 = 5: x = cos wt + 5/(5 - 9) (cos 3t - cos wt). rk4
 * with steps of 1 ms is off by less than 1e-11 there: (w h)^4 = 2.5e-11. */
static void a_moving_target_drives_the_particle(void **state) {
  (void)state;
  test_engine e;
  hk_plugin_spec *spec = open_scene(&e, 10, 0);
  test_plugin(&e, HK_INTEGRATOR, "rk4");
  test_function(&e, spec, "target", (hk_function){.call = circle});
  test_run(&e);
  test_advance(&e, 1);
  double w = sqrt(5), x = cos(w) - 1.25 * (cos(3) - cos(w));
  assert_true(fabs(test_position(&e, 1)[0] - x) < 1e-10);
  test_engine_close(&e);
}

static void what_is_missing_is_said(void **state) {
  (void)state;
  test_engine e;
  hk_run *run = NULL;
  test_engine_open(&e);
  test_particle(&e, 1, 0, 0, 2);
  test_plugin(&e, HK_FORCE, "pull");
  assert_int_equal(hk_run_open(e.scene, &e.options, &run, &e.error), HK_BAD_PARAM);
  assert_non_null(strstr(e.error.text, "k: the stiffness"));
  test_engine_close(&e);
}

/* ---- the user's hand ---- */

static const hk_hand *hand_of(test_engine *e) {
  const hk_instances *services = &e->run->plugins.kind[HK_SERVICE];
  for (size_t k = 0; k < services->count; k++)
    if (strcmp(services->item[k]->plugin->name, "grip") == 0)
      return services->item[k]->plugin->service->table(services->item[k]->self);
  fail_msg("the hand is not there");
  return NULL;
}

static void open_hand(test_engine *e) {
  test_engine_open(e);
  test_particle(e, 1, 0, 0, 2);
  test_particle(e, 0, 3, -1, 0.5);
  test_plugin(e, HK_INTEGRATOR, "leapfrog");
  test_boolean(e, test_plugin(e, HK_FORCE, "pull"), "by_hand", true);
  e->options.dt = 1e-3;
  test_run(e);
}

static void a_hand_that_holds_nothing_does_nothing(void **state) {
  (void)state;
  test_engine e;
  hk_summary s;
  open_hand(&e);
  test_advance(&e, 0.5);
  hk_run_summary(e.run, &s);
  assert_true(isnan(s.hand_work));
  assert_true(test_position(&e, 1)[0] == 1);
  test_engine_close(&e);
}

/* Between frames the hand and its hold are linear in time, so that they do not jump at a frame. */
static void the_grip_is_continuous(void **state) {
  (void)state;
  test_engine e;
  open_hand(&e);
  const hk_hand *hand = hand_of(&e);
  hk_view view = *hk_run_view(e.run);
  double place[2][3] = {{3, 0, 0}, {5, 1, 0}}, frame = 1.0 / 60;
  hand->move(hand->self, &view, frame, 1, place[0], 1);
  hk_grip g = hand->grip(hand->self, 0);
  assert_true(g.id == 1 && g.hold == 0 && g.place[0] == 1); /* taken where it is */
  g = hand->grip(hand->self, frame / 2);
  assert_true(fabs(g.hold - 0.5) < 1e-15 && fabs(g.place[0] - 2) < 1e-15);
  view.t = frame;
  hand->move(hand->self, &view, frame, 1, place[1], 1);
  g = hand->grip(hand->self, frame);
  assert_true(g.hold == 1 && g.place[0] == 3);
  view.t = 2 * frame;
  hand->move(hand->self, &view, frame, 0, place[1], 1);
  g = hand->grip(hand->self, 2 * frame);
  assert_true(g.id == 1 && g.hold == 1 && g.place[0] == 5 && g.place[1] == 1);
  view.t = 3 * frame;
  hand->move(hand->self, &view, frame, 0, place[1], 1);
  assert_true(hand->grip(hand->self, 3 * frame).id == 0);
  test_engine_close(&e);
}

/* Where nothing else acts, what the hand did is what the particle has: kinetic energy. The trapezoidal sum is off by
 * some h^2 of it: (w h)^2/12 = 1e-4 with w of about 40/s and steps of 1 ms. */
static void its_work_is_the_kinetic_energy(void **state) {
  (void)state;
  test_engine e;
  hk_summary s;
  open_hand(&e);
  const hk_hand *hand = hand_of(&e);
  for (int k = 0; k < 30; k++) {
    double place[3] = {1 + 0.1 * k, 0, 0.02 * k};
    hand->move(hand->self, hk_run_view(e.run), 1.0 / 60, k < 25 ? 1 : 0, place, 1);
    test_advance(&e, (k + 1) / 60.0);
  }
  hk_run_summary(e.run, &s);
  const double *v = test_velocity(&e, 1);
  double kinetic = v[0] * v[0] + v[1] * v[1] + v[2] * v[2]; /* of 2 kg */
  assert_true(test_position(&e, 1)[0] > 2 && kinetic > 1);
  if (!(fabs(s.hand_work - kinetic) < 1e-3 * kinetic)) fail_msg("work %g J, kinetic energy %g J", s.hand_work, kinetic);
  assert_true(fabs(s.energy_work - kinetic) < 1e-2 * kinetic);
  test_engine_close(&e);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(by_hand_on_paper),
      cmocka_unit_test(the_jacobian_is_the_forces),
      cmocka_unit_test(a_moving_target_drives_the_particle),
      cmocka_unit_test(what_is_missing_is_said),
      cmocka_unit_test(a_hand_that_holds_nothing_does_nothing),
      cmocka_unit_test(the_grip_is_continuous),
      cmocka_unit_test(its_work_is_the_kinetic_energy),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
