/* Scripts: their limits hold whatever they catch, errors keep their place and status, driving gives verdicts. */
#include "core/app/lua/lua.h"
#include "core/app/tools/tools.h"
#include "tests/support/command.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#define SCENE "local scene = hooke.scene { duration = 0.1, fps = 10 }\n"
#define BALL SCENE "local p = scene:particle { position = {0, 0, 1}, mass = 1 }\nscene:force('gravity')\n"

static hk_registry registry;
static hk_error error;
static hk_verdict worst;
static hk_run_options run_options = {
    .dt = NAN, .tol = NAN, .until = NAN, .accuracy = NAN, .no_output = true, .progress = -1};

static int open_registry(void **state) {
  (void)state;
  return hk_registry_open(&registry, HK_BUILD "/plugins", NULL, &error);
}

static int close_registry(void **state) {
  (void)state;
  hk_registry_close(&registry);
  return 0;
}

/* Runs the text as t.lua with a budget of 20 million instructions and 64 MiB; when it returned a scene, runs that. */
static hk_status play(const char *text, size_t given_count, hk_param_given *given) {
  hk_script_options options = {.registry = &registry,
                               .memory_limit = (size_t)64 << 20,
                               .instruction_limit = 20000000,
                               .run = &run_options,
                               .given = given,
                               .given_count = given_count};
  hk_script *script = NULL;
  hk_run *run = NULL;
  error = (hk_error){0};
  hk_status status = hk_script_open(test_write("t.lua", text), &options, &script, &error);
  hk_scene *scene = script ? hk_script_scene(script) : NULL;
  if (status == HK_OK && scene) status = hk_run_open(scene, &run_options, &run, &error);
  if (status == HK_OK && run) status = hk_run_advance(run, hk_run_end(run), &error);
  if (run) hk_run_close(run, NULL);
  if (script) hk_script_drove(script, &worst);
  hk_run_destroy(run);
  hk_script_close(script);
  return status;
}

static void expect(const char *text, hk_status status, const char *message) {
  hk_status got = play(text, 0, NULL);
  if (got != status) fail_msg("status %d instead of %d: %s: in %s", (int)got, (int)status, error.text, text);
  if (!strstr(error.text, message)) fail_msg("expected '%s' in '%s': in %s", message, error.text, text);
}

static void good(const char *text) { expect(text, HK_OK, ""); }

/* A force calls a function for its particles together: two calls of 12 million instructions, and one that is too long.
 */
static void every_call_of_a_force_has_a_budget_of_its_own(void **state) {
  (void)state;
#define FIELD(most)                                                                                                    \
  "local scene = hooke.scene { duration = 0.1, dt = 0.1, fps = 10, integrator = 'symplectic_euler' }\n"                \
  "for i = 1, 2 do scene:particle { position = {i, 0, 0} } end\n"                                                      \
  "scene:force('field', { f = function(t, x, y, z, vx, vy, vz, id)\n"                                                  \
  "  for i = 1, id == 2 and " most " or 12000000 do end return 0, 0, 0 end })\n"                                       \
  "return scene"
  good(FIELD("12000000"));
  expect(FIELD("1000000000"), HK_SCRIPT, "t.lua:4: the script ran beyond its limit of 20 million instructions");
#undef FIELD
}

static void no_script_outlives_its_instructions(void **state) {
  (void)state;
  const char *beyond = "beyond its limit of 20 million instructions";
  expect("while true do end", HK_SCRIPT, "t.lua:1: the script ran beyond its limit");
  expect("while true do pcall(function() while true do end end) end", HK_SCRIPT, beyond);
  expect("while true do xpcall(function() while true do end end, print) end", HK_SCRIPT, beyond);
  expect("while true do coroutine.resume(coroutine.create(function() while true do end end)) end", HK_SCRIPT, beyond);
  expect("coroutine.wrap(function() while true do pcall(function() while true do end end) end end)()", HK_SCRIPT,
         beyond);
  expect(BALL "scene:measure('m', function() while true do end end)\nreturn scene", HK_SCRIPT, "t.lua:4: the script");
  expect(BALL "while true do scene:run { to = 0.05 } end", HK_SCRIPT, beyond);
  /* Memory costs instructions; where pages are dear, under sanitizers on a busy machine, the 3 s are over first. */
  expect("while true do pcall(string.rep, 'x', 2^24) end", HK_SCRIPT, "t.lua:1: the script ran beyond its limit of ");
}

static void each_callback_has_a_budget_of_its_own(void **state) {
  (void)state;
  good("local scene = hooke.scene { duration = 1, fps = 30 }\nscene:particle { mass = 1 }\n"
       "scene:measure('m', function() for i = 1, 2000000 do end return 1 end)\nreturn scene");
}

static void no_script_outlives_its_memory(void **state) {
  (void)state;
  const char *beyond = "t.lua: not enough memory: the script went beyond its limit of 64 MiB";
  expect("local s = string.rep('x', 2^30)", HK_SCRIPT, beyond);
  expect("local t = {} for i = 1, 1e9 do t[i] = {} end", HK_SCRIPT, beyond);
  expect("while true do pcall(string.rep, 'x', 2^30) end", HK_SCRIPT, beyond);
  expect("while true do pcall(coroutine.wrap(string.rep), 'x', 2^30) end", HK_SCRIPT, beyond);
  expect("while true do coroutine.resume(coroutine.create(string.rep), 'x', 2^30) end", HK_SCRIPT, beyond);
  expect(SCENE "scene:grid { nx = 100000, ny = 100000 }", HK_SCRIPT, beyond);
}

static void garbage_is_collected_before_memory_is_refused(void **state) {
  (void)state;
  good(BALL "for i = 1, 20 do local s = string.rep('x', 2^22) end\nreturn scene");
}

/* Few instructions that fill much memory are no standstill to the watchdog, however slow that memory is: 40 texts of 1
 * MiB and their buffers, in some 400 instructions, of which the hook sees none. */
static void large_allocations_are_progress(void **state) {
  (void)state;
  hk_pulse pulse = {0};
  hk_script_options options = {.registry = &registry, .run = &run_options, .pulse = &pulse};
  hk_script *script = NULL;
  const char *path = test_write("t.lua", BALL "for i = 1, 40 do local s = string.rep('x', 2^20) end\nreturn scene");
  if (hk_script_open(path, &options, &script, &error) != HK_OK) fail_msg("%s", error.text);
  hk_script_close(script);
  assert_true(atomic_load(&pulse.beats) >= 40);
}

static void loops_inside_library_functions_end(void **state) {
  (void)state;
  expect("string.rep('', 1e15)", HK_SCRIPT, "t.lua:1: string.rep");
  expect("local s = ('').rep('', 1e15)", HK_SCRIPT, "string.rep");
  expect("table.move({}, 1, 1e15, 2)", HK_SCRIPT, "table.move");
  expect("table.insert(setmetatable({}, { __len = function() return 1e15 end }), 1, 1)", HK_SCRIPT, "__len");
  expect("setmetatable({}, { __gc = function() while true do end end })", HK_SCRIPT, "__gc is not available");
}

static void guarded_functions_do_what_luas_own_do(void **state) {
  (void)state;
  good("local co = coroutine.wrap(function(a)\n"
       "  local ok, b = pcall(function() return coroutine.yield(a + 1) end)\n"
       "  local fine, text = xpcall(function() coroutine.yield(b) error('x', 0) end, function(m) return 'H' .. m end)\n"
       "  return fine, text\nend)\n"
       "assert(co(1) == 2 and co(5) == 5)\n"
       "local fine, text = co()\nassert(fine == false and text == 'Hx')\n"
       "assert(select('#', pcall(function() return 1, nil, nil end)) == 4)\n"
       "assert(select(2, xpcall(function(a, b) return a + b end, print, 3, 4)) == 7)\n"
       "assert(select(2, pcall(error, 'e')) == 'e' and not pcall(error))\n"
       "local _, a, b = coroutine.resume(coroutine.create(function(...) return ... end), 1, 2)\n"
       "assert(a == 1 and b == 2)\n"
       "local t = { 1, 2, 3 }\ntable.insert(t, 4)\ntable.insert(t, 1, 0)\n"
       "assert(table.remove(t) == 4 and table.concat(table.move(t, 1, 2, 3), ',') == '0,1,0,1')\n"
       "assert(('ab'):rep(3, '-') == 'ab-ab-ab' and ('x'):rep(-1) == '')\n"
       "assert(setmetatable({}, { __index = function(_, k) return k end }).name == 'name')\n"
       "assert(getmetatable('') == false)\n" BALL "return scene");
}

static void what_callbacks_return_is_checked(void **state) {
  (void)state;
  expect(BALL "scene:measure('m', function() return nil end)\nreturn scene", HK_SCRIPT,
         "t.lua:4: this function returned nil where a number is needed");
  expect(BALL "scene:measure('m', function() local t = {} t[1] = t return t end)\nreturn scene", HK_SCRIPT,
         "t.lua:4: this function returned tables nested too deeply");
  expect(BALL "scene:measure('m', function() return 1, 2 end)\nreturn scene", HK_SCRIPT,
         "t.lua:4: this function returned more numbers than are expected");
  expect(BALL "scene:measure('m', function() error({}) end)\nreturn scene", HK_SCRIPT, "an error that is a table");
  good(BALL "scene:on_frame(function() return 'ignored' end)\nreturn scene");
}

static void a_list_that_holds_itself_is_no_list_of_edges(void **state) {
  (void)state;
  expect(BALL "local e = {} e[1] = e\nscene:force('springs', { edges = e, k = 1 })", HK_BAD_PARAM,
         "t.lua:5: springs: edges: expected a list of edges");
}

/* Under the sanitizers: see STACK_SLOTS in core/app/script.c. */
static void edges_join_in_chains(void **state) {
  (void)state;
  good(SCENE "local a = scene:strand { n = 3 }\n"
             "local e = a:edges() .. a:flexion() .. a:edges() .. { { {1, 3} }, a:edges() }\n"
             "assert(#e == 8 and e[6][2] == 3)\nassert(#(a:edges() + { {1, 3} }) == 3)\nreturn scene");
}

static void an_error_keeps_its_own_status(void **state) {
  (void)state;
  expect(BALL "scene:mesh { file = 'none.obj' }", HK_IO, "t.lua:4: mesh: cannot read");
  expect(BALL "scene:mesh { file = 'a.lua' }", HK_IO, "t.lua:4: mesh: cannot read");
  expect(BALL "pcall(scene.mesh, scene, { file = 'none.obj' })\nerror('later')", HK_SCRIPT, "t.lua:5: later");
  expect("scene = hooke.scene {}\nscene.grid { nx = 2, ny = 2 }", HK_SCRIPT, "t.lua:2: a scene's functions are called");
  expect("hooke.scene { seed = -3 }", HK_BAD_PARAM, "t.lua:1: scene: seed: -3 is not a whole number");
  expect(BALL "scene:force('drag', { from = 2, to = 1 })", HK_BAD_PARAM, "t.lua:4: drag: from: 2 s is not before");
}

static void params_take_the_type_of_their_default(void **state) {
  (void)state;
  hk_param_given given[] = {{"n", "8.0", false}, {"x", "2", false}, {"s", "12", false}, {"b", "true", false}};
  hk_status status = play("assert(math.type(param('n', 3)) == 'integer')\nassert(param('x', 1.5) == 2)\n"
                          "assert(param('s', 'text') == '12')\nassert(param('b', false) == true)\n"
                          "assert(param('rest', 7) == 7)\n" BALL "return scene",
                          4, given);
  assert_string_equal(error.text, "");
  assert_int_equal(status, HK_OK);
  hk_param_given wrong = {"b", "yes", false};
  assert_int_equal(play("param('b', false)\n", 1, &wrong), HK_BAD_PARAM);
  assert_non_null(strstr(error.text, "t.lua:1: parameter b: 'yes' is not true or false"));
}

static void modules_are_found_once_and_circles_seen(void **state) {
  (void)state;
  test_write("helper.lua", "count = (rawget(_G, 'count') or 0) + 1\nreturn { value = 41 }");
  good("assert(require('helper').value == 41 and require('helper') == require('helper') and count == 1)\n" BALL
       "return scene");
  test_write("circle.lua", "return require('circle')");
  expect("require('circle')", HK_SCRIPT, "circle.lua:1: require: 'circle' requires itself");
  expect("require('nowhere')", HK_SCRIPT, "t.lua:1: require: there is no module 'nowhere'");
  test_write("broken.lua", "local x = = 1");
  expect("require('broken')", HK_SCRIPT, "broken.lua:1:");
  expect("require('t2/../t')", HK_SCRIPT, "is not the name of a module");
}

static void driving_goes_on_and_ends_with_a_verdict(void **state) {
  (void)state;
  good(BALL "scene:measure('z', function(s) return s:position(p)[3] end)\n"
            "local run = scene:run { to = 0.05 }\n"
            "assert(run:state().t == 0.05 and run:summary().verdict == 'running')\n"
            "run = scene:run {}\n"
            "assert(run:summary().verdict == 'ok' and run:state().t == 0.1)\n"
            "assert(math.abs(run:summary().measures.z - (1 - 9.80665 * 0.1 ^ 2 / 2)) < 1e-4)\n"
            "assert(scene:run {}:summary().steps == run:summary().steps)");
  assert_int_equal(worst, HK_VERDICT_OK);
  good(BALL "coroutine.wrap(function()\n  scene:measure('one', function() return 1 end)\n"
            "  assert(scene:run {}:summary().measures.one == 1)\nend)()");
  expect(BALL "scene:run { to = 3 }", HK_BAD_PARAM, "t.lua:4: run: to: 3 s is after the scene's duration, 0.1 s");
  expect(BALL "scene:run { to = -1 }", HK_BAD_PARAM, "t.lua:4: run: to: -1 s is before the run's present time, 0 s");
  expect(BALL "scene:run { to = 0.08 } scene:run { to = 0.02 }", HK_BAD_PARAM,
         "t.lua:4: run: to: 0.02 s is before the run's present time, 0.08 s");
  good(BALL "for k = 1, 3 do scene:run { to = 0.1 * 3 / 10 } end scene:run { to = 0.03 }");
  expect(BALL "scene:measure('m', function() scene:run {} return 1 end)\nscene:run {}", HK_SCRIPT,
         "t.lua:4: a scene is run by the script itself");
  expect(BALL "scene:measure('m', function() scene:run {} return 1 end)\nreturn scene", HK_SCRIPT,
         "t.lua:4: a scene is run by the script itself");
  expect(BALL "scene:run {}\nscene:force('drag')", HK_BAD_PARAM, "t.lua:5: the scene runs and can no longer be edited");
}

/* 0.01 k and k/100 differ in the last digit for k = 7 and others; no step of 1e-17 s makes up for it. */
static void driving_to_frames_takes_no_step_beside_them(void **state) {
  (void)state;
  good("local scene = hooke.scene { duration = 1, fps = 100, dt = 0.01, integrator = 'leapfrog' }\n"
       "scene:particle { mass = 1 }\n"
       "for k = 0, 100 do\n"
       "  local run = scene:run { to = 0.01 * k }\n"
       "  assert(run:state().t == k / 100 and run:summary().steps == k)\n"
       "end");
}

static void a_rate_gets_time_id_and_values(void **state) {
  (void)state;
  good(BALL "scene:particle { mass = 1 }\n"
            "scene:channel('y', { initial = { 1, 2 }, rate = function(t, id, a, b)\n"
            "  assert(t >= 0 and math.type(id) == 'integer' and b > a)\n  return id, { 2 * id }\nend })\n"
            "local s = scene:run {}:state()\n" /* a constant rate is exact in any method of order 1 */
            "for id = 1, 2 do\n  local y = s:channel('y', id)\n"
            "  assert(math.abs(y[1] - 1 - 0.1 * id) < 1e-12 and math.abs(y[2] - 2 - 0.2 * id) < 1e-12)\nend");
}

/* A gas at rest, of which nothing but its wind is known. */
static void a_state_knows_what_plugins_publish(void **state) {
  (void)state;
  good(BALL "scene:corrector('gas', { low = {-1, -1, -1}, high = {1, 1, 1}, cell = 0.5, ambient = 300, open = 'all',\n"
            "  wind = {2, 0, 0} })\n"
            "local s = scene:run { to = 0 }:state()\n"
            "assert(s:field('temperature', 1) == 300 and s:field('flow', 1)[1] == 2 and #s:field('flow', 1) == 3)\n"
            "local fine, why = pcall(s.field, s, 'vapour', 1)\n"
            "assert(not fine and tostring(why):find(\"no plugin of the scene publishes a field 'vapour'\", 1, true))");
}

/* The square 1 2 3 4, cut along 1-3: four sides and the cut; across the cut 2 faces 4. */
static void a_mesh_knows_its_sides_and_what_faces_across_them(void **state) {
  (void)state;
  test_write("square.obj", "# square\nv 0 0 0\nv\t1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nf 1/1/1 2//2 3\nf -4 -2 -1\n");
  good(SCENE "local m = scene:mesh { file = 'square.obj', mass = 4, scale = 2, origin = {0, 0, 1} }\n"
             "local e = m:edges()\nassert(#e == 5 and #m:triangles() == 2 and #m:ids() == 4)\n"
             "local text = ''\nfor k = 1, #e do text = text .. e[k][1] .. e[k][2] .. ' ' end\n"
             "assert(text == '12 13 14 23 34 ')\n"
             "local f = m:flexion()\nassert(#f == 1 and f[1][1] == 2 and f[1][2] == 4)\n"
             "local s = scene:run {}:state()\nassert(s:position(3)[1] == 2 and s:position(3)[3] == 1)\n"
             "assert(s:mass(1) == 1)");
  test_write("bad.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 2\n");
  expect(SCENE "scene:mesh { file = 'bad.obj' }", HK_IO, "t.lua:2: mesh: bad.obj:4: a face names a vertex twice");
  test_write("bad.obj", "v 0 0 0\nv 1 0\n");
  expect(SCENE "scene:mesh { file = 'bad.obj' }", HK_IO, "bad.obj:2: a vertex needs three numbers");
}

static void tools_load_and_drive_scenes(void **state) {
  (void)state;
  char name[] = "drive", *arguments[] = {name};
  int code = 0;
  test_write("ball.lua", "local m = param('m', 1)\n" SCENE "scene:particle { mass = m, velocity = {0, 0, 1} }\n"
                         "scene:measure('m', function() return m end)\nreturn scene");
  const char *tool =
      test_write("drive.lua", "local ball = hooke.folder .. '/ball.lua'\nlocal s = assert(hooke.load(ball, { m = 0.1 "
                              "}, { integrator = 'rk4', dt = 0.01 }))\n"
                              "local run = s:run {}\ns = nil\ncollectgarbage() collectgarbage()\n"
                              "local sum, state = run:summary(), run:state()\nrun = nil\ncollectgarbage()\n"
                              "assert(sum.integrator == 'rk4' and sum.steps == 10 and sum.measures.m == 0.1)\n"
                              "assert(state:position(1)[3] > 0.09)\n"
                              "local none, why = hooke.load(ball, { mm = 1 })\n"
                              "assert(not none and why:find(\"no parameter 'mm'\", 1, true))\n"
                              "assert(not pcall(hooke.load, ball, {}, { integratr = 'rk4' }))\n"
                              "return 7");
  hk_script_options options = {.registry = &registry, .trust = true, .run = &run_options};
  error = (hk_error){0};
  hk_tool_run(tool, 1, arguments, &options, &code, NULL, &error);
  assert_string_equal(error.text, "");
  assert_int_equal(code, 7);
}

/* Else what checks a run would run another scene than it. */
static void trusted_scenes_draw_the_same_numbers_again(void **state) {
  (void)state;
  double first = 0;
  for (int k = 0; k < 3; k++) {
    hk_script_options options = {.registry = &registry, .trust = k > 0, .run = &run_options};
    hk_script *script = NULL;
    error = (hk_error){0};
    const char *path = test_write("chance.lua", SCENE "scene:particle { mass = 1 + math.random() }\nreturn scene");
    hk_script_open(path, &options, &script, &error);
    assert_string_equal(error.text, "");
    double mass = hk_script_scene(script)->particles.mass[0];
    if (k > 0 && mass != first) fail_msg("%.17g kg, and %.17g kg again", first, mass);
    first = mass;
    hk_script_close(script);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(every_call_of_a_force_has_a_budget_of_its_own),
      cmocka_unit_test(no_script_outlives_its_instructions),
      cmocka_unit_test(each_callback_has_a_budget_of_its_own),
      cmocka_unit_test(no_script_outlives_its_memory),
      cmocka_unit_test(garbage_is_collected_before_memory_is_refused),
      cmocka_unit_test(large_allocations_are_progress),
      cmocka_unit_test(loops_inside_library_functions_end),
      cmocka_unit_test(guarded_functions_do_what_luas_own_do),
      cmocka_unit_test(what_callbacks_return_is_checked),
      cmocka_unit_test(a_list_that_holds_itself_is_no_list_of_edges),
      cmocka_unit_test(edges_join_in_chains),
      cmocka_unit_test(an_error_keeps_its_own_status),
      cmocka_unit_test(params_take_the_type_of_their_default),
      cmocka_unit_test(modules_are_found_once_and_circles_seen),
      cmocka_unit_test(driving_goes_on_and_ends_with_a_verdict),
      cmocka_unit_test(driving_to_frames_takes_no_step_beside_them),
      cmocka_unit_test(a_rate_gets_time_id_and_values),
      cmocka_unit_test(a_state_knows_what_plugins_publish),
      cmocka_unit_test(a_mesh_knows_its_sides_and_what_faces_across_them),
      cmocka_unit_test(tools_load_and_drive_scenes),
      cmocka_unit_test(trusted_scenes_draw_the_same_numbers_again),
  };
  return cmocka_run_group_tests(tests, open_registry, close_registry);
}
