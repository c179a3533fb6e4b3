/* plugins/synonyms: every name that is suggested exists, as a plugin, a parameter of one, a builder or a method of
 * scenes; and scripts and command lines get the suggestions. */
#include "core/app/builders/builders.h"
#include "tests/support/command.h"
#include "tests/support/engine.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

/* What is no plugin, no parameter of one and no builder: in lines of a script, which are tried below. */
static const char *const lines[][2] = {{"pin", "local method = scene.pin"},
                                       {"on_frame", "local method = scene.on_frame"},
                                       {"dt", "local other = hooke.scene { dt = 1e-3 }"},
                                       {"tol", "local other = hooke.scene { tol = 1e-3 }"},
                                       {"fps", "local other = hooke.scene { fps = 10 }"},
                                       {"duration", "local other = hooke.scene { duration = 0.1 }"},
                                       {"integrator", "local other = hooke.scene { integrator = 'rk4' }"},
                                       {"n", "scene:strand { n = 2, from = { 0, 0, 0 }, to = { 1, 0, 0 } }"},
                                       {"nx", "scene:grid { nx = 2, ny = 2, width = 1, height = 1, mass = 1 }"},
                                       {"ny", "scene:grid { nx = 2, ny = 2, width = 1, height = 1, mass = 1 }"},
                                       {"positions", "scene:particles { positions = { { 0, 0, 0 } } }"},
                                       {"faces", "local read = scene.surface"},
                                       {"t", "scene:measure('a', function(s) return s.t end)"},
                                       {"energy", "scene:measure('a', function(s) return s:energy() end)"},
                                       {"kinetic", "scene:measure('a', function(s) return s:kinetic() end)"},
                                       {"potential", "scene:measure('a', function(s) return s:potential() end)"},
                                       {"ids", "scene:measure('a', function(s) return #s:ids() end)"},
                                       {NULL, NULL}};

static bool has_param(const hk_plugin *plugin, const char *name) {
  for (const hk_param *p = plugin->params; p && p->name; p++)
    if (strcmp(p->name, name) == 0) return true;
  return false;
}

static bool exists(const hk_registry *registry, const char *name) {
  for (size_t k = 0; k < registry->count; k++) {
    const hk_plugin *plugin = registry->item[k].plugin;
    if (plugin && (strcmp(plugin->name, name) == 0 || has_param(plugin, name))) return true;
  }
  for (const luaL_Reg *b = hk_builders; b->name; b++)
    if (strcmp(b->name, name) == 0) return true;
  for (size_t k = 0; lines[k][0]; k++)
    if (strcmp(lines[k][0], name) == 0) return true;
  return false;
}

static void every_suggested_name_exists(void **state) {
  (void)state;
  test_engine e;
  char line[512], *rest = NULL;
  size_t count = 0;
  test_engine_open(&e);
  assert_int_equal(hk_registry_load_all(&e.registry, &e.error), HK_OK);
  FILE *file = fopen(HK_BUILD "/plugins/synonyms", "r");
  assert_non_null(file);
  while (fgets(line, sizeof line, file)) {
    char *word = strtok_r(line, " \n", &rest), *name;
    if (!word || *word == '#') continue;
    if (!(name = strtok_r(NULL, " \n", &rest))) fail_msg("'%s' stands for nothing", word);
    for (; name && strcmp(name, "--") != 0; name = strtok_r(NULL, " \n", &rest), count++) {
      bool optional = strcmp(name, "frames") == 0 || strcmp(name, "cvode") == 0 ||
                      strcmp(name, "trajectory") == 0; /* built where their libraries are */
      if (!optional && !exists(&e.registry, name)) fail_msg("'%s' stands for '%s', which does not exist", word, name);
    }
  }
  fclose(file);
  assert_true(count > 100);
  test_engine_close(&e);
}

#define SCENE                                                                                                          \
  "local scene = hooke.scene { duration = 0.1, fps = 10 }\nlocal k = param('k', 1, 'stiffness, N/m')\n"                \
  "scene:particle { position = {0,0,0}, mass = 1 }\nscene:particle { position = {1,0,0}, mass = 1 }\n"
#define END "return scene\n"

static void scripts_get_them(void **state) {
  (void)state;
  for (size_t k = 0; lines[k][0]; k++) {
    char text[512];
    static test_result r;
    snprintf(text, sizeof text, SCENE "%s\n" END, lines[k][1]);
    test_write("good.lua", text);
    test_hooke(&r, NULL, "run good.lua --quiet --no-output");
    if (r.code != 0) fail_msg("%s: %s", lines[k][1], r.err);
  }
  test_refused(SCENE "scene:force('attractor')\n" END, "", 1, "there is no force 'attractor'; did you mean 'central'?");
  test_refused(SCENE "scene:force('cloth')\n" END, "", 1, "there is no force 'cloth'; did you mean 'membrane'?");
  test_refused(SCENE "scene:force('contact')\n" END, "", 1, "there is no force 'contact'; did you mean 'repulsion'?");
  test_refused(SCENE "scene:force('bars')\n" END, "", 1,
               "there is no force 'bars'; did you mean the constraint 'bars'?");
  test_refused(SCENE "scene:output('csv')\n" END, "", 1,
               "there is no output 'csv'; did you mean 'trajectory' (then: hooke convert RUN --to csv)?");
  test_refused(SCENE "scene:output('sequence')\n" END, "", 1, "(then: hooke convert RUN --to ply, obj or vtk)?");
  test_refused(SCENE "scene:output('point_cache')\n" END, "", 1, "(then: hooke convert RUN --to pc2)?");
  test_refused(SCENE "scene:cloth {}\n" END, "", 1, "a scene has no 'cloth'; did you mean 'grid'?");
  test_refused(SCENE "scene:fix { 1 }\n" END, "", 1, "a scene has no 'fix'; did you mean 'pin'?");
  test_refused(SCENE "scene:force('springs', { edges = {{1,2}}, stiffness = 3 })\n" END, "", 1,
               "springs: no parameter 'stiffness'; did you mean 'k'?");
  test_refused(SCENE "scene:force('springs', { edges = {{1,2}}, K = 3 })\n" END, "", 1, "did you mean 'k'?");
  test_refused(SCENE "scene:output('frames', { camera = { 0, -3, 1 } })\n" END, "", 1,
               "frames: no parameter 'camera'; did you mean 'from'?");
  test_refused(SCENE "scene:output('frames', { target = { 0, 0, 1 } })\n" END, "", 1,
               "frames: no parameter 'target'; did you mean 'look_at'?");
}

/* What people write for a parameter, and what is meant. */
static void parameters_get_them(void **state) {
  static const char *const meant[][3] = {
      {"'springs', { edges = {{1,2}}, ", "stiffness", "k"},
      {"'springs', { edges = {{1,2}}, ", "spring_constant", "k"},
      {"'springs', { edges = {{1,2}}, ", "ks", "k"},
      {"'springs', { edges = {{1,2}}, ", "c", "damping"},
      {"'springs', { edges = {{1,2}}, ", "damp", "damping"},
      {"'springs', { edges = {{1,2}}, ", "kd", "damping"},
      {"'springs', { edges = {{1,2}}, ", "L", "rest"},
      {"'springs', { edges = {{1,2}}, ", "length", "rest"},
      {"'springs', { edges = {{1,2}}, ", "rest_length", "rest"},
      {"'springs', { edges = {{1,2}}, k = 1, ", "ids", "only"},
      {"'gravity', { ", "gravity", "g"},
      {"'gravity', { ", "acceleration", "g"},
      {"'drag', { ", "damping", "rate"},
      {"'drag', { ", "coefficient", "rate"},
      {"'nbody', { ", "eps", "softening"},
      {"'repulsion', { ", "mu", "friction"},
      {"'repulsion', { ", "k", "stiffness"},
      {"'hinges', { ", "bending_stiffness", "rigidity"},
      {"'central', { ", "exponent", "power"},
  };
  (void)state;
  for (size_t k = 0; k < sizeof meant / sizeof *meant; k++) {
    char script[512], text[64];
    snprintf(script, sizeof script, SCENE "scene:force(%s%s = 3 })\n" END, meant[k][0], meant[k][1]);
    snprintf(text, sizeof text, "no parameter '%s'; did you mean '%s'?", meant[k][1], meant[k][2]);
    test_refused(script, "", 1, text);
  }
  test_refused(SCENE "scene:particle { position = {0,0,0}, m = 1 }\n" END, "", 1, "'m'; did you mean 'mass'?");
  test_refused(SCENE "hooke.scene { timestep = 1e-3 }\n" END, "", 1, "'timestep'; did you mean 'dt'?");
  test_refused(SCENE "scene:grid { columns = 3 }\n" END, "", 1, "'columns'; did you mean 'nx'?");
}

static void command_lines_get_them(void **state) {
  (void)state;
  static test_result r;
  test_refused(SCENE END, "--integrator verlet", 1, "there is no integrator 'verlet'; did you mean 'leapfrog'?");
  test_refused(SCENE END, "--integrator vertlet", 1, "there is no integrator 'vertlet'; did you mean 'leapfrog'?");
  test_refused(
      "local scene = hooke.scene { duration = 1 }\nscene:force('springs', { edges = { { 1, 2 } }, k = 1 })\n" END, "",
      1, "there is no particle 1 (the scene has none yet)");
  test_refused(SCENE END, "--integrator RK45", 1, "did you mean 'dopri5'?");
  test_refused(SCENE END, "--integrator crank-nicolson", 1, "did you mean 'implicit_trapezoid'?");
  test_refused(SCENE END, "--integrator bdf2:max_iterations=3", 1, "did you mean 'iterations'?");
  test_refused(SCENE END, "--solver cg", 1, "did you mean 'pcg'?");
  test_refused(SCENE END, "K=3", 1, "has no parameter 'K'; did you mean 'k'?");
  test_refused(SCENE END, "stiffness=3", 1, "has no parameter 'stiffness'; did you mean 'k'?");
  test_refused(SCENE END, "--k 3", 1, "unknown option '--k'; a parameter of the scene is written k=VALUE");
  test_refused(SCENE END, "--k=3", 1, "a parameter of the scene is written k=VALUE");
  test_hooke(&r, NULL, "plugins newmark");
  assert_true(r.code == 1 && strstr(r.err, "did you mean 'implicit_trapezoid'?"));
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(every_suggested_name_exists),
      cmocka_unit_test(scripts_get_them),
      cmocka_unit_test(parameters_get_them),
      cmocka_unit_test(command_lines_get_them),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
