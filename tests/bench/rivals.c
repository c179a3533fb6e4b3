/* Speed against error beside the programs that one would take or write instead: the curtains of 32 x 32 and 64 x 64
 * particles, 0.5 s, and of 256 x 256, 0.1 s, one thread. hooke's explicit integrators; plain C with leapfrog and
 * Runge-Kutta 4; SUNDIALS' ERKStep and CVODE on a plain C right-hand side, and on hooke's forces.
 *
 * build/bench/rivals [N]: the curtains up to N x N, 64 by default; with 256 it takes a quarter of an hour.
 *
 * Every method runs over a ladder of steps (from beyond its stability limit down) or tolerances; runs that cannot win
 * any more are not taken, or given up when they take longer than the best. SUNDIALS takes the same steps on either
 * forces, so its ladders are climbed on hooke's alone. Between the two rungs around a target the
 * setting that just reaches it is interpolated (log-log). For each target the methods of every side that promise most
 * run again at that setting, in turn, and the median counts: the time loop alone, in the thread's own time. A run
 * counts when its error is at most the target, so where the stability limit gives less already, it is the cheapest
 * stable run.
 *
 * The reference is one of Stoermer's methods on hooke's forces; Runge-Kutta 4 on the plain ones must agree with it to a
 * hundredth of the smallest target. */
#include "tests/bench/rivals.h"

enum { SIZES = 3, REPEATS = 3, SHORT_REPEATS = 4, CANDIDATES = 3, RUNGS = 40 };
static const struct {
  uint32_t N;
  double end; /* s; the motion of the largest is determined to the smallest target for this time only */
  const char *reference;
  double fine, other; /* steps of the reference, and of the other method, by those of leapfrog at its limit */
} sizes[SIZES] = {{32, 0.5, "stoermer5", 4, 3.5},
                  {64, 0.5, "stoermer5", 4, 3.5},
                  {256, 0.1, "stoermer_wide4", 2, 0.6}}; /* damped too much for order 5 */
static const double target[TARGETS] = {1e-3, 1e-5, 1e-7};

static const char *const side_name[SIDES] = {"hooke", "plain C, leapfrog", "plain C, RK4", "SUNDIALS, plain C forces",
                                             "SUNDIALS, hooke's forces"};
/* How many times faster hooke is to be; 0: nothing was set. */
static const double goal[SIDES][TARGETS] = {[SUNDIALS_PLAIN] = {20, 20, 20}, [SUNDIALS_HOOKE] = {6, 6, 6}};

/* ---- the methods ---- */

/* Within a side those that promise most come first, so that the others are given up soon. Not among them: SUNDIALS'
 * methods of order 6 and 8, and implicit Runge-Kutta, for which BDF stands. */
#define HOOKE_STEPS(plugin, first)                                                                                     \
  { plugin, HOOKE, run_hooke, first, plugin, NULL, 0, 0, false }
#define PLAIN_STEPS(side)                                                                                              \
  { "", side, run_plain, 0.6, NULL, NULL, 0, 0, false }
#define ERK_STEPS(side, name, table, first, shared)                                                                    \
  { name ", fixed steps", side, run_sundials, first, NULL, erkstep, table, 0, shared }
#define ERK_TOL(side, name, table, shared)                                                                             \
  { name ", atol 1e-6 rtol", side, run_sundials, 10, NULL, erkstep, table, 1e-6, shared }
#define CVODE_TOL(side, name, table, atol, shared)                                                                     \
  { name ", atol " #atol " rtol", side, run_sundials, 10, NULL, cvode, table, atol, shared }
#define SUNDIALS_SIDE(side, shared)                                                                                    \
  ERK_STEPS(side, "Zonneveld 4", ARKODE_ZONNEVELD_5_3_4, 0.5, shared),                                                 \
      ERK_STEPS(side, "Knoth-Wolke 3", ARKODE_KNOTH_WOLKE_3_3, 0.6, shared),                                           \
      ERK_STEPS(side, "Bogacki-Shampine 3", ARKODE_BOGACKI_SHAMPINE_4_2_3, 0.6, shared),                               \
      ERK_STEPS(side, "Cash-Karp 5", ARKODE_CASH_KARP_6_4_5, 0.5, shared),                                             \
      ERK_STEPS(side, "Fehlberg 5", ARKODE_FEHLBERG_6_4_5, 0.4, shared),                                               \
      ERK_STEPS(side, "Dormand-Prince 5", ARKODE_DORMAND_PRINCE_7_4_5, 0.55, shared),                                  \
      ERK_STEPS(side, "Kennedy-Carpenter 4", ARKODE_ARK436L2SA_ERK_6_3_4, 0.6, shared),                                \
      ERK_STEPS(side, "Heun 2", ARKODE_HEUN_EULER_2_1_2, 1, shared),                                                   \
      ERK_TOL(side, "Zonneveld 4", ARKODE_ZONNEVELD_5_3_4, shared),                                                    \
      ERK_TOL(side, "Bogacki-Shampine 3", ARKODE_BOGACKI_SHAMPINE_4_2_3, shared),                                      \
      ERK_TOL(side, "Cash-Karp 5", ARKODE_CASH_KARP_6_4_5, shared),                                                    \
      ERK_TOL(side, "Dormand-Prince 5", ARKODE_DORMAND_PRINCE_7_4_5, shared),                                          \
                                                                                                                       \
      CVODE_TOL(side, "CVODE, Adams", CV_ADAMS, 1e-6, shared),                                                         \
      CVODE_TOL(side, "CVODE, BDF, GMRES", CV_BDF, 1e-3, shared)

static const method methods[] = {
    HOOKE_STEPS("stoermer_wide4", 0.9),
    HOOKE_STEPS("stoermer_wide3", 0.9),
    HOOKE_STEPS("stoermer_wide2", 0.8),
    HOOKE_STEPS("leapfrog", 0.8),
    HOOKE_STEPS("symplectic_euler", 0.8),
    HOOKE_STEPS("stoermer", 1.4),
    HOOKE_STEPS("stoermer5", 2),
    HOOKE_STEPS("blanes_moan", 0.25),
    HOOKE_STEPS("rk4", 0.6),
    {"dopri5, tol", HOOKE, run_hooke, 1e3, "dopri5", NULL, 0, 1, false},
    PLAIN_STEPS(PLAIN_LEAPFROG),
    PLAIN_STEPS(PLAIN_RK4),
    SUNDIALS_SIDE(SUNDIALS_PLAIN, false),
    SUNDIALS_SIDE(SUNDIALS_HOOKE, true),
};
enum { METHODS = sizeof methods / sizeof *methods };

/* ---- ladders ---- */

typedef struct rung {
  double setting;
  outcome out;
} rung;

typedef struct ladder {
  const method *m;
  size_t count;
  rung rung[RUNGS];
  double promise[TARGETS]; /* s, at each target; INFINITY: not reached */
  double setting[TARGETS]; /* that just reaches it */
} ladder;

static void measure(const method *m, const problem *q, double setting, outcome *out) {
  double *x = memory(3 * q->p.n, sizeof *x);
  *out = (outcome){.error = 0};
  m->run(m, q, setting, out, x);
  if (out->error == 0) out->error = rms(x, q->reference, q->p.n);
  if (!(out->error < 1)) out->error = INFINITY;
  free(x);
}

static double next_setting(const method *m, const rung *last) {
  if (m->atol > 0) return last->setting * sqrt(10);
  return ceil(last->setting * (last->out.error > target[0] ? 1.06 : 1.5));
}

/* What reaches the target: the rung below it; or between two rungs that are both within the largest target, where the
 * error falls as a power of the setting. */
static void interpolate(ladder *l, int k) {
  l->promise[k] = INFINITY;
  for (size_t r = 0; r < l->count; r++) {
    const rung *fine = &l->rung[r], *coarse = r ? fine - 1 : NULL;
    if (fine->out.error > target[k] || fine->out.seconds >= l->promise[k]) continue;
    double part = 0;
    if (coarse && coarse->out.error <= target[0] && coarse->out.error > target[k])
      part = 0.97 * log(target[k] / fine->out.error) / log(coarse->out.error / fine->out.error);
    l->setting[k] = part > 0 ? fine->setting * pow(coarse->setting / fine->setting, part) : fine->setting;
    l->promise[k] =
        part > 0 ? fine->out.seconds * pow(coarse->out.seconds / fine->out.seconds, part) : fine->out.seconds;
  }
}

/* Whether finer rungs, which cost more, can still win: for a target that is not reached yet, no run of the side was
 * faster by a tenth. */
static bool worth_going_on(const rung *r, const double best[TARGETS]) {
  for (int k = 0; k < TARGETS; k++)
    if (r->out.error > target[k] && best[k] > 0.9 * r->out.seconds) return true;
  return false;
}

static void climb(ladder *l, double setting, problem *q) {
  double *best = q->best[l->m->side];
  for (l->count = 0; l->count < RUNGS; setting = next_setting(l->m, &l->rung[l->count - 1])) {
    rung *r = &l->rung[l->count++];
    r->setting = setting;
    measure(l->m, q, setting, &r->out);
    for (int k = 0; k < TARGETS; k++)
      if (r->out.error <= target[k]) best[k] = fmin(best[k], r->out.seconds);
    if (!worth_going_on(r, best)) break;
  }
  for (int k = 0; k < TARGETS; k++) interpolate(l, k);
}

/* ---- the table ---- */

typedef struct entry {
  const ladder *l;
  double setting, seconds[REPEATS * SHORT_REPEATS], median;
  size_t runs;
  outcome out;
} entry;

typedef entry row[SIDES][CANDIDATES];

/* The most promising methods of a side at a target, within 15 % of the best. */
static void choose(const ladder *all, side s, int k, entry chosen[CANDIDATES]) {
  memset(chosen, 0, CANDIDATES * sizeof *chosen);
  for (int c = 0; c < CANDIDATES; c++)
    for (const ladder *l = all; l < all + METHODS; l++) {
      bool fits = l->m && l->m->side == s && isfinite(l->promise[k]);
      for (int other = 0; other < c; other++) fits &= chosen[other].l != l;
      if (c > 0) fits &= chosen[0].l && l->promise[k] <= 1.15 * chosen[0].l->promise[k];
      if (fits && (!chosen[c].l || l->promise[k] < chosen[c].l->promise[k]))
        chosen[c] = (entry){.l = l, .setting = l->setting[k]};
    }
}

/* Where the interpolation promised too much, the next finer rung stands for it. */
static void settle(const problem *q, entry *e, int k) {
  measure(e->l->m, q, e->setting, &e->out);
  for (size_t g = 0; g < e->l->count && e->out.error > target[k]; g++) {
    if (e->l->rung[g].setting <= e->setting || e->l->rung[g].out.error > target[k]) continue;
    e->setting = e->l->rung[g].setting;
    measure(e->l->m, q, e->setting, &e->out);
  }
}

/* Runs of less than a tenth of a second, which others on the machine disturb most, count several times a turn. */
static void repeat(const problem *q, entry *e, int k) {
  int times = e->runs == 0 || e->out.seconds > 0.1 ? 1 : SHORT_REPEATS;
  for (int i = 0; i < times; i++) {
    if (e->runs == 0)
      settle(q, e, k);
    else
      measure(e->l->m, q, e->setting, &e->out);
    e->seconds[e->runs++] = e->out.seconds;
  }
}

/* The same run for an easier target, which the stability limit may set for several. */
static const entry *twin(row *rows, int k, side s, const entry *e) {
  for (int easier = 0; easier < k; easier++)
    for (int c = 0; c < CANDIDATES; c++) {
      const entry *o = &rows[easier][s][c];
      if (o->l == e->l && o->setting == e->setting) return o;
    }
  return NULL;
}

static void print_entry(const entry *e, const problem *q, int k, const entry *hooke) {
  const method *m = e->l->m;
  char setting[64], error[32];
  if (m->atol > 0)
    snprintf(setting, sizeof setting, "rtol %.1e", 1 / e->setting);
  else
    snprintf(setting, sizeof setting, "%.0f steps", ceil(e->setting));
  snprintf(error, sizeof error, e->out.error < 100 * q->uncertain ? "under %.0e" : "%.1e",
           fmax(e->out.error, 100 * q->uncertain));
  printf("    %.0e m  %-25s %-34s %-14s %6zu evaluations  %8.1f ms  %-12s", target[k], side_name[m->side], m->name,
         setting, e->out.evaluations, 1e3 * e->median, error);
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
          const entry *same = e->l ? twin(rows, k, s, e) : NULL;
          if (same)
            *e = *same;
          else if (e->l)
            repeat(q, e, k);
        }
}

static const entry *best_of(entry e[CANDIDATES]) {
  const entry *best = NULL;
  for (int c = 0; c < CANDIDATES; c++) {
    if (!e[c].l) continue;
    e[c].median = median(e[c].seconds, e[c].runs);
    if (!best || e[c].median < best->median) best = &e[c];
  }
  return best;
}

static void compare(const problem *q, const ladder *all) {
  static row rows[TARGETS];
  for (int k = 0; k < TARGETS; k++)
    for (side s = 0; s < SIDES; s++) choose(all, s, k, rows[k][s]);
  run_in_turn(q, rows);
  for (int k = 0; k < TARGETS; k++) {
    const entry *hooke = best_of(rows[k][HOOKE]);
    for (side s = 0; s < SIDES; s++) {
      const entry *e = best_of(rows[k][s]);
      if (e && hooke) print_entry(e, q, k, hooke);
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
    if (!l->m || l->m->side == SUNDIALS_PLAIN) continue;
    printf("    %-25s %-34s", side_name[l->m->side], l->m->name);
    for (int k = 0; k < TARGETS; k++) {
      if (isfinite(l->promise[k]))
        printf("  %9.1f", 1e3 * l->promise[k]);
      else
        printf("  %9s", "-");
    }
    printf("\n");
  }
}

/* The smaller curtain tells which methods need not be tried on the larger one: those that were never within 1.6 times
 * their side's best. */
static bool hopeless(const ladder *smaller, size_t l) {
  bool hopeless = true;
  if (!smaller[l].m) return true;
  for (int k = 0; k < TARGETS; k++) {
    double best = INFINITY;
    for (size_t o = 0; o < METHODS; o++)
      if (smaller[o].m && methods[o].side == methods[l].side) best = fmin(best, smaller[o].promise[k]);
    hopeless &= !(smaller[l].promise[k] <= 1.6 * best) || isinf(best);
  }
  return hopeless;
}

static double first_setting(const method *m, const problem *q) {
  return m->atol > 0 ? m->first : ceil(m->first * q->end / q->p.limit);
}

/* Frequencies grow with N: from below the fewest stable steps, by those of the smaller curtain. The larger one is
 * damped more, for which Runge-Kutta methods are stable with steps up to a third longer. */
static double lowest(const ladder *smaller, size_t size) {
  double more = 0.75 * sizes[size].N / sizes[size - 1].N * sizes[size].end / sizes[size - 1].end;
  size_t r = 0;
  while (r + 1 < smaller->count && smaller->rung[r].out.error > target[0]) r++;
  return smaller->rung[r].setting * (smaller->m->atol > 0 ? 1 : more);
}

/* The rungs of the same method on hooke's forces; its times are not those of this side. */
static ladder twin_of(const ladder *all, const method *m) {
  for (const ladder *l = all; l < all + METHODS; l++) {
    if (!l->m || l->m->side != SUNDIALS_HOOKE || strcmp(l->m->name, m->name) != 0) continue;
    ladder copy = *l;
    copy.m = m;
    return copy;
  }
  return (ladder){.m = NULL};
}

/* The ladders of a size, those of the one before being known (NULL: it is the first). */
static void climb_all(ladder *all, const ladder *smaller, size_t size, problem *q) {
  for (size_t l = 0; l < METHODS; l++) {
    const method *m = &methods[l];
    bool out = m->side == SUNDIALS_PLAIN || (smaller && hopeless(smaller, l));
    all[l] = (ladder){.m = out ? NULL : m};
    if (!out) climb(&all[l], smaller ? lowest(&smaller[l], size) : first_setting(m, q), q);
  }
  for (size_t l = 0; l < METHODS; l++)
    if (methods[l].side == SUNDIALS_PLAIN) all[l] = twin_of(all, &methods[l]);
}

static void forget_the_best(problem *q) {
  for (side s = 0; s < SIDES; s++)
    for (int k = 0; k < TARGETS; k++) q->best[s][k] = INFINITY;
}

int main(int count, char **argument) {
  static ladder ladders[SIZES][METHODS];
  uint32_t largest = count > 1 ? (uint32_t)atoi(argument[1]) : 64;
  setvbuf(stdout, NULL, _IOLBF, 0);
  for (size_t size = 0; size < SIZES && sizes[size].N <= largest; size++) {
    test_engine e;
    problem q = {.N = sizes[size].N, .end = sizes[size].end};
    forget_the_best(&q);
    open_reference(&e, q.N, true, q.end);
    test_run(&e);
    q.p = plain_of(&e);
    test_engine_close(&e);
    converge(&q, size);
    print_evaluation(&q);
    climb_all(ladders[size], size ? ladders[size - 1] : NULL, size, &q);
    printf("  a first run of each, ms at %g, %g and %g m:\n", target[0], target[1], target[2]);
    print_ladders(ladders[size]);
    printf("  the best of each side, medians of %d runs in turn:\n", REPEATS);
    forget_the_best(&q); /* no run is given up any more */
    compare(&q, ladders[size]);
    free(q.reference);
    plain_free(&q.p);
  }
  return 0;
}
