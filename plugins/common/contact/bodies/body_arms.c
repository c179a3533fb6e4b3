/* See body_arms.h. Every vector that turns with a rigid body is a combination of its four carriers: -radius n = sum of
 * weight[c] (x_c - x_0), solved by Cramer's rule. The nearest places x_1 and x_2 of both sides touch at x_1 - r_1 n and
 * x_2 + r_2 n, so both arms add the same vector to the difference x_1 - x_2. */
#include "plugins/common/contact/bodies/body_arms.h"
#include "plugins/kit/vector3.h"

#include <string.h>

const uint32_t *hk_body_arm_carriers(const hk_model *m, const uint32_t *particle, const double *weight, int count) {
  const hk_rider *first = NULL;
  for (int i = 0; i < count; i++) {
    if (weight[i] == 0) continue;
    const hk_rider *r = m->pin[particle[i]] == HK_PIN_RIDES ? hk_model_rider(m, particle[i]) : NULL;
    if (!r || r->carriers != 4) return NULL;
    if (first && memcmp(r->carrier, first->carrier, sizeof r->carrier) != 0) return NULL;
    first = r;
  }
  return first ? first->carrier : NULL;
}

/* across[c]/volume are the reciprocal vectors of x_c - x_0. Returns the volume. */
double hk_body_arms_reciprocal(const uint32_t *carrier, const double *x, double across[3][3]) {
  double side[3][3];
  for (int c = 0; c < 3; c++) hk_subtract(side[c], x + 3 * (size_t)carrier[c + 1], x + 3 * (size_t)carrier[0]);
  for (int c = 0; c < 3; c++) hk_cross(across[c], side[(c + 1) % 3], side[(c + 2) % 3]);
  return hk_dot(side[0], across[0]);
}

static void set(hk_body_arm *a, const double *x, const double n[3]) {
  double across[3][3], volume = hk_body_arms_reciprocal(a->carrier, x, across);
  a->weight[0] = 0;
  for (int c = 0; c < 3; c++) {
    a->weight[c + 1] = -a->radius * hk_dot(across[c], n) / volume;
    a->weight[0] -= a->weight[c + 1];
  }
}

void hk_body_arms_set(hk_body_arms *arms, const double *x, const double n[3]) {
  for (int k = 0; k < 2; k++)
    if (arms->side[k].carrier) set(&arms->side[k], x, n);
}

void hk_body_arms_add(const hk_body_arms *arms, const double *y, const double n[3], double out[3]) {
  double sum[3] = {0, 0, 0};
  for (int k = 0; k < 2; k++)
    for (int c = 0; c < 4 && arms->side[k].carrier; c++)
      hk_add_scaled(sum, arms->side[k].weight[c], y + 3 * (size_t)arms->side[k].carrier[c]);
  hk_add_scaled(sum, -hk_dot(sum, n), n);
  hk_add_scaled(out, 1, sum);
}

void hk_body_arms_across(const double sum[9], const double n[3], double G[9]) {
  for (int c = 0; c < 3; c++) {
    double along = n[0] * sum[c] + n[1] * sum[3 + c] + n[2] * sum[6 + c];
    for (int row = 0; row < 3; row++) G[3 * row + c] += sum[3 * row + c] - along * n[row];
  }
}

/* The spin w of v_c - v_0 = w x (x_c - x_0): half of the sum of the reciprocal vectors times these. */
void hk_body_spin(const uint32_t *carrier, const double *x, const double *v, double out[3]) {
  double across[3][3], d[3], part[3], volume = hk_body_arms_reciprocal(carrier, x, across);
  out[0] = out[1] = out[2] = 0;
  for (int c = 0; c < 3; c++) {
    hk_subtract(d, v + 3 * (size_t)carrier[c + 1], v + 3 * (size_t)carrier[0]);
    hk_cross(part, across[c], d);
    hk_add_scaled(out, 0.5 / volume, part);
  }
}

void hk_body_arms_carry(const uint32_t *carrier, const double *x_from, const double *v_from, const double *x,
                        double *v) {
  double w[3], d[3], part[3], middle[3] = {0, 0, 0}, speed[3] = {0, 0, 0};
  hk_body_spin(carrier, x_from, v_from, w);
  for (int c = 0; c < 4; c++) {
    hk_add_scaled(middle, 0.25, x + 3 * (size_t)carrier[c]);
    hk_add_scaled(speed, 0.25, v_from + 3 * (size_t)carrier[c]);
  }
  for (int c = 0; c < 4; c++) {
    hk_subtract(d, x + 3 * (size_t)carrier[c], middle);
    hk_cross(part, w, d);
    for (int k = 0; k < 3; k++) v[3 * (size_t)carrier[c] + (size_t)k] = speed[k] + part[k];
  }
}

/* ---- what has none ---- */

/* m: how far apart the particles are that carry the rider. */
static double extent_of(const hk_view *view, const hk_rider *r) {
  double most = 0, d[3];
  for (uint32_t k = 1; k < r->carriers; k++) {
    hk_subtract(d, view->x + 3 * (size_t)r->carrier[k], view->x + 3 * (size_t)r->carrier[0]);
    most = fmax(most, hk_length(d));
  }
  return most;
}

void hk_body_warn_of_arms(const hk_host *host, const hk_view *view, double radius) {
  static const double shows = 0.1; /* of the extent */
  const hk_model *m = view->model;
  for (size_t k = 0; k < m->riders; k++) {
    const hk_rider *r = &m->rider[k];
    double own = r->radius > 0 ? r->radius : radius;
    if (!r->touches || r->carriers == 4 || !(own > shows * extent_of(view, r))) continue;
    host->warn(
        host,
        "a round point of a flat body or a rod is rubbed at its centre: particle %u, of the radius %g m, so that "
        "friction does not turn it about what it has no extent across; give the body a thickness",
        m->id[r->particle], own);
    return;
  }
}
