/* The scenes of contact with `contact=barrier`, coarse, to their end: no surfaces may intersect at any frame. One line
 * each: particles, the time reached, intersections, the least gap, the verdict and its reason, wall time. Energy that
 * the steps of bdf2 do not resolve is lost, so that a verdict `inaccurate` is no failure here. Arguments: names of
 * scenes, in place of all. */
#include "tests/support/command.h"

#include <stdio.h>
#include <string.h>

static const struct {
  const char *scene, *options;
} scenes[] = {
    {"cloth_on_sphere", "N=15"},
    {"flag", "N=7"},
    {"folds", "N=4"},
    {"stack", "N=5 sheets=4"},
    {"twist", "N=5"},
    {"funnel", "N=7"},
    {"rollers", "N=7"},
    {"card_house", "N=3"},
    {"net", "meshes=4 balls=2"},
    {"knot", "n=41"},
    {"hair_on_shoulder", "strands=15 n=10"},
    {"rotating_sphere", "N=13"},
    {"soft_cube", "n=3"},
};

/* The text behind "key": in JSON, cut at the size; "" where there is none. */
static void text_of(const char *json, const char *key, char *into, size_t size) {
  char wanted[64];
  snprintf(wanted, sizeof wanted, "\"%s\":\"", key);
  const char *begin = strstr(json, wanted);
  begin = begin ? begin + strlen(wanted) : "";
  snprintf(into, size, "%.*s", (int)strcspn(begin, "\""), begin);
}

static bool run(size_t k) {
  static test_result r;
  char arguments[1024], verdict[32], reason[256];
  snprintf(arguments, sizeof arguments, "run '%s/scripts/scenes/%s.lua' contact=barrier %s --json --quiet --no-output",
           HK_ROOT, scenes[k].scene, scenes[k].options);
  test_hooke(&r, NULL, arguments);
  text_of(r.out, "verdict", verdict, sizeof verdict);
  text_of(r.out, "reason", reason, sizeof reason);
  bool fine = (r.code == 0 || r.code == 5) && test_json(r.out, "intersections") == 0;
  printf("%-17s %-16s n = %-5g t = %-5g intersections %g, gap %.1e m, %.0f s: %s %s%s\n", scenes[k].scene,
         scenes[k].options, test_json(r.out, "particles"), test_json(r.out, "t"), test_json(r.out, "intersections"),
         test_json(r.out, "closest"), test_json(r.out, "wall_s"), verdict, reason, fine ? "" : r.err);
  return fine;
}

static bool is_asked(const char *scene, int argc, char **argv) {
  bool asked = argc == 1;
  for (int k = 1; k < argc; k++) asked |= strcmp(argv[k], scene) == 0;
  return asked;
}

int main(int argc, char **argv) {
  setvbuf(stdout, NULL, _IOLBF, 0);
  int bad = 0;
  for (size_t k = 0; k < sizeof scenes / sizeof *scenes; k++)
    if (is_asked(scenes[k].scene, argc, argv)) bad += !run(k);
  return bad > 0;
}
