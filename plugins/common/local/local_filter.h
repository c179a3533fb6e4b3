/* The filter of local steps: what p short steps inside a step of h make of a mode that they alone resolve.
 *
 * With x = (h w)^2 the exact motion from rest is c = cos(h w), and leapfrog's own p steps give T_p(1 - x/(2 p^2)), T_p
 * being Chebyshev's polynomial. Both come to c = 1 and c = -1, where what the long step adds has no room, so that steps
 * in resonance with a stiff mode are unstable. With
 *     c(x) = T_p(delta - x/omega) / T_p(delta),   delta = cosh(s/p),   omega = 2 p tanh(s) / sinh(s/p),
 * |c| <= 1/cosh(s) wherever the mode is fast, and c = 1 - x/2 + O(x^2) where it is slow: no resonance, and order 2
 * (Grote, Michel and Sauter 2021, whose nu is p^2 (delta - 1), about s^2/2). Modes are shifted, not damped. */
#ifndef HK_LOCAL_FILTER_H
#define HK_LOCAL_FILTER_H

#include <math.h>

/* cosh(2.5) = 6.1. The longest step grows with s, as room() says, from 0.77 of that without stiff modes at s = 1.4 to
 * 0.93 at s = 3; the short steps needed grow as sqrt(s), from 1.26 p to 1.73 p. With some hundredths of a step's work
 * in a short one the sum of both is least, and flat, from 2 to 3. */
static const double hk_local_damping = 2.5;

/* Fewer short steps than 4 leave less room. */
enum { HK_LOCAL_LEAST = 4 };

static inline double hk_local_delta(int p) { return cosh(hk_local_damping / p); }

static inline double hk_local_omega(int p) { return 2 * p * tanh(hk_local_damping) / sinh(hk_local_damping / p); }

/* The largest x that p short steps can take. */
static inline double hk_local_range(int p) { return hk_local_omega(p) * (hk_local_delta(p) + 1); }

/* The number of short steps for modes up to x. */
static inline int hk_local_count(double x) {
  int p = (int)fmax(HK_LOCAL_LEAST, floor(sqrt(x * hk_local_damping / (4 * tanh(hk_local_damping)))));
  while (hk_local_range(p) < x) p++;
  return p;
}

/* c(x) for x within the range. */
double hk_local_filter(int p, double x);

/* How the displacements d from rest go on in the short steps of a step:
 *     d_1 = g_0 a_0,   d_{k+1} = d_k + f_k (d_k - d_{k-1}) + g_k a_k,
 *     f_k = T_{k-1}/T_{k+1},   g_k = 2 h^2 T_k/(omega T_{k+1}),   T_k = T_k(delta) = cosh(k s/p),
 * a_k being the acceleration at d_k. As d is even in time, T_{-1} = T_1, and g_0 is half of what the rule says. */
typedef struct hk_local_rule {
  int count; /* p */
  double delta, scale;
} hk_local_rule;

typedef struct hk_local_step {
  double f, g, T, next; /* T_k, T_{k+1} */
} hk_local_step;

static inline hk_local_rule hk_local_rule_of(double stiffest, double h) {
  int p = hk_local_count(h * h * stiffest);
  return (hk_local_rule){p, hk_local_delta(p), 2 * h * h / hk_local_omega(p)};
}

static inline hk_local_step hk_local_first(const hk_local_rule *r) {
  return (hk_local_step){0, 0.5 * r->scale / r->delta, 1, r->delta};
}

static inline void hk_local_next(const hk_local_rule *r, hk_local_step *s) {
  double after = 2 * r->delta * s->next - s->T;
  *s = (hk_local_step){s->T / after, r->scale * s->next / after, s->next, after};
}

/* Bounds of stiff modes. */
typedef struct hk_local_modes {
  double stiffest;    /* 1/s^2, of the squared frequency */
  double damping;     /* 1/s, of the damping rate, ... */
  double retardation; /* s, ... and of the damping over the stiffness */
} hk_local_modes;

/* What such modes leave of leapfrog's condition to the others: a step is stable while (h w)^2 + 4 h g <= 4 room. 0 or
 * less: it is not stable at all. */
double hk_local_room(const hk_local_modes *, double h);

#endif
