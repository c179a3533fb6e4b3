/* Random scenes against hooke's verdict: what is called ok and is wrong, and what is right and is not called ok.
 *
 *   adversary [--hooke PATH] [--seed S] [--cases N] [--runs R] [--family A,B] [--methods A,B] [--accuracies 1e-4,none]
 *             [--dt X] [--tol X] [--list] [--all] [--at-end] [-j N]
 *   adversary --one FAMILY --seed S [--methods A,B] [--accuracies A,B] [--dt X] [--tol X] [--print]
 *
 * A case is a scene, which R runs of random method and accuracy try (0: each with each); --dt and --tol replace those
 * of the scenes (0: hooke's choice). --at-end judges the last frame alone. --list names the false alarms, --all every
 * run, with hooke's reason; what is ok and wrong is always named, with the options that repeat it. Returns 1 when
 * something is ok and wrong, or more than 5 % of what is right is not called ok. */
#include "tests/adversary/adversary.h"

#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double most_alarms = 0.05;

static int usage(const char *what) {
  fprintf(stderr, "%s: see the head of tests/study/adversary.c\n", what);
  return 2;
}

/* How many arguments an option took; 0: it is unknown. */
static int option(adv_options *o, const char *name, const char *value) {
  if (strcmp(name, "--list") == 0) return o->alarms = true, 1;
  if (strcmp(name, "--print") == 0) return o->print = true, 1;
  if (strcmp(name, "--at-end") == 0) return o->at_end = true, 1;
  if (strcmp(name, "--all") == 0) return o->all = true, 1;
  if (!value) return 0;
  if (strcmp(name, "--one") == 0) return o->families = value, o->one = true, o->cases = 1, o->runs = 0, 2;
  if (strcmp(name, "--hooke") == 0) return o->hooke = value, 2;
  if (strcmp(name, "--family") == 0) return o->families = value, 2;
  if (strcmp(name, "--methods") == 0) return o->methods = value, 2;
  if (strcmp(name, "--accuracies") == 0) return o->accuracies = value, 2;
  if (strcmp(name, "--seed") == 0) return o->seed = strtoull(value, NULL, 0), 2;
  if (strcmp(name, "--cases") == 0) return o->cases = atoi(value), 2;
  if (strcmp(name, "--runs") == 0) return o->runs = atoi(value), 2;
  if (strcmp(name, "--dt") == 0) return o->dt = atof(value), 2;
  if (strcmp(name, "--tol") == 0) return o->tol = atof(value), 2;
  if (strcmp(name, "-j") == 0) return o->jobs = atoi(value), 2;
  return 0;
}

int main(int argc, char **argv) {
  adv_options o = {.hooke = HK_BUILD "/hooke", .seed = 1, .cases = 500, .runs = 8, .jobs = 2, .dt = NAN, .tol = NAN};
  adv_tally t;
  for (int k = 1, took; k < argc; k += took)
    if ((took = option(&o, argv[k], k + 1 < argc ? argv[k + 1] : NULL)) == 0) return usage(argv[k]);
  char path[PATH_MAX];
  if (!realpath(o.hooke, path)) return usage(o.hooke);
  o.hooke = path;
  if (o.cases < 1 || o.jobs < 1 || o.runs < 0) return usage("a number that cannot be");
  printf("seed %llu, %d cases\n", (unsigned long long)o.seed, o.cases);
  if (!adv_measure(&o, &t)) return 2;
  double share = t.right + t.alarms > 0 ? t.alarms / (double)(t.right + t.alarms) : 0;
  printf("\nok and wrong: %d; of what is right, %.1f %% is not called ok\n", t.wrong, 100 * share);
  return t.wrong > 0 || t.broken > 0 || share > most_alarms;
}
