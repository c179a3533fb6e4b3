/* A scene pays for what it names and for nothing else: libraries in the process, memory and evaluations are counted
 * with and without other plugins in the folder, and with and without the outputs that are switched off. */
#include "core/run/run/run.h"
#include "tests/support/command.h"

#include <malloc.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmocka.h>

/* ---- libraries, seen by the scene's own process ---- */

/* What is mapped into hooke, written to maps.txt at the last frame; the names of its files. */
static const char maps[] = "local function note(file)\n"
                           "  local seen, out = {}, io.open(file, 'w')\n"
                           "  for line in io.lines('/proc/self/maps') do\n"
                           "    local path = line:match('(/%S+%.so[%d.]*)$')\n"
                           "    if path and not seen[path] then out:write(path, '\\n') end\n"
                           "    if path then seen[path] = true end\n"
                           "  end\n"
                           "  out:close()\n"
                           "end\n"
                           "note('before.txt')\n";

static const char scene[] = "local scene = hooke.scene { duration = 0.05, integrator = 'leapfrog' }\n"
                            "local a = scene:particle { position = {0, 0, 0}, mass = 1 }\n"
                            "local b = scene:particle { position = {1, 0, 0}, mass = 1 }\n"
                            "scene:force('springs', { edges = {{a, b}}, k = 10, rest = 0.9 })\n"
                            "scene:force('gravity', { g = {0, 0, -1} })\n";

static const char note[] = "scene:on_frame(function(s) if s.t == 0.05 then note('after.txt') end end)\nreturn scene\n";

/* The lines of a file of the test's folder that have `text` in them, or that have not. */
static size_t lines(const char *name, const char *text, bool with, char last[512]) {
  char path[512], line[512];
  size_t count = 0;
  snprintf(path, sizeof path, "%s/%s", test_folder(), name);
  FILE *file = fopen(path, "r");
  if (!file) fail_msg("no %s: the scene did not write it", path);
  while (fgets(line, sizeof line, file)) {
    if ((strstr(line, text) != NULL) != with) continue;
    strcpy(last, line);
    count++;
  }
  fclose(file);
  return count;
}

static void run_scene(const char *more, const char *arguments) {
  static test_result r;
  char text[4096], all[256];
  snprintf(text, sizeof text, "%s%s%s%s", maps, scene, more, note);
  test_write("maps.lua", text);
  snprintf(all, sizeof all, "run --trust maps.lua --quiet %s", arguments);
  test_hooke(&r, NULL, all);
  if (r.code != 0) fail_msg("%s: exit %d: %s", all, r.code, r.err);
}

static void exactly_the_plugins_that_are_named_are_loaded(void **state) {
  (void)state;
  static const char *const named[] = {"/forces/springs.so", "/forces/gravity.so", "/integrators/leapfrog.so"};
  char last[512];
  run_scene("", "");
  for (size_t k = 0; k < 3; k++) assert_int_equal(lines("after.txt", named[k], true, last), 1);
  size_t plugins = lines("after.txt", HK_BUILD "/plugins/", true, last);
  if (plugins != 3) fail_msg("%zu plugins are loaded, the last of them %s", plugins, last);
  assert_int_equal(lines("before.txt", HK_BUILD "/plugins/", true, last), 0);
}

static void explicit_runs_bring_no_library_along(void **state) {
  (void)state;
  static const char *const heavy[] = {"cholmod", "umfpack", "blas", "sundials", "OSMesa", "libpng", "LLVM", "libEGL"};
  char last[512];
  run_scene("", "");
  size_t before = lines("before.txt", HK_BUILD "/plugins/", false, last);
  size_t after = lines("after.txt", HK_BUILD "/plugins/", false, last);
  if (after != before) fail_msg("%zu libraries became %zu: %s", before, after, last);
  for (size_t k = 0; k < sizeof heavy / sizeof *heavy; k++)
    assert_int_equal(lines("after.txt", heavy[k], true, last), 0);
}

/* A plugin asks for a service, and it comes; without one that asks none is loaded, as the first test counts. */
static void a_service_is_loaded_when_a_plugin_asks(void **state) {
  (void)state;
  char last[512];
  run_scene("scene:force('" HK_BUILD "/tests/fixtures/lennard_jones.so', { epsilon = 1e-9 })\n", "");
  assert_int_equal(lines("after.txt", "/services/neighbours.so", true, last), 1);
  run_scene("scene:force('" HK_BUILD "/tests/fixtures/lennard_jones.so', { epsilon = 1e-9 })\n"
            "scene:service('neighbours', { skin = 0.3 })\n",
            "");
  assert_int_equal(lines("after.txt", "/services/", true, last), 1);
}

/* The opposite: what is named is seen by this count. */
static void an_implicit_run_loads_its_solver(void **state) {
  (void)state;
  char last[512];
  run_scene("", "--integrator bdf2 --solver cholmod");
  assert_int_equal(lines("after.txt", "/solvers/cholmod.so", true, last), 1);
  assert_true(lines("after.txt", "libcholmod", true, last) >= 1);
  assert_int_equal(lines("after.txt", "/integrators/bdf2.so", true, last), 1);
}

static void outputs_that_are_switched_off_load_nothing(void **state) {
  (void)state;
  char last[512];
  run_scene("scene:output('table')\n", "");
  assert_int_equal(lines("after.txt", "/outputs/table.so", true, last), 1);
  assert_true(test_exists("out/maps"));
  run_scene("scene:output('table')\n", "--no-output --out off");
  assert_false(test_exists("off"));
  size_t outputs = lines("after.txt", "/outputs/", true, last);
  if (outputs) fail_msg("--no-output, and %s is loaded", last);
}

/* ---- memory and evaluations ---- */

size_t __sanitizer_get_current_allocated_bytes(void) __attribute__((weak));

static size_t bytes_in_use(void) {
  if (__sanitizer_get_current_allocated_bytes) return __sanitizer_get_current_allocated_bytes();
  struct mallinfo2 now = mallinfo2();
  return now.uordblks + now.hblkhd;
}

typedef struct counts {
  size_t plugins, bytes, growth; /* loaded; in use once the run is open; what 400 steps added to it */
  size_t allocations;            /* through the hosts */
  size_t evaluations, calls;     /* of f; of the one force */
} counts;

enum { PLENTY = 1 << 20, GRID = 8 };

static void add_grid(hk_scene *s, hk_error *error) {
  double position[3 * GRID * GRID] = {0};
  uint32_t first;
  for (size_t k = 0; k < GRID * GRID; k++) {
    position[3 * k] = (double)(k % GRID);
    position[3 * k + 1] = (double)(k / GRID);
  }
  assert_int_equal(hk_scene_add_particles(s, GRID * GRID, position, NULL, NULL, 1, 0, &first, error), HK_OK);
}

static void add_force(hk_scene *s, hk_error *error) {
  hk_plugin_spec *force;
  if (hk_scene_add_plugin(s, HK_FORCE, "central", NULL, "", &force, error) != HK_OK) fail_msg("%s", error->text);
  hk_value strength = {.kind = HK_VALUE_NUMBER, .number = 3};
  const hk_param *param = hk_spec_param(force, "strength", error);
  assert_int_equal(hk_spec_set(force, param, &strength, s->particles.n, error), HK_OK);
}

static counts count_run(const char *root) {
  counts c = {0};
  hk_error error = {0};
  hk_registry registry;
  hk_run *run = NULL;
  hk_run_options options = {.dt = 0.01,
                            .tol = NAN,
                            .until = NAN,
                            .accuracy = NAN,
                            .no_output = true,
                            .progress = -1,
                            .allocations = PLENTY + 1};
  assert_int_equal(hk_registry_open(&registry, root, NULL, &error), HK_OK);
  hk_scene *s = hk_scene_create("test.lua", &registry);
  s->fps = 100;
  s->duration = 10;
  s->threads = 1;
  add_grid(s, &error);
  add_force(s, &error);
  if (hk_run_open(s, &options, &run, &error) != HK_OK) fail_msg("%s", error.text);
  assert_int_equal(hk_run_advance(run, 5, &error), HK_OK); /* with what the first steps, frames and estimates make */
  c.bytes = bytes_in_use();
  assert_int_equal(hk_run_advance(run, 9, &error), HK_OK);
  c.growth = bytes_in_use() - c.bytes;
  c.plugins = registry.count;
  c.allocations = PLENTY - (size_t)run->shared.allocations_left;
  c.evaluations = run->dynamics.count.evaluations;
  c.calls = run->plugins.kind[HK_FORCE].item[0]->calls;
  hk_run_close(run, &error);
  hk_run_destroy(run);
  hk_scene_destroy(s);
  hk_registry_close(&registry);
  return c;
}

/* In a process of its own, for a library that was loaded once stays, and its second load allocates less. */
static counts count_in_child(const char *root) {
  counts c = {0};
  int fd[2], status;
  assert_int_equal(pipe(fd), 0);
  pid_t pid = fork();
  assert_true(pid >= 0);
  if (pid == 0) {
    c = count_run(root);
    _exit(write(fd[1], &c, sizeof c) == sizeof c ? 0 : 1);
  }
  close(fd[1]);
  ssize_t got = read(fd[0], &c, sizeof c);
  close(fd[0]);
  assert_int_equal(waitpid(pid, &status, 0), pid);
  assert_int_equal(status, 0);
  assert_int_equal(got, sizeof c);
  return c;
}

/* Two folders of the same length: only what is named, and every plugin there is. */
static void folder_of(char *into, size_t size, const char *name, const char *copy) {
  char command[1024];
  snprintf(into, size, "%s/%s", test_folder(), name);
  snprintf(command, sizeof command, "mkdir -p '%s' && cd '%s' && mkdir -p forces integrators && %s", into, into, copy);
  assert_int_equal(system(command), 0);
}

static void unused_plugins_cost_no_memory_and_no_evaluation(void **state) {
  (void)state;
  char few[256], all[256];
  folder_of(few, sizeof few, "few",
            "cp " HK_BUILD "/plugins/forces/central.so forces && cp " HK_BUILD
            "/plugins/integrators/leapfrog.so " HK_BUILD "/plugins/integrators/default integrators");
  folder_of(all, sizeof all, "all", "cp -r " HK_BUILD "/plugins/*/ .");
  counts a = count_in_child(few), b = count_in_child(all);
  assert_int_equal(a.plugins, 2);
  assert_int_equal(b.plugins, 2);
  assert_true(a.bytes > 64 * 64); /* the count counts: the state alone is 64 particles of 64 bytes */
  assert_int_equal(a.bytes, b.bytes);
  assert_int_equal(a.allocations, b.allocations);
  assert_int_equal(a.evaluations, b.evaluations);
  assert_int_equal(a.calls, b.calls);
  assert_true(a.evaluations >= 900); /* one a step with leapfrog */
  assert_int_equal(a.growth, 0);     /* no allocation inside a step */
  assert_int_equal(b.growth, 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(exactly_the_plugins_that_are_named_are_loaded),
      cmocka_unit_test(a_service_is_loaded_when_a_plugin_asks),
      cmocka_unit_test(explicit_runs_bring_no_library_along),
      cmocka_unit_test(an_implicit_run_loads_its_solver),
      cmocka_unit_test(outputs_that_are_switched_off_load_nothing),
      cmocka_unit_test(unused_plugins_cost_no_memory_and_no_evaluation),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
