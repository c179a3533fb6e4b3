/* Scenes of what melts by the channel `temperature`, K. */
#ifndef TEST_MELTING_H
#define TEST_MELTING_H

#include "tests/support/engine.h"

#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

/* All particles are at T at the start. */
static inline void melting_channel(test_engine *e, double T) {
  assert_int_equal(hk_scene_add_channel(e->scene, "temperature", 1, &T, NAN, NULL, &e->error), HK_OK);
}

/* rate: K/s, of all particles. */
static inline void melting_warms(test_engine *e, double rate) {
  hk_plugin_spec *relax = test_plugin(e, HK_FORCE, "relax");
  test_text(e, relax, "channel", "temperature");
  test_number(e, relax, "growth", rate);
}

static inline void melting_follows(test_engine *e, hk_plugin_spec *spec, double softens, double range) {
  test_text(e, spec, "channel", "temperature");
  test_number(e, spec, "softens", softens);
  test_number(e, spec, "range", range);
}

/* The scene is refused when the plugin asks for a channel that is not there. */
static inline void melting_needs_its_channel(test_engine *e, hk_plugin_spec *spec) {
  test_text(e, spec, "channel", "warmth");
  assert_int_equal(hk_run_open(e->scene, &e->options, &e->run, &e->error), HK_BAD_PARAM);
  assert_non_null(strstr(e->error.text, "warmth"));
}

#endif
