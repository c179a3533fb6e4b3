/* The force barrier beside constraints: in an implicit step both stand in one saddle point, so that surfaces of bars
 * neither intersect nor change their lengths, at steps of 1/240 s. 1e-12 m: what the projection leaves. */
#include "tests/support/bar_box.h"

#include <stdio.h>
#include <string.h>

static void a_box_of_bars_rests_on_a_barrier(void **state) {
  static const char *const methods[] = {"bdf2", "backward_euler"};
  (void)state;
  for (int k = 0; k < 2; k++) {
    test_engine w;
    hk_summary s;
    test_engine_open(&w);
    w.options.integrator = methods[k];
    w.options.dt = 1.0 / 240;
    w.scene->duration = 1;
    w.scene->fps = 30;
    bar_box_add(&w, "bars");
    hk_plugin_spec *barrier = test_plugin(&w, HK_FORCE, "barrier");
    test_number(&w, barrier, "thickness", 4e-3);
    test_number(&w, barrier, "friction", 0.3);
    test_run(&w);
    test_advance(&w, 1);
    hk_run_summary(w.run, &s);
    print_message(
        "box of bars on a barrier, %s: %g intersections at %g frames, least gap %.1e m, lengths off by %.1e m\n",
        methods[k], s.intersections, s.contact_frames, s.closest, s.constraint_violation);
    assert_true(s.contact_frames >= 30 && s.intersections == 0 && s.closest > 0);
    assert_true(s.constraint_violation < 1e-12);
    test_engine_close(&w);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(a_box_of_bars_rests_on_a_barrier)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
