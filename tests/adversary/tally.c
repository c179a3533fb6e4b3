/* Runs cases in one or more processes, counts what verdicts are worth, and prints it. */
#define _GNU_SOURCE /* MAP_ANONYMOUS */
#include "tests/adversary/adversary.h"

#include <dirent.h>
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

enum { NAMES = 64, LENGTH = 64 };

typedef struct names {
  char name[NAMES][LENGTH];
  int count;
} names;

typedef struct plan {
  const adv_options *o;
  names methods, accuracies;
  int family[NAMES], families;
  int runs; /* of a scene */
  adv_run *run;
} plan;

static void split(const char *list, names *into) {
  while (list && *list && into->count < NAMES) {
    size_t length = strcspn(list, ",");
    snprintf(into->name[into->count++], LENGTH, "%.*s", (int)length, list);
    list += length + (list[length] == ',');
  }
}

static int by_name(const void *a, const void *b) { return strcmp(a, b); }

/* The integrators that are built, in the order of the alphabet: plugins/integrators beside the program. */
static void find_methods(const char *hooke, names *into) {
  char path[PATH_MAX];
  const char *slash = strrchr(hooke, '/');
  snprintf(path, sizeof path, "%.*splugins/integrators", slash ? (int)(slash + 1 - hooke) : 0, hooke);
  DIR *folder = opendir(path);
  for (struct dirent *e; folder && (e = readdir(folder)) && into->count < NAMES;) {
    size_t length = strlen(e->d_name);
    if (length < 4 || length >= LENGTH || strcmp(e->d_name + length - 3, ".so") != 0) continue;
    snprintf(into->name[into->count++], LENGTH, "%.*s", (int)(length - 3), e->d_name);
  }
  if (folder) closedir(folder);
  qsort(into->name, (size_t)into->count, LENGTH, by_name);
}

static bool find_families(plan *p, const char *list) {
  names wanted = {.count = 0};
  split(list, &wanted);
  for (int f = 0; f < adv_families_count && !list; f++) p->family[p->families++] = f;
  for (int k = 0; k < wanted.count; k++) {
    int f = 0;
    while (f < adv_families_count && strcmp(adv_families[f].name, wanted.name[k]) != 0) f++;
    if (f == adv_families_count) return fprintf(stderr, "no family is called %s\n", wanted.name[k]), false;
    p->family[p->families++] = f;
  }
  return true;
}

/* ---- Running ---- */

/* One of the methods by lot: the one whose name and the number drawn give the largest hash. A method that is not built
 * on some machine, or that is new, changes the lots that it would win and no others. */
static const char *draw_method(const names *methods, uint64_t number) {
  const char *best = methods->name[0];
  uint64_t most = 0;
  for (int k = 0; k < methods->count; k++) {
    uint64_t hash = number;
    for (const char *c = methods->name[k]; *c; c++) hash ^= (unsigned char)*c, hash = adv_next(&hash);
    if (hash > most) most = hash, best = methods->name[k];
  }
  return best;
}

static void set_run(const plan *p, adv_run *r, int k, uint64_t *seed) {
  int every = p->o->runs == 0, methods = p->methods.count, accuracies = p->accuracies.count;
  const char *accuracy = p->accuracies.name[every ? k / methods : adv_below(seed, accuracies)];
  const char *method = every ? p->methods.name[k % methods] : draw_method(&p->methods, adv_next(seed));
  snprintf(r->method, sizeof r->method, "%s", method);
  r->accuracy = strcmp(accuracy, "none") == 0 ? NAN : atof(accuracy);
}

static void run_case(const plan *p, int index, const char *folder) {
  uint64_t seed = p->o->seed + (uint64_t)index * 0xd1342543de82ef95u, draw = p->o->one ? p->o->seed : adv_next(&seed);
  adv_scene s;
  adv_answer a;
  adv_scene_make(&s, p->family[index % p->families], draw);
  if (!isnan(p->o->dt)) s.dt = p->o->dt > 0 ? p->o->dt : NAN;
  if (!isnan(p->o->tol)) s.tol = p->o->tol > 0 ? p->o->tol : NAN;
  if (p->o->print) adv_scene_write(&s, NAN, stdout);
  bool memory = adv_answer_make(&a, &s);
  if (p->o->print)
    printf("-- the reference is known to %.2g m; a disturbance grows by %.2g\n", a.uncertainty, a.growth);
  for (int k = 0; k < p->runs; k++) {
    adv_run *r = &p->run[index * p->runs + k];
    set_run(p, r, k, &draw);
    r->end = ADV_BROKEN;
    if (memory && a.uncertainty < INFINITY)
      adv_run_make(r, p->o->hooke, folder, &s, &a), r->error = p->o->at_end ? r->last : r->error;
    else
      r->family = s.family, r->seed = s.seed, r->uncertainty = INFINITY, r->bound = 1;
  }
  adv_answer_free(&a);
}

static void work(const plan *p, int job) {
  char folder[] = "/tmp/hooke-adversary-XXXXXX", command[PATH_MAX];
  if (!mkdtemp(folder)) return;
  for (int k = job; k < p->o->cases; k += p->o->jobs) run_case(p, k, folder);
  snprintf(command, sizeof command, "rm -rf '%s'", folder);
  if (system(command) != 0) fprintf(stderr, "cannot remove %s\n", folder);
}

static void work_all(const plan *p) {
  fflush(NULL);
  for (int job = 1; job < p->o->jobs; job++)
    if (fork() == 0) work(p, job), fflush(NULL), _exit(0);
  work(p, 0);
  for (int job = 1; job < p->o->jobs; job++) wait(NULL);
}

/* ---- Counting ---- */

static void count(adv_tally *t, const adv_run *r) {
  if (!adv_run_certain(r)) {
    t->uncertain++;
    return;
  }
  bool wrong = adv_run_wrong(r), right = adv_run_right(r);
  if (r->end == ADV_NOT_OK && adv_run_lucky(r)) {
    t->uncertain++;
    return;
  }
  t->right += r->end == ADV_OK && !wrong;
  t->wrong += r->end == ADV_OK && wrong;
  t->rightly += r->end == ADV_NOT_OK && !right;
  t->alarms += r->end == ADV_NOT_OK && right;
  t->near += r->end == ADV_NOT_OK && right && r->error <= r->bound / 10;
  t->refused += r->end == ADV_REFUSED;
  t->too_long += r->end == ADV_TOO_LONG;
  t->broken += r->end == ADV_BROKEN;
}

static void print_head(const char *of) {
  printf("\n%-18s %9s %9s %9s %12s %9s %9s %9s %8s\n", of, "ok+right", "OK+WRONG", "rightly", "false alarm", "(<1/10)",
         "no answer", "refused", "too long");
}

static void print_row(const char *name, const adv_tally *t) {
  if (t->right + t->wrong + t->rightly + t->alarms + t->uncertain + t->refused + t->too_long + t->broken == 0) return;
  printf("%-18s %9d %9d %9d %12d %9d %9d %9d %8d", name, t->right, t->wrong, t->rightly, t->alarms, t->near,
         t->uncertain, t->refused, t->too_long);
  printf(t->broken ? "  %d broken\n" : "\n", t->broken);
}

static bool same_accuracy(const adv_run *r, const char *name) {
  return strcmp(name, "none") == 0 ? isnan(r->accuracy) : atof(name) == r->accuracy;
}

/* The runs of one family, method, accuracy; -1, NULL: of all. `asked`: with an accuracy. */
static adv_tally count_of(const plan *p, int family, const char *method, const char *accuracy, bool asked) {
  adv_tally t = {0};
  for (int k = 0; k < p->o->cases * p->runs; k++) {
    const adv_run *r = &p->run[k];
    if ((family < 0 || r->family == family) && (!method || strcmp(r->method, method) == 0) &&
        (!accuracy || same_accuracy(r, accuracy)) && asked == isfinite(r->accuracy))
      count(&t, r);
  }
  return t;
}

static void print_tables(const plan *p) {
  adv_tally t;
  print_head("family");
  for (int k = 0; k < p->families; k++)
    t = count_of(p, p->family[k], NULL, NULL, true), print_row(adv_families[p->family[k]].name, &t);
  print_head("method");
  for (int k = 0; k < p->methods.count; k++)
    t = count_of(p, -1, p->methods.name[k], NULL, true), print_row(p->methods.name[k], &t);
  print_head("accuracy");
  for (int k = 0; k < p->accuracies.count; k++)
    if (strcmp(p->accuracies.name[k], "none") != 0)
      t = count_of(p, -1, NULL, p->accuracies.name[k], true), print_row(p->accuracies.name[k], &t);
  t = count_of(p, -1, NULL, NULL, true), print_row("together", &t);
  t = count_of(p, -1, NULL, NULL, false), print_row("none asked for", &t);
}

static void print_run(const char *what, const adv_run *r) {
  printf("%s: --one %s --seed %llu --methods %s --accuracies %g: ", what, adv_families[r->family].name,
         (unsigned long long)r->seed, r->method, r->accuracy);
  printf("error %.3g m, at the end %.3g m, bound %.3g m", r->error, r->last, r->bound);
  if (r->channel > 0) printf(", channel %.2g", r->channel);
  printf(", dt %g, %s %s\n", r->dt, r->verdict, r->reason);
}

static void print_lists(const plan *p) {
  for (int k = 0; k < p->o->cases * p->runs; k++) {
    const adv_run *r = &p->run[k];
    bool certain = adv_run_certain(r), wrong = adv_run_wrong(r), right = adv_run_right(r),
         asked = isfinite(r->accuracy);
    if (r->end == ADV_BROKEN && r->uncertainty < INFINITY) print_run("BROKEN", r);
    if (certain && r->end == ADV_OK && wrong) print_run(asked ? "OK AND WRONG" : "ok and wrong, no accuracy", r);
    if (certain && r->end == ADV_NOT_OK && right && !adv_run_lucky(r) && p->o->alarms) print_run("false alarm", r);
    if (p->o->one || p->o->all) print_run("run", r);
  }
}

bool adv_measure(const adv_options *o, adv_tally *t) {
  plan p = {.o = o};
  if (!find_families(&p, o->families)) return false;
  split(o->methods, &p.methods);
  split(o->accuracies ? o->accuracies : "1e-2,1e-4,1e-6,none", &p.accuracies);
  if (!o->methods) find_methods(o->hooke, &p.methods);
  if (p.methods.count == 0) return fprintf(stderr, "no integrators beside %s\n", o->hooke), false;
  p.runs = o->runs > 0 ? o->runs : p.methods.count * p.accuracies.count;
  size_t size = (size_t)(o->cases * p.runs) * sizeof *p.run;
  p.run = mmap(NULL, size, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (p.run == MAP_FAILED) return fprintf(stderr, "no memory for %d cases\n", o->cases), false;
  work_all(&p);
  print_lists(&p);
  print_tables(&p);
  *t = count_of(&p, -1, NULL, NULL, true);
  munmap(p.run, size);
  return true;
}
