#include "plugins/common/orbits/kepler.h"
#include "plugins/kit/vector3.h"

#include <float.h>

static const double two_pi = 6.283185307179586476925;

/* Series for |z| below 0.1, whose next terms are 1e-20 of the first, and c_k(4 z) from c_k(z). */
void hk_stumpff(double z, double c[4]) {
  static const double even[] = {1 / 2.0,       1 / 24.0,        1 / 720.0,        1 / 40320.0,
                                1 / 3628800.0, 1 / 479001600.0, 1 / 87178291200.0};
  static const double odd[] = {1 / 6.0,        1 / 120.0,        1 / 5040.0,         1 / 362880.0,
                               1 / 39916800.0, 1 / 6227020800.0, 1 / 1307674368000.0};
  int quarters = 0, k = (int)(sizeof even / sizeof *even) - 1;
  for (; fabs(z) > 0.1 && quarters < 600; quarters++) z /= 4;
  c[2] = even[k], c[3] = odd[k];
  while (k-- > 0) {
    c[2] = even[k] - z * c[2];
    c[3] = odd[k] - z * c[3];
  }
  c[1] = 1 - z * c[3], c[0] = 1 - z * c[2];
  for (; quarters > 0; quarters--) {
    c[3] = (c[2] + c[0] * c[3]) / 4;
    c[2] = c[1] * c[1] / 2;
    c[1] = c[0] * c[1];
    c[0] = 2 * c[0] * c[0] - 1;
  }
}

/* What is known of the motion at its start, and at s. */
typedef struct orbit {
  double mu, h, r0, e, b;  /* see kepler.h */
  double g1, g2, g3;       /* G_k(s) */
  double late, r, slope_r; /* time(s) - h, its derivative, and the derivative of that */
} orbit;

static void look(orbit *o, double s) {
  double c[4], deeper = o->mu - o->b * o->r0; /* of mu G_k + r0 G_(k-2), as G_k = s^k/k! - b G_(k+2) */
  hk_stumpff(o->b * s * s, c);
  o->g1 = s * c[1], o->g2 = s * s * c[2], o->g3 = s * s * s * c[3];
  o->late = o->r0 * s + o->e * o->g2 + deeper * o->g3 - o->h;
  o->r = o->r0 + o->e * o->g1 + deeper * o->g2;
  o->slope_r = o->e * c[0] + deeper * o->g1;
}

/* Two terms of the series s(h) where they tell something, else the average of ds/dt over an ellipse, or a hyperbola
 * whose distance grows as cosh. */
static double first_guess(const orbit *o) {
  double near = o->h / o->r0, bend = o->e * near / (2 * o->r0), rate = sqrt(fabs(o->b)), mean = o->b * o->h / o->mu;
  if (fabs(bend) < 0.3 && rate * fabs(near) < 1) return near * (1 - bend);
  if (o->b > 0 && rate * fabs(mean) > 0.5) return mean;
  near /= 1 + fabs(bend);
  return o->b < 0 ? asinh(rate * near) / rate : near;
}

/* Halley's step, third order; Newton's where the time bends too much. */
static double improvement(const orbit *o) {
  double half = o->late * o->slope_r / (2 * o->r);
  return -o->late / (fabs(half) < o->r / 2 ? o->r - half : o->r);
}

/* Looks at the s whose time is h; false: it is not found. Where Halley's step leaves what is known to enclose it, and
 * each fourth time, so that distances that rise as exp(s) are not followed step by step, that is halved. */
static bool solve(orbit *o) {
  enum { MOST = 200 };
  const double nearly = 1e-6; /* of s: the next error is its third power */
  double low = o->h > 0 ? 0 : -INFINITY, high = o->h > 0 ? INFINITY : 0, s = first_guess(o);
  for (int k = 0; k < MOST; k++) {
    look(o, s);
    if (o->late == 0) return true;
    bool beyond = isfinite(o->late) ? o->late > 0 : s > 0;
    *(beyond ? &high : &low) = s;
    double next = s + improvement(o);
    bool enclosed = isfinite(low) && isfinite(high), inside = next > low && next < high && !(enclosed && k % 4 == 3);
    if (!inside) next = enclosed ? low + (high - low) / 2 : 2 * s;
    double change = fabs(next - s), size = fabs(next);
    s = next;
    if (change <= 2 * DBL_EPSILON * size || (inside && change <= nearly * size)) {
      look(o, s);
      return true;
    }
  }
  return false;
}

/* On a hyperbola towards the pericentre the terms of the time grow as exp(s) and cancel. */
static bool cancels(const orbit *o) {
  const double most = 16; /* times what is left */
  double terms = fabs(o->e * o->g2) + fabs((o->mu - o->b * o->r0) * o->g3);
  return o->b < 0 && o->e * o->h < 0 && !(terms < most * fabs(o->h));
}

static bool move(double mu, double h, double x[3], double v[3], int halvings) {
  enum { MOST = 60 };
  orbit o = {.mu = mu, .h = h, .r0 = hk_length(x), .e = hk_dot(x, v)};
  if (!(o.r0 > 0)) return false;
  o.b = 2 * mu / o.r0 - hk_dot(v, v);
  double period = o.b > 0 ? two_pi * mu / (o.b * sqrt(o.b)) : INFINITY;
  if (fabs(h) > period) o.h = h - period * round(h / period);
  if (o.h == 0) return true;
  bool found = true;
  if (mu > 0)
    found = solve(&o);
  else
    o.g1 = o.h / o.r0, o.r = o.r0;
  if (mu > 0 && cancels(&o) && halvings < MOST)
    return move(mu, h / 2, x, v, halvings + 1) && move(mu, h / 2, x, v, halvings + 1);
  double f = -mu * o.g2 / o.r0, g = o.h - mu * o.g3, df = -mu * o.g1 / (o.r * o.r0), dg = -mu * o.g2 / o.r;
  for (int c = 0; c < 3; c++) {
    double place = x[c];
    x[c] += f * place + g * v[c];
    v[c] += df * place + dg * v[c];
  }
  return found;
}

bool hk_kepler_move(double mu, double h, double x[3], double v[3]) {
  double to[3], speed[3];
  hk_copy(to, x);
  hk_copy(speed, v);
  if (!move(mu, h, to, speed, 0) || !isfinite(hk_length(to) + hk_length(speed))) return false;
  hk_copy(x, to);
  hk_copy(v, speed);
  return true;
}
