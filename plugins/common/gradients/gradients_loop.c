/* See gradients_loop.h. */
#include "plugins/common/gradients/gradients_loop.h"

typedef struct task {
  hk_gradients_loop *s;
  double factor;
} task;

static double larger(double a, double b) { return a > b ? a : b; }

/* x += a p, r -= a q; the chunk's part of the size of r. */
static void advance(void *context, size_t begin, size_t end, size_t chunk) {
  const task *t = context;
  double *restrict x = t->s->x, *restrict r = t->s->r, sum[4] = {0}, most[4] = {0};
  const double *restrict p = t->s->p, *restrict q = t->s->q;
  size_t k = begin;
  for (; k + 4 <= end; k += 4)
    for (size_t c = 0; c < 4; c++) {
      x[k + c] += t->factor * p[k + c];
      r[k + c] -= t->factor * q[k + c];
      sum[c] += r[k + c] * r[k + c];
      most[c] = larger(fabs(r[k + c]), most[c]);
    }
  for (; k < end; k++) {
    x[k] += t->factor * p[k];
    r[k] -= t->factor * q[k];
    sum[0] += r[k] * r[k];
    most[0] = larger(fabs(r[k]), most[0]);
  }
  t->s->part[chunk].squares = (sum[0] + sum[1]) + (sum[2] + sum[3]);
  t->s->part[chunk].largest = larger(larger(most[0], most[1]), larger(most[2], most[3]));
}

/* p = z + factor p */
static void update_direction(void *context, size_t begin, size_t end, size_t chunk) {
  const task *t = context;
  const double *restrict z = t->s->z;
  double *restrict p = t->s->p;
  (void)chunk;
  for (size_t k = begin; k < end; k++) p[k] = z[k] + t->factor * p[k];
}

static void next_direction(hk_gradients_loop *s, double factor) {
  task t = {s, factor};
  s->host->parallel_for(s->host, s->unknowns, HK_GRADIENTS_CHUNK, update_direction, &t);
}

static void step_along(hk_gradients_loop *s, double factor) {
  task t = {s, factor};
  s->host->parallel_for(s->host, s->unknowns, HK_GRADIENTS_CHUNK, advance, &t);
  s->left = (hk_residual){0, 0};
  for (size_t k = 0; k < hk_gradients_chunks(s->unknowns); k++) {
    s->left.squares += s->part[k].squares;
    s->left.largest = larger(s->part[k].largest, s->left.largest);
  }
}

/* False also where the sum of squares is not finite, of which the largest number knows nothing. */
static bool reached(const hk_residual *left, const hk_residual *goal) {
  return left->squares <= goal->squares && left->largest <= goal->largest;
}

bool hk_gradients_iterate(hk_gradients_loop *s, const hk_residual *goal, int limit) {
  double rz = s->precondition(s->context, s->r, s->z);
  next_direction(s, 0);
  while (s->iterations < limit) {
    s->curvature = s->product(s->context, s->p, s->q);
    if (!(s->curvature > 0) || !isfinite(rz)) return false;
    ++s->iterations;
    step_along(s, rz / s->curvature);
    if (reached(&s->left, goal)) break;
    double next = s->precondition(s->context, s->r, s->z);
    next_direction(s, next / rz);
    rz = next;
  }
  return true;
}
