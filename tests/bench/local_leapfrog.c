/* A curtain of 128 x 128 particles of whose springs some are stiffer: leapfrog, whose step the stiffest spring sets,
 * and local_leapfrog. Stiff springs have the damping of the others or sqrt(stiffness ratio) times it, which is the same
 * damping ratio. Seconds of the wall on one thread for the same time of motion, the least of three runs in turns. The
 * errors are RMS distances at the end to leapfrog at a quarter of its step. build/bench/local_leapfrog [side] [seconds]
 * [scene] Scenes: random, one spring in a hundred, 1,000 times stiffer; patch, a square of a hundredth of the area;
 * mixed, one in a hundred, a third each 100, 1,000 and 10,000 times; stripes, every 16th row, in turns of the same
 * three; field, every spring stiffer by 1,000^u^16, u uniform in [0, 1): of many degrees, and hanging together. */
#include "core/numerics/step_choice/step_choice.h"
#include "tests/bench/cloth.h"

#include <string.h>

enum { REPEATS = 3 };
enum { STRIPE = 16 }; /* rows */
static const double part = 0.01;

typedef enum layout { RANDOM, PATCH, MIXED, STRIPES, FIELD, LAYOUTS } layout;
static const char *const layout_name[] = {"random", "patch", "mixed", "stripes", "field"};

typedef struct sheet {
  uint32_t N;
  layout layout;
  bool damped; /* stiff springs by sqrt(ratio) */
} sheet;

typedef struct result {
  double cpu, dt, *x;
  size_t steps;
} result;

static double wall(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
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

/* How much stiffer a spring between two particles is; `number` tells it from all others. */
static double ratio_of(const sheet *s, const uint32_t p[2], const uint32_t q[2], uint64_t number) {
  static const double degree[3] = {100, 1000, 10000};
  double u = uniform(number);
  if (s->layout == RANDOM) return u < part ? 1000 : 1;
  if (s->layout == MIXED) return u < part ? degree[(int)(3 * u / part)] : 1;
  if (s->layout == FIELD) return pow(1000, pow(u, 16));
  if (s->layout == PATCH) return in_patch(s->N, p[0], p[1]) && in_patch(s->N, q[0], q[1]) ? 1000 : 1;
  return p[1] == q[1] && p[1] % STRIPE == STRIPE / 2 ? degree[p[1] / STRIPE % 3] : 1;
}

static void add_mixed(test_engine *e, const sheet *s, const int offset[2][2], double k, double c) {
  uint32_t N = s->N, (*edge)[2] = malloc(2 * (size_t)N * N * sizeof *edge);
  double *values = malloc(4 * (size_t)N * N * sizeof *values), *dampings = values + 2 * (size_t)N * N;
  size_t count = 0;
  for (int o = 0; o < 2; o++)
    for (uint32_t j = 0; j + (uint32_t)offset[o][1] < N; j++)
      for (uint32_t i = 0; i < N; i++) {
        uint32_t p[2] = {i, j}, q[2] = {i + (uint32_t)offset[o][0], j + (uint32_t)offset[o][1]};
        if (q[0] >= N) continue; /* also where it is below 0 */
        double ratio = ratio_of(s, p, q, count + (uint64_t)(1e6 * k));
        values[count] = ratio * k;
        dampings[count] = s->damped ? sqrt(ratio) * c : c;
        edge[count][0] = p[1] * N + p[0] + 1;
        edge[count++][1] = q[1] * N + q[0] + 1;
      }
  hk_plugin_spec *springs = test_plugin(e, HK_FORCE, "springs");
  test_edges(e, springs, (const uint32_t(*)[2])edge, count);
  test_list(e, springs, "k", values, count);
  test_list(e, springs, "damping", dampings, count);
  free(edge);
  free(values);
}

static void open_mixed(test_engine *e, const sheet *s) {
  const uint32_t N = s->N;
  static const int structural[2][2] = {{1, 0}, {0, 1}}, shear[2][2] = {{1, 1}, {-1, 1}},
                   flexion[2][2] = {{2, 0}, {0, 2}};
  test_engine_open(e);
  e->scene->threads = 1;
  for (uint32_t i = 0; i < N * N; i++)
    test_particle(e, i % N / (N - 1.0), i / N / (N - 1.0), 0, 0.15 / ((double)N * N));
  for (uint32_t i = 1; i <= N; i++) test_pin(e, HK_PIN_FIXED, N * (N - 1) + i, NULL);
  test_plugin(e, HK_FORCE, "gravity");
  test_number(e, test_plugin(e, HK_FORCE, "drag"), "rate", 0.02);
  add_mixed(e, s, structural, 1000, 0.02);
  add_mixed(e, s, shear, 300, 0.01);
  add_mixed(e, s, flexion, 50, 0.005);
}

/* dt 0: chosen. Keeps the least time. */
static void measure(result *r, const char *method, const sheet *s, double dt, double until) {
  test_engine e;
  open_mixed(&e, s);
  e.options.integrator = method;
  if (dt > 0) e.options.dt = dt;
  e.scene->duration = until;
  test_run(&e);
  double begin = wall();
  test_advance(&e, until);
  r->cpu = fmin(r->x ? r->cpu : INFINITY, wall() - begin);
  r->dt = e.run->step->length.dt;
  r->steps = e.run->record.steps;
  if (!r->x) r->x = malloc(3 * (size_t)s->N * s->N * sizeof *r->x);
  memcpy(r->x, e.run->state.X, 3 * (size_t)s->N * s->N * sizeof *r->x);
  test_engine_close(&e);
}

static double distance(const result *a, const result *b, uint32_t N) {
  double sum = 0;
  for (size_t c = 0; c < 3 * (size_t)N * N; c++) sum += (a->x[c] - b->x[c]) * (a->x[c] - b->x[c]);
  return sqrt(sum / N / N);
}

static void print(const char *name, const result *r, const result *reference, uint32_t N) {
  printf("  %-15s %8zu steps of %.3g s, %8.3f s, error %.2g m\n", name, r->steps, r->dt, r->cpu,
         distance(r, reference, N));
}

static void compare(const sheet *s, double until) {
  result plain = {0}, local = {0}, reference = {0};
  printf("%s, damping %s:\n", layout_name[s->layout], s->damped ? "of the same ratio" : "of the other springs");
  for (int k = 0; k < REPEATS; k++) {
    measure(&plain, "leapfrog", s, 0, until);
    measure(&local, "local_leapfrog", s, 0, until);
  }
  measure(&reference, "leapfrog", s, plain.dt / 4, until);
  print("leapfrog", &plain, &reference, s->N);
  print("local_leapfrog", &local, &reference, s->N);
  printf("  %.1f times faster\n", plain.cpu / local.cpu);
  free(plain.x), free(local.x), free(reference.x);
}

int main(int count, char **argument) {
  setvbuf(stdout, NULL, _IOLBF, 0);
  sheet s = {.N = count > 1 ? (uint32_t)atoi(argument[1]) : 128};
  double until = count > 2 ? atof(argument[2]) : 0.02;
  for (int damped = 0; damped < 2; damped++)
    for (s.layout = RANDOM; s.layout < LAYOUTS; s.layout++) {
      s.damped = damped;
      if (count < 4 || strcmp(argument[3], layout_name[s.layout]) == 0) compare(&s, until);
    }
  return 0;
}
