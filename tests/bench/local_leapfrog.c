/* A curtain of 128 x 128 particles, one in a hundred of its springs 1,000 times stiffer, at random or in a patch, with
 * the damping of the others or sqrt(1000) times it: leapfrog, whose step the stiffest spring sets, and local_leapfrog.
 * CPU seconds of one thread for the same time of motion, the least of three runs in turns. The errors are RMS distances
 * at the end to leapfrog at a quarter of its step.
 *     build/bench/local_leapfrog [side] [seconds] */
#include "tests/bench/cloth.h"

#include <string.h>

enum { REPEATS = 3 };
static const double factor = 1000, part = 0.01;

typedef struct result {
  double cpu, dt, *x;
  size_t steps;
} result;

static double cpu(void) {
  struct timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* splitmix64 (Steele, Lea and Flood 2014), in [0, 1), of a spring's number. */
static double uniform(uint64_t number) {
  uint64_t z = (number + 1) * 0x9e3779b97f4a7c15ull;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
  return (double)((z ^ (z >> 31)) >> 11) / 9007199254740992.0;
}

static bool in_patch(uint32_t N, uint32_t i, uint32_t j) {
  double low = 0.5 * (1 - sqrt(part)) * N, high = low + sqrt(part) * N;
  return i >= low && i < high && j >= low && j < high;
}

static void add_mixed(test_engine *e, uint32_t N, bool patch, const int offset[2][2], double k, double c,
                      double stiffer) {
  uint32_t(*edge)[2] = malloc(2 * (size_t)N * N * sizeof *edge);
  double *values = malloc(4 * (size_t)N * N * sizeof *values), *dampings = values + 2 * (size_t)N * N;
  size_t count = 0;
  for (int o = 0; o < 2; o++)
    for (uint32_t j = 0; j + (uint32_t)offset[o][1] < N; j++)
      for (uint32_t i = 0; i < N; i++) {
        int64_t other = (int64_t)i + offset[o][0];
        if (other < 0 || other >= N) continue;
        bool stiff = patch ? in_patch(N, i, j) && in_patch(N, (uint32_t)other, j + (uint32_t)offset[o][1])
                           : uniform(count + (uint64_t)(1e6 * k)) < part;
        values[count] = stiff ? factor * k : k;
        dampings[count] = stiff ? stiffer * c : c;
        edge[count][0] = j * N + i + 1;
        edge[count++][1] = (j + (uint32_t)offset[o][1]) * N + (uint32_t)other + 1;
      }
  hk_plugin_spec *springs = test_plugin(e, HK_FORCE, "springs");
  test_edges(e, springs, (const uint32_t(*)[2])edge, count);
  test_list(e, springs, "k", values, count);
  test_list(e, springs, "damping", dampings, count);
  free(edge);
  free(values);
}

static void open_mixed(test_engine *e, uint32_t N, bool patch, double stiffer) {
  static const int structural[2][2] = {{1, 0}, {0, 1}}, shear[2][2] = {{1, 1}, {-1, 1}},
                   flexion[2][2] = {{2, 0}, {0, 2}};
  test_engine_open(e);
  e->scene->threads = 1;
  for (uint32_t i = 0; i < N * N; i++)
    test_particle(e, i % N / (N - 1.0), i / N / (N - 1.0), 0, 0.15 / ((double)N * N));
  for (uint32_t i = 1; i <= N; i++) test_pin(e, HK_PIN_FIXED, N * (N - 1) + i, NULL);
  test_plugin(e, HK_FORCE, "gravity");
  test_number(e, test_plugin(e, HK_FORCE, "drag"), "rate", 0.02);
  add_mixed(e, N, patch, structural, 1000, 0.02, stiffer);
  add_mixed(e, N, patch, shear, 300, 0.01, stiffer);
  add_mixed(e, N, patch, flexion, 50, 0.005, stiffer);
}

/* dt 0: chosen. Keeps the least time. */
static void measure(result *r, const char *method, uint32_t N, bool patch, double stiffer, double dt, double until) {
  test_engine e;
  open_mixed(&e, N, patch, stiffer);
  e.options.integrator = method;
  if (dt > 0) e.options.dt = dt;
  e.scene->duration = until;
  test_run(&e);
  double begin = cpu();
  test_advance(&e, until);
  r->cpu = fmin(r->x ? r->cpu : INFINITY, cpu() - begin);
  r->dt = e.run->step.dt;
  r->steps = e.run->record.steps;
  if (!r->x) r->x = malloc(3 * (size_t)N * N * sizeof *r->x);
  memcpy(r->x, e.run->state.X, 3 * (size_t)N * N * sizeof *r->x);
  test_engine_close(&e);
}

static double distance(const result *a, const result *b, uint32_t N) {
  double sum = 0;
  for (size_t c = 0; c < 3 * (size_t)N * N; c++) sum += (a->x[c] - b->x[c]) * (a->x[c] - b->x[c]);
  return sqrt(sum / N / N);
}

static void print(const char *name, const result *r, const result *reference, uint32_t N) {
  printf("  %-15s %8zu steps of %.3g s, %8.3f s CPU, error %.2g m\n", name, r->steps, r->dt, r->cpu,
         distance(r, reference, N));
}

static void compare(uint32_t N, bool patch, double stiffer, double until) {
  result plain = {0}, local = {0}, reference = {0};
  printf("%s, damping times %.3g:\n", patch ? "a patch" : "at random", stiffer);
  for (int k = 0; k < REPEATS; k++) {
    measure(&plain, "leapfrog", N, patch, stiffer, 0, until);
    measure(&local, "local_leapfrog", N, patch, stiffer, 0, until);
  }
  measure(&reference, "leapfrog", N, patch, stiffer, plain.dt / 4, until);
  print("leapfrog", &plain, &reference, N);
  print("local_leapfrog", &local, &reference, N);
  printf("  %.1f times faster\n", plain.cpu / local.cpu);
  free(plain.x), free(local.x), free(reference.x);
}

int main(int count, char **argument) {
  setvbuf(stdout, NULL, _IOLBF, 0);
  uint32_t N = count > 1 ? (uint32_t)atoi(argument[1]) : 128;
  double until = count > 2 ? atof(argument[2]) : 0.05;
  for (int damped = 0; damped < 2; damped++)
    for (int patch = 0; patch < 2; patch++) compare(N, patch, damped ? sqrt(factor) : 1, until);
  return 0;
}
