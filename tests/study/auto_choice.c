/* What `--integrator auto` takes beside the best of `hooke bench`, on fifteen scenes of all kinds, each at an accuracy
 * of its own: the cost, by the bench's own table, of the cheapest run with the chosen method that keeps the accuracy,
 * over that of the cheapest run of all. Wanted are 1.3 times or less in twelve of them. Times are of the processor, so
 * other programs on the machine do little harm; where they fight for caches, costs differ by a fifth from run to run.
 * Arguments: names of scenes, in place of all. Returns 1 when fewer are within 1.3.
 *
 * Measured (two busy cores, EPYC), with the processor time that choosing took:
 *     scene            best               s         chosen             times   choosing, s
 *     curtain          leapfrog           3.1e-2    local_leapfrog     1.02    4.9
 *     cloth            symplectic_euler   4.1e-3    leapfrog           1.11    2.0
 *     stiff_cloth      symplectic_euler   2.1e-2    symplectic_euler   1.00    3.5
 *     wind_cloth       symplectic_euler   3.8e-2    stoermer_wide2     1.12    6.0
 *     string           leapfrog           2.3e-4    stoermer_wide4     1.17    1.0
 *     stiff_string     symplectic_euler   4.8e-3    symplectic_euler   1.00    1.9
 *     catenary         leapfrog           1.1e-3    leapfrog           1.00    1.4
 *     pendulum_chain   dopri5             1.3e-3    dopri5             1.00    2.4
 *     fpu              blanes_moan        1.6e-3    blanes_moan        1.00    2.4
 *     circle           stoermer5          1.2e-4    stoermer5          1.00    1.0
 *     orbit            blanes_moan        9.9e-5    blanes_moan        1.00    0.9
 *     pleiades         cvode adams        8.9e-5    cvode adams        1.00    0.7
 *     cantilever       esdirk4            1.2e-2    esdirk4            1.00    7.7
 *     truss            leapfrog           4.5e-4    leapfrog           1.00    1.1
 *     discretization   leapfrog           3.4e-2    leapfrog           1.00    7.8
 * Choosing costs more than these short runs: it takes what its budget allows (`hooke auto --budget`, 6 s), however long
 * the run is, and is kept on file. */
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>

static const double allowed = 1.3;
static const int wanted = 12;

static const struct {
  const char *scene, *parameters, *end;
  double accuracy; /* m, RMS */
} scenes[] = {
    {"curtain", "N=32", "0.5", 1e-5}, {"cloth", "N=16", "0.5", 1e-3},    {"stiff_cloth", "N=12 k=1e6", "0.2", 1e-3},
    {"wind_cloth", "", "0.5", 1e-3},  {"string", "", "0.5", 1e-5},       {"stiff_string", "", "0.5", 1e-4},
    {"catenary", "", "0.5", 1e-4},    {"pendulum_chain", "", "1", 1e-4}, {"fpu", "", "20", 1e-4},
    {"circle", "", "4", 1e-6},        {"orbit", "", "4", 1e-6},          {"pleiades", "", "1", 1e-4},
    {"cantilever", "", "0.2", 1e-5},  {"truss", "", "0.5", 1e-5},        {"discretization", "", "0.2", 1e-3},
};
enum { SCENES = sizeof scenes / sizeof *scenes };

static bool is_asked(const char *scene, int argc, char **argv) {
  bool asked = argc == 1;
  for (int k = 1; k < argc; k++) asked |= strcmp(argv[k], scene) == 0;
  return asked;
}

/* Up to `end` and without settings of substeps: "xpbd:substeps=20" and "xpbd" are the same method. */
static void name_of(const char *text, const char *end, char name[128]) {
  const char *substeps = strstr(text, ":substeps");
  size_t length = strcspn(text, end);
  if (substeps && substeps < text + length) length = (size_t)(substeps - text);
  snprintf(name, 128, "%.*s", (int)length, text);
}

/* Processor time of all processes that have been started and have ended, s. */
static double processor_time(void) {
  struct rusage used;
  getrusage(RUSAGE_CHILDREN, &used);
  return (double)(used.ru_utime.tv_sec + used.ru_stime.tv_sec) +
         1e-6 * (double)(used.ru_utime.tv_usec + used.ru_stime.tv_usec);
}

/* The method that auto takes; false: none. */
static bool choose(size_t k, const char *folder, char name[128]) {
  char command[1200], line[4096];
  snprintf(command, sizeof command,
           "XDG_CACHE_HOME='%s' '%s/hooke' auto '%s/scripts/scenes/%s.lua' %s --until %s --accuracy %g --again 2>&1",
           folder, HK_BUILD, HK_ROOT, scenes[k].scene, scenes[k].parameters, scenes[k].end, scenes[k].accuracy);
  FILE *pipe = popen(command, "r");
  bool found = false;
  while (pipe && fgets(line, sizeof line, pipe)) {
    static const char start[] = "hooke: auto: ";
    if (found || strncmp(line, start, sizeof start - 1) != 0) continue;
    name_of(line + sizeof start - 1, ",\n", name);
    found = true;
  }
  return pipe && pclose(pipe) == 0 && found;
}

static const char *field(const char *row, int index) {
  while (index-- > 0 && row) row = strchr(row, ',') ? strchr(row, ',') + 1 : NULL;
  return row ? row : "";
}

typedef struct costs {
  double best, chosen; /* s; INFINITY: not reached */
  char best_name[128];
} costs;

/* From the table that the bench wrote. An error below what the reference supports begins with "<". */
static void read_costs(const char *path, double accuracy, const char *chosen, costs *c) {
  char line[4096], name[128];
  FILE *file = fopen(path, "r");
  *c = (costs){INFINITY, INFINITY, ""};
  while (file && fgets(line, sizeof line, file)) {
    const char *error = field(line, 7), *verdict = field(line, 11);
    double wall = atof(field(line, 6)), size = atof(error + (*error == '<'));
    if (strncmp(verdict, "ok", 2) != 0 || !(wall > 0) || size > accuracy) continue;
    name_of(line, ",", name);
    if (wall < c->best) {
      c->best = wall;
      snprintf(c->best_name, sizeof c->best_name, "%s", name);
    }
    if (strcmp(name, chosen) == 0) c->chosen = fmin(c->chosen, wall);
  }
  if (file) fclose(file);
}

static bool compare(size_t k, const char *folder) {
  char command[1024], path[600], chosen[128] = "none";
  costs c;
  snprintf(path, sizeof path, "%s/bench.csv", folder);
  remove(path); /* of the scene before: a bench that fails must not leave it to be read */
  snprintf(
      command, sizeof command,
      "'%s/hooke' bench '%s/scripts/scenes/%s.lua' %s --until %s --target %g --finest %g --budget 40 --quiet --out "
      "'%s' >/dev/null",
      HK_BUILD, HK_ROOT, scenes[k].scene, scenes[k].parameters, scenes[k].end, scenes[k].accuracy, scenes[k].accuracy,
      folder);
  if (system(command) != 0) printf("%-16s the bench failed\n", scenes[k].scene);
  double begin = processor_time();
  choose(k, folder, chosen);
  double trial = processor_time() - begin;
  read_costs(path, scenes[k].accuracy, chosen, &c);
  bool fine = c.chosen <= allowed * c.best;
  printf("%-16s %8.0e m  best %-22s %9.4f s   auto %-22s %9.4f s  %5.2f times, chosen in %4.1f s %s\n", scenes[k].scene,
         scenes[k].accuracy, c.best_name, c.best, chosen, c.chosen, c.chosen / c.best, trial,
         fine ? "" : "(more than wanted)");
  return fine;
}

int main(int argc, char **argv) {
  char folder[] = "/tmp/hooke-auto-XXXXXX", command[64];
  int fine = 0, asked = 0;
  setvbuf(stdout, NULL, _IOLBF, 0);
  if (!mkdtemp(folder)) return 1;
  for (size_t k = 0; k < SCENES; k++) {
    if (!is_asked(scenes[k].scene, argc, argv)) continue;
    asked++;
    fine += compare(k, folder);
  }
  snprintf(command, sizeof command, "rm -rf '%s'", folder);
  int removed = system(command);
  printf("%d of %d within %.1f times\n", fine, asked, allowed);
  return fine < asked * wanted / SCENES || removed != 0;
}
