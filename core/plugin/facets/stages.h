/* Facet of methods with a fixed step, and of linear ones: the step as linear combinations of accelerations, by which
 * the host differentiates it (core/numerics/sensitivity). In a step of h, from x and v at t, stage k has the
 * acceleration
 *     a_k = a(t + c_k h,  x + c_k h v + h^2 sum_{j<=k} x_kj a_j,  v + h sum_{j<=k} v_kj a_j),
 * where x_kk and v_kk are 0 in explicit stages, and the host solves the equation of the others, and the step ends at x
 * + h v + h^2 sum_j X_j a_j and v + h sum_j V_j a_j (Nystroem 1925; Hairer, Norsett and Wanner, Solving ODEs I, II.14).
 * A Runge-Kutta method with the matrix A and the weights b has v_kj = A, x_kj = A A, V = b and X = b A. */
#ifndef HK_PLUGIN_STAGES_H
#define HK_PLUGIN_STAGES_H

#include "core/plugin/integrator.h"

#define HK_STAGES_ID "stages/1"
#define HK_STAGES_FACET(...) HK_FACET(HK_STAGES_ID, hk_stages_facet, __VA_ARGS__)

enum { HK_MOST_STAGES = 4 };

/* How a method with `linear` took a step. By `start`: its first stage has the acceleration that the step before ended
 * with; or it was evaluated, in the first step and in the first one after `reset`. */
typedef enum hk_linear_step { HK_STEP_LINEAR, HK_STEP_OF_START, HK_STEP_AFRESH } hk_linear_step;

typedef struct hk_stages_facet hk_stages_facet;
struct hk_stages_facet {
  size_t size;
  size_t count; /* of stages, 1 to HK_MOST_STAGES */
  /* The first stage has the acceleration of the last stage of the step before, unless there is none or `reset` has been
   * called since. */
  bool carries;
  double c[HK_MOST_STAGES];
  double x[HK_MOST_STAGES][HK_MOST_STAGES], v[HK_MOST_STAGES][HK_MOST_STAGES]; /* up to the diagonal */
  double x_end[HK_MOST_STAGES], v_end[HK_MOST_STAGES];                         /* X and V. Required. */
  /* Of a method of two steps, otherwise 0: in place of x and v the step goes from x* = x + back (x - x_before) and v*
   * likewise, at the begin of the step before; as these are where the motion is at t + back h, to first order, c_k -
   * back stands for c_k in the point, and x* + (1 - back) h v* for x + h v in the step's end. */
  double back;
  const hk_stages_facet *start; /* required with `back`: of a step without one before, or after one of another length */
  /* Of a method of two steps that solves one linear system in place of a step's equation, and may choose its steps;
   * NULL otherwise. With the ratio q of the step to that before, g = h (1 + q)/(1 + 2 q), X* = X + q^2/(1 + 2 q) (X -
   * X_before), and K and D at x^ = x* + g v and v, a linear step is
   *     (M + g D + g^2 K) dv = M (v* - v + g a(t + h, x^, v)),  v' = v + dv,  x' = x* + g v',
   * without unsymmetric terms where the scene's solver is one for symmetric matrices. Where the step before was linear,
   * hk_linear_table.linearised is its x^ and `reached` is x. Where the factorization fails, that with HK_WANT_DEFINITE
   * gives dv, and then once more the correction of it by its residual in the matrix that failed. After a linear step
   * `start` goes on with the acceleration (v' - v*)/g. What is above describes equal steps. Says how the last step was
   * taken. */
  hk_linear_step (*linear)(const void *self);
};

#endif
