/* hooke check: every force and integrator of the build passes. Sanitizers, under which a check takes ten times as long,
 * see every third: their own tests run all of them under sanitizers. check_faults_long.c has the faults. */
#include "tests/tools/check_faults.h"

#include <dirent.h>

/* What it cannot guess: a box about the particles of its scenes; a closed surface; a force whose dissipation becomes
 * heat. */
static const char *options_of(const char *file) {
  if (strcmp(file, "pressure.so") == 0) {
    test_write("balloon.lua",
               "local scene = hooke.scene { duration = 0.1, fps = 10, dt = 0.01 }\n"
               "local ball = scene:body { shape = 'sphere', radius = 1, detail = 0.1, density = 1 }\n"
               "scene:force('pressure', { triangles = ball:triangles(), p = 100, exponent = 1.4 })\nreturn scene\n");
    return "--scene balloon.lua";
  }
  if (strcmp(file, "grid_conduction.so") == 0) return "low=-10,-10,-10 high=10,10,10 cell=2.5 density=1";
  if (strcmp(file, "viscous_heating.so") != 0) return "";
  test_write("sheared.lua",
             "local scene = hooke.scene { duration = 0.1, fps = 10, dt = 0.01 }\n"
             "scene:channel('enthalpy', { initial = 300 })\n"
             "for i = 0, 35 do scene:particle { position = { i // 6 / 10, 0, i % 6 / 10 }, mass = 10,\n"
             "  velocity = { i % 6, 0, i // 6 * (i % 6) / 5 } } end\n"
             "scene:force('viscosity', { spacing = 0.1, dimensions = 2, density = 1000, mu = 1 })\n"
             "scene:force('viscous_heating', { of = 'viscosity', channel = 'enthalpy' })\nreturn scene\n");
  return "--scene sheared.lua";
}

static void check_all(const char *kind, size_t least) {
  char folder[512], arguments[1024];
  size_t count = 0, step = strstr(HK_BUILD, "sanitize") ? 3 : 1;
  snprintf(folder, sizeof folder, "%s/plugins/%s", HK_BUILD, kind);
  DIR *directory = opendir(folder);
  assert_non_null(directory);
  for (struct dirent *entry; (entry = readdir(directory));) {
    if (!strstr(entry->d_name, ".so") || count++ % step != 0) continue;
    /* Sanitizers take ten times as long as the time that a property has by itself is made for. */
    snprintf(arguments, sizeof arguments, "check %s/%s %s --seconds 200", folder, entry->d_name,
             options_of(entry->d_name));
    test_hooke(&r, NULL, arguments);
    if (r.code != 0) break;
  }
  closedir(directory);
  if (r.code != 0) fail_msg("%s: exit %d: %s%s", arguments, r.code, r.out, r.err);
  assert_true(count >= least);
}

static void every_force_passes(void **state) {
  (void)state;
  check_all("forces", 9);
}

static void every_integrator_passes(void **state) {
  (void)state;
  check_all("integrators", 24);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(every_force_passes), cmocka_unit_test(every_integrator_passes)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
