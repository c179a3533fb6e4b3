/* Coulomb friction of a barrier's contacts, with a memory of what sticks. With the normal n, the weights w of the
 * nearest points and the normal force l, all of the present positions, a contact has the elastic slip L u,
 *     u = s + T/L sum_i w_i v_i less its part along n,
 * s what u was at the start of the step, T the time since then, and
 *     F_i = -w_i c mu l f(|u|) u/|u|,   f(y) = 2y - y^2 below 1, 1 above.
 * At the end of a step s becomes what it was and the way of the step by L, across n, and of length 1 at most: the
 * return mapping of an elastic and perfectly plastic body (Simo and Laursen 1992, An augmented Lagrangian treatment of
 * contact problems involving friction, section 3; Dahl 1968 for the elastic slip). So what sticks comes to rest: it is
 * displaced by less than L, where a law of velocities alone creeps for ever. f is that of Li and others 2020
 * (Incremental Potential Contact, section 5, equation 15), which smooths by velocities.
 *
 * L is the parameter. Implicit steps of T s that do not resolve the swing on it take others. A contact that is new, or
 * moves, has the way at 1 mm/s in a step where that is more: it would otherwise change from sticking to sliding and
 * back in every iteration (three sheets that land on a floor took 34,353 evaluations of forces in 105 steps, and 769 in
 * 36 now). One that has rested for 8 steps, or from the start, has no more than 5e-4 of mu l T^2/m, the way by which
 * friction turns a contact back in the step (l of its start, 1/m = sum_i w_i^2/m_i): such a stick is 4,000 times as
 * stiff as inertia is, however short steps are, and what it yields by while it is loaded brings no speed that counts.
 * It rests as long as its way in a step is below that. c is 1 for what is new or slid at the end of the last
 * step, 1.001 for what stuck: that stops what so little speed is left of, where mu is the tangent of a slope and
 * Coulomb's law alone never would.
 *
 * Their paper takes n, w and l from the step before and repeats the step until they agree. Here they are part of the
 * equation that a step solves, so that what slides loses mu times the impulse along the normal, whatever the steps:
 * with l of the step before, a card on a slope of tan 1/2 at mu = 0.4 was 9.4 % off after 30 steps of 1/60 s. It costs
 * the symmetry of -dF/dx; without its unsymmetric terms Newton's method still converges, as l is known once the gap is.
 *
 * What slides is slowed along its velocity at the end of the step, which has the order of the method. */
#ifndef HK_FRICTION_H
#define HK_FRICTION_H

#include "plugins/common/contact/barrier/barrier_contacts.h"

/* What a contact remembers of the last step. */
typedef struct hk_slip {
  double s[3];   /* of the first feature against the second; |s| = 1: it slid */
  double change; /* m/s^2: mu l/m; 0: nothing is remembered */
  double slid;   /* m, since it began to slide */
  double stuck;  /* steps for which it has rested, at most 8 */
} hk_slip;

/* A contact that carried something at its end. */
typedef struct hk_stick {
  hk_feature_pair pair;
  uint32_t id[4]; /* of its particles: indices change at births and deaths */
  hk_slip slip;
  double n[3]; /* the normal there */
  double load; /* N */
} hk_stick;

typedef struct hk_friction {
  double coefficient, elastic_slip; /* mu; L, m */
  /* fields */
  hk_array sticks; /* hk_stick, rising by hk_pair_compare */
  hk_array next;   /* the same of the step that ends; scratch */
  hk_array slips;  /* hk_slip, of every pair of hk_barrier_contacts.near; scratch */
  hk_array begun;  /* double, 2 x n x 3: positions and velocities at the start of the step; scratch */
  hk_array first;  /* uint32_t, n + 1, and of every particle the sticks that it belongs to; scratch */
  hk_array member;
  bool ready;           /* what carries something at the start was noted */
  int64_t implicit;     /* whether Jacobians are asked for */
  double taken, missed; /* J: mu l times the way of all that slid, and what of it the forces did not take */
  double most;          /* N, largest sum of mu l of a step */
} hk_friction;

/* Of the contacts at the positions of the view. Returns the power, W. */
double hk_friction_add(const hk_friction *, hk_barrier_contacts *, const hk_view *, double *F);
/* Adds D, symmetric and definite, and, where no symmetric or definite blocks are wanted, K, which is unsymmetric. Where
 * definite ones are, D has mu l f/|u| along u as well, the slope of a quadratic that is nowhere below the potential of
 * the friction (Huber 1981, Robust Statistics, 7.8): no step goes beyond where it turns, and searches succeed. */
void hk_friction_blocks(const hk_friction *, hk_barrier_contacts *, const hk_view *, const hk_blocks *into);
/* Adds to block[i] as hk_force.stiffness_bound asks: the stiffness of the contacts that act now. */
void hk_friction_bound(const hk_friction *, hk_barrier_contacts *, const hk_view *, double (*block)[6]);

/* ---- friction_memory.c ---- */

/* m, L after T s: what a contact of that memory may be displaced by; and what it may where it rests. */
double hk_friction_length(const hk_friction *, const hk_slip *, double T);
double hk_friction_rest_length(const hk_friction *, const hk_slip *, double T);
/* After hk_barrier_find, with the law of the step: what each candidate remembers. Where the move begins at the start of
 * a step, that is noted. */
hk_status hk_friction_recall(hk_friction *, hk_barrier_contacts *, const hk_view *from);
/* What the candidate `near` of the contacts, which acts, remembers; n, the particles. */
const hk_slip *hk_friction_slip(const hk_friction *, const hk_barrier_contacts *, size_t near, size_t n);
/* At the end of a step of h s. Adds to *lost what friction took, J: mu l times what slid beyond the elastic slip. */
hk_status hk_friction_remember(hk_friction *, hk_barrier_contacts *, const hk_view *, double h, double *lost);
/* What the forces missed of Coulomb's work on what slid, the work over an elastic slip wherever a contact began to,
 * relative to that work, or to that on a way of ten distances of the barrier where this is more; 0 before anything
 * slid. */
double hk_friction_missed(const hk_friction *, const hk_barrier_contacts *);
/* When particles have other indices, or the contacts come from a checkpoint: those of particles that are gone go. */
hk_status hk_friction_renumber(hk_friction *, const hk_host *, const hk_view *);

/* ---- the slopes that K is made of ----
 *
 * How what friction depends on, of a contact, changes with the positions of its four points: the weights w of the
 * nearest points, the normal force l = -2 m E' |d|, and u = W - n (n.W), W = s + T/L sum_i w_i v_i.
 *
 * The nearest points lie at d.d_k = 0, for the directions d_k in which they may move, by which w changes at c_k
 * (geometry/nearest_frame.h). With G_kl = d_k.d_l the parameters of the directions follow a move of the points by
 *     dq = -G^-1 (c_k (x) d + w (x) d_k).dx,   dw = sum_k c_k dq_k,   d(d) = sum_i w_i dx_i + sum_k d_k dq_k. */

/* Derivatives by the 12 coordinates, 3 of each point. */
typedef struct hk_friction_slopes {
  double w[4][12]; /* 1/m */
  double u[3][12]; /* 1/m */
  double load[12]; /* N/m */
} hk_friction_slopes;

/* Of a pair that acts, whose value is that of the positions x. way: T/L v of the four points. */
void hk_friction_slopes_of(const hk_barrier_pair *, const hk_barrier_value *, const double *x, const double s[3],
                           const double way[12], hk_friction_slopes *);

#endif
