/* Where within a step a one-sided equation is met. A stage of a method knows no equation that was not met with equality
 * at the start of the step, so its stages are those of a smooth motion; an impact that is left to the end of the step
 * comes late by a part of it, which is an error of order 1 whatever the order of the method (Hairer, Norsett and
 * Wanner, Solving ODEs I, II.6: discontinuities). So the loop takes such a step back, takes the part up to the impact
 * and then the rest.
 *
 * The instant is found on the cubic that has g and dg/dt of both ends of the step, whose error is of the fourth order
 * in the step. Of methods up to order 3 that is enough: where the part ends the equation is met, and the projection
 * brings it to g = 0. Of others the part is taken and looked at again: near its ends the cubic is right to the square
 * of the distance, so that g at the end of the part is 0 to rounding after two or three parts. A cubic also has the two
 * roots of a particle that meets and leaves again within one step. */

#include "core/numerics/constraints/constraints.h"

#include <float.h>
#include <string.h>

enum { BISECTIONS = 60, ENOUGH = 3 };

static const double same = 1e-9; /* times and roots, in parts of a step */

/* g of a step from s = 0 to s = 1, by its values and slopes there: g(0) + s (a + s (b + s c)). */
typedef struct cubic {
  double first, a, b, c;
} cubic;

static cubic through(double g0, double slope0, double g1, double slope1) {
  return (cubic){g0, slope0, 3 * (g1 - g0) - 2 * slope0 - slope1, 2 * (g0 - g1) + slope0 + slope1};
}

static double at(const cubic *q, double s) { return q->first + s * (q->a + s * (q->b + s * q->c)); }

/* Where its slope vanishes in (0, 1), rising, and 1. */
static size_t pieces(const cubic *q, double end[3]) {
  size_t count = 0;
  double root = q->b * q->b - 3 * q->a * q->c;
  if (root > 0) {
    /* of a + 2 b s + 3 c s^2, without cancellation */
    double sum = -(q->b + copysign(sqrt(root), q->b)), one = q->a / sum, other = sum / (3 * q->c);
    double low = fmin(one, other), high = fmax(one, other);
    if (low > 0 && low < 1) end[count++] = low;
    if (high > 0 && high < 1) end[count++] = high;
  }
  end[count++] = 1;
  return count;
}

/* The first s at which it has fallen to 0, of a cubic that falls below -tolerance in (0, 1]; 1: it does not. */
static double first_root(const cubic *q, double tolerance) {
  double end[3], low = 0;
  size_t count = pieces(q, end);
  for (size_t k = 0; k < count; low = end[k++]) {
    double high = end[k];
    if (!(at(q, high) < -tolerance)) continue;
    for (int i = 0; i < BISECTIONS; i++) {
      double middle = low + (high - low) / 2;
      *(at(q, middle) > 0 ? &low : &high) = middle;
    }
    return low;
  }
  return 1;
}

void hk_constraint_note_start(hk_constraints *c) {
  memcpy(c->g_start, c->g, c->equations * sizeof *c->g);
  memcpy(c->rate_start, c->residual, c->equations * sizeof *c->rate_start);
}

/* The root of equation k in the step, in parts of it; 1: it is not looked at, or has none. */
static double root_of(const hk_constraints *c, size_t k, double h, double tolerance) {
  if (!c->one_sided[k] || c->touches[k] || c->full[k] == 0 || !(c->g_start[k] > 0)) return 1;
  if (c->meets && c->met[k]) return 1;
  cubic q = through(c->g_start[k], h * c->rate_start[k], c->g[k], h * c->residual[k]);
  return first_root(&q, tolerance);
}

/* The first root; those at it are met there. */
static double first_of(hk_constraints *c, double h, double tolerance) {
  double part = 1;
  for (size_t k = 0; k < c->equations; k++) {
    c->rhs[k] = root_of(c, k, h, tolerance);
    part = fmin(part, c->rhs[k]);
  }
  for (size_t k = 0; k < c->equations && part < 1; k++) c->met[k] = c->rhs[k] <= part + same;
  return part;
}

hk_status hk_constraints_impact(hk_dynamics *d, double t, double *x, double *v, double h, double *part) {
  hk_constraints *c = d->constraints;
  *part = 1;
  if (c->one_sided_count == 0) return HK_OK;
  hk_status status = d->has_timed && t != d->timed_at ? hk_dynamics_impose(d, t, x, v) : HK_OK;
  if (status == HK_OK) status = hk_constraint_value(d, t, x, v);
  if (status == HK_OK) status = hk_constraint_matrix_linearise(d, t, x, v);
  if (status == HK_OK) status = hk_constraint_speed(d, t, x, v);
  if (status != HK_OK) return status;
  double tolerance = hk_constraint_met * hk_constraint_extent(c, x);
  hk_constraint_rate(c, v, c->residual, NULL);
  c->meets = hk_constraint_order(d) <= ENOUGH && fabs(t - c->met_at) <= same * h + 4 * DBL_EPSILON * fabs(t);
  *part = first_of(c, h, tolerance);
  c->meets &= *part == 1;
  if (*part < 1) c->met_at = t - h + *part * h;
  return hk_constraints_release(d, t, x, v, h, part);
}
