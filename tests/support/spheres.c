#include "core/engine/contract/contract.h"
#include "tests/support/spheres.h"

#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

hk_plugin_spec *test_two_spheres(test_engine *e) {
  test_engine_open(e);
  test_particle(e, -0.15, 0, 0, 1);
  test_particle(e, 0.15, 0, 0, 2);
  e->scene->particles.velocity[0] = 1;
  e->scene->particles.velocity[3] = -1;
  return test_plugin(e, HK_FORCE, "fixture:barrier_spheres");
}

hk_plugin_spec *test_heap(test_engine *e) {
  test_engine_open(e);
  for (int i = 0; i < 10; i++) { /* layers of four, three, three, each askew */
    int layer = i < 4 ? 0 : i < 7 ? 1 : 2, j = i - (i < 4 ? 0 : i < 7 ? 4 : 7);
    double turn = 1.7 * layer + 6.283 * j / (layer == 0 ? 4 : 3);
    test_particle(e, 0.17 * cos(turn), 0.17 * sin(turn), 0.15 + 0.25 * layer + 0.003 * i, 0.5 + 0.1 * i);
  }
  test_plugin(e, HK_FORCE, "gravity");
  return test_plugin(e, HK_FORCE, "fixture:barrier_spheres");
}

static void *field(test_engine *e, const hk_plugin_spec *spec, const char *name, hk_type type) {
  hk_instance *instance = test_instance(e, spec);
  for (const hk_field *f = instance->plugin->fields; f && f->name; f++)
    if (strcmp(f->name, name) == 0 && hk_field_type(f) == type) return hk_field_in(f, instance->self);
  fail_msg("%s has no field %s of that type", spec->label, name);
  return NULL;
}

int64_t test_counter(test_engine *e, const hk_plugin_spec *spec, const char *name) {
  return *(int64_t *)field(e, spec, name, HK_INTEGER);
}

double test_field(test_engine *e, const hk_plugin_spec *spec, const char *name) {
  return *(double *)field(e, spec, name, HK_NUMBER);
}

double test_momentum(test_engine *e, int axis) {
  const hk_view *view = hk_run_view(e->run);
  double sum = 0;
  for (size_t i = 0; i < view->n; i++) sum += view->model->mass[i] * view->v[3 * i + (size_t)axis];
  return sum;
}
