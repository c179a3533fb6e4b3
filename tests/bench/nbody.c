/* Gravitation: the kernels and the sum over all pairs beside the plain loop of a textbook, which is also what a widely
 * used package has; the tree beside that package's figures; and the growth of the tree's time with the number of
 * bodies.
 *
 * The package's tree (REBOUND 5: monopoles, a cell is opened when its width over the distance exceeds an angle) took
 * 0.165 s a step for 1e4 bodies of a Plummer sphere with angle 0.5 and 3.5 s for 1e5, 0.077 and 2.0 s with 0.7, on a
 * machine where its own sum over all pairs took 0.29 s for 1e4. Here these times are scaled by the plain loop of today:
 * it stands for that sum. The errors of its criterion are computed here. Times are of the wall, the least of many
 * repeats: where neighbours take a processor away, the clock of a process is wrong by up to a quarter, and the least is
 * not.
 *
 * build/bench/nbody [bodies]: with a number, the largest of the growth, 1e6 by default. */
#include "plugins/common/gravity/tree/tree_sum.h"
#include "plugins/common/space/octree_builder.h"
#include "tests/support/nbody_scenes.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <time.h>

enum { REPEATS = 3, SAMPLES = 2000, PIECE = 64 /* bodies of a piece of some 100 us */ };
static const double softening = 0.01, package_direct = 0.29;

static double wall(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void *memory(size_t count, size_t size) {
  void *p = calloc(count + 1, size);
  if (p) return p;
  fprintf(stderr, "no memory for %zu numbers: close other programs\n", count);
  exit(1);
}

/* ---- a sphere, and plain sums ---- */

typedef struct sphere {
  size_t n;
  double *x, *m;
} sphere;

static sphere sphere_of(size_t n) {
  sphere s = {n, memory(3 * n, sizeof(double)), memory(n, sizeof(double))};
  uint64_t seed[4];
  hk_random_seed(seed, 7);
  for (size_t i = 0; i < n; i++) {
    double r, z = 2 * hk_random_uniform(seed) - 1, angle = 6.283185307179586 * hk_random_uniform(seed);
    do r = 1 / sqrt(pow(hk_random_uniform(seed), -2.0 / 3) - 1);
    while (!(r < 20));
    s.x[3 * i] = r * sqrt(1 - z * z) * cos(angle);
    s.x[3 * i + 1] = r * sqrt(1 - z * z) * sin(angle);
    s.x[3 * i + 2] = r * z;
    s.m[i] = 1 / (double)n;
  }
  return s;
}

static void free_sphere(sphere *s) {
  free(s->x);
  free(s->m);
}

static void plain_pull(const sphere *s, size_t i, double a[3]) {
  const double *x = s->x, *at = x + 3 * i;
  double ax = 0, ay = 0, az = 0;
  for (size_t j = 0; j < s->n; j++) {
    double dx = x[3 * j] - at[0], dy = x[3 * j + 1] - at[1], dz = x[3 * j + 2] - at[2];
    double s2 = dx * dx + dy * dy + dz * dz + softening * softening, f = s->m[j] / (s2 * sqrt(s2));
    ax += f * dx, ay += f * dy, az += f * dz;
  }
  a[0] = ax, a[1] = ay, a[2] = az;
}

/* s per ordered pair of the plain loop. */
static double plain_time(void) {
  sphere s = sphere_of(4096);
  double best = INFINITY, a[3], sink = 0;
  for (int r = 0; r < 32 * REPEATS; r++) {
    double begin = wall();
    for (size_t i = 0; i < PIECE; i++) plain_pull(&s, i, a), sink += a[0];
    best = fmin(best, wall() - begin);
  }
  free_sphere(&s);
  return sink == 0 ? NAN : best / (PIECE * 4096.0);
}

/* ---- kernels ---- */

static void kernel(const hk_gravity_path *path, double eps2) {
  enum { N = 4096 };
  sphere s = sphere_of(N);
  double *number = memory(4 * N, sizeof *number), best = INFINITY, off = 0;
  hk_bodies at = {number, number + N, number + 2 * N, number + 3 * N};
  for (size_t k = 0; k < N; k++) {
    at.x[k] = s.x[3 * k], at.y[k] = s.x[3 * k + 1], at.z[k] = s.x[3 * k + 2], at.m[k] = s.m[k];
  }
  for (int r = 0; r < 4 * REPEATS; r++) {
    double begin = wall();
    for (size_t i = 0; i < 1024; i += HK_GRAVITY_BLOCK) {
      hk_targets t;
      hk_pull sum = {0};
      for (size_t l = 0; l < HK_GRAVITY_BLOCK; l++)
        t.x[0][l] = at.x[i + l], t.x[1][l] = at.y[i + l], t.x[2][l] = at.z[i + l];
      path->pull(&at, 0, N, &t, eps2, &sum);
      for (size_t l = 0; l < HK_GRAVITY_BLOCK && r == 0; l++) {
        long double a[3] = {0}, d2 = 0, a2 = 0;
        for (size_t j = 0; j < N; j++) {
          long double d[3], s2 = eps2;
          for (size_t c = 0; c < 3; c++) d[c] = (long double)s.x[3 * j + c] - s.x[3 * (i + l) + c], s2 += d[c] * d[c];
          for (size_t c = 0; c < 3 && s2 > 0; c++) a[c] += s.m[j] * d[c] / (s2 * sqrtl(s2));
        }
        for (size_t c = 0; c < 3; c++) d2 += (sum.a[c][l] - a[c]) * (sum.a[c][l] - a[c]), a2 += a[c] * a[c];
        off += (double)(d2 / a2) / 1024;
      }
    }
    best = fmin(best, wall() - begin);
  }
  printf("  %-15s softening %-6.2g %6.3f ns per ordered pair, forces off by %.1e RMS\n", path->name, sqrt(eps2),
         1e9 * best / (1024.0 * N), sqrt(off));
  free(number);
  free_sphere(&s);
}

/* ---- forces in a scene ---- */

typedef struct setting {
  const char *method, *parameter;
  double value;
  int threads;
} setting;

typedef struct outcome {
  double seconds, rms, p99, largest, resident; /* resident: GB */
} outcome;

static int by_size(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

/* exact: for every stride-th body; NULL: errors are not wanted. */
static void compare(const double *F, const sphere *s, const double *exact, size_t stride, outcome *o) {
  double *off = memory(s->n, sizeof *off);
  size_t count = 0;
  for (size_t i = 0; i < s->n; i += stride, count++) {
    double d2 = 0, a2 = 0;
    for (size_t c = 0; c < 3; c++) {
      d2 += pow(F[3 * i + c] / s->m[i] - exact[3 * i + c], 2);
      a2 += pow(exact[3 * i + c], 2);
    }
    off[count] = sqrt(d2 / a2);
    o->rms += d2 / a2;
  }
  qsort(off, count, sizeof *off, by_size);
  o->rms = sqrt(o->rms / (double)count);
  o->p99 = off[count * 99 / 100];
  o->largest = off[count - 1];
  free(off);
}

static outcome measure(const sphere *s, const setting *how, int repeats, const double *exact, size_t stride) {
  test_engine e;
  outcome o = {.seconds = INFINITY};
  uint32_t id;
  double *F = memory(3 * s->n, sizeof *F), *x = memory(3 * s->n, sizeof *x);
  test_engine_open(&e);
  if (hk_scene_add_particles(e.scene, s->n, s->x, NULL, s->m, 0, 0, &id, &e.error) != HK_OK) exit(1);
  e.scene->threads = how->threads;
  e.options.dt = 0.01;
  hk_plugin_spec *spec = test_plugin(&e, HK_FORCE, "nbody");
  test_number(&e, spec, "G", 1);
  test_number(&e, spec, "softening", softening);
  test_text(&e, spec, "method", how->method);
  if (how->parameter) test_number(&e, spec, how->parameter, how->value);
  test_run(&e);
  hk_instance *force = test_instance(&e, spec);
  hk_view view = hk_force_view_at(&e.run->dynamics, 0, 0, e.run->state.X, s->n);
  view.x = x;
  for (int r = 0; r < repeats; r++) {
    memcpy(x, s->x, 3 * s->n * sizeof *x);
    x[0] += 1e-12 * r; /* another place: the tree is built anew */
    memset(F, 0, 3 * s->n * sizeof *F);
    double begin = wall();
    if (force->plugin->force->add(force->self, &view, F) != HK_OK) exit(1);
    o.seconds = fmin(o.seconds, wall() - begin);
  }
  struct rusage usage;
  getrusage(RUSAGE_SELF, &usage);
  o.resident = (double)usage.ru_maxrss / 1048576;
  if (exact) compare(F, s, exact, stride, &o);
  test_engine_close(&e);
  free(F);
  free(x);
  return o;
}

/* ---- the package's criterion, for its errors: a cell is taken as a point where width < angle x distance ---- */

typedef struct plain_tree {
  const sphere *s;
  const hk_octree *t;
  double *mass, (*center)[3];
} plain_tree;

static void plain_moments(plain_tree *p) {
  p->mass = memory(p->t->cells, sizeof *p->mass);
  p->center = memory(p->t->cells, sizeof *p->center);
  for (size_t k = 0; k < p->t->cells; k++) {
    for (size_t q = p->t->cell[k].begin; q < (size_t)p->t->cell[k].begin + p->t->cell[k].count; q++) {
      size_t i = p->t->order[q];
      p->mass[k] += p->s->m[i];
      for (size_t c = 0; c < 3; c++) p->center[k][c] += p->s->m[i] * p->s->x[3 * i + c];
    }
    for (size_t c = 0; c < 3; c++) p->center[k][c] /= p->mass[k];
  }
}

static void add_point(double m, const double *from, const double *to, double a[3]) {
  double d[3], s2 = softening * softening;
  for (size_t c = 0; c < 3; c++) d[c] = from[c] - to[c], s2 += d[c] * d[c];
  for (size_t c = 0; c < 3; c++) a[c] += m * d[c] / (s2 * sqrt(s2));
}

static void package_pull(const plain_tree *p, size_t i, double angle, double a[3]) {
  for (size_t k = 0; k < p->t->cells;) {
    const hk_octree_cell *cell = &p->t->cell[k];
    double width = 0, r2 = 0;
    for (size_t c = 0; c < 3; c++) {
      width = fmax(width, cell->high[c] - cell->low[c]);
      r2 += pow(p->center[k][c] - p->s->x[3 * i + c], 2);
    }
    bool whole = width * width < angle * angle * r2, leaf = cell->next == k + 1;
    if (whole) add_point(p->mass[k], p->center[k], p->s->x + 3 * i, a);
    for (size_t q = cell->begin; !whole && leaf && q < (size_t)cell->begin + cell->count; q++)
      add_point(p->s->m[p->t->order[q]], p->s->x + 3 * (size_t)p->t->order[q], p->s->x + 3 * i, a);
    k = whole || leaf ? cell->next : k + 1;
  }
}

static void *take(const hk_host *host, size_t bytes) {
  (void)host;
  return memory(bytes, 1);
}

static void give(const hk_host *host, void *p) {
  (void)host;
  free(p);
}

static void in_turn(const hk_host *host, size_t count, size_t grain, void (*body)(void *, size_t, size_t, size_t),
                    void *context) {
  (void)host, (void)grain;
  if (count) body(context, 0, count, 0);
}

static outcome package_errors(const sphere *s, double angle, const double *exact, size_t stride) {
  const hk_host host = {.lanes = hk_processor_lanes(), .allocate = take, .release = give, .parallel_for = in_turn};
  hk_octree_builder builder = {0};
  hk_octree t;
  uint32_t flawed;
  outcome o = {0};
  if (hk_octree_reserve(&builder, &host, s->n) != HK_OK || !hk_octree_build(&builder, s->x, NULL, s->n, &t, &flawed))
    exit(1);
  plain_tree p = {.s = s, .t = &t};
  plain_moments(&p);
  double *F = memory(3 * s->n, sizeof *F);
  for (size_t i = 0; i < s->n; i += stride) {
    package_pull(&p, i, angle, F + 3 * i);
    for (size_t c = 0; c < 3; c++) F[3 * i + c] *= s->m[i];
  }
  compare(F, s, exact, stride, &o);
  free(F);
  free(p.mass);
  free(p.center);
  hk_octree_release(&builder);
  return o;
}

/* ---- the tables ---- */

static void print_tree(const char *name, const outcome *o, double package) {
  printf("  %-28s %8.4f s   %.1e  %.1e  %.1e", name, o->seconds, o->rms, o->p99, o->largest);
  if (package > 0) printf("   %5.1f times", package / o->seconds);
  puts("");
}

/* Against the package at one angle: the largest alpha whose 99th percentile and largest error are no larger. */
static void against(const sphere *s, double angle, double package, const double *exact, size_t stride) {
  static const double alphas[] = {0.1, 0.05, 0.02, 0.01, 0.005, 0.002};
  outcome theirs = package_errors(s, angle, exact, stride);
  char name[64];
  theirs.seconds = package;
  snprintf(name, sizeof name, "package, angle %g (scaled)", angle);
  print_tree(name, &theirs, 0);
  for (size_t k = 0; k < sizeof alphas / sizeof *alphas; k++) {
    setting how = {"tree", "alpha", alphas[k], 1};
    outcome ours = measure(s, &how, s->n < 20000 ? 10 * REPEATS : REPEATS, exact, stride);
    snprintf(name, sizeof name, "tree, alpha %g", alphas[k]);
    if (!(ours.p99 <= theirs.p99 && ours.largest <= theirs.largest)) continue;
    print_tree(name, &ours, package);
    return;
  }
  puts("  no alpha has errors as small");
}

static void trees(size_t n, double scale, double half, double wide) {
  sphere s = sphere_of(n);
  size_t stride = n / SAMPLES + 1;
  double *exact = memory(3 * n, sizeof *exact);
  for (size_t i = 0; i < n; i += stride) plain_pull(&s, i, exact + 3 * i);
  printf("%zu bodies, one thread: s for forces; errors RMS, 99th percentile, largest, of every %zuth body\n", n,
         stride);
  against(&s, 0.5, half * scale, exact, stride);
  against(&s, 0.7, wide * scale, exact, stride);
  setting usual = {"tree", NULL, 0, 1};
  outcome o = measure(&s, &usual, REPEATS, exact, stride);
  print_tree("tree, as it comes", &o, 0);
  free(exact);
  free_sphere(&s);
}

/* What alpha buys: its errors, and the time that they take. */
static void ladder(size_t n) {
  static const double alphas[] = {0.2, 0.1, 0.05, 0.02, 0.01, 5e-3, 2e-3, 1e-3, 1e-4, 1e-5};
  sphere s = sphere_of(n);
  size_t stride = n / SAMPLES + 1;
  double *exact = memory(3 * n, sizeof *exact);
  for (size_t i = 0; i < n; i += stride) plain_pull(&s, i, exact + 3 * i);
  printf("%zu bodies, one thread: time against error over alpha\n", n);
  for (size_t k = 0; k < sizeof alphas / sizeof *alphas; k++) {
    char name[64];
    setting how = {"tree", "alpha", alphas[k], 1};
    outcome o = measure(&s, &how, 10 * REPEATS, exact, stride);
    snprintf(name, sizeof name, "alpha %g", alphas[k]);
    print_tree(name, &o, 0);
  }
  free(exact);
  free_sphere(&s);
}

static void direct(size_t n) {
  sphere s = sphere_of(n);
  setting how = {"direct", NULL, 0, 1};
  outcome o = measure(&s, &how, 10 * REPEATS, NULL, 1);
  printf("  %zu bodies: %.4f s, %.3f ns per ordered pair\n", n, o.seconds, 1e9 * o.seconds / ((double)n * (double)n));
  free_sphere(&s);
}

static void growth(size_t most) {
  puts("growth, one thread: s for forces, us per body and per body and log2 n, the process's memory");
  for (size_t n = 1000; n <= most; n *= 10) {
    sphere s = sphere_of(n);
    setting tree = {"tree", NULL, 0, 1};
    outcome o = measure(&s, &tree, n < 1000000 ? REPEATS : 2, NULL, 1);
    printf("  %8zu bodies %9.4f s  %7.3f us  %7.4f us  %6.2f GB\n", n, o.seconds, 1e6 * o.seconds / (double)n,
           1e6 * o.seconds / (double)n / log2((double)n), o.resident);
    free_sphere(&s);
  }
}

static void threads(void) {
  sphere s = sphere_of(20000);
  const char *methods[] = {"direct", "tree"};
  for (int m = 0; m < 2; m++) {
    double best[2] = {INFINITY, INFINITY};
    for (int r = 0; r < 3; r++)
      for (int t = 0; t < 2; t++) {
        setting how = {methods[m], NULL, 0, t + 1};
        best[t] = fmin(best[t], measure(&s, &how, 3, NULL, 1).seconds);
      }
    printf("  %-6s 20000 bodies: %.4f s with one thread, %.4f s with two: %.2f times\n", methods[m], best[0], best[1],
           best[0] / best[1]);
  }
  free_sphere(&s);
}

int main(int count, char **argument) {
  setvbuf(stdout, NULL, _IOLBF, 0); /* minutes: whoever waits sees how far it is */
  double plain = plain_time(), scale = plain * 1e8 / package_direct;
  printf("plain loop: %.3f ns per ordered pair; the package's times are scaled by %.2f\n", 1e9 * plain, scale);
  const hk_gravity_path *paths[] = {hk_gravity_path_of(2), hk_gravity_path_of(4), hk_gravity_path_of(8)};
  for (int p = 0; p < 3 && 2 << p <= hk_processor_lanes(); p++)
    for (int soft = 0; soft < 2; soft++) kernel(paths[p], soft ? softening * softening : 0);
  puts("method direct in a scene, one thread");
  direct(10000);
  puts("threads, wall time");
  threads();
  ladder(10000);
  trees(10000, scale, 0.165, 0.077);
  trees(100000, scale, 3.5, 2.0);
  growth(count > 1 ? strtoul(argument[1], NULL, 10) : 1000000);
  return 0;
}
