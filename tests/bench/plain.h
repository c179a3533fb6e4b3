/* The reference cloths for comparisons with other programs: hooke's scene, and the same numbers in plain C as who
 * writes such a program by hand would lay them out, with the forces as a plain scalar loop. Times are the thread's own.
 */
#ifndef HK_BENCH_PLAIN_H
#define HK_BENCH_PLAIN_H

#include "core/numerics/step_choice/step_choice.h"
#include "tests/bench/cloth.h"

#include <string.h>

typedef struct spring {
  uint32_t i, j;
  double k, c, L;
} spring;

typedef struct plain {
  size_t n, count;
  spring *springs;
  double *start; /* x and v, n x 3 each */
  double *w;     /* n, 1/kg; 0: pinned */
  double limit;  /* s, leapfrog's largest stable step, as hooke estimates it */
} plain;

/* s, the thread's own: others on the machine disturb it less. */
static inline double own(void) {
  struct timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Zeroed, and aligned as hooke's vectors are. */
static inline void *memory(size_t count, size_t size) {
  enum { LINE = 64 };
  size_t bytes = (count * size / LINE + 1) * LINE;
  void *p = aligned_alloc(LINE, bytes);
  if (p) return memset(p, 0, bytes);
  fprintf(stderr, "no memory for %zu numbers: close other programs\n", count);
  exit(1);
}

/* hang(N), or curtain(N): with the whole upper row pinned. Without frames on the way. */
static inline void open_reference(test_engine *e, uint32_t N, bool curtain, double end) {
  open_cloth(e, N, 1000);
  for (uint32_t i = 2; curtain && i < N; i++) test_pin(e, HK_PIN_FIXED, N * (N - 1) + i, NULL);
  e->scene->fps = 1 / end;
  e->options.until = end;
}

/* Masses, springs and start of a scene that runs with leapfrog. */
static inline plain plain_of(const test_engine *e) {
  const hk_system *s = &e->run->dynamics.system;
  plain p = {.n = s->n, .limit = e->run->step->dt_limit};
  p.start = memory(6 * s->n, sizeof *p.start);
  p.w = memory(s->n, sizeof *p.w);
  memcpy(p.start, s->X, 6 * s->n * sizeof *p.start);
  memcpy(p.w, s->model->inverse_mass, s->n * sizeof *p.w);
  for (size_t l = 0; l < s->model->element_lists; l++) p.count += s->model->element_list[l].elements.node.count;
  p.springs = memory(p.count, sizeof *p.springs);
  spring *next = p.springs;
  for (size_t l = 0; l < s->model->element_lists; l++) {
    const hk_elements *E = &s->model->element_list[l].elements;
    for (size_t q = 0; q < E->node.count; q++)
      *next++ = (spring){hk_tuple(&E->node, q)[0], hk_tuple(&E->node, q)[1], hk_tuple_value(&E->stiffness, q),
                         hk_tuple_value(&E->damping, q), hk_tuple_value(&E->rest, q)};
  }
  return p;
}

static inline void plain_free(plain *p) {
  free(p->springs);
  free(p->start);
  free(p->w);
}

/* a = F/m. Of five ways to write a spring's factor this is the fastest: root and division do not wait for each other.
 */
static inline void plain_accelerations(const plain *p, const double *restrict x, const double *restrict v,
                                       double *restrict a) {
  memset(a, 0, 3 * p->n * sizeof *a);
  for (const spring *s = p->springs, *end = s + p->count; s < end; s++) {
    const size_t i = 3 * (size_t)s->i, j = 3 * (size_t)s->j;
    double dx = x[j] - x[i], dy = x[j + 1] - x[i + 1], dz = x[j + 2] - x[i + 2];
    double u = dx * (v[j] - v[i]) + dy * (v[j + 1] - v[i + 1]) + dz * (v[j + 2] - v[i + 2]);
    double l2 = dx * dx + dy * dy + dz * dz, l = sqrt(l2), r = 1 / l2, f = s->k * (l - s->L) * l * r + s->c * u * r;
    a[i] += f * dx, a[i + 1] += f * dy, a[i + 2] += f * dz;
    a[j] -= f * dx, a[j + 1] -= f * dy, a[j + 2] -= f * dz;
  }
  for (size_t i = 0; i < p->n; i++) {
    bool moves = p->w[i] > 0;
    for (size_t c = 3 * i; c < 3 * i + 3; c++) a[c] = moves ? a[c] * p->w[i] - 0.02 * v[c] : 0;
    if (moves) a[3 * i + 2] -= 9.81;
  }
}

/* m, root of the mean square distance. */
static inline double rms(const double *a, const double *b, size_t n) {
  double sum = 0;
  for (size_t e = 0; e < 3 * n; e++) sum += (a[e] - b[e]) * (a[e] - b[e]);
  return sqrt(sum / (double)n);
}

#endif
