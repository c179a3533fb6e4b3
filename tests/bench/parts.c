/* What a step of leapfrog costs where the forces are not springs: cloth of triangles (membrane, hinges, gravity, drag)
 * and a net of springs in the wind, nanoseconds for each particle and step: the thread's own time on one thread, and
 * the clock on the wall on one and on two. Both run the same steps in turn, and the least of the turns counts; the
 * motion is that of the first instants.
 *
 *     parts [N ...]: sheets of N x N particles. */
#include "tests/bench/cloth.h"

#include <string.h>

enum { TURNS = 400, PARTICLES_A_TURN = 20000 }; /* a turn is short, so that some are not disturbed */

typedef struct sheet {
  uint32_t N;
  test_engine e;
  size_t turns, steps;
  double least, own, all; /* ns; all: of all turns */
} sheet;

static void add_triangles(test_engine *e, uint32_t N) {
  uint32_t(*t)[3] = malloc(2 * (size_t)N * N * sizeof *t);
  size_t count = 0;
  for (uint32_t k = 0; k < N * (N - 1); k++) {
    if (k % N == N - 1) continue;
    uint32_t a = k + 1, b = a + 1, c = a + N, d = c + 1, odd = (k / N + k % N) % 2;
    memcpy(t[count++], (uint32_t[3]){a, b, odd ? d : c}, sizeof *t);
    memcpy(t[count++], odd ? (uint32_t[3]){a, d, c} : (uint32_t[3]){b, d, c}, sizeof *t);
  }
  if (hk_scene_add_triangles(e->scene, count, (const uint32_t(*)[3])t, &e->error) != HK_OK) exit(1);
  free(t);
}

static void add_cloth(test_engine *e) {
  hk_plugin_spec *membrane = test_plugin(e, HK_FORCE, "membrane"), *hinges = test_plugin(e, HK_FORCE, "hinges");
  test_number(e, membrane, "stiffness", 100);
  test_number(e, membrane, "damping", 1e-4);
  test_number(e, hinges, "rigidity", 1e-6);
}

static void add_net(test_engine *e, uint32_t N) {
  static const int structural[2][2] = {{1, 0}, {0, 1}}, shear[2][2] = {{1, 1}, {-1, 1}};
  add_springs(e, N, structural, 1000, 0.02);
  add_springs(e, N, shear, 300, 0.01);
  test_vector(e, test_plugin(e, HK_FORCE, "wind"), "velocity", 2, 3, 0.5);
}

static void open_sheet(sheet *s, uint32_t N, bool net, int threads) {
  test_engine *e = &s->e;
  *s = (sheet){.N = N, .least = INFINITY, .own = INFINITY, .steps = PARTICLES_A_TURN / ((size_t)N * N) + 1};
  test_engine_open(e);
  e->scene->threads = threads;
  e->options.dt = 1e-6 * (1 + 1e-9); /* so that rounding does not add a step */
  for (uint32_t i = 0; i < N * N; i++)
    test_particle(e, i % N / (N - 1.0), i / N / (N - 1.0), 0.01 * sin(0.1 * i), 0.15 / ((double)N * N));
  add_triangles(e, N);
  test_plugin(e, HK_FORCE, "gravity");
  test_number(e, test_plugin(e, HK_FORCE, "drag"), "rate", 0.02);
  net ? add_net(e, N) : add_cloth(e);
  test_plugin(e, HK_INTEGRATOR, "leapfrog");
  e->options.until = e->scene->duration = (TURNS + 1) * (double)s->steps * 1e-6;
  e->scene->fps = 1 / e->options.until;
  test_run(e);
}

static double own(void) {
  struct timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void turn(sheet *s) {
  double begin = now(), thread = own();
  test_advance(&s->e, (double)(++s->turns * s->steps) * 1e-6);
  double each = 1e9 / (double)s->steps / s->N / s->N;
  if (s->turns == 1) return; /* it warms up */
  s->own = fmin(s->own, each * (own() - thread));
  s->least = fmin(s->least, each * (now() - begin));
  s->all += each * (now() - begin);
}

static void measure(uint32_t N, bool net) {
  sheet one, two;
  open_sheet(&one, N, net, 1);
  open_sheet(&two, N, net, 2);
  double begin = now();
  for (int t = 0; t <= TURNS && now() < begin + 20; t++) turn(&one), turn(&two);
  printf("%4u x %4u  %-16s own %7.2f ns  one thread %7.2f ns  two %7.2f ns  %5.2f times, in the mean %5.2f\n", N, N,
         net ? "springs, wind" : "membrane, hinges", one.own, one.least, two.least, one.least / two.least,
         one.all / two.all);
  fflush(stdout);
  test_engine_close(&one.e);
  test_engine_close(&two.e);
}

int main(int argc, char **argv) {
  static const uint32_t sides[] = {32, 64, 128, 512};
  size_t count = argc > 1 ? (size_t)argc - 1 : sizeof sides / sizeof *sides;
  for (size_t k = 0; k < count; k++)
    for (int net = 0; net < 2; net++) measure(argc > 1 ? (uint32_t)atoi(argv[k + 1]) : sides[k], net);
  return 0;
}
