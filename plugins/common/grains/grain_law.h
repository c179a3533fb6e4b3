/* The force of a soft contact: along the normal a linear spring and dashpot that never pull, across it a spring and
 * dashpot that slip at Coulomb's limit (Cundall and Strack 1979; the slip as in Luding 2008, Granular Matter 10, 4.2).
 *     N = max(0, k d + 2 z sqrt(k m) dd/dt),     T = -k_t s - 2 z sqrt(k_t m/q) u_t,   |T| <= mu N,
 * with the overlap d, the effective mass m, the slip s since the contact began and the velocity u_t across the normal.
 * Where spheres turn, they yield to a force across the normal as if their mass were less by q = 1 + m R^2/I = 7/2.
 * Where T is at the limit, s becomes what gives that force. */
#ifndef HK_GRAIN_LAW_H
#define HK_GRAIN_LAW_H

#include "core/plugin.h"
#include "plugins/kit/vector3.h"

typedef struct hk_grain_law {
  double stiffness, tangential; /* N/m: k, k_t */
  double friction;              /* mu */
  double damping;               /* z, part of the critical damping */
  double yielding;              /* q: 1, or 7/2 where the bodies turn */
} hk_grain_law;

typedef struct hk_grain_contact {
  double overlap;   /* m, above 0 */
  double mass;      /* kg */
  double normal[3]; /* from the other body to this one */
  double u[3];      /* m/s, of this body's surface against the other's */
  double slip[3];   /* m; hk_grain_force leaves what the friction allows */
  double force[3];  /* N, on this body: the answer */
  double across[3]; /* N, the part of it across the normal */
  double power;     /* W, of all but the normal spring */
} hk_grain_contact;

/* z for the coefficient of restitution e in (0, 1] of two bodies that meet head-on. A contact ends when its force does,
 * after t = 2 acos(z)/(w sqrt(1 - z^2)) with w^2 = k/m, which leaves e = exp(-z w t) (Schwager and Poeschel 2007,
 * Granular Matter 9, equations 19 to 21, in one). */
double hk_grain_damping(double restitution);
/* t of above times w. */
double hk_grain_duration(double damping);
/* s, of a collision with the effective mass `mass`, kg: t of above, or half a period of the spring across, m/(q k_t),
 * where that is shorter. */
double hk_grain_collision(const hk_grain_law *, double mass);

/* The stiffness of a contact along the normal and across it: of -dF/dx, N/m, or of -dF/dv, N s/m; mass: an effective
 * mass that no contact of the sphere exceeds. Spheres that turn are as fast across it as if it were q times that. */
typedef struct hk_grain_bound {
  double along, across;
} hk_grain_bound;

hk_grain_bound hk_grain_stiffness(const hk_grain_law *, hk_stiffness_part part, double mass);

static inline void hk_grain_force(const hk_grain_law *law, hk_grain_contact *c) {
  double apart = hk_dot(c->u, c->normal), spring = law->stiffness * c->overlap;
  double N = spring - 2 * law->damping * sqrt(law->stiffness * c->mass) * apart;
  double viscous = 2 * law->damping * sqrt(law->tangential * c->mass / law->yielding), T[3], u[3];
  if (!(N > 0)) N = 0;
  for (int a = 0; a < 3; a++) u[a] = c->u[a] - apart * c->normal[a];
  for (int a = 0; a < 3; a++) T[a] = -law->tangential * c->slip[a] - viscous * u[a];
  double size2 = hk_dot(T, T), most = law->friction * N;
  if (size2 > most * most) {
    double part = most / sqrt(size2);
    for (int a = 0; a < 3; a++) {
      T[a] *= part;
      c->slip[a] = law->tangential > 0 ? -(T[a] + viscous * u[a]) / law->tangential : 0;
    }
  }
  for (int a = 0; a < 3; a++) c->across[a] = T[a], c->force[a] = N * c->normal[a] + T[a];
  c->power = (N - spring) * apart + hk_dot(T, u);
}

#endif
