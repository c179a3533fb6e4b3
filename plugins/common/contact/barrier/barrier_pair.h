/* The barrier energy of one pair of features, a point and a triangle or two edges (geometry/distance.h). With their
 * distance d, the sum xi of their radii and the distance D beyond it at which the barrier begins, it is
 *     E = kappa A D m b(u),   u = (d^2 - xi^2)/((D + xi)^2 - xi^2),
 * Li, Kaufman and Jiang 2021 (Codimensional Incremental Potential Contact, equation 6), scaled as by Li and others 2023
 * (Convergent Incremental Potential Contact): kappa is a pressure, and A the area that the pair stands for, so that the
 * pressure between two surfaces at a given gap does not depend on how finely they are divided. m is the mollifier of
 * nearly parallel edges (distance.h). */
#ifndef HK_BARRIER_PAIR_H
#define HK_BARRIER_PAIR_H

#include "plugins/common/contact/geometry/distance_form.h"
#include "plugins/common/contact/surfaces/surfaces.h"

typedef struct hk_barrier_pair {
  hk_feature_pair pair; /* its gap: at the start of the present move */
  double area;          /* m^2 */
  double limit;         /* m^4, of the mollifier; 0: none */
  double least;         /* m: on that move the gap is nowhere less, where this is above 0 */
  double axis[3];       /* unit vector between the nearest points at the start of the present move; 0: not known */
  uint32_t name;        /* its position among the pairs that have blocks; UINT32_MAX: it has none */
} hk_barrier_pair;

/* What the energy of a pair needs. */
typedef struct hk_barrier_law {
  double stiffness; /* kappa, Pa */
  double distance;  /* D, m */
} hk_barrier_law;

typedef struct hk_barrier_value {
  hk_nearest nearest;
  double gap;    /* m */
  double E, E1;  /* J, J/m^2: the energy without m, and its derivative by d^2; 0 from D on, E infinite at gap <= 0 */
  double E2;     /* J/m^4 */
  double m;      /* the mollifier */
  uint32_t near; /* the position of the pair in a list of some, where the caller says so */
} hk_barrier_value;

/* Whether `axis` shows that the pair is farther apart than D. */
bool hk_barrier_is_apart(const hk_barrier_pair *, const hk_barrier_law *, const double *x);
/* False: the pair is farther apart than D, and only `nearest` and gap are set. */
bool hk_barrier_evaluate(const hk_barrier_pair *, const hk_barrier_law *, const double *x, hk_barrier_value *);
/* Of the value at x: the gradient of m E, J/m. */
void hk_barrier_gradient(const hk_barrier_pair *, const hk_barrier_value *, const double *x, double g[12]);
/* N, the size of the force with which the two features push each other. */
double hk_barrier_load(const hk_barrier_value *);

/* ---- the Hessian of m E, in a form that gives its blocks ---- */

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
HK_INLINE void hk_barrier_hessian_row(const hk_barrier_hessian *h, int i, const size_t slot[4], double *B) {
  hk_distance_form_row(&h->form, i, slot, B);
  if (h->turns) hk_barrier_turn_row(h, i, slot, B);
}

#endif
