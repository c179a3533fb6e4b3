/* A step is linear in all that it hands on: X and the fields. The matrix of one step, or of as many as it takes until
 * counters such as a ring's position come round, is read off, and its spectral radius follows from powers of it by
 * repeated squaring. Nothing is judged by watching for a blow-up. */
#include "core/engine/base/base.h"
#include "core/engine/contract/contract.h"
#include "core/plugin/widest.h"
#include "tests/support/step_matrix.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

enum { MOST = 400, WARM = 16, ROUND = 12, SQUARINGS = 45 };

typedef struct matrix {
  size_t n;
  double *value;
} matrix;

static double largest(const matrix *m) {
  double most = 0;
  for (size_t e = 0; e < m->n * m->n; e++) {
    double size = fabs(m->value[e]);
    if (size > most) most = size;
  }
  return most;
}

/* Nearly all of the time of a growth is spent in one loop, on numbers that sanitizers need not watch one by one. */
#define UNWATCHED __attribute__((no_sanitize("address", "undefined")))

/* out = m m, n x n; the terms of a sum in the order of m's columns, four at a time, so that it stays in its register.
 */
HK_INLINE UNWATCHED void multiply_each(const double *restrict m, size_t n, double *restrict out) {
  for (size_t i = 0; i < n; i++) {
    const double *restrict factor = m + n * i;
    double *restrict row = out + n * i;
    size_t l = 0;
    for (size_t j = 0; j < n; j++) row[j] = 0;
    for (; l + 4 <= n; l += 4) {
      const double *restrict p = m + n * l;
      double a = factor[l], b = factor[l + 1], c = factor[l + 2], d = factor[l + 3];
      for (size_t j = 0; j < n; j++) row[j] = row[j] + a * p[j] + b * p[n + j] + c * p[2 * n + j] + d * p[3 * n + j];
    }
    for (; l < n; l++)
      for (size_t j = 0; j < n; j++) row[j] += factor[l] * m[n * l + j];
  }
}

HK_VERSIONS(UNWATCHED static void, multiply, (const double *m, size_t n, double *out), multiply_each(m, n, out))

/* M = M M / |M|^2, |M| being the largest entry, which is returned. */
static double square(matrix *m, double *scratch, int lanes) {
  size_t n = m->n;
  double most = largest(m);
  if (!(most > 0)) return most;
  for (size_t e = 0; e < n * n; e++) m->value[e] /= most;
  HK_WIDEST(lanes, multiply)(m->value, n, scratch);
  memcpy(m->value, scratch, n * n * sizeof *scratch);
  return most;
}

static double trace(const matrix *m) {
  double sum = 0;
  for (size_t i = 0; i < m->n; i++) sum += m->value[i * m->n + i];
  return fabs(sum);
}

/* |M^N|^(1/N), N = 2^45; destroys M. With a `bound` above 0 the power N is as small as tells on which side of it the
 * radius is, which is at most (n |M^N|)^(1/N) and at least (|tr M^N|/n)^(1/N); that number is then returned. */
static double radius(matrix *m, double bound) {
  double *scratch = malloc(m->n * m->n * sizeof *scratch), logarithm = 0, weight = 1, n = (double)m->n, sure = 0;
  assert_non_null(scratch);
  for (int k = 0; k < SQUARINGS && sure == 0; k++) {
    double most = square(m, scratch, hk_processor_lanes());
    if (!(most > 0)) break;
    logarithm += weight * log(most);
    weight /= 2;
    double high = logarithm + weight * log(n * largest(m)), low = logarithm + weight * log(trace(m) / n);
    if (bound > 0 && exp(high) < bound) sure = exp(high);
    if (bound > 0 && exp(low) > bound) sure = exp(low);
  }
  free(scratch);
  return sure > 0 ? sure : exp(logarithm);
}

static void go(fake_method *m, size_t steps) {
  for (size_t i = 0; i < steps; i++)
    if (fake_method_step(m, 1, NULL) != HK_OK) fail_msg("%s: %s", m->plugin->name, m->system->message);
}

static bool integers_match(const fake_method *m, const char *saved) {
  for (const hk_field *field = m->plugin->fields; field && field->name; field++) {
    if (field->integer && memcmp(hk_field_in(field, m->self), saved, 8) != 0) return false;
    if (field->integer || field->number) saved += 8;
  }
  return true;
}

/* The motion is linear: its size does not matter, and shall not become infinite. */
static void normalise(double *const *address, size_t count) {
  double largest = 0;
  for (size_t e = 0; e < count; e++) largest = fmax(largest, fabs(*address[e]));
  for (size_t e = 0; e < count && largest > 1e6; e++) *address[e] /= largest;
}

/* Whether it is a number that a method keeps for a particle beside the motion, such as a place in an order. */
static bool is_of_a_particle(const fake_method *m, const double *address) {
  for (const hk_field *field = m->plugin->fields; field && field->name; field++) {
    if (!field->per_particle) continue;
    const double *first = *(double **)hk_field_in(field, m->self);
    if (address >= first && address < first + m->system->system.n * field->width) return true;
  }
  return false;
}

/* Keeps the addresses that the motion reaches: the other components stay 0, or are a particle's and constant. Returns
 * how many. */
static size_t reached(fake_method *m, double **address, size_t count) {
  bool *alive = calloc(count, sizeof *alive);
  double *first = malloc((count + 1) * sizeof *first);
  size_t kept = 0;
  assert_true(alive && first);
  for (int i = 0; i < WARM; i++) {
    go(m, 1);
    for (size_t e = 0; e < count; e++) {
      if (i == 0) first[e] = *address[e];
      alive[e] |= *address[e] != 0 && !(*address[e] == first[e] && is_of_a_particle(m, address[e]));
    }
    normalise(address, count);
  }
  free(first);
  for (size_t e = 0; e < count; e++)
    if (alive[e]) address[kept++] = address[e];
  free(alive);
  return kept;
}

/* Returns the number of steps that the matrix is of. */
static size_t read_matrix(fake_method *m, matrix *into) {
  char saved[256];
  double *address[MOST];
  size_t round = 0, count = fake_method_memory(m, address, MOST), n = reached(m, address, count);
  assert_true(count < MOST);
  assert_true(fake_method_save(m, saved) <= sizeof saved);
  do {
    go(m, 1);
    round++;
  } while (!integers_match(m, saved) && round < ROUND);
  assert_true(integers_match(m, saved));
  *into = (matrix){n, malloc(n * n * sizeof(double))};
  assert_non_null(into->value);
  for (size_t j = 0; j < n; j++) {
    fake_method_load(m, saved);
    for (size_t e = 0; e < n; e++) *address[e] = e == j;
    go(m, round);
    for (size_t e = 0; e < n; e++) into->value[n * e + j] = *address[e];
  }
  return round;
}

double step_growth(fake_method *m) {
  matrix M;
  double round = (double)read_matrix(m, &M), growth = pow(radius(&M, 0), 1 / round);
  free(M.value);
  return growth;
}

bool step_growth_exceeds(fake_method *m, double bound) {
  matrix M;
  double round = (double)read_matrix(m, &M), level = pow(bound, round);
  bool exceeds = radius(&M, level) > level;
  free(M.value);
  return exceeds;
}
