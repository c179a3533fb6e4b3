/* Every scene of scripts/scenes as it is, to its end: what `make test` runs coarser and for a quarter of a second. One
 * line each: the verdict, the time reached, the frames' intersections of surfaces where there is contact, wall time.
 * Arguments: names of scenes, in place of all. Returns 1 when a run does not end ok. */
#include "tests/support/command.h"

#include <dirent.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bool run(const char *scene) {
  static test_result r;
  char arguments[1024], verdict[32] = "none";
  snprintf(arguments, sizeof arguments, "run '%s/scripts/scenes/%s.lua' --json --quiet --no-output", HK_ROOT, scene);
  test_hooke(&r, NULL, arguments);
  const char *said = strstr(r.out, "\"verdict\":\"");
  if (said) sscanf(said, "\"verdict\":\"%31[a-z]", verdict);
  printf("%-20s %-10s t = %-8g intersections %-4g %8.1f s%s%s\n", scene, verdict, test_json(r.out, "t"),
         test_json(r.out, "intersections"), test_json(r.out, "wall_s"), *r.err ? ": " : "", r.err);
  return r.code == 0 && !(test_json(r.out, "intersections") > 0);
}

static int by_name(const struct dirent **a, const struct dirent **b) { return strcmp((*a)->d_name, (*b)->d_name); }

static int is_scene(const struct dirent *entry) {
  size_t length = strlen(entry->d_name);
  return length > 4 && strcmp(entry->d_name + length - 4, ".lua") == 0;
}

static int run_all(void) {
  struct dirent **entry;
  int count = scandir(HK_ROOT "/scripts/scenes", &entry, is_scene, by_name), bad = 0;
  for (int k = 0; k < count; k++) {
    entry[k]->d_name[strlen(entry[k]->d_name) - 4] = 0;
    bad += !run(entry[k]->d_name);
    free(entry[k]);
  }
  if (count > 0) free(entry);
  return bad + (count <= 0);
}

int main(int argc, char **argv) {
  setvbuf(stdout, NULL, _IOLBF, 0);
  int bad = argc > 1 ? 0 : run_all();
  for (int k = 1; k < argc; k++) bad += !run(argv[k]);
  return bad > 0;
}
