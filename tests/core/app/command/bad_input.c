/* Bad input: a clear error that names the cause, the place and the remedy; nothing is lost. */
#include "tests/support/command.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#define SCENE "local scene = hooke.scene { duration = 0.1, fps = 10 }\n"
#define BALL SCENE "local p = scene:particle { position = {0, 0, 1}, mass = 1 }\n"
#define PAIR                                                                                                           \
  SCENE "local a = scene:particle { position = {0,0,0}, mass = 1 }\n"                                                  \
        "local b = scene:particle { position = {1,0,0}, mass = 1 }\n"
#define END "return scene\n"

static test_result r;

static void expect(const char *arguments, int code, const char *text) {
  test_hooke(&r, NULL, arguments);
  if (r.code != code) fail_msg("%s: exit %d instead of %d; it said: %s", arguments, r.code, code, r.err);
  if (!strstr(r.err, text)) fail_msg("%s: expected '%s' in: %s", arguments, text, r.err);
}

static void unknown_names_offer_the_nearest(void **state) {
  (void)state;
  test_write("ball.lua", BALL END);
  expect("rnu ball.lua", 1, "unknown command 'rnu'; did you mean 'run'?");
  expect("run ball.lua --integrater leapfrog", 1, "unknown option '--integrater'; did you mean '--integrator'?");
  expect("run bal.lua", 4, "cannot read the scene bal.lua: No such file or directory; did you mean 'ball.lua'?");
  test_refused("local k = param('stiffness', 1)\n" BALL END, "stifness=3", 1,
               "no parameter 'stifness'; did you mean 'stiffness'?");
  test_refused(BALL "scene:force('gravty')\n" END, "", 1,
               "bad.lua:3: there is no force 'gravty'; did you mean 'gravity'?");
  test_refused(BALL END, "--integrator leapfrg", 1, "there is no integrator 'leapfrg'; did you mean 'leapfrog'?");
  test_refused(SCENE "scene:grid { nx = 2, ny = 2, widht = 1 }\n" END, "", 1,
               "bad.lua:2: grid: unknown key 'widht'; did you mean 'width'?");
  test_refused(BALL "scene:force('gravity', { G = {0,0,1} })\n" END, "", 1,
               "bad.lua:3: gravity: no parameter 'G'; did you mean 'g'?");
  test_refused(BALL "scene:forse('gravity')\n" END, "", 1, "a scene has no 'forse'; did you mean 'force'?");
  test_refused(BALL "scen:force('gravity')\n" END, "", 1, "bad.lua:3: 'scen' is not defined");
  test_refused("local scene = hooke.scene { duraton = 1 }\n" END, "", 1,
               "scene: unknown key 'duraton'; did you mean 'duration'?");
}

static void wrong_values_are_refused(void **state) {
  (void)state;
  test_refused(BALL "scene:force('gravity', { g = 9.81 })\n" END, "", 1,
               "bad.lua:3: gravity: g: expected a list of three numbers, got a number");
  test_refused(PAIR "scene:force('springs', { edges = 7, k = 1 })\n" END, "", 1,
               "springs: edges: expected a list of edges");
  test_refused(PAIR "scene:force('springs', { edges = {{1,2}}, k = -1 })\n" END, "", 1,
               "springs: k: -1 N/m is below the minimum 0");
  test_refused(PAIR "scene:force('springs', { edges = {{1,2}}, k = 1, damping = 0/0 })\n" END, "", 1, "damping");
  test_refused(PAIR "scene:force('springs', { edges = {{1,2}}, k = 1/0 })\n" END, "", 1, "inf is not a finite number");
  test_refused(SCENE "scene:particle { position = {0, 0/0, 0}, mass = 1 }\n" END, "", 1,
               "bad.lua:2: particle: position");
  test_refused(SCENE "scene:particle { position = {0,0,0}, mass = -1 }\n" END, "", 1,
               "particle: mass: -1 kg is below the minimum 0");
  test_refused(SCENE "scene:particle { position = {0,0,0}, mass = 0 }\n" END, "", 1,
               "particle 1: mass 0 kg needs a pin");
  test_refused(PAIR "scene:force('springs', { edges = {{1,3}}, k = 1 })\n" END, "", 1,
               "edges[1] = {1, 3}: there is no particle 3 (ids are 1 to 2)");
  test_refused(PAIR "scene:force('springs', { edges = {{2,2}}, k = 1 })\n" END, "", 1,
               "edges[1] joins particle 2 to itself");
  test_refused(PAIR "scene:force('springs', { edges = {{1,2}}, k = {1, 2} })\n" END, "", 1,
               "k has 2 numbers for 1 edges");
  test_refused(PAIR "scene:force('springs', { edges = {{1,2}} })\n" END, "", 1,
               "the parameter 'k' (stiffness) is required");
  test_refused(SCENE END, "", 1, "the scene is empty");
  test_refused(BALL END, "--dt 0", 1, "--dt: '0' is not a positive number");
  test_refused(BALL END, "--threads many", 1, "--threads: 'many' is not a whole number");
  test_refused("param('n', 3, 'count', { min = 2 })\n" BALL END, "n=1", 1, "parameter n: 1 is below the minimum 2");
  test_refused("param('n', 3)\n" BALL END, "n=three", 1, "parameter n: 'three' is not a number");
  test_refused(BALL "scene:pin { 2 }\n" END, "", 1, "pin: there is no particle 2");
  test_refused(BALL "scene:pin { p }\nscene:pin { p }\n" END, "", 1,
               "particle 1 is pinned already: leave it out of one of the two");
}

static void slips_in_scripts_are_explained(void **state) {
  (void)state;
  test_refused(BALL "scene:force(gravity)\n" END, "", 1,
               "bad.lua:3: 'gravity' is not defined; a text stands in quotes, \"gravity\"");
  test_refused(BALL "scene.duration = 5\n" END, "", 1, "bad.lua:3: a scene is changed by its functions only");
  test_refused(BALL "print(scene.duration)\n" END, "", 1,
               "bad.lua:3: a scene has no 'duration'; hooke.scene { ... } sets values, none is read");
  test_refused(BALL "scene:measure(function() end)\n" END, "", 1, "bad.lua:3: measure: expected a name and a function");
  test_refused(BALL "scene:measure('e', 'kinetic')\n" END, "", 1, "bad.lua:3: measure: expected a name and a function");
  test_refused(BALL "scene:on_frame(1)\n" END, "", 1, "bad.lua:3: on_frame: expected a function");
}

/* What has no effect as it is written, or contradicts itself, and cannot be meant. */
static void what_cannot_be_meant_is_refused(void **state) {
  (void)state;
#define GRID SCENE "local g = scene:grid { nx = 3, ny = 3 }\n"
  static const struct {
    const char *scene, *text;
  } wrong[] = {
      {GRID "scene:force('membrane', { triangles = {} })\n",
       "bad.lua:3: membrane: triangles is an empty list: name some; where it is left out, all are meant"},
      {GRID "scene:force('hinges', { triangles = {}, rigidity = 1 })\n",
       "bad.lua:3: hinges: triangles is an empty list"},
      {BALL "scene:force('nbody', { sources = {} })\n", "bad.lua:3: nbody: sources is an empty list: name some"},
      {BALL "scene:force('pull', { particles = {}, k = 1 })\n", "bad.lua:3: pull: particles is an empty list"},
      {BALL "scene:output('trajectory', { only = {} })\n", "bad.lua:3: trajectory: only is an empty list"},
      {GRID "scene:corrector('contact', { friction = 0.3 })\nscene:corrector('contact', { friction = 0.8 })\n",
       "bad.lua:4: contact#2: the scene already has a 'contact' with a friction of 0.3, which treats all of its"},
      {GRID "scene:force('barrier')\nscene:force('barrier', { friction = 1 })\n",
       "bad.lua:4: barrier#2: the scene already has a 'barrier' with a fric"},
      {SCENE "scene:source('emitter', { rate = 0, burst_at = { 0.05 } })\n", "bad.lua:2: emitter: burst_at: how many"},
      {SCENE "scene:channel('mass', { initial = 1 })\n",
       "bad.lua:2: channel 'mass': a particle's mass is its own already: choose another name"},
      {SCENE "scene:channel('id')\n", "bad.lua:2: channel 'id': a particle's id is its own already"},
  };
  char scene[1024];
  for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++) {
    snprintf(scene, sizeof scene, "%s" END, wrong[k].scene);
    test_refused(scene, "", 1, wrong[k].text);
  }
}

/* Not in Lua's words, which know neither the function nor what it is for. */
static void wrong_arguments_show_the_call(void **state) {
  (void)state;
  static const struct {
    const char *lines, *text;
  } wrong[] = {
      {"param('k')\n",
       "bad.lua:3: param: 'k' has no default, which says its type, too: give one, as in param(\"k\", 1000"},
      {"param(3, 1)\n", "bad.lua:3: param: expected a name and a default, as in param("},
      {"param('k', {})\n",
       "bad.lua:3: param: the default of 'k' is a table: expected a number, a text, or true or false"},
      {"param('k', 1, 2)\n", "bad.lua:3: param: the help of 'k' is a number: expected a text"},
      {"param('k', 1, 'stiffness', 0)\n",
       "bad.lua:3: param: the limits of 'k' are a number: expected { min =, max = }"},
      {"scene:exact(3)\n", "bad.lua:3: exact: expected a function, scene:exact(function(t) return x, y, z end), got a"},
      {"scene:channel()\n", "bad.lua:3: expected a text, as in scene:channel(\"heat\", { initial = 0 }), got nothing"},
      {"for _, v in ipairs(3) do end\n",
       "bad.lua:3: ipairs goes through a table, and this is a number: use it as it is"},
      {"for k in pairs(nil) do end\n", "bad.lua:3: pairs goes through a table, and this is nothing"},
      {"scene:strand { n = 3 }:at('x')\n", "bad.lua:3: expected a whole number, as in strand:at(1), got a text"},
      {"scene:grid { nx = 3, ny = 3 }:at(1.5, 1)\n",
       "bad.lua:3: expected a whole number, as in grid:at(1, 1), got 1.5"},
      {"require()\n", "bad.lua:3: expected a text, as in require(\"drape\"), got nothing"},
      {"scene:measure('m', function(s) return s:force() end)\n",
       "bad.lua:3: expected a text, as in state:force(LABEL, id), got nothing"},
      {"scene:measure('m', function(s) for _, e in ipairs(s:energy()) do end return 1 end)\n",
       "bad.lua:3: ipairs goes through a table, and this is a number"},
  };
  char scene[1024];
  for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++) {
    snprintf(scene, sizeof scene, BALL "%s" END, wrong[k].lines);
    test_refused(scene, "", 1, wrong[k].text);
  }
  test_refused(BALL "for k = 1, 2 do scene:strand { n = 3, mass = 1 }:at(2.0) end\nparam('k', 1, nil, nil)\n"
                    "for _, e in ipairs(scene:grid { nx = 3, ny = 3 }:edges()) do assert(e[1]) end\nerror('end')\n",
               "", 1, "end"); /* and what is right is not refused */
}

static void errors_of_the_run_name_the_line(void **state) {
  (void)state;
  test_refused(PAIR "scene:constraint('bars', { edges = {{1, 2}} })\n" END, "--integrator xpbd", 1,
               "bad.lua:4: xpbd takes no constraints ('bars')");
  test_refused(PAIR "scene:exact(function(t) return 1, 2 end)\n" END, "", 1,
               "bad.lua:4: exact gave 2 numbers at t = 0.1 s, which are not x, y, z of whole particles: return three");
  test_refused(BALL "scene:start { file = 'none.csv' }\n" END, "", 4,
               "bad.lua:3: start: cannot read none.csv: No such file or directory");
  test_write("empty.csv", "");
  test_refused(BALL "scene:start { file = 'empty.csv' }\n" END, "", 4, "bad.lua:3: start: empty.csv is empty");
  test_refused("local scene = hooke.scene { integrator = 'auto' }\nscene:particle {}\n" END, "", 1,
               "bad.lua:1: integrator 'auto' needs to know the accuracy that is asked for");
  test_refused(BALL END, "--integrator auto", 1, "hooke: integrator 'auto' needs to know the accuracy");
}

static void a_watch_without_a_scene_says_so(void **state) {
  (void)state;
  expect("run --watch", 1, "--watch: there is no scene to run: name its script, as in hooke run SCENE.lua --watch");
  expect("watch", 1, "there is no scene to run");
}

static void zero_mass_is_fine_when_pinned(void **state) {
  (void)state;
  test_write(
      "pinned.lua",
      SCENE "local p = scene:particle { position = {0,0,0}, mass = 0 }\nscene:pin { p }\nscene:force('gravity')\n" END);
  test_hooke(&r, NULL, "run pinned.lua --quiet");
  assert_int_equal(r.code, 0);
}

static void scripts_are_kept_in_their_sandbox(void **state) {
  (void)state;
  test_refused("local x = = 1\n", "", 1, "bad.lua:1:");
  test_refused("while true do end\n", "", 1, "bad.lua:1: the script ran beyond its limit");
  test_refused("while true do pcall(function() while true do end end) end\n", "", 1, "the script ran beyond its limit");
  test_refused("local s = string.rep('x', 2^30)\n", "", 1,
               "not enough memory: the script went beyond its limit of 512 MiB");
  test_refused("os.execute('true')\n", "", 1, "bad.lua:1: os.execute is not available to scenes");
  test_refused("io.open('/etc/passwd')\n", "", 1, "io.open is not available to scenes");
  test_refused("debug.getregistry()\n", "", 1, "debug.getregistry is not available to scenes");
  test_refused("load('x = 1')()\n", "", 1, "load is not available to scenes");
  test_refused("require('../secret')\n", "", 1, "is not the name of a module");
  test_refused("('x').dump(print)\n", "", 1, "dump");
  test_refused("setmetatable({}, { __gc = function() while true do end end })\n", "", 1,
               "__gc is not available to scenes");
  test_refused(BALL, "", 1, "bad.lua returned no scene: end it with 'return scene'");
  test_refused(BALL "scene:measure('m', function(s) return s:position(9)[1] end)\n" END, "", 1,
               "bad.lua:3: there is no particle 9 now");
}

static void bad_plugins_are_refused_with_the_reason(void **state) {
  (void)state;
  char scene[1024];
  const struct {
    const char *file, *text;
    int code;
  } cases[] = {{"wrong_abi", "was built for plugin interface 4.0 and this hooke has 3.5", 2},
               {"no_symbol", "exports no hk_plugin_main", 2},
               {"missing", "does not exist", 2},
               {"floor", "is of the kind 'corrector', not 'force'", 1}};
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
    snprintf(scene, sizeof scene, BALL "scene:force('%s/tests/fixtures/%s.so')\n" END, HK_BUILD, cases[k].file);
    test_refused(scene, "--trust", cases[k].code, cases[k].text);
  }
  snprintf(scene, sizeof scene, BALL "scene:force('%s/tests/fixtures/kicker.so', { fail_at = -1 })\n" END, HK_BUILD);
  test_refused(scene, "--trust", 2, "bad.lua:3: kicker: asked to fail in create");
  test_refused(scene, "", 2, "is native code outside the installation: run with --trust");
  snprintf(scene, sizeof scene, BALL "scene:force('%s/tests/fixtures/kicker.so', { fail_at = 3 })\n" END, HK_BUILD);
  test_refused(scene, "--trust --dt 0.01", 2, "kicker: asked to fail");
}

/* Before the script runs, which here would say so. */
static void files_are_tried_before_the_run(void **state) {
  (void)state;
  static const char *const wrong[][2] = {
      {"--state no/where.csv", "--state: cannot write no/where.csv: No such file or directory; make its folder first"},
      {"--state .", "--state: cannot write .: Is a directory; name another file"},
      {"--state ''", "--state: the file has no name"},
      {"--state told.lua/x", "--state: cannot write told.lua/x: Not a directory; name another file"},
      {"--out told.lua/x", "--out: cannot make the folder told.lua/x: told.lua is a file; name another folder"},
      {"--out ''", "--out: the folder has no name"},
  };
  char arguments[512];
  test_write("told.lua", "print('the script ran')\n" BALL END);
  for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++) {
    snprintf(arguments, sizeof arguments, "run told.lua --quiet %s", wrong[k][0]);
    expect(arguments, k == 2 || k == 5 ? 1 : 4, wrong[k][1]);
    if (*r.out) fail_msg("%s: %s", wrong[k][0], r.out);
  }
  test_hooke(&r, "mkdir kept; echo old >kept/a.csv;", "run told.lua --quiet --state kept/a.csv --until 0 --dt -1");
  assert_int_equal(r.code, 1);
  test_hooke(&r, "test \"$(cat kept/*)\" = old || exit 9;", "--version"); /* trying changes nothing */
  assert_int_equal(r.code, 0);
  test_hooke(&r, NULL, "run told.lua --quiet --out deep/down --state kept/a.csv");
  assert_int_equal(r.code, 0);
  test_hooke(&r, "mkfifo pipe; cat pipe >through &", "run told.lua --quiet --state pipe");
  assert_int_equal(r.code, 0);
}

static void files_that_cannot_be_written_are_named(void **state) {
  (void)state;
  test_write("ball.lua", BALL "scene:measure('z', function(s) return s:position(p)[3] end)\n" END);
  expect("run ball.lua --quiet --state /dev/full", 4, "cannot write /dev/full: No space left on device");
  expect("run ball.lua --quiet --out /proc/nowhere", 4, "/proc/nowhere");
  test_hooke(&r, NULL, "run ball.lua --json --out a >/dev/full");
  assert_int_equal(r.code, 4);
}

/* By its own name, or another one. */
static void a_run_writes_over_nothing_that_it_reads(void **state) {
  (void)state;
  test_write("ball.lua", BALL "scene:output('checkpoint', { every = 1 })\n" END);
  expect("run ball.lua --quiet --summary ./ball.lua", 1, "--summary: ./ball.lua is what is to be run");
  expect("run ball.lua --quiet --state ball.lua", 1, "--state: ball.lua is what is to be run");
  expect("run ball.lua --quiet --out kept", 0, "");
  expect("run ball.lua --resume kept/newest.checkpoint --quiet --state kept/newest.checkpoint", 1,
         "is what is to be run");
}

/* Whether it is there or not, and by whatever path. Into a device both may go. */
static void one_file_for_two_options_is_refused(void **state) {
  (void)state;
  test_write("ball.lua", BALL END);
  test_write("there.txt", "mine");
  expect("run ball.lua --quiet --state both --summary ./both", 1, "--summary: ./both is the file of --state as well");
  assert_true(!test_exists("both"));
  expect("run ball.lua --quiet --summary there.txt --state ./there.txt", 1, "one would be lost; name another file");
  test_hooke(&r, "test \"$(cat there.txt)\" = mine || exit 9;", "--version");
  assert_int_equal(r.code, 0);
  test_hooke(&r, "ln -s there.txt other.txt;", "run ball.lua --quiet --summary there.txt --state other.txt");
  assert_int_equal(r.code, 1);
  expect("run ball.lua --quiet --summary /dev/null --state /dev/null", 0, "");
  expect("run ball.lua --quiet --summary one --state two", 0, "");
}

/* Nobody writes to it: whoever opens it would wait for ever. */
static void a_pipe_is_no_checkpoint(void **state) {
  (void)state;
  test_write("ball.lua", BALL END);
  test_hooke(&r, "mkfifo silent.checkpoint; timeout -s KILL 60", "run ball.lua --quiet --resume silent.checkpoint");
  assert_int_equal(r.code, 4);
  assert_non_null(strstr(r.err, "cannot read silent.checkpoint: it is not a plain file"));
}

/* Its output folder is hidden as well; the names that stand for folders are refused. */
static void a_scene_may_have_a_hidden_name(void **state) {
  (void)state;
  test_write(".ball.lua", BALL "scene:output('table')\n" END);
  test_write("..lua", BALL "scene:output('table')\n" END);
  expect("run .ball.lua --quiet", 0, "");
  assert_true(test_exists("out/.ball/table.csv"));
  expect("run ..lua --quiet", 1, "names no output folder");
}

static void files_of_others_are_never_touched(void **state) {
  (void)state;
  test_write("ball.lua", BALL "scene:measure('z', function(s) return s:position(p)[3] end)\n" END);
  test_write("other.lua", BALL "scene:measure('w', function(s) return 1 end)\n" END);
  expect("run ball.lua --quiet --out shared", 0, "");
  test_write("shared/notes.txt", "mine");
  expect("run ball.lua --quiet --out shared", 0, ""); /* replaces its own */
  assert_true(test_exists("shared/notes.txt"));
  expect("run other.lua --quiet --out shared", 4, "holds the output of the scene 'ball'");
  assert_true(test_exists("shared/measures.csv"));
}

static void a_run_that_diverges_says_where_and_keeps_the_last_good_state(void **state) {
  (void)state;
  test_write("stiff.lua",
             "local scene = hooke.scene { duration = 100, fps = 10 }\n"
             "for i = 0, 9 do scene:particle { position = {i, 0, 0.01 * i * i}, velocity = {0, i, 0}, mass = 1 } end\n"
             "local e = {}\nfor i = 1, 9 do e[i] = {i, i + 1} end\n"
             "scene:force('springs', { edges = e, k = 1e6, rest = 0.5, label = 'chain' })\n" END);
  test_hooke(&r, NULL, "run stiff.lua --dt 0.05 --state s.csv");
  assert_int_equal(r.code, 3);
  assert_non_null(strstr(r.err, "is above the largest stable step"));
  assert_non_null(strstr(r.err, "diverged at step "));
  assert_non_null(strstr(r.err, "t = "));
  assert_non_null(strstr(r.err, "particle "));
  assert_non_null(strstr(r.err, "'chain'"));
  assert_true(test_exists("s.csv"));
  test_hooke(&r, NULL, "run stiff.lua --dt 0.05 --json --quiet");
  assert_non_null(strstr(r.out, "\"verdict\":\"diverged\""));
}

static void an_interrupted_run_keeps_its_state_and_closes_outputs(void **state) {
  (void)state;
  char scene[1024];
  snprintf(
      scene, sizeof scene,
      "local scene = hooke.scene { duration = 1e6, fps = 100 }\nscene:particle { mass = 1 }\nscene:force('gravity')\n"
      "scene:output('%s/tests/fixtures/witness.so')\n" END,
      HK_BUILD);
  test_write("long.lua", scene);
  test_hooke(&r, "timeout --preserve-status -s INT 1", "run long.lua --trust --state s2.csv --out long_out");
  assert_int_equal(r.code, 130);
  assert_non_null(strstr(r.out, "interrupted"));
  assert_true(test_exists("s2.csv"));
  char text[256] = "";
  char path[512];
  snprintf(path, sizeof path, "tail -n 1 %s/long_out/witness/calls.txt", test_folder());
  FILE *pipe = popen(path, "r");
  assert_non_null(pipe);
  assert_non_null(fgets(text, sizeof text, pipe));
  pclose(pipe);
  assert_string_equal(text, "close 4\n"); /* HK_STOPPED */
}

static void two_particles_at_one_point_make_no_nan(void **state) {
  (void)state;
  test_write("same.lua", SCENE "scene:particle { mass = 1 }\nscene:particle { mass = 1 }\n"
                               "scene:force('springs', { edges = {{1, 2}}, k = 100, damping = 1, rest = 0.5 })\n"
                               "scene:force('central', { strength = 1, power = -2 })\n" END);
  test_hooke(&r, NULL, "run same.lua --until 0.01 --json --quiet --no-output");
  assert_int_equal(r.code, 0);
  assert_true(test_json(r.out, "last") == test_json(r.out, "first"));
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(unknown_names_offer_the_nearest),
      cmocka_unit_test(wrong_values_are_refused),
      cmocka_unit_test(slips_in_scripts_are_explained),
      cmocka_unit_test(what_cannot_be_meant_is_refused),
      cmocka_unit_test(wrong_arguments_show_the_call),
      cmocka_unit_test(errors_of_the_run_name_the_line),
      cmocka_unit_test(a_watch_without_a_scene_says_so),
      cmocka_unit_test(zero_mass_is_fine_when_pinned),
      cmocka_unit_test(scripts_are_kept_in_their_sandbox),
      cmocka_unit_test(bad_plugins_are_refused_with_the_reason),
      cmocka_unit_test(files_are_tried_before_the_run),
      cmocka_unit_test(files_that_cannot_be_written_are_named),
      cmocka_unit_test(files_of_others_are_never_touched),
      cmocka_unit_test(a_run_writes_over_nothing_that_it_reads),
      cmocka_unit_test(one_file_for_two_options_is_refused),
      cmocka_unit_test(a_pipe_is_no_checkpoint),
      cmocka_unit_test(a_scene_may_have_a_hidden_name),
      cmocka_unit_test(a_run_that_diverges_says_where_and_keeps_the_last_good_state),
      cmocka_unit_test(an_interrupted_run_keeps_its_state_and_closes_outputs),
      cmocka_unit_test(two_particles_at_one_point_make_no_nan),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
