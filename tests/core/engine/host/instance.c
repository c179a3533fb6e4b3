/* Instances of plugins: what stays of one that is gone. */
#include "tests/support/engine.h"

#include "core/engine/host/host.h"

#include <setjmp.h>
#include <stdarg.h>

#include <cmocka.h>

/* The handlers of signals and of exit() look at who is at work, at any time. */
static void who_is_gone_is_not_at_work(void **state) {
  (void)state;
  const hk_instance *volatile acting = NULL;
  test_engine e;
  test_engine_open(&e);
  hk_shared shared = {.error = &e.error, .acting = &acting};
  hk_plugin_spec *spec = test_plugin(&e, HK_FORCE, "gravity");
  hk_instance *gone = hk_instance_create(spec, &shared, &e.error), *other = hk_instance_create(spec, &shared, &e.error);
  assert_true(gone && other);
  acting = gone;
  hk_instance_destroy(gone);
  assert_null(acting);
  acting = other;
  hk_instance_destroy(hk_instance_create(spec, &shared, &e.error));
  assert_ptr_equal(acting, other);
  hk_instance_destroy(other);
  test_engine_close(&e);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(who_is_gone_is_not_at_work),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
