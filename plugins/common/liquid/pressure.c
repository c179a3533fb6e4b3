/* Conjugate gradients for the pressure. */
#include "plugins/common/liquid/pressure.h"

#include <string.h>

enum { PIECE = 4096, MOST_ITERATIONS = 2000 };

static const double modification = 0.97, safety = 0.25; /* Bridson 2015, figure 5.8 */

hk_status hk_pressure_open(hk_pressure *p, const hk_host *host, size_t most) {
  memset(p, 0, sizeof *p);
  p->host = host;
  p->most = most;
  double **numbers[] = {&p->diagonal, &p->side[0], &p->side[1], &p->side[2], &p->pivot, &p->b,
                        &p->x,        &p->r,       &p->z,       &p->s,       &p->q};
  uint32_t **lists[] = {&p->cell,     &p->next[0],  &p->next[1],  &p->next[2],
                        &p->prior[0], &p->prior[1], &p->prior[2], &p->part};
  bool all = (p->sums = host->allocate(host, (most / PIECE + 2) * sizeof(double))) != NULL;
  for (size_t k = 0; k < sizeof numbers / sizeof *numbers; k++)
    all &= (*numbers[k] = host->allocate(host, (most + 1) * sizeof(double))) != NULL;
  for (size_t k = 0; k < sizeof lists / sizeof *lists; k++)
    all &= (*lists[k] = host->allocate(host, (most + 1) * sizeof(uint32_t))) != NULL;
  if (all) return HK_OK;
  hk_pressure_close(p);
  return HK_NO_MEMORY;
}

void hk_pressure_close(hk_pressure *p) {
  if (!p->host) return;
  double *numbers[] = {p->diagonal, p->side[0], p->side[1], p->side[2], p->pivot, p->b,
                       p->x,        p->r,       p->z,       p->s,       p->q,     p->sums};
  uint32_t *lists[] = {p->cell, p->next[0], p->next[1], p->next[2], p->prior[0], p->prior[1], p->prior[2], p->part};
  for (size_t k = 0; k < sizeof numbers / sizeof *numbers; k++) p->host->release(p->host, numbers[k]);
  for (size_t k = 0; k < sizeof lists / sizeof *lists; k++) p->host->release(p->host, lists[k]);
  memset(p, 0, sizeof *p);
}

void hk_pressure_factorize(hk_pressure *p) {
  size_t none = p->rows;
  p->pivot[none] = p->x[none] = p->z[none] = p->s[none] = p->q[none] = p->r[none] = 0;
  for (int c = 0; c < 3; c++) p->side[c][none] = 0;
  for (size_t i = 0; i < p->rows; i++) {
    double e = p->diagonal[i];
    for (int c = 0; c < 3; c++) {
      size_t j = p->prior[c][i];
      double w = p->side[c][j] * p->pivot[j];
      double others = p->side[0][j] + p->side[1][j] + p->side[2][j] - p->side[c][j];
      e -= w * w + modification * w * others * p->pivot[j];
    }
    if (e < safety * p->diagonal[i]) e = p->diagonal[i];
    p->pivot[i] = e > 0 ? 1 / sqrt(e) : 0;
  }
}

/* z = M^-1 r. */
static void precondition(hk_pressure *p) {
  for (size_t i = 0; i < p->rows; i++) {
    double t = p->r[i];
    for (int c = 0; c < 3; c++) {
      size_t j = p->prior[c][i];
      t += p->side[c][j] * p->q[j];
    }
    p->q[i] = t * p->pivot[i] * p->pivot[i];
  }
  for (size_t i = p->rows; i-- > 0;) {
    double t = 0;
    for (int c = 0; c < 3; c++) t += p->side[c][i] * p->z[p->next[c][i]];
    p->z[i] = p->q[i] + t * p->pivot[i] * p->pivot[i];
  }
}

typedef struct task {
  hk_pressure *p;
  const double *in;
  double *out;
  double factor;
} task;

static double times(const hk_pressure *p, const double *in, size_t i) {
  double t = p->diagonal[i] * in[i];
  for (int c = 0; c < 3; c++) {
    size_t j = p->prior[c][i];
    t -= p->side[c][i] * in[p->next[c][i]] + p->side[c][j] * in[j];
  }
  return t;
}

/* out = A in; the sum is in.out. */
static void multiply_piece(void *context, size_t begin, size_t end, size_t piece) {
  const task *t = context;
  double sum = 0;
  for (size_t i = begin; i < end; i++) {
    t->out[i] = times(t->p, t->in, i);
    sum += t->in[i] * t->out[i];
  }
  t->p->sums[piece] = sum;
}

/* x += factor s, r -= factor q; the sum is the largest number of r. */
static void advance_piece(void *context, size_t begin, size_t end, size_t piece) {
  const task *t = context;
  hk_pressure *p = t->p;
  double most = 0;
  for (size_t i = begin; i < end; i++) {
    p->x[i] += t->factor * p->s[i];
    p->r[i] -= t->factor * t->in[i];
    most = fmax(most, fabs(p->r[i]));
  }
  p->sums[piece] = most;
}

static void dot_piece(void *context, size_t begin, size_t end, size_t piece) {
  const task *t = context;
  double sum = 0;
  for (size_t i = begin; i < end; i++) sum += t->p->r[i] * t->p->z[i];
  t->p->sums[piece] = sum;
}

static void turn_piece(void *context, size_t begin, size_t end, size_t piece) {
  const task *t = context;
  (void)piece;
  for (size_t i = begin; i < end; i++) t->p->s[i] = t->p->z[i] + t->factor * t->p->s[i];
}

typedef void (*piece_body)(void *, size_t, size_t, size_t);

static double total(hk_pressure *p, piece_body body, task *t) {
  p->host->parallel_for(p->host, p->rows, PIECE, body, t);
  double sum = 0;
  for (size_t k = 0; k * PIECE < p->rows; k++) sum += p->sums[k];
  return sum;
}

static double largest(hk_pressure *p, piece_body body, task *t) {
  p->host->parallel_for(p->host, p->rows, PIECE, body, t);
  double most = 0;
  for (size_t k = 0; k * PIECE < p->rows; k++) most = fmax(most, p->sums[k]);
  return most;
}

/* The row from which i is reached: `part` is a forest of links to rows that come before. */
static uint32_t root_of(uint32_t *part, uint32_t i) {
  while (part[i] != i) i = part[i] = part[part[i]];
  return i;
}

static void join_parts(hk_pressure *p) {
  for (size_t i = 0; i < p->rows; i++) {
    p->part[i] = (uint32_t)i;
    for (int c = 0; c < 3; c++) {
      size_t j = p->prior[c][i];
      if (j == p->rows || !(p->side[c][j] > 0)) continue;
      uint32_t a = root_of(p->part, (uint32_t)j), b = root_of(p->part, (uint32_t)i);
      p->part[a > b ? a : b] = a > b ? b : a;
    }
  }
  for (size_t i = 0; i < p->rows; i++) p->part[i] = p->part[p->part[i]];
}

/* Of a part without a surface the sum of b has to be zero. What its rows have on the diagonal beyond their neighbours
 * is its hold, z; s: sum of b; q: rows. */
static void take_means(hk_pressure *p) {
  join_parts(p);
  memset(p->z, 0, p->rows * sizeof(double));
  memset(p->s, 0, p->rows * sizeof(double));
  memset(p->q, 0, p->rows * sizeof(double));
  for (size_t i = 0; i < p->rows; i++) {
    uint32_t k = p->part[i];
    double hold = p->diagonal[i];
    for (int c = 0; c < 3; c++) hold -= p->side[c][i] + p->side[c][p->prior[c][i]];
    p->z[k] = fmax(p->z[k], hold / p->diagonal[i]);
    p->s[k] += p->b[i];
    p->q[k]++;
  }
  for (size_t i = 0; i < p->rows; i++) {
    uint32_t k = p->part[i];
    if (p->z[k] < 1e-9) p->b[i] -= p->s[k] / p->q[k];
  }
}

static double largest_of(const double *v, size_t rows) {
  double most = 0;
  for (size_t i = 0; i < rows; i++) most = fmax(most, fabs(v[i]));
  return most;
}

/* The residual of the first guess, which is dropped where it is worse than none. Returns its largest number. */
static double begin(hk_pressure *p) {
  for (size_t i = 0; i < p->rows; i++) p->r[i] = p->b[i] - times(p, p->x, i);
  double most = largest_of(p->r, p->rows), without = largest_of(p->b, p->rows);
  if (most < without) return most;
  memset(p->x, 0, p->rows * sizeof(double));
  memcpy(p->r, p->b, p->rows * sizeof(double));
  return without;
}

bool hk_pressure_solve(hk_pressure *p, double tolerance, double floor) {
  p->iterations = 0;
  if (p->rows == 0) return true;
  double bound = fmax(floor, tolerance * largest_of(p->b, p->rows));
  take_means(p);
  double most = begin(p);
  memset(p->s, 0, p->rows * sizeof(double));
  double before = 0;
  task t = {.p = p};
  while (most > bound && p->iterations < MOST_ITERATIONS) {
    precondition(p);
    double rz = total(p, dot_piece, &t);
    if (!(rz > 0)) return false;
    t.factor = p->iterations ? rz / before : 0;
    before = rz;
    p->host->parallel_for(p->host, p->rows, PIECE, turn_piece, &t);
    t.in = p->s;
    t.out = p->q;
    double sAs = total(p, multiply_piece, &t);
    if (!(sAs > 0)) return false;
    t.factor = rz / sAs;
    t.in = p->q;
    most = largest(p, advance_piece, &t);
    p->iterations++;
  }
  return most <= bound;
}
