/* The Hessian of the barrier energy of one pair, m E of barrier_pair.h, in a form that gives its blocks. */
#ifndef HK_BARRIER_HESSIAN_H
#define HK_BARRIER_HESSIAN_H

#include "plugins/common/barrier/barrier_pair.h"
#include "plugins/common/collision/distance_form.h"

/* What the mollifier adds, for a pair of edges u = x1 - x0 and v = x3 - x2. */
typedef struct hk_barrier_turn {
  double gradient[2][3]; /* of m, by u and v, 1/m */
  double force[3];       /* 2 E' d, N: the gradient of E by x_i is w_i times that */
  double M[3][9];        /* E times the Hessian of m, by uu, uv and vv */
} hk_barrier_turn;

typedef struct hk_barrier_hessian {
  hk_distance_form form;
  bool turns;
  hk_barrier_turn turn; /* not set where `turns` is false */
} hk_barrier_hessian;

/* Of the value at x. `definite`: of it what the mollifier does not change, projected. */
void hk_barrier_hessian_of(const hk_barrier_pair *, const hk_barrier_value *, const double *x, bool definite,
                           hk_barrier_hessian *);
/* Adds what the mollifier adds. */
void hk_barrier_turn_row(const hk_barrier_hessian *, int i, const size_t slot[4], double *B);

/* Adds the blocks of point i and each of the four to B + 9 slot[j]. */
INLINE void hk_barrier_hessian_row(const hk_barrier_hessian *h, int i, const size_t slot[4], double *B) {
  hk_distance_form_row(&h->form, i, slot, B);
  if (h->turns) hk_barrier_turn_row(h, i, slot, B);
}

#endif
