/* See impact.h. A gap that is closed at the start of a step, as where surfaces start nearer than their thickness, opens
 * by half of what is missing in each step, without a velocity. */
#include "plugins/common/impacts/impact.h"

#include "plugins/common/space/vector3.h"

#include <string.h>

void hk_pair_gather(double out[12], const hk_surface_pair *pair, const double *x) {
  for (int i = 0; i < 4; i++) hk_copy(out + 3 * i, x + 3 * (size_t)pair->vertex[i]);
}

void hk_pair_path_of(hk_pair_path *path, const hk_surface_pair *pair, const double *x_from, const double *x_to) {
  hk_pair_gather(path->from, pair, x_from);
  hk_pair_gather(path->to, pair, x_to);
}

static double largest(const double *moves, const double mean[3], int begin, int end) {
  double most2 = 0;
  for (int i = begin; i < end; i++) {
    double d[3];
    hk_subtract(d, moves + 3 * i, mean);
    most2 = fmax(most2, hk_dot(d, d));
  }
  return sqrt(most2);
}

double hk_pair_motion(hk_pair_kind kind, const hk_pair_path *path) {
  double moves[12], mean[3] = {0};
  for (int k = 0; k < 12; k++) {
    moves[k] = path->to[k] - path->from[k];
    mean[k % 3] += moves[k] / 4;
  }
  int split = kind == HK_POINT_TRIANGLE ? 1 : 2;
  return largest(moves, mean, 0, split) + largest(moves, mean, split, 4);
}

static void weigh(double out[3], const hk_impact *k, const double *y) {
  for (int c = 0; c < 3; c++) out[c] = 0;
  for (int i = 0; i < 4; i++) hk_add_scaled(out, k->w[i], y + 3 * (size_t)k->vertex[i]);
}

/* The part of the step at which the gap closes: the root of c + b s + (c_1 - c - b) s^2 in (0, 1], of which there is
 * one where c > 0 > c_1. */
static double closing_time(double c, double b, double c_1) {
  if (!(c > 0)) return 0;
  double a = c_1 - c - b, root = sqrt(fmax(0, b * b - 4 * a * c));
  double s = b < 0 ? 2 * c / (root - b) : -(b + root) / (2 * a);
  return s < 1 ? s : 1;
}

void hk_impact_of(hk_impact *k, const hk_surface_pair *pair, const hk_step_move *m, const hk_meeting *meeting) {
  double from[3], to[3], v_from[3], v_to[3];
  *k = (hk_impact){.gap_from = meeting->gap_from};
  memcpy(k->vertex, pair->vertex, sizeof k->vertex);
  memcpy(k->w, meeting->w, sizeof k->w);
  hk_copy(k->n, meeting->n);
  for (int i = 0; i < 4; i++) k->mobility += k->w[i] * k->w[i] * m->inverse_mass[k->vertex[i]];
  weigh(from, k, m->x_from);
  weigh(to, k, m->x);
  weigh(v_from, k, m->v_from);
  weigh(v_to, k, m->v);
  double c_0 = hk_dot(k->n, from) - pair->offset, c_1 = hk_dot(k->n, to) - pair->offset;
  double u_0 = hk_dot(k->n, v_from), u_1 = hk_dot(k->n, v_to);
  double s = c_1 < 0 ? closing_time(c_0, m->h * u_0, c_1) : 1, gap = fmin(0, meeting->gap_from) / 2;
  if (c_1 < 0 && !meeting->again) {
    double u = fmin(0, u_0 + s * (u_1 - u_0)), turned = (1 + meeting->restitution) * u;
    gap = fmax(gap, c_1 - turned * (1 - s) * m->h);
    k->speed.target = fmax(0, u_1 - turned);
  }
  for (int c = 0; c < 3; c++) k->place.origin[c] = from[c] + s * (to[c] - from[c]);
  k->place.target = pair->offset - hk_dot(k->n, k->place.origin) + gap;
}
