/* See body_moments.h. A moment along a is the couple of d and p = a x d, unit vectors: forces p times the weights of d
 * = sum of weight[c] x_c on the carriers; and the spin along a is p.(sum of weight[c] v_c), as w x d is that rate. What
 * the moments may be is the disc of radius rolling times the normal impulse and an interval; a step of projection as
 * for friction (body_contact_law.h). */
#include "plugins/common/contact/bodies/body_moments.h"
#include "plugins/common/contact/bodies/body_arms.h"
#include "plugins/common/contact/bodies/body_contact_law.h"
#include "plugins/kit/vector3.h"

#include <string.h>

/* sign: 1 of the first side, -1 of the second. */
static void set_side(hk_body_moment_side *side, const hk_body_moments *m, double sign, const double *x) {
  double across[3][3], volume = hk_body_arms_reciprocal(side->carrier, x, across);
  for (int a = 0; a < 3; a++) {
    const double *d = m->axis[(a + 1) % 3];
    side->weight[a][0] = 0;
    for (int c = 0; c < 3; c++) {
      side->weight[a][c + 1] = sign * hk_dot(across[c], d) / volume;
      side->weight[a][0] -= side->weight[a][c + 1];
    }
  }
}

void hk_body_moments_set(hk_body_moments *m, const double *x, const double n[3]) {
  hk_vectors_across(n, m->axis[0], m->axis[1]);
  hk_copy(m->axis[2], n);
  for (int a = 0; a < 3; a++) hk_cross(m->push[a], m->axis[a], m->axis[(a + 1) % 3]);
  for (int k = 0; k < 2; k++)
    if (m->side[k].carrier) set_side(&m->side[k], m, k == 0 ? 1 : -1, x);
}

/* sum += the weights of the axis a times y. */
static void weigh(const hk_body_moments *m, int a, double factor, const double *y, double sum[3]) {
  for (int k = 0; k < 2; k++)
    for (int c = 0; c < 4 && m->side[k].carrier; c++)
      hk_add_scaled(sum, factor * m->side[k].weight[a][c], y + 3 * (size_t)m->side[k].carrier[c]);
}

void hk_body_moments_rates(const hk_body_moments *m, bool speeds, const double *y, const double *from, double out[3]) {
  for (int a = 0; a < 3; a++) {
    double sum[3] = {0, 0, 0};
    weigh(m, a, 1, y, sum);
    if (from) weigh(m, a, -1, from, sum);
    out[a] = hk_dot(m->push[a], sum) + (speeds ? -hk_dot(m->axis[a], m->rest) : hk_dot(m->axis[a], m->way));
  }
}

void hk_body_moments_solve(hk_body_moments *m, bool speeds, const double rates[3], double push, double change[3]) {
  double next[3], *now = m->moment[speeds], most = fmax(m->inverse_inertia[0], m->inverse_inertia[1]);
  for (int a = 0; a < 3; a++) next[a] = now[a] - rates[a] / (a < 2 ? most : m->inverse_inertia[2]);
  double size = sqrt(next[0] * next[0] + next[1] * next[1]), limit = m->rolling * push;
  for (int a = 0; a < 2 && size > limit; a++) next[a] *= limit / size;
  next[2] = fmax(-m->spinning * push, fmin(m->spinning * push, next[2]));
  for (int a = 0; a < 3; a++) {
    change[a] = next[a] - now[a];
    now[a] = next[a];
  }
}
