#include "plugins/common/contact/impulses/proximity.h"

#include "plugins/kit/vector3.h"

static const double part_of_overlap = 0.1; /* that a step may take back; section 6.1 of the paper */

/* The impulse that takes the normal speed from u_n to `target`, and friction with it. Returns its size. */
static double act(const hk_proximity *p, const hk_impact *k, const double r[3], double target, double *u) {
  double u_n = hk_dot(r, k->frame.n), change = target - u_n, across[3], impulse[3];
  for (int c = 0; c < 3; c++) across[c] = r[c] - u_n * k->frame.n[c];
  double sliding = hk_length(across), taken = sliding > 0 ? fmin(1, p->friction * change / sliding) : 0;
  for (int c = 0; c < 3; c++) impulse[c] = (change * k->frame.n[c] - taken * across[c]) / k->mobility;
  for (int i = 0; i < 4; i++)
    hk_add_scaled(u + 3 * (size_t)k->pair.vertex[i], k->frame.w[i] * p->inverse_mass[k->pair.vertex[i]], impulse);
  return change / k->mobility;
}

static void relative(double r[3], const hk_impact *k, const double *u) {
  for (int c = 0; c < 3; c++) r[c] = 0;
  for (int i = 0; i < 4; i++) hk_add_scaled(r, k->frame.w[i], u + 3 * (size_t)k->pair.vertex[i]);
}

double hk_proximity_repel(const hk_proximity *p, const hk_contact_solver *all, double *u) {
  double sum = 0, r[3];
  for (size_t e = 0; e < all->count; e++) {
    const hk_impact *k = &all->impact[e];
    double d = -k->pair.gap, most = part_of_overlap * d / p->h;
    relative(r, k, u);
    double stopped = fmax(0, hk_dot(r, k->frame.n));
    if (!(k->mobility > 0) || stopped >= most) continue;
    sum += act(p, k, r, fmin(most, stopped + p->h * p->stiffness * d * k->mobility), u);
  }
  return sum;
}

double hk_proximity_collide(const hk_proximity *p, const hk_contact_solver *all, double *u) {
  double sum = 0, r[3];
  for (size_t e = 0; e < all->count; e++) {
    const hk_impact *k = &all->impact[e];
    relative(r, k, u);
    double u_n = hk_dot(r, k->frame.n);
    if (k->mobility > 0 && u_n < 0) sum += act(p, k, r, -p->restitution * u_n, u);
  }
  return sum;
}
