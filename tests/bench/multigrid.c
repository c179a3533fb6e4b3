/* The solver multigrid beside supernodal and pcg on the matrix of an implicit step of a cloth of 64 to 512 squared (M +
 * h^2 K, k = 1e5 N/m, h = 1/60 s): set-up or factorization, a solution to 1e-6 with its iterations, and one to a tenth,
 * as Newton's method asks for. On one thread, its own time, the least of some; supernodal to 256, pcg to 128. To reach:
 * below 1.5 s at 256, 6 s and 0.5 GB at 512, at most 25 iterations. usage: multigrid [SIDE ...] */
#include "tests/bench/cloth_matrix.h"
#include "tests/support/solver_matrix.h"

#include <stdio.h>
#include <sys/resource.h>
#include <time.h>

static double now(void) {
  struct timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static double megabytes(void) { /* the most that this process has had */
  struct rusage use;
  getrusage(RUSAGE_SELF, &use);
  return (double)use.ru_maxrss / 1024;
}

static void must(test_solver *s, hk_status status) {
  if (status == HK_OK) return;
  printf("%s\n", s->e.error.text);
  exit(1);
}

/* Returns the time of a solution. */
static double solve(test_solver *s, const double *b, double *x, double tolerance, int *iterations) {
  hk_solve_info info = {0, 0, tolerance};
  double t0 = now();
  must(s, test_solver_solve(s, b, x, &info));
  *iterations = info.iterations;
  return now() - t0;
}

static void measure(const cloth_matrix *c, const char *name, int repeats) {
  test_solver s;
  size_t n = 3 * c->A.rows, held = n - 3 * (size_t)c->side;
  double *b = calloc(2 * n, sizeof *b), best[3] = {INFINITY, INFINITY, INFINITY}, before = megabytes();
  int iterations[2] = {0};
  for (size_t k = 0; k < held; k++) b[k] = noise(k);
  test_solver_open(&s, name, 1);
  s.A = c->A;
  must(&s, test_solver_analyze(&s));
  for (int r = 0; r < repeats; r++) {
    double t0 = now();
    must(&s, test_solver_factorize(&s));
    best[0] = fmin(best[0], now() - t0);
    best[1] = fmin(best[1], solve(&s, b, b + n, 1e-6, &iterations[0]));
    best[2] = fmin(best[2], solve(&s, b, b + n, 0.1, &iterations[1]));
  }
  printf("%3u x %3u, %-10s set-up %8.1f ms, to 1e-6 %8.1f ms in %3d iterations, to 0.1 %7.1f ms in %2d; %.0f MB more\n",
         c->side, c->side, name, best[0] * 1e3, best[1] * 1e3, iterations[0], best[2] * 1e3, iterations[1],
         megabytes() - before);
  s.A.value = NULL;
  test_solver_close(&s);
  free(b);
}

static void compare(uint32_t side) {
  cloth_matrix c;
  open_cloth_matrix(&c, side, 1e5, 1 / 60.0);
  measure(&c, "multigrid", side > 256 ? 1 : 3);
  if (side <= 256) measure(&c, "supernodal", 3);
  if (side <= 128) measure(&c, "pcg", 1);
  close_cloth_matrix(&c);
}

int main(int count, char **arguments) {
  static const uint32_t sides[] = {64, 128, 256, 512};
  for (int k = 1; k < count; k++) compare((uint32_t)strtoul(arguments[k], NULL, 10));
  for (size_t k = 0; k < sizeof sides / sizeof *sides && count < 2; k++) compare(sides[k]);
  return 0;
}
