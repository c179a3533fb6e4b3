/* An upper bound of a scene's frequencies from the stiffness bounds that its forces state.
 *
 * Each force bounds its stiffness by blocks, one per particle: u.K u <= sum_i u_i.B_i u_i. The mass-scaled stiffness is
 * then at most block-diagonal with the blocks B_i/m_i, and the largest eigenvalue of any of them bounds w^2. This is
 * the block form of Gershgorin's theorem; it does not depend on the axes. */
#include "core/numerics/stability/stiffness.h"

#include <string.h>

/* Smith, Commun. ACM 4 (1961) 168. */
void hk_symmetric_eigenvalues(const double a[6], double value[3]) {
  double mean = (a[0] + a[3] + a[5]) / 3, x = a[0] - mean, y = a[3] - mean, z = a[5] - mean;
  double p = sqrt((x * x + y * y + z * z + 2 * (a[1] * a[1] + a[2] * a[2] + a[4] * a[4])) / 6), angle = 0;
  if (p > 0) {
    double half_det =
        (x * (y * z - a[4] * a[4]) - a[1] * (a[1] * z - a[4] * a[2]) + a[2] * (a[1] * a[4] - y * a[2])) / 2;
    angle = acos(fmax(-1, fmin(1, half_det / (p * p * p)))) / 3;
  }
  value[2] = mean + 2 * p * cos(angle);
  value[0] = mean + 2 * p * cos(angle + 2.0943951023931957);
  value[1] = 3 * mean - value[0] - value[2];
}

/* Whether all eigenvalues are below `most`: then the leading minors of most I - a are positive (Sylvester). Most blocks
 * need no more than that. */
static bool is_below(const double a[6], double most) {
  double x = most - a[0], y = most - a[3], z = most - a[5], xy = a[1], xz = a[2], yz = a[4], minor = x * y - xy * xy;
  return x > 0 && minor > 0 && minor * z > x * yz * yz + xz * (2 * xy * yz + y * xz);
}

/* Blocks of equal eigenvalues are common, in a flat sheet: one that is larger by this much is not looked for. */
static const double alike = 1e-9;

static double largest_block(const hk_model *model, double (*block)[6]) {
  double largest = 0, value[3];
  for (size_t i = 0; i < model->n; i++) {
    double w = model->inverse_mass[i];
    if (!(w > 0) || is_below(block[i], (1 + alike) * largest / w)) continue;
    hk_symmetric_eigenvalues(block[i], value);
    largest = fmax(largest, w * value[2]);
  }
  return largest;
}

static void note_lengths(double *shortest, const double *x, const hk_tuples *list) {
  for (size_t e = 0; e < list->count; e++)
    for (unsigned b = 1; b < list->arity; b++)
      for (unsigned a = 0; a < b; a++) {
        const double *p = x + 3 * (size_t)hk_tuple(list, e)[a], *q = x + 3 * (size_t)hk_tuple(list, e)[b];
        double dx = q[0] - p[0], dy = q[1] - p[1], dz = q[2] - p[2], l = sqrt(dx * dx + dy * dy + dz * dz);
        if (l > 0 && l < *shortest) *shortest = l;
      }
}

static double least_ratio(const hk_model *model) {
  double least = INFINITY;
  for (size_t k = 0; k < model->element_lists; k++) {
    const hk_elements *list = &model->element_list[k].elements;
    for (size_t e = 0; e < list->node.count; e++) {
      double stiffness = list->stiffness.count ? hk_tuple_value(&list->stiffness, e) : 0;
      double damping = list->damping.count ? hk_tuple_value(&list->damping, e) : 0;
      if (stiffness > 0) least = fmin(least, damping / stiffness);
    }
  }
  return isfinite(least) ? least : 0;
}

bool hk_stiffness_part_of(hk_system *s, hk_stiffness_part part, double (*scratch)[6], double *largest) {
  memset(scratch, 0, s->n * sizeof *scratch);
  bool covered = s->queries->stiffness_bound(s, part, false, scratch);
  const hk_fast_subset *fast = s->split->fast;
  if (covered && fast) fast->remove_bound(fast->self, s, part, scratch);
  *largest = largest_block(s->model, scratch);
  return covered;
}

bool hk_stated_damping(hk_system *s, double (*scratch)[6], double *largest) {
  for (size_t k = 0; k < s->split->forces; k++)
    if (s->split->force[k].flags & HK_STIFFENS) return false;
  return hk_stiffness_part_of(s, HK_DAMPING_WHOLE, scratch, largest);
}

hk_stiffness hk_stiffness_of(hk_system *s, double (*scratch)[6]) {
  const hk_model *model = s->model;
  hk_stiffness found = {.length = INFINITY, .beta = least_ratio(model)};
  note_lengths(&found.length, s->X, &model->edges);
  for (size_t k = 0; k < model->element_lists; k++)
    note_lengths(&found.length, s->X, &model->element_list[k].elements.node);
  found.covered = hk_stiffness_part_of(s, HK_STIFFNESS_WHOLE, scratch, &found.whole);
  if (found.beta > 0) hk_stiffness_part_of(s, HK_STIFFNESS_UNDAMPED, scratch, &found.undamped);
  bool any = false;
  found.damps_alone = true;
  for (size_t k = 0; k < s->split->forces; k++) {
    bool stiffens = s->split->force[k].flags & HK_STIFFENS;
    any |= stiffens;
    found.damps_alone &= stiffens || !(s->split->force[k].flags & HK_DEPENDS_ON_V);
  }
  if (any) {
    s->queries->stiffness_bound(s, HK_STIFFNESS_WHOLE, true, scratch);
    found.stiffening = largest_block(model, scratch);
    s->queries->stiffness_bound(s, HK_DAMPING_WHOLE, true, scratch);
    found.stiffening_damping = largest_block(model, scratch);
  }
  return found;
}
