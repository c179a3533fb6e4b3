/* Speed against error beside the programs that one would take or write instead: the curtains of 32 x 32 and 64 x 64
 * particles, 0.5 s, and of 256 x 256, 0.1 s, one thread. hooke's explicit integrators; plain C with leapfrog and
 * Runge-Kutta 4; SUNDIALS' ERKStep and CVODE on a plain C right-hand side, and on hooke's forces.
 *
 *     rivals [LARGEST [SMALLEST]]: the curtains up to LARGEST, 64 by default; of those below SMALLEST, 32 by default,
 *     the ladders alone, which the next curtain needs. With 256 it takes six minutes.
 *
 * Every method runs over a ladder of steps (from beyond its stability limit down) or tolerances. Runs that cannot win
 * any more are not taken, or given up: those that take longer than their side's best, or ten times as long as hooke's.
 * SUNDIALS takes the same steps on either forces, so its ladders are climbed on hooke's alone, and its errors are
 * those. Between the two rungs around a target the setting that just reaches it is interpolated (log-log). For each
 * target the methods of every side that promise most run again at that setting, in turn, and the median counts: the
 * time loop alone, in the thread's own time. Of long runs by fixed steps the first part is timed, and stands for all
 * steps; the start, which counts in full, is to hooke's disadvantage. A run counts when its error is at most the
 * target, so where the stability limit gives less already, it is the cheapest stable run.
 *
 * The reference is one of Stoermer's methods on hooke's forces; Runge-Kutta 4 on the plain ones must agree with it to a
 * hundredth of the smallest target. */
#include "tests/bench/rival_ladders.h"

enum { SIZES = 3, REPEATS = 3, SHORT_REPEATS = 4, CANDIDATES = 3 };
static const double PART = 0.5; /* s */
static const struct {
  uint32_t N;
  double end; /* s; the motion of the largest is determined to the smallest target for this time only */
  const char *reference;
  double fine, other; /* steps of the reference, and of the other method, by those of leapfrog at its limit */
} sizes[SIZES] = {{32, 0.5, "stoermer5", 4, 3.5},
                  {64, 0.5, "stoermer5", 4, 3.5},
                  {256, 0.1, "stoermer_wide4", 2, 0.6}}; /* damped too much for order 5 */

static const char *const side_name[SIDES] = {"hooke", "plain C, leapfrog", "plain C, RK4", "SUNDIALS, plain C forces",
                                             "SUNDIALS, hooke's forces"};
/* How many times faster hooke is to be; 0: nothing was set. */
static const double goal[SIDES][TARGETS] = {[SUNDIALS_PLAIN] = {20, 20, 20}, [SUNDIALS_HOOKE] = {6, 6, 6}};

/* ---- the table ---- */

typedef struct entry {
  const method *m;
  aim aim;
  double seconds[REPEATS * SHORT_REPEATS], median;
  size_t runs;
} entry;

typedef entry row[SIDES][CANDIDATES];

/* The most promising methods of a side at a target, within 15 % of the best; settled. */
static void choose(ladder *all, side s, int k, const problem *q, entry chosen[CANDIDATES]) {
  side climbed = s == SUNDIALS_PLAIN ? SUNDIALS_HOOKE : s;
  ladder *of[CANDIDATES] = {NULL};
  for (int c = 0; c < CANDIDATES; c++)
    for (ladder *l = all; l < all + METHODS; l++) {
      double seconds = l->aim[k].out.seconds;
      bool fits = l->m && l->m->side == climbed && isfinite(seconds);
      for (int other = 0; other < c; other++) fits &= of[other] != l;
      if (c > 0) fits &= of[0] && seconds <= 1.15 * of[0]->aim[k].out.seconds;
      if (fits && (!of[c] || seconds < of[c]->aim[k].out.seconds)) of[c] = l;
    }
  for (int c = 0; c < CANDIDATES && of[c]; c++) {
    settle(q, of[c], k);
    chosen[c] = (entry){.m = on_side(of[c]->m, s), .aim = of[c]->aim[k]};
  }
}

/* s. Fixed steps cost the same all along, so that of a run that takes `about` many seconds PART s may stand for all. */
static double timed(const method *m, const problem *q, double setting, double about) {
  double steps = ceil(setting), some = about > 2 * PART && m->atol == 0 ? ceil(steps * PART / about) : steps;
  problem part = *q;
  outcome out;
  double *x = memory(3 * q->p.n, sizeof *x);
  if (some < steps) part.end *= some / steps;
  m->run(m, &part, some < steps ? some : setting, &out, x);
  free(x);
  return out.seconds * steps / some;
}

/* Runs of less than a tenth of a second, which others on the machine disturb most, count several times a turn. */
static void repeat(const problem *q, entry *e) {
  int times = e->runs == 0 || e->seconds[0] > 0.1 ? 1 : SHORT_REPEATS;
  for (int i = 0; i < times; i++) e->seconds[e->runs++] = timed(e->m, q, e->aim.setting, e->aim.out.seconds);
}

/* The same run for an easier target, which the stability limit may set for several. */
static const entry *twin(row *rows, int k, side s, const entry *e) {
  for (int easier = 0; easier < k; easier++)
    for (int c = 0; c < CANDIDATES; c++) {
      const entry *o = &rows[easier][s][c];
      if (o->m == e->m && o->aim.setting == e->aim.setting) return o;
    }
  return NULL;
}

static void print_entry(const entry *e, const problem *q, int k, const entry *hooke) {
  const method *m = e->m;
  char setting[64], error[32];
  if (m->atol > 0)
    snprintf(setting, sizeof setting, "rtol %.1e", 1 / e->aim.setting);
  else
    snprintf(setting, sizeof setting, "%.0f steps", ceil(e->aim.setting));
  snprintf(error, sizeof error, e->aim.out.error < 100 * q->uncertain ? "under %.0e" : "%.1e",
           fmax(e->aim.out.error, 100 * q->uncertain));
  printf("    %.0e m  %-25s %-34s %-14s %6zu evaluations  %8.1f ms  %-12s", target[k], side_name[m->side], m->name,
         setting, e->aim.out.evaluations, 1e3 * e->median, error);
  double ratio = e->median / hooke->median, asked = goal[m->side][k];
  if (e != hooke) printf("  %5.2f times hooke's", ratio);
  if (asked > 0) printf(", %s %g", ratio >= asked ? "reaches" : "MISSES", asked);
  printf("\n");
}

static void run_in_turn(const problem *q, row *rows) {
  for (int r = 0; r < REPEATS; r++)
    for (int k = 0; k < TARGETS; k++)
      for (side s = 0; s < SIDES; s++)
        for (int c = 0; c < CANDIDATES; c++) {
          entry *e = &rows[k][s][c];
          const entry *same = e->m ? twin(rows, k, s, e) : NULL;
          if (same)
            *e = *same;
          else if (e->m)
            repeat(q, e);
        }
}

static const entry *best_of(entry e[CANDIDATES]) {
  const entry *best = NULL;
  for (int c = 0; c < CANDIDATES; c++) {
    if (!e[c].m) continue;
    e[c].median = median(e[c].seconds, e[c].runs);
    if (!best || e[c].median < best->median) best = &e[c];
  }
  return best;
}

static void compare(const problem *q, ladder *all) {
  static row rows[TARGETS];
  memset(rows, 0, sizeof rows);
  for (int k = 0; k < TARGETS; k++)
    for (side s = 0; s < SIDES; s++) choose(all, s, k, q, rows[k][s]);
  run_in_turn(q, rows);
  for (int k = 0; k < TARGETS; k++) {
    const entry *hooke = best_of(rows[k][HOOKE]);
    for (side s = 0; hooke && s < SIDES; s++) {
      const entry *e = best_of(rows[k][s]);
      if (e)
        print_entry(e, q, k, hooke);
      else
        printf("    %.0e m  %-25s not in %d times hooke's time\n", target[k], side_name[s], PATIENCE);
    }
  }
}

/* The reference, and how far another method on other forces is from it. */
static void converge(problem *q, size_t size) {
  const char *name = sizes[size].reference;
  const method fine = HOOKE_STEPS(name, 0), other = PLAIN_STEPS(PLAIN_RK4);
  double least = ceil(q->end / q->p.limit), steps = ceil(sizes[size].fine * least),
         others = ceil(sizes[size].other * least);
  outcome out;
  q->reference = memory(3 * q->p.n, sizeof *q->reference);
  fine.run(&fine, q, steps, &out, q->reference);
  measure(&other, q, others, &out);
  q->uncertain = out.error;
  printf("curtain(%u), %.1f s: %s of %.0f steps and RK4 of %.0f on plain forces end %.1e m apart\n", q->N, q->end, name,
         steps, others, out.error);
  if (out.error <= target[TARGETS - 1] / 100) return;
  fprintf(stderr, "the reference does not support errors of %g m: shorten its steps\n", target[TARGETS - 1]);
  exit(1);
}

/* us of one evaluation by hooke and by the plain loop, the best of REPEATS. */
static void print_evaluation(const problem *q) {
  const int calls = q->N > 64 ? 20 : 200;
  test_engine e;
  open_reference(&e, q->N, true, q->end);
  test_run(&e);
  hk_system *s = &e.run->dynamics.system;
  double *a = memory(s->size, sizeof *a), ours = INFINITY, theirs = INFINITY;
  for (int r = 0; r < REPEATS; r++) {
    double begin = own();
    for (int c = 0; c < calls; c++) s->accelerations(s, 0, s->X, s->X + 3 * s->n, s->X + 6 * s->n, a, a + 3 * s->n);
    ours = fmin(ours, own() - begin);
    begin = own();
    for (int c = 0; c < calls; c++) plain_accelerations(&q->p, s->X, s->X + 3 * s->n, a);
    theirs = fmin(theirs, own() - begin);
  }
  printf(
      "  an evaluation: %.1f us by hooke, %.1f by the plain loop (%zu springs); what a run costs above its evaluations "
      "is the method and the engine\n",
      1e6 * ours / calls, 1e6 * theirs / calls, q->p.count);
  free(a);
  test_engine_close(&e);
}

static void print_ladders(const ladder *all) {
  for (const ladder *l = all; l < all + METHODS; l++) {
    if (!l->m) continue;
    printf("    %-25s %-34s", side_name[l->m->side], l->m->name);
    for (int k = 0; k < TARGETS; k++) {
      if (isfinite(l->aim[k].out.seconds))
        printf("  %9.1f", 1e3 * l->aim[k].out.seconds);
      else
        printf("  %9s", "-");
    }
    printf("\n");
  }
}

static void forget_the_best(problem *q) {
  for (side s = 0; s < SIDES; s++)
    for (int k = 0; k < TARGETS; k++) q->best[s][k] = INFINITY;
}

/* Everything of one size; `before`: the one below, with its ladders. */
static void measure_size(size_t size, bool prints, problem *q, ladder *ladders, const problem *before,
                         const ladder *smaller) {
  test_engine e;
  *q = (problem){.N = sizes[size].N, .end = sizes[size].end};
  forget_the_best(q);
  open_reference(&e, q->N, true, q->end);
  test_run(&e);
  q->p = plain_of(&e);
  test_engine_close(&e);
  converge(q, size);
  print_evaluation(q);
  climb_all(ladders, smaller, before, q);
  printf("  a first run of each, ms at %g, %g and %g m:\n", target[0], target[1], target[2]);
  print_ladders(ladders);
  forget_the_best(q); /* no run is given up any more */
  if (prints) {
    printf("  the best of each side, medians of %d runs in turn:\n", REPEATS);
    compare(q, ladders);
  }
  free(q->reference);
  plain_free(&q->p);
}

int main(int count, char **argument) {
  static ladder ladders[SIZES][METHODS];
  problem q[SIZES];
  uint32_t largest = count > 1 ? (uint32_t)atoi(argument[1]) : 64,
           smallest = count > 2 ? (uint32_t)atoi(argument[2]) : 0;
  setvbuf(stdout, NULL, _IOLBF, 0);
  for (size_t k = 0; k < SIZES && sizes[k].N <= largest; k++)
    measure_size(k, sizes[k].N >= smallest, &q[k], ladders[k], k ? &q[k - 1] : NULL, k ? ladders[k - 1] : NULL);
  return 0;
}
