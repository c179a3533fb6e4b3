/* For tests that drive the engine through its C interface, without Lua. */
#ifndef HK_TEST_ENGINE_H
#define HK_TEST_ENGINE_H

#include "core/run/run/run.h"
#include "core/scene/scene/scene.h"

typedef struct test_engine {
  hk_registry registry;
  hk_scene *scene;
  hk_run *run;
  hk_run_options options;
  hk_error error;
} test_engine;

/* A registry of the built plugins and an empty scene. Fails the test when that cannot be had. */
void test_engine_open(test_engine *);
void test_engine_close(test_engine *);
/* Adds one particle; returns its id. */
uint32_t test_particle(test_engine *, double x, double y, double z, double mass);
/* Adds a plugin by name, or a fixture by "fixture:NAME"; parameters are set with the functions below. */
hk_plugin_spec *test_plugin(test_engine *, hk_kind kind, const char *name);
/* The scene's integrator; with a parameter `tolerance`, of algebraic errors, that is 1e-12. */
void test_exact_integrator(test_engine *, const char *name);
void test_number(test_engine *, hk_plugin_spec *, const char *name, double value);
void test_boolean(test_engine *, hk_plugin_spec *, const char *name, bool value);
void test_function(test_engine *, hk_plugin_spec *, const char *name, hk_function); /* of a timed parameter */
void test_vector(test_engine *, hk_plugin_spec *, const char *name, double x, double y, double z);
void test_text(test_engine *, hk_plugin_spec *, const char *name, const char *text);
void test_list(test_engine *, hk_plugin_spec *, const char *name, const double *list, size_t count);
void test_edges(test_engine *, hk_plugin_spec *, const uint32_t (*edge)[2], size_t count);
/* Tuples of ids, `arity` each. */
void test_tuples(test_engine *, hk_plugin_spec *, const char *name, unsigned arity, const uint32_t *ids, size_t count);
void test_pin(test_engine *, hk_pin kind, uint32_t id, const double axis[3]);
/* What the spec has become in the run, once it is open. */
hk_instance *test_instance(test_engine *, const hk_plugin_spec *);
/* Opens the run with the options; advances it. Both fail the test on an error. */
void test_run(test_engine *);
void test_advance(test_engine *, double t);
const double *test_position(test_engine *, uint32_t id); /* NULL: no such particle */
const double *test_velocity(test_engine *, uint32_t id);

#endif
