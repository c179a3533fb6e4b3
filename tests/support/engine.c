#include "tests/support/engine.h"

#include <limits.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

static void must(test_engine *e, hk_status status) {
  if (status != HK_OK) fail_msg("%s", e->error.text);
}

void test_engine_open(test_engine *e) {
  *e = (test_engine){
      .options = {.dt = NAN, .tol = NAN, .until = NAN, .accuracy = NAN, .no_output = true, .progress = -1}};
  must(e, hk_registry_open(&e->registry, HK_BUILD "/plugins", NULL, &e->error));
  e->scene = hk_scene_create("test.lua", &e->registry);
  assert_non_null(e->scene);
  e->scene->trusted = true;
  e->scene->threads = 1;
}

void test_engine_close(test_engine *e) {
  if (e->run) hk_run_close(e->run, NULL);
  hk_run_destroy(e->run);
  hk_scene_destroy(e->scene);
  hk_registry_close(&e->registry);
}

uint32_t test_particle(test_engine *e, double x, double y, double z, double mass) {
  uint32_t id = 0;
  must(e, hk_scene_add_particles(e->scene, 1, (double[]){x, y, z}, NULL, NULL, mass, 0, &id, &e->error));
  return id;
}

hk_plugin_spec *test_plugin(test_engine *e, hk_kind kind, const char *name) {
  hk_plugin_spec *spec = NULL;
  char path[PATH_MAX];
  if (strncmp(name, "fixture:", 8) == 0) {
    snprintf(path, sizeof path, HK_BUILD "/tests/fixtures/%s.so", name + 8);
    name = path;
  }
  must(e, hk_scene_add_plugin(e->scene, kind, name, NULL, "", &spec, &e->error));
  return spec;
}

static void set(test_engine *e, hk_plugin_spec *spec, const char *name, const hk_value *value) {
  const hk_param *param = hk_spec_param(spec, name, &e->error);
  if (!param) fail_msg("%s", e->error.text);
  must(e, hk_spec_set(spec, param, value, e->scene->particles.n, &e->error));
}

void test_number(test_engine *e, hk_plugin_spec *spec, const char *name, double value) {
  set(e, spec, name, &(hk_value){.kind = HK_VALUE_NUMBER, .number = value});
}

void test_exact_integrator(test_engine *e, const char *name) {
  hk_plugin_spec *integrator = test_plugin(e, HK_INTEGRATOR, name);
  for (const hk_param *p = integrator->plugin->params; p && p->name; p++)
    if (strcmp(p->name, "tolerance") == 0) test_number(e, integrator, "tolerance", 1e-12);
}

void test_boolean(test_engine *e, hk_plugin_spec *spec, const char *name, bool value) {
  set(e, spec, name, &(hk_value){.kind = HK_VALUE_BOOLEAN, .boolean = value});
}

void test_function(test_engine *e, hk_plugin_spec *spec, const char *name, hk_function function) {
  const hk_param *param = hk_spec_param(spec, name, &e->error);
  assert_non_null(param);
  hk_value value = {.kind = HK_VALUE_FUNCTION, .function = function};
  assert_int_equal(hk_spec_set(spec, param, &value, e->scene->particles.n, &e->error), HK_OK);
}

void test_vector(test_engine *e, hk_plugin_spec *spec, const char *name, double x, double y, double z) {
  set(e, spec, name, &(hk_value){.kind = HK_VALUE_LIST, .count = 3, .list = (double[]){x, y, z}});
}

void test_text(test_engine *e, hk_plugin_spec *spec, const char *name, const char *text) {
  set(e, spec, name, &(hk_value){.kind = HK_VALUE_STRING, .text = text});
}

void test_list(test_engine *e, hk_plugin_spec *spec, const char *name, const double *list, size_t count) {
  set(e, spec, name, &(hk_value){.kind = HK_VALUE_LIST, .count = count, .list = list});
}

void test_tuples(test_engine *e, hk_plugin_spec *spec, const char *name, unsigned arity, const uint32_t *ids,
                 size_t count) {
  set(e, spec, name, &(hk_value){.kind = HK_VALUE_TUPLES, .count = count, .arity = arity, .tuples = ids});
}

void test_edges(test_engine *e, hk_plugin_spec *spec, const uint32_t (*edge)[2], size_t count) {
  test_tuples(e, spec, "edges", 2, &edge[0][0], count);
}

hk_instance *test_instance(test_engine *e, const hk_plugin_spec *spec) {
  const hk_instances *list = &e->run->plugins.kind[spec->plugin->kind];
  for (size_t k = 0; k < list->count; k++)
    if (list->item[k]->spec == spec) return list->item[k];
  fail_msg("%s is not in the run", spec->label);
  return NULL;
}

void test_pin(test_engine *e, hk_pin kind, uint32_t id, const double axis[3]) {
  hk_pin_spec spec = {.kind = kind, .count = 1, .id = &id, .release = INFINITY};
  if (axis) memcpy(spec.axis, axis, sizeof spec.axis);
  must(e, hk_scene_add_pin(e->scene, &spec, &e->error));
}

void test_run(test_engine *e) { must(e, hk_run_open(e->scene, &e->options, &e->run, &e->error)); }

void test_advance(test_engine *e, double t) { must(e, hk_run_advance(e->run, t, &e->error)); }

const double *test_position(test_engine *e, uint32_t id) {
  uint32_t index;
  return hk_run_index(e->run, id, &index) ? hk_run_view(e->run)->x + 3 * index : NULL;
}

const double *test_velocity(test_engine *e, uint32_t id) {
  uint32_t index;
  return hk_run_index(e->run, id, &index) ? hk_run_view(e->run)->v + 3 * index : NULL;
}
