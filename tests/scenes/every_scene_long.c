/* Every scene of scripts/scenes runs. */
#include "tests/support/command.h"

#include <dirent.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

static test_result r;

static double value(const char *key) { return test_json(r.out, key); }

static void near(double got, double wanted, double tolerance) {
  if (!(fabs(got - wanted) <= tolerance)) fail_msg("%.17g is not within %g of %.17g", got, tolerance, wanted);
}

/* Scenes that are large, or whose comparison with another method takes long, are coarser and shorter here;
 * tests/study/scenes.c runs all of them as they are. With --trust nothing is compared where no accuracy is asked for:
 * where discs of a gas are, no method foretells for 0.25 s.
 */
static const char *options_of(const char *scene) {
  static const struct {
    const char *scene, *options;
  } coarse[] = {
      {"bowling", "rows=1 duration=1"},
      {"bricks", "rows=2 columns=2"},
      {"candle", "cell=0.008"},
      {"cantilever", "n=10"},
      {"card_house", "N=3 --dt 8e-5"},
      {"chocolate", "cell=0.008 duration=0.3"},
      {"cloth", "N=12"},
      {"cloth_on_heart", "N=9 size=0.08"},
      {"cloth_on_sphere", "N=21"},
      {"curtain", "N=12"},
      {"dam_break", "cell=0.0625"},
      {"dam_break_sph", "n=4"},
      {"discretization", "N=8"},
      {"dust", "N=20"},
      {"embroidery", "N=32"},
      {"euler_disc", "n=40"},
      {"folds", "N=5"},
      {"galaxy", "N=2000"},
      {"granular_gas", "n=100 --trust"},
      {"gyroid", "size=0.1"},
      {"hair_methods", "strands=4"},
      {"boat", "cell=0.1"},
      {"drop", "cell=0.002"},
      {"glass", "fill=0.1"},
      {"skipping_stone", "cell=0.04"},
      {"tumbler", "cell=0.006 off=0.1"},
      {"harbour", "cell=0.1"},
      {"honey", "cell=0.008"},
      {"hourglass", "n=60"},
      {"ice_cube", "cell=0.02 duration=0.3"},
      {"ice_sheet", "n=9 duration=0.5"},
      {"knot_in_net", "n=60 around=8 meshes=4"},
      {"lava", "cell=0.05 duration=0.3"},
      {"liquid_methods", "n=8"},
      {"materials", "N=7 --trust"},
      {"metaballs", "pairs=1 size=0.1"},
      {"peirce", "N=10"},
      {"plume", "cell=0.05"},
      {"pour", "size=0.03"},
      {"rotating_sphere", "N=21"},
      {"sand", "n=50"},
      {"sand_castle", "cell=0.04 duration=0.3"},
      {"stack", "N=6 sheets=3"},
      {"stiff_cloth", "N=12"},
      {"tangled", "N=7"},
      {"wetting", "n=4"},
      {"wax_figure", "cell=0.014"},
      {"washing_line", "sheets=1 N=5"},
      {"wind_cloth", "N=8"},
      {"wrecking_ball", "rows=2 columns=1 links=2"},
      {"hair", "strands=6 segments=16"},
  };
  for (size_t k = 0; k < sizeof coarse / sizeof *coarse; k++)
    if (strcmp(coarse[k].scene, scene) == 0) return coarse[k].options;
  return "";
}

static void every_scene_runs_and_opens_with_a_comment(void **state) {
  (void)state;
  DIR *folder = opendir(HK_ROOT "/scripts/scenes");
  assert_non_null(folder);
  int count = 0;
  for (struct dirent *entry; (entry = readdir(folder));) {
    char name[256], path[1024], line[256] = "", wanted[300], words[128];
    size_t length = strlen(entry->d_name);
    if (length < 5 || length > 200 || strcmp(entry->d_name + length - 4, ".lua") != 0) continue;
    snprintf(name, sizeof name, "%.*s", (int)length - 4, entry->d_name);
    snprintf(path, sizeof path, HK_ROOT "/scripts/scenes/%s", entry->d_name);
    FILE *file = fopen(path, "r");
    assert_non_null(file);
    assert_non_null(fgets(line, sizeof line, file));
    fclose(file);
    snprintf(wanted, sizeof wanted, "-- %s: ", entry->d_name);
    assert_memory_equal(line, wanted, strlen(wanted));
    snprintf(words, sizeof words, "--until 0.25 %s", options_of(name));
    test_scene(&r, name, words);
    near(value("t"), 0.25, 0);
    assert_false(value("intersections") > 0); /* NAN where there is no contact */
    count++;
  }
  closedir(folder);
  assert_true(count >= 8);
}

/* ---- scenes with bars ---- */

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(every_scene_runs_and_opens_with_a_comment),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
