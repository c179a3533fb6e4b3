/* What a step costs beside the springs: the curtain with its springs, gravity and drag, and the same particles with
 * gravity and drag alone, by integrator; nanoseconds for each particle and step, on one thread, in the thread's own
 * time. The two take turns, and the least of the turns counts; the motion is that of the first instants.
 *
 *     beside [N [INTEGRATOR ...]]: N x N particles, 32 by default. */
#include "tests/bench/plain.h"

enum { TURNS = 60, PARTICLES_A_TURN = 400000 };

static const char *const methods[] = {"leapfrog",       "symplectic_euler", "stoermer_wide2",
                                      "stoermer_wide3", "stoermer_wide4",   "stoermer8"};

typedef struct sheet {
  test_engine e;
  size_t steps, turns;
  double least; /* ns */
} sheet;

static void open_sheet(sheet *s, uint32_t N, bool springs, const char *method) {
  const double dt = 1e-7; /* s; stable for all of them */
  *s = (sheet){.steps = PARTICLES_A_TURN / ((size_t)N * N) + 50, .least = INFINITY};
  double end = (TURNS + 1) * (double)s->steps * dt;
  open_reference(&s->e, N, true, end);
  if (!springs) s->e.scene->plugin[HK_FORCE].count = 2; /* gravity and drag, which come first */
  s->e.options.until = s->e.scene->duration = end;
  s->e.options.dt = dt * (1 + 1e-9); /* so that rounding does not add a step */
  test_plugin(&s->e, HK_INTEGRATOR, method);
  test_run(&s->e);
}

static void turn(sheet *s, uint32_t N) {
  double begin = own();
  if (hk_run_advance(s->e.run, (double)(++s->turns * s->steps) * 1e-7, &s->e.error) != HK_OK) exit(1);
  if (s->turns == 1) return; /* it warms up */
  s->least = fmin(s->least, 1e9 * (own() - begin) / (double)s->steps / N / N);
}

static void measure(uint32_t N, const char *method) {
  sheet whole, bare;
  open_sheet(&whole, N, true, method);
  open_sheet(&bare, N, false, method);
  for (int t = 0; t <= TURNS; t++) turn(&whole, N), turn(&bare, N);
  printf("%4u x %4u  %-18s  a step %6.2f ns a particle, without springs %6.2f\n", N, N, method, whole.least,
         bare.least);
  fflush(stdout);
  test_engine_close(&whole.e);
  test_engine_close(&bare.e);
}

int main(int argc, char **argv) {
  const uint32_t N = argc > 1 ? (uint32_t)atoi(argv[1]) : 32;
  size_t count = argc > 2 ? (size_t)argc - 2 : sizeof methods / sizeof *methods;
  for (size_t m = 0; m < count; m++) measure(N, argc > 2 ? argv[m + 2] : methods[m]);
  return 0;
}
