/* Splitting methods for x'' = F(x, t), as integrators: kicks v += b_i h F and drifts x += a_i h v alternate,
 *     b_1 a_1 b_2 a_2 ... a_s b_(s+1),
 * the drifts advance the time. The list is the same from both ends, so a method is symmetric, and symplectic. The last
 * kick of a step and the first of the next have the same x and use the same evaluation: a step takes s of them.
 *
 * Evaluations get v and the channels y in the middle of the kick, predicted with the rates of the kick before. This
 * gives order 2 for drag, for power and for channel rates that depend on v or y, without further evaluations. Channels
 * whose rates depend on x and t alone are advanced by kicks like v and have the method's order.
 * Hairer, Lubich and Wanner, Geometric Numerical Integration, II.5 and V.3.
 *
 * With constraints that are all equalities a step is a composition of steps of RATTLE, of lengths g_i h
 * (plugins/kit/integrate/rattle.h), of the method's order: g = 0 and J v = 0 hold after each of them, and none of the
 * forces of constraints, which depend on v, is ever evaluated with a predicted one. With one-sided constraints it is
 * the list above, of order 2. */
#ifndef HK_SPLITTING_H
#define HK_SPLITTING_H

#include "core/plugin.h"

enum { HK_SPLITTING_STAGES = 17 }; /* at most */

typedef struct hk_splitting_method {
  int stages;
  double kick[HK_SPLITTING_STAGES + 1], drift[HK_SPLITTING_STAGES]; /* b and a, each with the sum 1 */
  int parts;                        /* an odd number, of steps of RATTLE that a step with constraints is made of */
  double part[HK_SPLITTING_STAGES]; /* their g, with the sum 1, the same from both ends */
} hk_splitting_method;

/* Leapfrog steps of the lengths g_i h, one after the other: drifts g_i, kicks (g_(i-1) + g_i)/2. G1 to G9 are the first
 * half of the list and its middle; the other half is the first one backwards. */
#define HK_COMPOSED_17(G1, G2, G3, G4, G5, G6, G7, G8, G9)                                                             \
  {                                                                                                                    \
    17, {(G1) / 2,          ((G1) + (G2)) / 2, ((G2) + (G3)) / 2, ((G3) + (G4)) / 2, ((G4) + (G5)) / 2,                \
         ((G5) + (G6)) / 2, ((G6) + (G7)) / 2, ((G7) + (G8)) / 2, ((G8) + (G9)) / 2, ((G8) + (G9)) / 2,                \
         ((G7) + (G8)) / 2, ((G6) + (G7)) / 2, ((G5) + (G6)) / 2, ((G4) + (G5)) / 2, ((G3) + (G4)) / 2,                \
         ((G2) + (G3)) / 2, ((G1) + (G2)) / 2, (G1) / 2},                                                              \
        {G1, G2, G3, G4, G5, G6, G7, G8, G9, G8, G7, G6, G5, G4, G3, G2, G1}, 17,                                      \
        {G1, G2, G3, G4, G5, G6, G7, G8, G9, G8, G7, G6, G5, G4, G3, G2, G1},                                          \
  }

typedef struct hk_splitting {
  int64_t primed; /* whether `slope` is that of X */
  double *slope;  /* (a, dy) of the last kick */
  double *seen;   /* shaped as X: predicted v and y for the next evaluation; with constraints, every second state */
  double *low;    /* n x 3, m: with constraints, what rounding has taken of the positions (rattle.h) */
} hk_splitting;

extern const hk_field hk_splitting_fields[]; /* of instances that are hk_splitting */
extern const hk_facet hk_splitting_facets[];

/* Members of an hk_integrator whose instance is an hk_splitting and whose `method` an hk_splitting_method. The growth
 * is also that of a method with another step, which evaluates nothing where a kick has no length. */
hk_status hk_splitting_step(void *self, const void *method, hk_system *s, double t_stop, double h, hk_step *out);
void hk_splitting_reset(void *self, hk_reason why);
double hk_splitting_growth(const void *self, const void *method, double hw, double hg, double hb);

#endif
