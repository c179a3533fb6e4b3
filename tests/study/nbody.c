/* Two bodies on an orbit of eccentricity 0.6 for 10,000 turns: the energy error of leapfrog stays where it was after
 * 100 turns, explicit Euler's grows from the first turn. Fails where leapfrog's does not stay. Some seconds. */
#include "tests/support/nbody_scenes.h"

#include <stdio.h>

static const double turn = 6.283185307179586; /* s */

static double energy(test_engine *e) {
  double kinetic, potential, work;
  hk_run_energy(e->run, &kinetic, &potential, &work);
  return kinetic + potential;
}

/* The largest relative change of the energy at frames, from one number of turns to another. */
static double largest(test_engine *e, double first, int from, int to) {
  double most = 0;
  for (int k = from + 1; k <= to; k++) {
    test_advance(e, turn * (k + 0.25));
    most = fmax(most, fabs(energy(e) / first - 1));
  }
  return most;
}

static double follow(const char *method, int turns) {
  test_engine e;
  nbody_open(&e, &nbody_kepler, method);
  e.options.dt = 0.01;
  e.scene->duration = turn * (turns + 1);
  e.scene->fps = 1 / turn;
  test_run(&e);
  double first = energy(&e), most = 0;
  for (int from = 0, to = turns < 100 ? turns : 100; from < turns; from = to, to = turns < 10 * to ? turns : 10 * to) {
    most = largest(&e, first, from, to);
    printf("%-10s turns %5d to %5d: energy off by at most %.3g of itself\n", method, from, to, most);
    fflush(stdout);
  }
  test_engine_close(&e);
  return most;
}

/* 1e-3: after 100 turns it is 7.3e-4. */
int main(void) {
  follow("euler", 20);
  return follow("leapfrog", 10000) < 1e-3 ? 0 : 1;
}
