/* Lists of tuples of a plugin's parameters, several in one table, with numbers per tuple: what is refused, and what
 * births and deaths do to them. */
#include "core/engine/contract/contract.h"
#include "tests/support/command.h"
#include "tests/support/element_scenes.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#define AREA HK_BUILD "/tests/fixtures/area_springs.so"
#define VOLUME HK_BUILD "/tests/fixtures/volume_springs.so"
#define GRID                                                                                                           \
  "local scene = hooke.scene { duration = 0.1, dt = 0.01 }\nlocal g = scene:grid { nx = 3, ny = 2, mass = 1 }\n"
#define END "return scene\n"

static void refused(const char *params, const char *text) {
  char scene[1024];
  snprintf(scene, sizeof scene, GRID "scene:force('%s', { %s, label = 'skin' })\n" END, AREA, params);
  test_refused(scene, "--trust", 1, text);
}

static void wrong_tuples_are_refused_by_the_list_and_the_place(void **state) {
  (void)state;
  refused("triangles = {{1, 2, 3}, {4, 5, 4}}, k = 1", "bad.lua:3: skin: triangles[2] joins particle 4 to itself");
  refused("triangles = {{1, 2, 7}}, k = 1", "skin: triangles[1] = {1, 2, 7}: there is no particle 7 (ids are 1 to 6)");
  refused("triangles = {{0, 2, 3}}, k = 1", "skin: triangles[1] = {0, 2, 3}: there is no particle 0");
  refused("triangles = {{1, 2}}, k = 1", "skin: triangles: expected a list of triangles, {{1, 2, 3}}");
  refused("triangles = {{1, 2, 3, 4}}, k = 1", "skin: triangles: expected a list of triangles, {{1, 2, 3}}");
  refused("triangles = {{1, 2, 3}}, k = 1, edges = {{1, 2, 3}}", "skin: edges: expected a list of edges");
  refused("triangles = {1, 2, 3}, k = 1", "skin: triangles: expected a list of triangles, {{1, 2, 3}}");
  refused("triangles = {g:triangles(), {1, 2}}, k = 1", "skin: triangles: expected a list of triangles");
  refused("triangles = (function() local t = {}; t[1] = t; return t end)(), k = 1",
          "skin: triangles: expected a list of triangles");
  refused("triangles = {{1, 2, 'a'}}, k = 1", "skin: triangles: expected a list of triangles, {{1, 2, 3}}");
  refused("k = 1", "skin: the parameter 'triangles' (triples of particles) is required");
}

static void counts_that_differ_name_the_list_they_go_with(void **state) {
  (void)state;
  refused("triangles = g:triangles(), k = {1, 2, 3}", "skin: k has 3 numbers for 4 triangles: give one, or one for each");
  refused("triangles = {{1, 2, 4}}, k = 1, edges = {{1, 2}, {2, 3}}, edge_k = {1, 2, 3}",
          "skin: edge_k has 3 numbers for 2 edges");
  refused("triangles = {{1, 2, 4}}, k = 1, edge_k = {1, 2}", "skin: edge_k has 2 numbers for 0 edges");
  refused("triangles = g:triangles(), k = {1, 2, -3, 4}", "skin: k[3]: -3 J/m^4 is below the minimum 0");
}

static test_result r;

static double measured(const char *body, const char *expression) {
  char scene[2048];
  snprintf(scene, sizeof scene, GRID "%s\nscene:measure('m', function(s) return %s end)\n" END, body, expression);
  test_write("tuples.lua", scene);
  test_hooke(&r, NULL, "run tuples.lua --trust --json --quiet");
  if (r.code != 0) fail_msg("exit %d: %s", r.code, r.err);
  return test_json(r.out, "m");
}

static void scripts_give_lists_of_builders_and_written_ones(void **state) {
  (void)state;
  const char *of_grid = "scene:force('" AREA "', { triangles = g:triangles(), k = 1, rest = 0.1, label = 'skin' })";
  const char *written = "scene:force('" AREA "', { triangles = {{1, 2, 5}, {1, 5, 4}}, k = {1, 2}, rest = 0.1,\n"
                        "  edges = g:edges(), edge_k = 3, label = 'skin' })";
  const char *solid = "local p = scene:particle { position = {0, 0, 1}, mass = 1 }\n"
                      "scene:force('" VOLUME "', { tetrahedra = {{1, 3, 4, p}}, k = 1, rest = 0.1, label = 'solid' })";
  /* A grid of 1 m x 1 m by default has triangles of 1/4 m^2: C/rest = (0.25 - 0.1)/0.1 at the start; stiffness 1 moves
   * little in 0.1 s. */
  assert_true(fabs(measured(of_grid, "s:strain('skin')") - 1.5) < 0.05);
  assert_true(fabs(measured(written, "s:strain('skin')") - 1.5) < 0.05);
  const char *mixed = "scene:force('" AREA "', { triangles = { g:triangles(), {1, 2, 6}, { {{2, 3, 4}} } },\n"
                      "  k = {1, 2, 3, 4, 5, 6}, rest = 0.1, label = 'skin' })";
  assert_true(measured(mixed, "s:strain('skin')") > 1);
  /* 1 m x 1 m x 1 m / 6 */
  assert_true(fabs(measured(solid, "s:strain('solid')") - (1.0 / 6 - 0.1) / 0.1) < 0.05);
}

static void check_list(const hk_elements *list, unsigned arity, size_t count, double first_k) {
  assert_int_equal(list->node.arity, arity);
  assert_int_equal(list->node.count, count);
  for (size_t k = 0; k < count; k++) assert_true(hk_tuple_value(&list->stiffness, k) == first_k + (double)k);
}

/* Of a sheet of 3 x 3 the particle 1 dies, and with it the first two triangles and the first two edges: their numbers
 * go, and the others stay with their tuples. */
static void deaths_take_their_tuples_and_their_numbers_of_the_right_list(void **state) {
  (void)state;
  static const double k[] = {1, 2, 3, 4, 5, 6, 7, 8}, edge_k[] = {11, 12, 13, 14, 15, 16, 17, 18, 19, 20, 21, 22};
  test_engine e;
  elements_open(&e, 0.01);
  hk_plugin_spec *force = elements_sheet(&e, 3, 0.02);
  test_list(&e, force, "k", k, 8);
  test_list(&e, force, "edge_k", edge_k, 12);
  hk_plugin_spec *emitter = test_plugin(&e, HK_SOURCE, "fixture:spout");
  test_number(&e, emitter, "every", 0.05);
  test_number(&e, emitter, "lifetime", 0.095);
  test_run(&e);
  const hk_model *model = hk_run_view(e.run)->model;
  assert_int_equal(model->element_lists, 2);
  check_list(&model->element_list[0].elements, 3, 8, 1);
  check_list(&model->element_list[1].elements, 2, 12, 11);
  double rest[8], length[12];
  memcpy(rest, model->element_list[0].elements.rest.value, sizeof rest);
  memcpy(length, model->element_list[1].elements.rest.value, sizeof length);
  test_advance(&e, 0.11);
  model = hk_run_view(e.run)->model;
  assert_int_equal(model->id[0], 2);
  check_list(&model->element_list[0].elements, 3, 6, 3);
  check_list(&model->element_list[1].elements, 2, 10, 13);
  assert_memory_equal(model->element_list[0].elements.rest.value, rest + 2, 6 * sizeof *rest);
  assert_memory_equal(model->element_list[1].elements.rest.value, length + 2, 10 * sizeof *length);
  const uint32_t *third = hk_tuple(&model->element_list[0].elements.node, 0); /* was {2, 3, 6} */
  assert_true(model->id[third[0]] == 2 && model->id[third[1]] == 3 && model->id[third[2]] == 6);
  test_engine_close(&e);
}

static void expect_numbers(test_engine *e, const hk_plugin_spec *spec, size_t row, const double *wanted, size_t count) {
  const hk_instance *instance = test_instance(e, spec);
  double *const *values = hk_field_in(&instance->plugin->fields[row], instance->self);
  assert_memory_equal(*values, wanted, count * sizeof **values);
}

/* Particle 4 of six dies, and with it edges 2 and 3 of four and the first of three triangles. A checkpoint of then
 * gives the same numbers to a run whose lists are still whole. */
static void fields_per_tuple_go_with_their_tuples(void **state) {
  (void)state;
  test_engine e[2];
  char path[512];
  snprintf(path, sizeof path, "%s/tally.checkpoint", test_folder());
  for (int k = 0; k < 2; k++) {
    test_engine_open(&e[k]);
    for (int i = 0; i < 6; i++) test_particle(&e[k], i, i * i, 0, 1);
    hk_plugin_spec *tally = test_plugin(&e[k], HK_FORCE, "fixture:tally");
    test_edges(&e[k], tally, (const uint32_t[][2]){{1, 2}, {3, 4}, {4, 5}, {5, 6}}, 4);
    test_tuples(&e[k], tally, "triangles", 3, (const uint32_t[]){2, 3, 4, 1, 2, 3, 3, 5, 6}, 3);
    hk_plugin_spec *reaper = test_plugin(&e[k], HK_SOURCE, "fixture:reaper");
    test_number(&e[k], reaper, "id", 4);
    test_number(&e[k], reaper, "at", 0.05);
    e[k].options.dt = 0.01;
    if (k) e[k].scene->start_file = strdup(path);
    test_run(&e[k]);
    if (k == 0) {
      expect_numbers(&e[k], tally, 0, (const double[]){1, 2, 3, 4}, 4);
      expect_numbers(&e[k], tally, 1, (const double[]){1, 2, 3, 4, 5, 6}, 6);
      test_advance(&e[k], 0.1);
      assert_int_equal(hk_run_save(e[k].run, path, &e[k].error), HK_OK);
    }
    expect_numbers(&e[k], tally, 0, (const double[]){1, 4}, 2);
    expect_numbers(&e[k], tally, 1, (const double[]){3, 4, 5, 6}, 4);
  }
  for (int k = 0; k < 2; k++) test_engine_close(&e[k]);
}

/* A force on some particles offers the tuples whose members it acts on, all of them and no others. */
static void a_selection_leaves_whole_tuples(void **state) {
  (void)state;
  const char *body = "scene:force('" AREA "', { triangles = {{1, 2, 5}, {2, 3, 6}}, k = 1, rest = {0.1, 0.05},\n"
                     "  label = 'skin', only = {1, 2, 4, 5} })";
  assert_true(fabs(measured(body, "s:strain('skin')") - 1.5) < 0.05); /* the other's is (0.25 - 0.05)/0.05 */
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(wrong_tuples_are_refused_by_the_list_and_the_place),
      cmocka_unit_test(counts_that_differ_name_the_list_they_go_with),
      cmocka_unit_test(scripts_give_lists_of_builders_and_written_ones),
      cmocka_unit_test(deaths_take_their_tuples_and_their_numbers_of_the_right_list),
      cmocka_unit_test(fields_per_tuple_go_with_their_tuples),
      cmocka_unit_test(a_selection_leaves_whole_tuples),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
