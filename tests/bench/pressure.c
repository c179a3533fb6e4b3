/* The pressure's equation of a liquid, -div grad p = b with random b: a cube of n^3 cells with walls all round but
 * above, where the surface is half a cell over the centres, to a residual of 1e-6 (largest numbers). With incomplete
 * factors and with the V-cycle: iterations, and time for each cell with all that is made anew in a step, the least of
 * turns, in one thread. Beside them conjugate gradients of scipy on the same matrix, where python3 has it. */
#include "plugins/common/mac_grid/pressure.h"
#include "tests/support/solver_matrix.h"

#include <stdio.h>
#include <stdlib.h>
#include <time.h>

enum { TURNS = 5 };

static const double tolerance = 1e-6;

static double own(void) {
  struct timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void set_row(hk_pressure *p, uint32_t k, uint32_t n) {
  const uint32_t at[3] = {k % n, k / n % n, k / n / n}, step[3] = {1, n, n * n};
  p->diagonal[k] = at[2] == n - 1 ? 2 : 0;
  for (int c = 0; c < 3; c++) {
    p->prior[c][k] = at[c] > 0 ? k - step[c] : (uint32_t)p->rows;
    p->next[c][k] = at[c] < n - 1 ? k + step[c] : (uint32_t)p->rows;
    p->side[c][k] = at[c] < n - 1;
    p->diagonal[k] += (at[c] > 0) + (at[c] < n - 1);
  }
}

static void measure(const hk_host *host, uint32_t n, hk_pressure_way way) {
  static const char *const name[] = {"", "factors", "V-cycle"};
  const hk_liquid_grid grid = {.cells = {n, n, n}, .slab = 2};
  const uint32_t m = n + 2;
  hk_pressure p;
  double least = INFINITY;
  if (hk_pressure_open(&p, host, &grid) != HK_OK) exit(1);
  p.way = way;
  p.rows = (size_t)n * n * n;
  for (uint32_t k = 0; k < p.rows; k++) {
    p.cell[k] = (1 + k % n) + (1 + k / n % n) * m + (1 + k / n / n) * m * m;
    set_row(&p, k, n);
  }
  for (int turn = 0; turn < TURNS; turn++) {
    for (size_t k = 0; k < p.rows; k++) p.b[k] = test_noise(), p.x[k] = 0;
    double begin = own();
    hk_pressure_prepare(&p);
    if (!hk_pressure_solve(&p, tolerance, 0)) exit(1);
    least = fmin(least, own() - begin);
  }
  printf("%4u^3  %-8s %4d iterations %8.1f ns a cell\n", n, name[way], p.iterations, 1e9 * least / (double)p.rows);
  fflush(stdout);
  hk_pressure_close(&p);
}

static void print_peer(uint32_t n) {
  static const char script[] =
      "try: import time, numpy as np, scipy.sparse as sp; from scipy.sparse.linalg import cg\n"
      "except ImportError: print('      scipy is not installed'); raise SystemExit\n"
      "n = %u; d = sp.diags([-np.ones(n-1), np.r_[1, 2*np.ones(n-2), 1], -np.ones(n-1)], [-1, 0, 1]); i = "
      "sp.identity(n)\n"
      "top = sp.diags([np.r_[np.zeros(n-1), 2]], [0])\n"
      "A = (sp.kron(i, sp.kron(i, d)) + sp.kron(i, sp.kron(d, i)) + sp.kron(d + top, sp.identity(n*n))).tocsr()\n"
      "b = np.random.default_rng(7).random(n**3) - 0.5; k = [0]\n"
      "t = time.process_time(); cg(A, b, rtol=1e-6, callback=lambda x: k.__setitem__(0, k[0] + 1))\n"
      "print('%%4d^3  scipy    %%4d iterations %%8.1f ns a cell' %% (n, k[0], 1e9 * (time.process_time() - t) / "
      "n**3))\n";
  FILE *python = popen("OPENBLAS_NUM_THREADS=1 python3 - || echo '      python3 is not installed'", "w");
  if (!python) return;
  fprintf(python, script, n);
  pclose(python);
}

int main(void) {
  test_solver s;
  test_solver_open(&s, "pcg", 1);
  for (uint32_t n = 16; n <= 128; n *= 2) {
    measure(&s.solver->host, n, HK_PRESSURE_FACTORS);
    measure(&s.solver->host, n, HK_PRESSURE_VCYCLE);
    print_peer(n);
  }
  test_solver_close(&s);
  return 0;
}
