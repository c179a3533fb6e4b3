/* The forces of hinges, and a bound of their stiffness.
 *
 * For one number C with the gradient g, of which member m has g_m, and any weights r_m > 0, (sum g_m.u_m)^2 <=
 * (sum |g_m| r_m) sum (g_m.u_m)^2/(|g_m| r_m) by Cauchy and Schwarz. With r_m^2 = 1/mass this divides k g g^T among the
 * particles so that the bound of the frequencies is smallest; regular meshes reach it, with neighbours that move to and
 * fro. The other part of K, k C H, is bounded block by block, |u.H_mq w| <= |H_mq| (s u^2 + w^2/s)/2 with s = r_q/r_m.
 */
#include "plugins/common/shells/bending.h"

#include "plugins/kit/vector3.h"

enum { VALUES = 3 };

/* ---- forces ------------------------------------------------------------------------------------------------------ */

/* Adds the force of element k, of which C and dC are given; returns its power. */
static double add_one(const hk_elements *a, const hk_view *view, size_t k, const double *C, const double (*dC)[3],
                      double *F) {
  const uint32_t *member = hk_tuple(&a->node, k);
  double stiffness = a->stiffness.value[k], damping = a->damping.value[k], power = 0;
  for (unsigned e = 0; e < a->values; e++, dC += 4) {
    double rate = 0;
    for (int m = 0; m < 4 && damping != 0; m++) rate += hk_dot(dC[m], view->v + 3 * (size_t)member[m]);
    for (int m = 0; m < 4; m++) hk_add_scaled(F + 3 * (size_t)member[m], -(stiffness * C[e] + damping * rate), dC[m]);
    power -= damping * rate * rate;
  }
  return power;
}

static double add_items(const void *context, const hk_view *view, const uint32_t *item, size_t count, double *F) {
  const hk_elements *a = &((const hk_bending *)context)->element.acting;
  double C[VALUES], dC[VALUES * 4][3], power = 0;
  for (size_t k = 0; k < count; k++) {
    a->evaluate(a->self, view->x, item[k], item[k] + (size_t)1, C, dC);
    power += add_one(a, view, item[k], C, (const double(*)[3])dC, F);
  }
  return power;
}

/* The same where C = sum weight x, which has no damping. */
static double add_linear(const void *context, const hk_view *view, const uint32_t *item, size_t count, double *F) {
  const hk_bending *b = context;
  const hk_elements *a = &b->element.acting;
  for (size_t k = 0; k < count; k++) {
    const uint32_t *member = hk_tuple(&a->node, item[k]);
    const double *w = b->weight[b->number[item[k]]], *base = view->x + 3 * (size_t)member[0];
    for (size_t c = 0; c < 3; c++) {
      double C = 0;
      for (int m = 1; m < 4; m++) C += w[m] * (view->x[3 * (size_t)member[m] + c] - base[c]);
      for (int m = 0; m < 4; m++) F[3 * (size_t)member[m] + c] -= a->stiffness.value[item[k]] * C * w[m];
    }
  }
  return 0;
}

void hk_bending_add_part(void *self, const hk_view *view, size_t part, double *F) {
  const hk_bending *b = self;
  hk_part_sums_add(&b->sums, view, part, b->weight ? add_linear : add_items, b, F);
}

hk_status hk_bending_add(void *self, const hk_view *view, double *F) {
  hk_bending_add_part(self, view, HK_ALL_PARTS, F);
  return HK_OK;
}

void hk_bending_parts(void *self, const hk_view *view, const hk_part_use *use) {
  const hk_bending *b = self;
  (void)view;
  hk_part_lists_touch(&b->sums.lists, &b->element.acting.node, use);
}

double hk_bending_energy(void *self, const hk_view *view) {
  return hk_element_force_energy(&((hk_bending *)self)->element, view);
}

void hk_bending_elements(void *self, const hk_view *view, hk_elements *out) {
  (void)view;
  *out = ((hk_bending *)self)->element.acting;
}

void hk_bending_pattern(void *self, const hk_view *view, hk_pattern *pattern) {
  (void)view;
  hk_element_force_pattern(&((hk_bending *)self)->element, pattern);
}

/* Where C = sum weight x the block of two members is k times their weights times the identity; there is no damping. */
static void add_linear_blocks(const hk_bending *b, const hk_blocks *into) {
  const hk_elements *a = &b->element.acting;
  const size_t *slot = into->slot;
  for (size_t k = 0; k < a->node.count; k++, slot += 16) {
    const double *w = b->weight[b->number[k]];
    for (int m = 0; m < 4; m++)
      for (int q = 0; q < 4; q++) {
        double *K = into->K + 9 * slot[4 * m + q], part = a->stiffness.value[k] * w[m] * w[q];
        K[0] += part, K[4] += part, K[8] += part;
      }
  }
}

hk_status hk_bending_jacobian(void *self, const hk_view *view, const hk_blocks *into) {
  const hk_bending *b = self;
  size_t next = 0;
  if (b->weight)
    add_linear_blocks(b, into);
  else
    hk_element_force_jacobian(&b->element, view, into, &next);
  return HK_OK;
}

/* ---- bound of the stiffness -------------------------------------------------------------------------------------- */

/* block += factor g g^T */
static void add_square(double block[6], double factor, const double g[3]) {
  for (int r = 0, at = 0; r < 3; r++)
    for (int c = r; c < 3; c++, at++) block[at] += factor * g[r] * g[c];
}

/* block += norm I */
static void add_norm(double block[6], double norm) { block[0] += norm, block[3] += norm, block[5] += norm; }

static void bound_square(double factor, const double (*g)[3], const double r[4], const uint32_t *member,
                         double (*block)[6]) {
  double size[4], sum = 0;
  for (int m = 0; m < 4; m++) sum += r[m] * (size[m] = hk_length(g[m]));
  for (int m = 0; m < 4; m++)
    if (size[m] * r[m] > 0) add_square(block[member[m]], factor * sum / (size[m] * r[m]), g[m]);
}

static void bound_hessian(double factor, const double H[144], const double r[4], const uint32_t *member,
                          double (*block)[6]) {
  for (int m = 0; m < 4; m++)
    for (int q = 0; q < 4; q++) {
      double square = 0;
      for (int e = 0; e < 9; e++)
        square += H[12 * (3 * m + e / 3) + 3 * q + e % 3] * H[12 * (3 * m + e / 3) + 3 * q + e % 3];
      if (r[m] > 0) add_norm(block[member[m]], factor * sqrt(square) * r[q] / r[m]);
    }
}

void hk_bending_stiffness_bound(void *self, const hk_view *view, hk_stiffness_part part, double (*block)[6]) {
  const hk_bending *b = self;
  const hk_elements *a = &b->element.acting;
  double C[VALUES], dC[VALUES * 4][3], H[144], r[4];
  for (size_t k = 0; k < a->node.count; k++) {
    const uint32_t *member = hk_tuple(&a->node, k);
    double stiffness = a->stiffness.value[k], damping = a->damping.value[k];
    for (int m = 0; m < 4; m++) r[m] = sqrt(view->model->inverse_mass[member[m]]);
    a->evaluate(a->self, view->x, k, k + 1, C, dC);
    for (unsigned e = 0; e < a->values; e++) {
      const double(*g)[3] = (const double(*)[3])dC + 4 * e;
      if (part != HK_STIFFNESS_UNDAMPED || b->weight) /* what is linear has no damping */
        bound_square(part == HK_DAMPING_WHOLE ? damping : stiffness, g, r, member, block);
      if (part == HK_DAMPING_WHOLE || C[e] == 0 || b->weight) continue;
      b->element.hessian(a->self, view->x, k, e, H);
      bound_hessian(stiffness * fabs(C[e]), H, r, member, block);
    }
  }
}
