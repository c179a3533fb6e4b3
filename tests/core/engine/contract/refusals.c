/* What is wrong with a plugin's file or constant is said in one sentence, before any of its code runs: the run ends
 * with code 2 (1 where the scene names the wrong kind), and the catalogue lists it. The plugins are compiled here, as a
 * user compiles one; each fault is one macro. */
#include "tests/support/command.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static test_result r;

/* A force of no effect with two parameters and a field, and a row for one more. */
static const char source[] =
    "#include \"core/plugin.h\"\n"
    "typedef struct wrong { double a, b, next; int64_t count; hk_tuples edges; hk_per_tuple k; int way; } wrong;\n"
    "#ifdef ROW\nenum { ROWS = 4 };\n#else\n#define ROW\nenum { ROWS = 3 };\n#endif\n"
    "#ifndef FIELD\n#define FIELD\n#endif\n"
    "#ifndef END\n#define END {0}\n#endif\n"
    "#ifndef NAME\n#define NAME \"wrong\"\n#endif\n"
    "#ifndef KIND\n#define KIND HK_FORCE\n#endif\n"
    "#ifndef SIZE\n#define SIZE sizeof(hk_force)\n#endif\n"
    "#ifndef TABLE\n#define TABLE .add = add\n#endif\n"
    "#ifndef FACET\n#define FACET {0}\n#endif\n#ifndef FACETS\n#define FACETS 2\n#endif\n"
    "#ifndef HAND_ID\n#define HAND_ID HK_BY_HAND_ID\n#endif\n"
    "#ifndef HAND\n#define HAND .moved = moved\n#endif\n"
    "#ifndef HAND_SIZE\n#define HAND_SIZE sizeof(hk_by_hand_facet)\n#endif\n"
    "#ifndef MAIN\n#define MAIN .force = &force\n#endif\n"
    "static const struct { hk_param rows[ROWS]; uintptr_t after[64]; } params = {{\n"
    "    {\"a\", \"m\", \"a length\", .number = HK_AT(wrong, a), .initial = {1}},\n"
    "    {\"edges\", \"\", \"pairs\", .edges = HK_AT(wrong, edges)},\n"
    "    ROW END}, {3, 5, 7, 9}};\n"
    "static const hk_field fields[] = {{\"count\", .integer = HK_AT(wrong, count)}, FIELD {0}};\n"
    "static hk_status add(void *self, const hk_view *view, double *F) {\n"
    "  (void)self, (void)view, (void)F;\n  return HK_OK;\n}\n"
    "static bool moved(const void *self, double *work) { return (void)self, (void)work, false; }\n"
    "const void *used[] = {(const void *)add, (const void *)moved};\n"
    "static const hk_by_hand_facet hand = {.size = HAND_SIZE, HAND};\n"
    "static const struct { hk_facet rows[FACETS]; uintptr_t after[64]; } facets = {{{HAND_ID, &hand}, FACET}, {3, "
    "5}};\n"
    "static const hk_force force = {.size = SIZE, TABLE, .facets = facets.rows};\n"
    "HK_EXPORT const hk_plugin hk_plugin_main = {.abi = HK_ABI, .kind = KIND, .name = NAME, .summary = \"nothing\",\n"
    "    .reference = \"\", .instance_size = sizeof(wrong), .params = params.rows, .fields = fields, MAIN};\n";

static void expect(const char *what, int code, const char *text) {
  test_hooke(&r, NULL, "run wrong.lua --trust --quiet");
  if (r.code != code) fail_msg("%s: exit %d instead of %d: %s", what, r.code, code, r.err);
  if (text && !strstr(r.err, text)) fail_msg("%s: expected '%s' in: %s", what, text, r.err);
  if (text && strchr(r.err, '\n') != strrchr(r.err, '\n')) fail_msg("%s: not one sentence: %s", what, r.err);
}

static void compile(const char *macros, const char *file) {
  char command[2048];
  test_write("wrong.c", source);
  snprintf(command, sizeof command, "cd '%s' && cc -w -shared -fPIC %s $('%s/hooke' --cflags) wrong.c -o %s",
           test_folder(), macros, HK_BUILD, file);
  if (system(command) != 0) fail_msg("cannot compile with %s", macros);
  snprintf(command, sizeof command,
           "local scene = hooke.scene { duration = 0.1, fps = 10, integrator = 'leapfrog' }\n"
           "scene:particle { mass = 1 }\nscene:force('./%s')\nreturn scene\n",
           file);
  test_write("wrong.lua", command);
}

static void every_fault_of_a_constant_is_one_sentence(void **state) {
  (void)state;
#define ROW(...) "'-DROW={" __VA_ARGS__ "},'"
#define B "\"b\",\"\",\"help\","
#define AT(offset) "(void*)(HK_BASE+(" offset "))"
  static const char *const faults[][2] = {
      {"'-DEND={" B ".number=HK_AT(wrong,b)}'", "its table of parameters has no end: row 4"},
      {ROW(B ".initial={1}"), "the parameter 'b' fills no member of the instance, or several: .number = HK_AT("},
      {ROW(B ".number=HK_AT(wrong,b),.integer=HK_AT(wrong,count)"), "fills no member of the instance, or several"},
      {ROW(B ".number=" AT("4096")), "the parameter 'b' lies outside the instance: bytes 4096 to 4104 of"},
      {ROW(B ".number=" AT("(size_t)-8")), "outside the instance"},
      {ROW(B ".vector=" AT("sizeof(wrong)-16")), "outside the instance"},
      {ROW(B ".number=" AT("offsetof(wrong,b)+1")), "at the odd offset"},
      {ROW(B ".number=HK_AT(wrong,a)"), "'a' and 'b' fill the same bytes"},
      {ROW("\"count_2\",\"\",\"help\",.integer=HK_AT(wrong,count)"), "'count_2' and 'count' fill the same bytes"},
      {ROW("\"a\",\"\",\"help\",.number=HK_AT(wrong,b)"), "two rows of its tables are called 'a'"},
      {ROW("\"only\",\"\",\"help\",.number=HK_AT(wrong,b)"), "'only' cannot be a parameter"},
      {ROW("\"b\",NULL,\"help\",.number=HK_AT(wrong,b)"), "lacks its unit"},
      {ROW(B ".number=HK_AT(wrong,b),.limits={0,0,1}"), "the limits of the parameter 'b' are none"},
      {ROW(B ".number=HK_AT(wrong,b),.limits=HK_WITHIN(2,1)"), "the limits of the parameter 'b' are none"},
      {ROW(B ".number=HK_AT(wrong,b),.limits=HK_AT_LEAST(NAN)"), "the limits of the parameter 'b' are none"},
      {ROW(B ".choice=HK_AT(wrong,way)"), "without choices"},
      {ROW(B ".choice=HK_AT(wrong,way),.initial={2},.choices=\"up|down\""),
       "the default of the parameter 'b', 2, is none of its choices, up|down"},
      {ROW(B ".per_tuple=HK_AT(wrong,k),.list=\"triangles\""), "a number per tuple of 'triangles', which is no list"},
      {ROW(B ".choice=HK_AT(wrong,way),.flags=HK_TIMED,.choices=\"up|down\""),
       "only a number or a vector can be a function of t"},
      {ROW(B ".choice=HK_AT(wrong,way),.flags=HK_NOT_EMPTY,.choices=\"up|down\""),
       "only a list of particles or tuples can be empty"},
      {"'-DFIELD={\"next\",.width=1},'", "the field 'next' keeps no member of the instance, or several"},
      {"'-DFIELD={\"next\",.state=" AT("1<<20") ",.width=1},'", "the field 'next' lies outside the instance"},
      {"'-DFIELD={\"next\",.state=(double**)HK_AT(wrong,next)},'", "the field 'next' has the width 0"},
      {"'-DFIELD={\"next\",.per_tuple=(double**)HK_AT(wrong,next),.list=\"edges\"},'",
       "the field 'next' has the width 0"},
      {"'-DFIELD={\"next\",.per_tuple=(double**)HK_AT(wrong,next),.list=\"triangles\",.width=1},'",
       "the field 'next' is per tuple of 'triangles', which is no list of its parameters"},
      {"'-DFIELD={\"next\",.state=(double**)HK_AT(wrong,next),.list=\"edges\",.width=1},'",
       "the field 'next' names the list 'edges' and is not per tuple"},
      {"'-DFIELD={\"next\",.per_tuple=(double**)HK_AT(wrong,next),.list=(const char*)64,.width=1},'",
       "the list of the field 'next' is no text"},
      {"'-DFIELD={\"next\",.per_tuple=(double**)HK_AT(wrong,next),.flags=HK_PUBLISHED,.width=1},'",
       "the field 'next' is published and not per particle"},
      {"'-DFACET=HK_INTERNAL_FACET(.evolve = (void *)add),{0}' -DFACETS=3",
       "it has the facet 'internal/1' and no energy, which is what its elements dissipate"},
      {"'-DFACET=HK_INTERNAL_FACET(.evolve = 0),{0}' -DFACETS=3 '-DTABLE=.add = add,.energy = (void *)add'",
       "its hk_internal_facet has no 'evolve', which it must have"},
      {"'-DTABLE=.energy = 0'", "its hk_force has neither 'add' nor 'add_part': it must have one of them"},
      {"'-DFACET=HK_IMPLICIT_FACET(.jacobian = (void *)add),{0}' -DFACETS=3",
       "its hk_implicit_facet has no 'pattern', which it must have"},
      {"'-DFACET=HK_IMPLICIT_FACET(.pattern = (void *)add),{0}' -DFACETS=3",
       "its hk_implicit_facet has no 'jacobian', which it must have"},
      {"'-DFACET=HK_APPROXIMATION_FACET(.errors = (void *)add),{0}' -DFACETS=3",
       "its hk_approximation_facet has no 'sharpen', which it must have"},
      {"'-DHAND_ID=\"by_hands/1\"'",
       "it has the facet 'by_hands/1', which this hooke does not know; did you mean 'by_hand/1'?"},
      {"'-DHAND_ID=\"by_hand/2\"'", "did you mean 'by_hand/1'?"},
      {"'-DHAND_ID=\"gravitation/1\"'", "which this hooke does not know: core/plugin/facets has them all"},
      {"'-DHAND_ID=(const char *)64'", "its list of facets has no end: row 1 is none; close it with {0}"},
      {"'-DFACET={\"x/1\",&hand}' -DFACETS=2", "the facet 'x/1'"},
      {"'-DFACET={HK_BY_HAND_ID,&hand}' -DFACETS=2", "it has the facet 'by_hand/1' twice"},
      {"'-DHAND=.moved=0'", "its hk_by_hand_facet has no 'moved', which it must have"},
      {"-DHAND_SIZE=8", "its table of functions gives its size as 8 bytes: write .size = sizeof(hk_by_hand_facet)"},
      {"'-DFACET={HK_BY_HAND_ID,0}' '-DHAND_ID=HK_BY_HAND_ID,&hand},{\"drop\"'", "the facet 'drop'"},
      {"-DSIZE=0", "its table of functions gives its size as 0 bytes: write .size = sizeof(hk_force)"},
      {"-DSIZE=8", "gives its size as 8 bytes"},
      {"-DMAIN=.topology=0", "it has no table of functions"},
      {"'-DMAIN=.force=(void*)64'", "its table of functions is not in its file"},
      {"-DNAME=NULL", "it has no name"},
      {"'-DNAME=\"w wrong\"'", "it has no name"},
      {"'-DNAME=\"wind\"'", "its name is 'wind' and its file is wrong.so: give both the same name"},
      {"'-DMAIN=.force=&force,.summary=0'", "it has no summary"},
      {"-DKIND=55", "its kind, 55, is unknown"},
  };
  for (size_t k = 0; k < sizeof faults / sizeof *faults; k++) {
    compile(faults[k][0], "wrong.so");
    expect(faults[k][0], 2, faults[k][1]);
  }
  compile("", "wrong.so");
  expect("the right one", 0, NULL);
}

/* Each kind's table, with one function too few. */
static void every_kind_has_its_functions(void **state) {
  (void)state;
  static const char *const kinds[][3] = {
      {"HK_CONSTRAINT", "constraint", "its hk_constraint has no 'count'"},
      {"HK_CORRECTOR", "corrector", "its hk_corrector has no 'correct'"},
      {"HK_SOURCE", "source", "its hk_source has no 'emit'"},
      {"HK_INTEGRATOR", "integrator", "its hk_integrator has no 'step'"},
      {"HK_SOLVER", "solver", "its hk_solver has no 'factorize'"},
      {"HK_OUTPUT", "output", "its hk_output has no 'frame'"},
      {"HK_SERVICE", "service", "its hk_service has no 'interface'"},
  };
  char macros[256];
  for (size_t k = 0; k < sizeof kinds / sizeof *kinds; k++) {
    const char *kind = kinds[k][1];
    snprintf(macros, sizeof macros, "-DKIND=%s '-DMAIN=.%s=&(const hk_%s){.size=sizeof(hk_%s)}'", kinds[k][0], kind,
             kind, kind);
    compile(macros, "wrong.so");
    expect(macros, 2, kinds[k][2]);
  }
}

/* Each facet of a method, with a member too few. */
static void facets_of_methods_are_checked(void **state) {
  (void)state;
  static const char *const faults[][3] = {
      {"tyle/1", "hk_tile_facet", "it has the facet 'tyle/1', which this hooke does not know; did you mean 'tile/1'?"},
      {"by_hand/1", "hk_by_hand_facet", "it has the facet 'by_hand/1', which this hooke does not know"},
      {"tile/1", "hk_tile_facet", "its hk_tile_facet has no 'steps', which it must have"},
      {"split/1", "hk_split_facet", "its hk_split_facet has no 'select_fast', which it must have"},
      {"split/1", "hk_split_facet,.select_fast=(void*)add", "its hk_split_facet has no 'coupled_growth'"},
      {"adaptive/1", "hk_adaptive_facet", "its hk_adaptive_facet has no 'tolerance', which it must have"},
      {"stages/1", "hk_stages_facet", "its facet 'stages/1' has 0 stages, and 1 to 4 are possible"},
      {"stages/1", "hk_stages_facet,.count=5", "its facet 'stages/1' has 5 stages, and 1 to 4 are possible"},
      {"stages/1", "hk_stages_facet,.count=1,.v={{1}}", "its facet 'stages/1' has 0 and 1 on the diagonals of x and v"},
      {"stages/1", "hk_stages_facet,.count=1,.back=0.5", "its facet 'stages/1' goes on from two states, and has no"},
  };
  char macros[512];
  for (size_t k = 0; k < sizeof faults / sizeof *faults; k++) {
    const char *type = faults[k][1], *more = strchr(type, ',');
    int length = more ? (int)(more - type) : (int)strlen(type);
    snprintf(macros, sizeof macros,
             "-DKIND=HK_INTEGRATOR '-DMAIN=.integrator=&(const hk_integrator){.size=sizeof(hk_integrator),.order=1,"
             ".step=(void*)add,.facets=(const hk_facet[]){{\"%s\",&(const %.*s){.size=sizeof(%.*s)%s}},{0}}}'",
             faults[k][0], length, type, length, type, more ? more : "");
    compile(macros, "wrong.so");
    expect(macros, 2, faults[k][2]);
  }
}

/* Cut at any place: dlopen maps what is there, and would crash at what is not. */
static void a_file_that_is_cut_off_is_said_to_be(void **state) {
  (void)state;
  char command[512];
  compile("", "wrong.so");
  snprintf(command, sizeof command, "cd '%s' && cp wrong.so whole.so", test_folder());
  assert_int_equal(system(command), 0);
  static const int percent[] = {0, 1, 10, 40, 70, 99};
  for (size_t k = 0; k < sizeof percent / sizeof *percent; k++) {
    snprintf(command, sizeof command, "cd '%s' && head -c $(($(wc -c <whole.so) * %d / 100)) whole.so >wrong.so",
             test_folder(), percent[k]);
    assert_int_equal(system(command), 0);
    expect("cut", 2, "the plugin ./wrong.so cannot be loaded: the file is cut off, with ");
  }
  test_write("wrong.so", "This is a text of more than the sixty-four bytes that the header of a library takes.\n");
  expect("text", 2, "the plugin ./wrong.so cannot be loaded: ");
}

static void two_plugins_of_one_name_are_said(void **state) {
  (void)state;
  char command[1024];
  compile("'-DNAME=\"gravity\"'", "gravity.so");
  snprintf(command, sizeof command, "cd '%s' && mkdir -p mine/forces && cp gravity.so mine/forces/", test_folder());
  assert_int_equal(system(command), 0);
  test_write("wrong.lua", "local scene = hooke.scene { duration = 0.1, fps = 10, integrator = 'leapfrog' }\n"
                          "scene:particle { mass = 1 }\nscene:force('gravity')\nreturn scene\n");
  expect("without a folder of mine", 0, NULL);
  test_hooke(&r, "HOOKE_PLUGIN_PATH=$PWD/mine", "run wrong.lua --quiet");
  assert_int_equal(r.code, 2);
  assert_non_null(strstr(r.err, "wrong.lua:3: there are two plugins of the name 'gravity', "));
  assert_non_null(strstr(r.err, "mine/forces/gravity.so: rename yours, or name it by its path"));
  test_hooke(&r, "HOOKE_PLUGIN_PATH=$PWD/mine", "plugins");
  assert_int_equal(r.code, 0);
  assert_non_null(strstr(r.out, "gravity: there are two plugins"));
  assert_non_null(strstr(r.out, "springs"));
  /* by its path it is used, and the folder of the installation named again is no second plugin */
  test_write("wrong.lua", "local scene = hooke.scene { duration = 0.1, fps = 10, integrator = 'leapfrog' }\n"
                          "scene:particle { mass = 1 }\nscene:force('./mine/forces/gravity.so')\nreturn scene\n");
  test_hooke(&r, "HOOKE_PLUGIN_PATH=$PWD/mine:" HK_BUILD "/plugins", "run wrong.lua --quiet");
  assert_int_equal(r.code, 0);
}

static void a_crash_while_it_is_loaded_names_the_file(void **state) {
  (void)state;
  char command[1024];
  test_write("wrong.c",
             "#include <signal.h>\n__attribute__((constructor)) static void begin(void) { raise(SIGABRT); }\n");
  snprintf(command, sizeof command, "cd '%s' && cc -shared -fPIC wrong.c -o wrong.so", test_folder());
  assert_int_equal(system(command), 0);
  test_write("wrong.lua", "local scene = hooke.scene { duration = 0.1 }\nscene:force('./wrong.so')\nreturn scene\n");
  expect("constructor", 2, "/wrong.so, while it was loaded, crashed (SIGABRT");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(every_fault_of_a_constant_is_one_sentence),
      cmocka_unit_test(every_kind_has_its_functions),
      cmocka_unit_test(facets_of_methods_are_checked),
      cmocka_unit_test(a_file_that_is_cut_off_is_said_to_be),
      cmocka_unit_test(two_plugins_of_one_name_are_said),
      cmocka_unit_test(a_crash_while_it_is_loaded_names_the_file),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
