/* Parameter sweeps as a user meets them: the values of ranges, isolation of cases, results that survive kill -9,
 * merging, CSV, and what is refused before the first case. */
#include "tests/support/command.h"

#include <complex.h>
#include <dirent.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static test_result r;

static void sweep(const char *arguments, int code) {
  char all[4096];
  snprintf(all, sizeof all, "sweep %s", arguments);
  test_hooke(&r, NULL, all);
  if (r.code != code) fail_msg("%s: exit %d instead of %d: %s%s", arguments, r.code, code, r.out, r.err);
}

static void fails(const char *arguments, int code, const char *text) {
  sweep(arguments, code);
  if (!strstr(r.err, text)) fail_msg("%s: no '%s' in: %s", arguments, text, r.err);
}

static void shell(const char *command) {
  char all[2048];
  snprintf(all, sizeof all, "cd '%s' && { %s; }", test_folder(), command);
  if (system(all) != 0) fail_msg("%s failed", command);
}

static void refused(const char *arguments, const char *text) { fails(arguments, 1, text); }

/* Lines of a file in the folder; 0 when it is not there. */
static int lines(const char *name) {
  char path[2048];
  int count = 0;
  snprintf(path, sizeof path, "%s/%s", test_folder(), name);
  FILE *file = fopen(path, "r");
  for (int c; file && (c = fgetc(file)) != EOF;) count += c == '\n';
  if (file) fclose(file);
  return count;
}

/* y(t) = exp(-k t) at t = 0.1, with a line in runs.log for every run (from its frame at 0.05 s; a file
 * that a string in the scene names would count as one that its results depend on). */
static const char scene[] = "local k = param('k', 1, 'rate', { min = 0 })\n"
                            "local m = param('m', 1, 'mass', { min = 0 })\n"
                            "local scene = hooke.scene { duration = 0.1, fps = 20, integrator = 'rk4', dt = 0.05 }\n"
                            "local p = scene:particle { position = { 0, 0, 0 }, mass = m }\n"
                            "scene:channel('y', { initial = 1, rate = -k })\n"
                            "scene:measure('y', function(s)\n"
                            "  local log = math.abs(s.t - 0.05) < 0.01 and io.open('runs' .. '.log', 'a')\n"
                            "  if log then log:write(k, '\\n') log:close() end\n"
                            "  return s:channel('y', p)\n"
                            "end)\n"
                            "return scene\n";

static void write_scene(void) {
  test_write("s.lua", scene);
  shell("rm -rf runs.log out *.db* *.csv");
}

/* ---- values ---- */

/* The values of parameter `name` as --print-cases lists them. */
static int printed(const char *arguments, const char *name, double *value, int most) {
  char all[1024], key[64];
  int count = 0;
  snprintf(all, sizeof all, "s.lua --trust --print-cases %s", arguments);
  snprintf(key, sizeof key, "\t%s=", name);
  sweep(all, 0);
  for (const char *at = r.out; (at = strstr(at, key)) && count < most; count++)
    value[count] = strtod(at += strlen(key), NULL);
  return count;
}

static void ranges_have_known_values(void **state) {
  (void)state;
  double v[32];
  write_scene();
  assert_int_equal(printed("k=1e2..1e6:log:5", "k", v, 32), 5);
  for (int i = 0; i < 5; i++) assert_true(v[i] == pow(10, 2 + i));
  assert_int_equal(printed("k=0..1:linear:5", "k", v, 32), 5);
  for (int i = 0; i < 5; i++) assert_true(v[i] == 0.25 * i);
  assert_int_equal(printed("k=16..128:log:4:whole", "k", v, 32), 4);
  for (int i = 0; i < 4; i++) assert_true(v[i] == 16 << i);
  assert_int_equal(printed("k=3,1,2", "k", v, 32), 3);
  assert_true(v[0] == 3 && v[1] == 1 && v[2] == 2);
  assert_int_equal(printed("k=1,2,3 m=1..2:linear:4", "k", v, 32), 12); /* the product */
}

static void a_latin_hypercube_has_one_value_in_each_stratum(void **state) {
  (void)state;
  enum { N = 40 };
  double k[N + 1], m[N + 1], other[N + 1];
  int seen_k[N] = {0}, seen_m[N] = {0}, moved = 0;
  write_scene();
  assert_int_equal(printed("k=0..10:latin:40 m=1..1e4:latin:log:40 --seed 7", "k", k, N + 1), N);
  assert_int_equal(printed("k=0..10:latin:40 m=1..1e4:latin:log:40 --seed 7", "m", m, N + 1), N);
  for (int i = 0; i < N; i++) {
    int a = (int)(k[i] / 10 * N), b = (int)(log10(m[i]) / 4 * N);
    assert_true(a >= 0 && a < N && b >= 0 && b < N);
    seen_k[a]++;
    seen_m[b]++;
    moved += a != b;
  }
  for (int i = 0; i < N; i++) assert_true(seen_k[i] == 1 && seen_m[i] == 1);
  assert_true(moved > N / 2); /* each in an order of its own: of 40 some one is expected to agree */
  assert_int_equal(printed("k=0..10:latin:40 --seed 7", "k", other, N + 1), N);
  assert_memory_equal(k, other, sizeof *k * N); /* one parameter's values do not depend on another's */
  assert_int_equal(printed("k=0..10:latin:40 --seed 8", "k", other, N + 1), N);
  assert_true(memcmp(k, other, sizeof *k * N) != 0);
}

static void random_values_are_reproducible_and_within_the_range(void **state) {
  (void)state;
  double a[200], b[200], sum = 0;
  write_scene();
  assert_int_equal(printed("k=2..4:random:200 --seed 3", "k", a, 200), 200);
  assert_int_equal(printed("k=2..4:random:200 --seed 3", "k", b, 200), 200);
  assert_memory_equal(a, b, sizeof a);
  for (int i = 0; i < 200; i++) {
    assert_true(a[i] >= 2 && a[i] < 4);
    sum += a[i];
  }
  /* The mean's standard deviation is 2/sqrt(12 * 200) = 0.041; five of them. */
  assert_true(fabs(sum / 200 - 3) < 0.21);
}

/* ---- refusals ---- */

static void wrong_names_and_values_are_refused_before_the_first_case(void **state) {
  (void)state;
  write_scene();
  refused("s.lua --trust kk=1,2", "no parameter 'kk'");
  refused("s.lua --trust k=1,2,-3", "-3 is below the minimum 0"); /* the third, before the first is run */
  refused("s.lua --trust k=1 --measures yy", "no measure 'yy'; did you mean 'y'?");
  refused("s.lua --trust k=1 --plot yy:k", "no measure 'yy'");
  refused("s.lua --trust k=1 --integrators rk5", "no integrator 'rk5'; did you mean 'rk4'?");
  refused("s.lua --trust k=1 --integrators xpbd:substep=4", "did you mean 'substeps'?");
  refused("s.lua --trust k=1..2", "how many values?");
  refused("s.lua --trust k=0..2:log:4", "both ends must be above 0");
  refused("s.lua --trust k=0..1:random:5 m=1..2:latin:6", "the numbers must be the same");
  refused("s.lua --trust k=1 --resum", "did you mean '--resume'?");
  refused("nothing.lua k=1", "nothing.lua: No such file");
  refused("s.lua --trust k=1 --csv ./s.lua", "--csv: ./s.lua is what is to be run");
  refused("s.lua --trust k=1 --db s.lua", "--db: s.lua is what is to be run");
  refused("s.lua --trust k=1 --csv twice --db ./twice", "--csv: twice is the file of --db as well");
  assert_int_equal(lines("runs.log"), 0);
}

static void a_script_describes_and_has_no_hands(void **state) {
  (void)state;
  write_scene();
  test_write("a.lua", "os.remove('s.lua')\nreturn hooke.sweep { scene = 's.lua' }\n");
  refused("a.lua", "a.lua:1: os.remove is not available");
  test_write("b.lua", "return hooke.sweep { scene = 's.lua', integrator = 'rk4' }\n");
  refused("b.lua", "did you mean 'integrators'?");
  test_write("b.lua", "return hooke.sweep { scene = 's.lua', trust = true }\n");
  refused("b.lua", "a script cannot lift the sandbox");
  test_write("b.lua", "return hooke.sweep { scene = 's.lua', params = { k = { 1, 2 } }, paths = { 1 }, plots = { {\n"
                      "path = 1, panels = { 'k' }, curves = { [1] = { '0:1', '(t):(system(t))' } } } } }\n");
  refused("b.lua", "there is no function 'system' here");
  test_write("c.lua", "while true do end\nreturn hooke.sweep { scene = 's.lua' }\n");
  refused("c.lua", "is there an endless loop?");
}

/* ---- running ---- */

/* Diverges (a spring that an unstable step makes swing ever wider), crashes, does not end, or is fine. */
static const char hazards[] =
    "local what = param('what', 'fine', '')\n"
    "local calm = io.open('ca' .. 'lm')\n"
    "if calm and what ~= 'diverges' then what = 'fine' end\n"
    "local scene = hooke.scene { duration = what == 'endless' and 1e9 or 10, fps = 10, "
    "integrator = 'rk4', dt = 0.05 }\n"
    "local p = scene:particle { position = { 1, 0, 0 }, mass = 1 }\n"
    "scene:force('central', { strength = what == 'diverges' and 1e9 or 1 })\n"
    "if what == 'crashes' then scene:force('%s/tests/fixtures/aborter.so', {}) end\n"
    "if what == 'fails' then scene:measure('m', function(s) return assert(s.t == 0, 'no') and 1 end) end\n"
    "scene:measure('x', function(s) return s:position(p)[1] end)\n"
    "return scene\n";

static void what_goes_wrong_in_a_case_stays_in_the_case(void **state) {
  (void)state;
  char text[2048];
  write_scene();
  snprintf(text, sizeof text, hazards, HK_BUILD);
  test_write("h.lua", text);
  sweep("h.lua what=diverges,crashes,endless,fails,fine --trust --timeout 2 -j 2 --csv h.csv 2>.said", 0);
  if (!strstr(r.out, "1 ok, 1 timeout")) fail_msg("%s", r.out);
  assert_non_null(strstr(r.out, "1 crashed, 1 diverged, 1 failed, 1 ok, 1 timeout"));
  assert_int_equal(lines("h.csv"), 6);
  shell("grep -q '^1,h,diverges,.*,diverged,' h.csv");
  shell("grep -q '^2,h,crashes,.*,crashed,the process crashed' h.csv");
  shell("grep -q '^3,h,endless,.*,timeout,ended after 2 s' h.csv");
  shell("grep -q '^5,h,fine,rk4,ok,' h.csv");
  shell("grep -q 'h.lua:8: .*no' h.csv");
}

static void retry_does_again_what_crashed_or_ran_out_of_time(void **state) {
  (void)state;
  char text[2048];
  write_scene();
  snprintf(text, sizeof text, hazards, HK_BUILD);
  test_write("h.lua", text);
  const char *cases = "h.lua what=crashes,endless,diverges,fine --trust --db r.db --quiet";
  snprintf(text, sizeof text, "%s --timeout 1 --csv first.csv 2>.said", cases);
  sweep(text, 0);
  test_write("calm", ""); /* now nothing happens */
  snprintf(text, sizeof text, "%s --resume --csv same.csv 2>.said", cases);
  sweep(text, 0);
  shell("cmp first.csv same.csv");
  snprintf(text, sizeof text, "%s --retry --csv second.csv 2>.said", cases);
  sweep(text, 0);
  shell("[ $(grep -c ',ok,' second.csv) = 3 ] && grep -q ',diverged,' second.csv");
  shell("grep ',fine,' first.csv >a.csv && grep ',fine,' second.csv | cmp - a.csv"); /* down to its seconds */
  shell("rm calm");
}

/* What is in the database when the process is killed is there afterwards, and is not done again. */
static void a_sweep_survives_kill_9(void **state) {
  (void)state;
  enum { CASES = 110, JOBS = 2, KILLS = 4 };
  int killed = 0;
  write_scene();
  for (; killed < KILLS; killed++) {
    /* Killed when some six to twenty further cases have begun; whoever ends before that is not killed. */
    char all[1024];
    snprintf(
        all, sizeof all,
        "'%s/hooke' sweep s.lua --trust k=1..2:linear:%d -j %d --quiet --db k.db --resume & pid=$!; "
        "want=$(($(cat runs.log 2>/dev/null | wc -l) + %d)); "
        "while kill -0 $pid 2>/dev/null && [ $(cat runs.log 2>/dev/null | wc -l) -lt $want ]; do sleep 0.01; done; "
        "kill -9 $pid 2>/dev/null; wait $pid; [ $? = 137 ]",
        HK_BUILD, CASES, JOBS, 6 + 4 * killed);
    shell(all);
    snprintf(all, sizeof all, "s.lua --trust k=1..2:linear:%d --quiet --db k.db --report --csv %d.csv", CASES, killed);
    sweep(all, 0);
    snprintf(all, sizeof all, "%d.csv", killed);
    assert_true(lines(all) > 1 && lines(all) <= CASES); /* a header and some cases, not all */
  }
  sweep("s.lua --trust k=1..2:linear:110 -j 2 --quiet --db k.db --resume --csv all.csv", 0);
  assert_int_equal(lines("all.csv"), 1 + CASES);
  /* Rows from before each kill are there unchanged, down to the seconds that they took. */
  for (int k = 0; k < KILLS; k++) {
    char all[256];
    snprintf(all, sizeof all, "[ $(grep -cxFf %d.csv all.csv) = $(wc -l <%d.csv) ]", k, k);
    shell(all);
  }
  /* Only what was under way at a kill ran twice. */
  assert_true(lines("runs.log") <= CASES + KILLS * JOBS);
  shell("cp runs.log before.log");
  sweep("s.lua --trust k=1..2:linear:110 --quiet --db k.db --resume", 0);
  sweep("s.lua --trust k=1..2:linear:110 --quiet --db k.db", 0); /* all of it is done: nothing to ask */
  shell("cmp runs.log before.log");
}

static void half_a_sweep_is_not_thrown_away_by_mistake(void **state) {
  (void)state;
  write_scene();
  sweep("s.lua --trust k=1,2,3 --quiet --db h.db --case 1,3", 0);
  assert_int_equal(lines("runs.log"), 2);
  refused("s.lua --trust k=1,2,3 --quiet --db h.db", "2 of 3 cases are in h.db already: --resume goes on");
  assert_int_equal(lines("runs.log"), 2);
  sweep("s.lua --trust k=1,2,3 --quiet --db h.db --resume", 0);
  assert_int_equal(lines("runs.log"), 3);
  sweep("s.lua --trust k=1,2,3,4 --quiet --db h.db --resume", 0); /* another sweep finds what it shares */
  assert_int_equal(lines("runs.log"), 4);
  sweep("s.lua --trust k=1,2,3 --quiet --db h.db --again", 0);
  assert_int_equal(lines("runs.log"), 7);
  refused("s.lua --trust k=1,2,3 --db h.db --case 4", "from 1 to 3");
}

static void a_case_is_done_again_when_what_it_runs_on_changes(void **state) {
  (void)state;
  char text[2048];
  write_scene();
  sweep("s.lua --trust k=1,2 --quiet --db v.db", 0);
  snprintf(text, sizeof text, "-- another text\n%s", scene);
  test_write("s.lua", text);
  sweep("s.lua --trust k=1,2 --quiet --db v.db --resume", 0);
  assert_int_equal(lines("runs.log"), 4);
  sweep("s.lua --trust k=1,2 --quiet --db v.db --resume --tol 1e-3", 0); /* a setting */
  assert_int_equal(lines("runs.log"), 6);
  test_write("s.lua", scene); /* as it was: its results are still there */
  sweep("s.lua --trust k=1,2 --quiet --db v.db --resume", 0);
  assert_int_equal(lines("runs.log"), 6);
  /* A module, and a plugin (a byte more behind its end changes nothing but its version). */
  snprintf(text, sizeof text, "require('part')\nlocal force = './kicker.so'\n%s", scene);
  char *end = strstr(text, "return scene\n");
  strcpy(end, "scene:force(force, {})\nreturn scene\n");
  test_write("s.lua", text);
  test_write("part.lua", "return 1\n");
  shell("cp '" HK_BUILD "/tests/fixtures/kicker.so' .");
  sweep("s.lua --trust k=1,2 --quiet --db v.db --resume", 0);
  assert_int_equal(lines("runs.log"), 8);
  test_write("part.lua", "return 2\n");
  sweep("s.lua --trust k=1,2 --quiet --db v.db --resume", 0);
  assert_int_equal(lines("runs.log"), 10);
  shell("printf x >>kicker.so");
  sweep("s.lua --trust k=1,2 --quiet --db v.db --resume", 0);
  assert_int_equal(lines("runs.log"), 12);
  sweep("s.lua --trust k=1,2 --quiet --db v.db --resume", 0);
  assert_int_equal(lines("runs.log"), 12);
}

/* A plugin that the scene names, found in a folder of plugins; another one there that it does not name. */
static void a_case_is_done_again_when_a_named_plugin_changes(void **state) {
  (void)state;
  char text[2048];
  const int wanted[] = {2, 2, 4};
  const char *const change[] = {":", "printf x >>p/forces/floor.so", "printf x >>p/forces/kicker.so"};
  write_scene();
  snprintf(text, sizeof text, "%s", scene);
  strcpy(strstr(text, "return scene\n"), "scene:force('kicker', {})\nreturn scene\n");
  test_write("s.lua", text);
  shell("mkdir -p p/forces && cp '" HK_BUILD "/tests/fixtures/kicker.so' '" HK_BUILD
        "/tests/fixtures/floor.so' p/forces");
  for (int k = 0; k < 3; k++) {
    shell(change[k]);
    test_hooke(&r, "HOOKE_PLUGIN_PATH=$PWD/p", "sweep s.lua --trust k=1,2 --quiet --db n.db --resume");
    if (r.code != 0) fail_msg("exit %d: %s", r.code, r.err);
    assert_int_equal(lines("runs.log"), wanted[k]);
  }
}

static void parts_of_a_sweep_merge_into_one(void **state) {
  (void)state;
  write_scene();
  sweep("s.lua --trust k=1,2,3,4 --quiet --db whole.db --csv whole.csv", 0);
  sweep("s.lua --trust k=1,2,3,4 --quiet --case 1-3 --part a.db", 0);
  sweep("s.lua --trust k=1,2,3,4 --quiet --case 3,4 --part b.db", 0);
  assert_int_equal(lines("runs.log"), 9);
  sweep("s.lua --trust k=1,2,3,4 --quiet --db all.db --merge a.db --merge b.db --csv all.csv", 0);
  sweep("s.lua --trust k=1,2,3,4 --quiet --db all.db --merge b.db --csv again.csv", 0); /* nothing comes in twice */
  assert_int_equal(lines("runs.log"), 9);
  shell("cmp all.csv again.csv");
  /* Case, scene, k, integrator, verdict, reason, t, ... up to dt_max, and the last column, y: all but the clock. */
  shell("for f in whole all; do cut -d, -f1-14 $f.csv >$f.a; sed 's/.*,//' $f.csv >$f.y; done; "
        "cmp whole.a all.a && cmp whole.y all.y");
  fails("s.lua --trust k=1 --db all.db --merge nothing.db", 4, "cannot merge nothing.db");
  test_write("text.db", "This is not a database, and it is long enough for that to be seen at once.");
  fails("s.lua --trust k=1 --db text.db", 4, "text.db: file is not a database");
  fails("s.lua --trust k=1 --db all.db --resume --csv text.db/x.csv", 4, "text.db");
}

/* y at the end: two steps of 0.05 s. */
static double rk4_decay(double k) {
  double z = -k * 0.05;
  return pow(1 + z + z * z / 2 + z * z * z / 6 + z * z * z * z / 24, 2);
}

/* 17 digits: the number of the file is the number of the run. */
static void the_csv_holds_every_digit(void **state) {
  (void)state;
  char path[512], line[4096];
  write_scene();
  sweep("s.lua --trust k=0.1,3 --quiet --csv out/deep/x.csv", 0);
  snprintf(path, sizeof path, "%s/out/deep/x.csv", test_folder());
  FILE *file = fopen(path, "r");
  assert_non_null(file);
  assert_non_null(fgets(line, sizeof line, file));
  assert_memory_equal(line, "case,scene,k,", 13);
  assert_string_equal(strrchr(line, ','), ",y\n");
  for (int i = 0; i < 2; i++) {
    assert_non_null(fgets(line, sizeof line, file));
    double k = i ? 3 : 0.1, y = strtod(strrchr(line, ',') + 1, NULL);
    char all[256];
    assert_true(fabs(y - rk4_decay(k)) < 1e-15); /* rounding */
    snprintf(all, sizeof all, "run s.lua --trust --json --quiet k=%.17g", k);
    test_hooke(&r, NULL, all);
    assert_true(test_json(r.out, "y") == y);
  }
  fclose(file);
}

/* ---- pictures ---- */

/* The data of a picture, from what gnuplot reads; without gnuplot the files are there, and the exit code says so. */
static void draw(const char *arguments, const char *name) {
  bool gnuplot = system("command -v gnuplot >/dev/null") == 0;
  char path[512], png[128];
  sweep(arguments, gnuplot ? 0 : 4);
  snprintf(png, sizeof png, "%s.png", name);
  assert_true(test_exists(png) == gnuplot);
  snprintf(path, sizeof path, "%s/%s.dat", test_folder(), name);
  FILE *file = fopen(path, "r");
  assert_non_null(file);
  size_t got = fread(r.out, 1, sizeof r.out - 1, file);
  r.out[got] = 0;
  fclose(file);
}

/* The numbers are drawn with 9 digits. */
static void pictures_show_the_measures(void **state) {
  (void)state;
  double x, y, z;
  write_scene();
  draw("s.lua --trust k=4,1,2 m=1,2 --quiet --db p.db --plot y:k", "p-y-k");
  const char *at = strstr(r.out, "$CURVE1 << EOD\n");
  assert_non_null(at);
  assert_non_null(strstr(r.out, "$CURVE2 << EOD\n")); /* a line for each m */
  assert_null(strstr(r.out, "$CURVE3"));
  at = strchr(at, '\n');
  for (int i = 0; i < 3; i++) { /* in the order of k */
    int used = 0;
    assert_int_equal(sscanf(at, "%lf %lf%n", &x, &y, &used), 2);
    assert_true(x == 1 << i && fabs(y / rk4_decay(x) - 1) < 1e-8);
    at += used;
  }
  draw("s.lua --trust k=4,1,2 m=1,2 --quiet --db p.db --plot y:k,m", "p-y-k-m");
  at = strchr(strstr(r.out, "$MATRIX << EOD\n"), '\n');
  for (int i = 0; i < 6; i++) { /* in the order of the lists, columns first */
    const double k[] = {4, 1, 2};
    int used = 0;
    assert_int_equal(sscanf(at, "%lf %lf %lf%n", &x, &y, &z, &used), 3);
    assert_true(x == i % 3 + 1 && y == i / 3 + 1 && fabs(z / rk4_decay(k[i % 3]) - 1) < 1e-8);
    at += used;
  }
}

/* One measure against another, in the order of the parameter that the lines run along. */
static void pictures_show_a_measure_against_another(void **state) {
  (void)state;
  double x, y;
  write_scene();
  test_write("along.lua",
             "return hooke.sweep { scene = 's.lua', params = { k = { 4, 1, 2 }, m = { 1, 2 } }, plots = { {\n"
             "measure = 'steps', over = 'y', along = 'k', name = 'both' } } }\n");
  draw("along.lua --trust --quiet --db a.db", "a-both");
  const char *at = strstr(r.out, "$CURVE1 << EOD\n");
  assert_true(at && strstr(r.out, "$CURVE2 << EOD\n") && !strstr(r.out, "$CURVE3"));
  at = strchr(at, '\n');
  for (int i = 0; i < 3; i++) {
    const double k[] = {4, 1, 2};
    int used = 0;
    assert_int_equal(sscanf(at, "%lf %lf%n", &x, &y, &used), 2);
    assert_true(y == 2 && fabs(x / rk4_decay(k[i]) - 1) < 1e-8);
    at += used;
  }
  test_write("along.lua", "return hooke.sweep { scene = 's.lua', params = { k = { 4, 1 } }, plots = { {\n"
                          "measure = 'steps', over = 'y', along = 'q' } } }\n");
  refused("along.lua --trust", "'q' is not a parameter of the sweep");
  test_write("along.lua", "return hooke.sweep { scene = 's.lua', params = { k = { 4, 1 } }, plots = { {\n"
                          "measure = 'steps', over = 'k', repeats = 'least' } } }\n");
  refused("along.lua --trust", "repeats: \"least\", of what is in `over`, beside `along`");
}

/* ---- the sweeps that come along ---- */

static void every_shipped_sweep_lists_its_cases(void **state) {
  (void)state;
  DIR *folder = opendir(HK_ROOT "/scripts/sweeps");
  int count = 0;
  assert_non_null(folder);
  for (struct dirent *entry; (entry = readdir(folder));) {
    char all[1024];
    if (!strstr(entry->d_name, ".lua")) continue;
    snprintf(all, sizeof all, HK_ROOT "/scripts/sweeps/%.200s --print-cases", entry->d_name);
    sweep(all, 0);
    assert_true(strncmp(r.out, "1\tscene=", 8) == 0);
    count++;
  }
  closedir(folder);
  assert_true(count >= 3);
}

/* Euler on x'' = -x multiplies x - iv by 1 + ih a step: after 32 steps of a sixteenth of a turn |(1 + ih)^32 - 1|. */
/* The start of a column of a line of CSV, from 0; commas inside quotes divide nothing. */
static const char *csv_column(const char *line, int column) {
  bool quoted = false;
  for (; *line && column > 0; line++) {
    quoted ^= *line == '"';
    column -= *line == ',' && !quoted;
  }
  return line;
}

static void the_classic_comparison_shows_what_is_known_of_euler(void **state) {
  (void)state;
  char path[512], line[4096];
  double found = NAN;
  write_scene();
  sweep(HK_ROOT "/scripts/sweeps/integrators.lua --quiet --csv i.csv --db i.db 2>.said || true", 0);
  snprintf(path, sizeof path, "%s/i.csv", test_folder());
  FILE *file = fopen(path, "r");
  assert_non_null(file);
  while (fgets(line, sizeof line, file)) {
    if (!strstr(line, ",oscillator,16,circle,euler,")) continue;
    found = strtod(csv_column(line, 22), NULL);
  }
  fclose(file);
  double wanted = cabs(cpow(1 + I * 2 * acos(-1) / 16, 32) - 1);
  assert_true(fabs(found - wanted) < 1e-12 * wanted * 32); /* 32 steps of rounding */
  assert_true(test_exists("i-paths.dat") && test_exists("i-error.dat"));
  if (system("command -v gnuplot >/dev/null") != 0) return;
  assert_true(test_exists("i-paths.png") && test_exists("i-paths.svg") && test_exists("i-error.png"));
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(ranges_have_known_values),
      cmocka_unit_test(a_latin_hypercube_has_one_value_in_each_stratum),
      cmocka_unit_test(random_values_are_reproducible_and_within_the_range),
      cmocka_unit_test(wrong_names_and_values_are_refused_before_the_first_case),
      cmocka_unit_test(a_script_describes_and_has_no_hands),
      cmocka_unit_test(what_goes_wrong_in_a_case_stays_in_the_case),
      cmocka_unit_test(retry_does_again_what_crashed_or_ran_out_of_time),
      cmocka_unit_test(a_sweep_survives_kill_9),
      cmocka_unit_test(half_a_sweep_is_not_thrown_away_by_mistake),
      cmocka_unit_test(a_case_is_done_again_when_what_it_runs_on_changes),
      cmocka_unit_test(a_case_is_done_again_when_a_named_plugin_changes),
      cmocka_unit_test(parts_of_a_sweep_merge_into_one),
      cmocka_unit_test(the_csv_holds_every_digit),
      cmocka_unit_test(pictures_show_the_measures),
      cmocka_unit_test(pictures_show_a_measure_against_another),
      cmocka_unit_test(every_shipped_sweep_lists_its_cases),
      cmocka_unit_test(the_classic_comparison_shows_what_is_known_of_euler),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
