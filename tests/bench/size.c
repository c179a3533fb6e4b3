/* What a step of leapfrog costs against the number of particles, by hooke and as a plain C loop: curtains of 10 x 10 to
 * 1024 x 1024 particles, one thread, nanoseconds for each spring and step. Both sides run the same steps in turn, in
 * the thread's own time, and the least of the turns counts; the motion is that of the first instants.
 *
 *     size [LARGEST [FILE]]: up to LARGEST particles along a side. FILE gets the plain loop's lines for `hooke scaling
 *     --beside`: label, particles, s for each particle and simulated second at leapfrog's largest stable step. */
#include "tests/bench/plain.h"

enum { TURNS = 5, SPRINGS_A_TURN = 4000000, STEPS = 150 };

typedef struct sides {
  test_engine e;
  plain p;
  double *x, *v, *seen, *a, *a_next, h;
  size_t steps, turns;
} sides;

/* Half of the largest step, by Gershgorin: all springs at one particle have 5400 N/m, and damp with 0.14 N s/m. */
static double stable(uint32_t N) {
  double mass = 0.15 / ((double)N * N);
  return fmin(sqrt(mass / (2 * 5400)), mass / (2 * 0.14));
}

/* A turn is a frame of the run, of so many steps that what is done at frames counts little, as in runs. */
static void open_sides(sides *s, uint32_t N) {
  size_t springs = 6 * (size_t)N * N;
  *s = (sides){.h = stable(N), .steps = SPRINGS_A_TURN / springs + STEPS};
  open_reference(&s->e, N, true, (double)s->steps * s->h);
  s->e.options.until = s->e.scene->duration = (TURNS + 1) * (double)s->steps * s->h;
  s->e.options.dt = s->h * (1 + 1e-9); /* so that rounding does not add a step */
  test_plugin(&s->e, HK_INTEGRATOR, "leapfrog");
  test_run(&s->e);
  s->p = plain_of(&s->e);
  double **vector[] = {&s->x, &s->v, &s->seen, &s->a, &s->a_next};
  for (size_t k = 0; k < sizeof vector / sizeof *vector; k++) *vector[k] = memory(3 * s->p.n, sizeof(double));
  memcpy(s->x, s->p.start, 3 * s->p.n * sizeof *s->x);
}

static void close_sides(sides *s) {
  double *vector[] = {s->x, s->v, s->seen, s->a, s->a_next};
  for (size_t k = 0; k < sizeof vector / sizeof *vector; k++) free(vector[k]);
  plain_free(&s->p);
  test_engine_close(&s->e);
}

static double hooke_turn(sides *s) {
  double begin = own();
  if (hk_run_advance(s->e.run, (double)(++s->turns * s->steps) * s->h, &s->e.error) != HK_OK) exit(1);
  return own() - begin;
}

static double plain_turn(sides *s) {
  size_t count = 3 * s->p.n;
  double begin = own(), half = s->h / 2;
  for (size_t k = 0; k < s->steps; k++) {
    double *swap = s->a;
    for (size_t e = 0; e < count; e++) {
      double kick = half * s->a[e], middle = s->v[e] + kick;
      s->x[e] += s->h * middle;
      s->seen[e] = middle + kick;
    }
    plain_accelerations(&s->p, s->x, s->seen, s->a_next);
    for (size_t e = 0; e < count; e++) s->v[e] += half * (s->a[e] + s->a_next[e]);
    s->a = s->a_next;
    s->a_next = swap;
  }
  return own() - begin;
}

static void measure(uint32_t N, FILE *file) {
  sides s;
  double ours = INFINITY, theirs = INFINITY;
  open_sides(&s, N);
  hooke_turn(&s); /* the first turn warms up */
  for (int t = 0; t < TURNS; t++) {
    theirs = fmin(theirs, plain_turn(&s));
    ours = fmin(ours, hooke_turn(&s));
  }
  double each = 1e9 / (double)s.steps / (double)s.p.count;
  printf("%4u x %4u  %8zu springs  hooke %6.2f ns  plain C %6.2f ns  %5.2f times\n", N, N, s.p.count, ours * each,
         theirs * each, theirs / ours);
  fflush(stdout);
  if (file) fprintf(file, "plain C leapfrog,%zu,%.6g\n", s.p.n, theirs / (double)s.steps / s.p.limit / (double)s.p.n);
  close_sides(&s);
}

int main(int argc, char **argv) {
  static const uint32_t side[] = {10, 32, 64, 128, 256, 512, 1024};
  uint32_t largest = argc > 1 ? (uint32_t)atoi(argv[1]) : 1024;
  FILE *file = argc > 2 ? fopen(argv[2], "w") : NULL;
  if (argc > 2 && !file) {
    fprintf(stderr, "cannot write %s\n", argv[2]);
    return 1;
  }
  for (size_t k = 0; k < sizeof side / sizeof *side; k++)
    if (side[k] <= largest) measure(side[k], file);
  return file && fclose(file) != 0;
}
