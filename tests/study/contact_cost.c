/* Cost against error of all kinds of contact, one diagram a scene: impulses, Bridson's pipeline (zones) and a repulsive
 * force in steps of leapfrog, and the barrier in steps of bdf2, against a fine reference with impulses. Times end
 * before the motion is chaotic. The tables go to standard output, the diagrams to out/bench/SCENE/bench.svg, that of
 * six of the scenes (contact_cost.gp) to out/bench/contact-ways.png, which is the handbook's. Arguments: names of
 * scenes, in place of all. Returns 1 when a bench fails. */
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char surfaces[] = "--integrators leapfrog,bdf2 --vary contact=impulses,force,zones,barrier";

static const struct {
  const char *scene, *options;
} scenes[] = {
    {"slide", "--integrators leapfrog,bdf2 --vary contact=corrector,force,both,zones,penalty,barrier"},
    {"slope", "--integrators bdf2 --vary elastic_slip=1e-3,1e-4,5e-7 --metric way --until 0.1"},
    {"cloth_on_sphere", "N=9 --until 0.15"},
    {"stack", "N=4 sheets=2 --until 0.15"},
    {"folds", "N=4 --until 0.2"},
    {"funnel", "N=7 --until 0.3"},
    {"rollers", "N=5 --until 0.5"},
    {"twist", "N=5 turns=3 --until 0.5"},
    {"flag", "N=5 --until 0.3"},
    {"card_house", "N=3 --until 0.1"},
    {"net", "meshes=3 balls=1 --until 0.25"},
    {"knot", "n=41 --until 0.3"},
    {"hair_on_shoulder", "strands=8 n=8 --until 0.2"},
    {"rotating_sphere", "N=9 --until 0.15"},
    {"soft_cube", "n=2 --until 0.2"},
};

static bool is_asked(const char *scene, int argc, char **argv) {
  bool asked = argc == 1;
  for (int k = 1; k < argc; k++) asked |= strcmp(argv[k], scene) == 0;
  return asked;
}

int main(int argc, char **argv) {
  setvbuf(stdout, NULL, _IOLBF, 0);
  int bad = 0;
  for (size_t k = 0; k < sizeof scenes / sizeof *scenes; k++) {
    char command[1024];
    const char *vary = strstr(scenes[k].options, "--vary") ? "" : surfaces;
    if (!is_asked(scenes[k].scene, argc, argv)) continue;
    snprintf(command, sizeof command, "'%s/hooke' bench '%s/scripts/scenes/%s.lua' %s %s --quiet", HK_BUILD, HK_ROOT,
             scenes[k].scene, scenes[k].options, vary);
    printf("\n== %s %s %s\n", scenes[k].scene, scenes[k].options, vary);
    fflush(stdout);
    bad += system(command) != 0;
  }
  if (argc == 1)
    bad += system("gnuplot -e \"out = 'out/bench/contact-ways.png'\" '" HK_ROOT "/tests/study/contact_cost.gp'") != 0;
  return bad > 0;
}
