/* See feature_pair.h. */
#include "plugins/common/contact/geometry/feature_pair.h"

#include "plugins/kit/vector3.h"

#include <stdio.h>
#include <string.h>

void hk_pair_gather(const hk_feature_pair *pair, const double *x, double out[12]) {
  for (int i = 0; i < 4; i++) hk_copy(out + 3 * i, x + 3 * (size_t)pair->vertex[i]);
}

hk_nearest hk_pair_nearest(const hk_feature_pair *pair, const double *x) {
  double at[12];
  hk_pair_gather(pair, x, at);
  return hk_nearest_of_pair(pair->kind, at);
}

hk_pair_frame hk_pair_frame_of(const hk_nearest *near) {
  hk_pair_frame f;
  double distance = sqrt(near->squared);
  for (int c = 0; c < 3; c++) f.n[c] = distance > 0 ? near->d[c] / distance : 0;
  memcpy(f.w, near->w, sizeof f.w);
  return f;
}

/* ---- moves ---- */

void hk_pair_path_of(hk_pair_path *path, const hk_feature_pair *pair, const double *x_from, const double *x_to) {
  hk_pair_gather(pair, x_from, path->from);
  hk_pair_gather(pair, x_to, path->to);
}

static double square_of_difference(const double *a, const double *b) {
  double d[3];
  hk_subtract(d, a, b);
  return hk_dot(d, d);
}

double hk_pair_approach(hk_pair_kind kind, const hk_pair_path *path) {
  double most2 = 0, moves[12];
  int split = hk_pair_split(kind);
  for (int k = 0; k < 12; k++) moves[k] = path->to[k] - path->from[k];
  for (int a = 0; a < split; a++)
    for (int b = split; b < 4; b++) most2 = fmax(most2, square_of_difference(moves + 3 * a, moves + 3 * b));
  return sqrt(most2);
}

static double largest(const double *moves, const double mean[3], int begin, int end) {
  double most2 = 0;
  for (int i = begin; i < end; i++) most2 = fmax(most2, square_of_difference(moves + 3 * i, mean));
  return sqrt(most2);
}

double hk_pair_motion(hk_pair_kind kind, const hk_pair_path *path) {
  double moves[12], mean[3] = {0};
  for (int k = 0; k < 12; k++) {
    moves[k] = path->to[k] - path->from[k];
    mean[k % 3] += moves[k] / 4;
  }
  int split = hk_pair_split(kind);
  return largest(moves, mean, 0, split) + largest(moves, mean, split, 4);
}

/* ---- for pictures and messages ---- */

void hk_pair_contact_point(const hk_feature_pair *pair, const double *x, double reach,
                           const hk_contact_points *points) {
  hk_nearest near = hk_pair_nearest(pair, x);
  hk_pair_frame f = hk_pair_frame_of(&near);
  double distance = sqrt(near.squared), middle[3] = {0};
  if (!(distance <= pair->offset + reach) || !(distance > 0)) return;
  for (int i = 0; i < hk_pair_split(pair->kind); i++) hk_add_scaled(middle, near.w[i], x + 3 * (size_t)pair->vertex[i]);
  hk_add_scaled(middle, -0.5, near.d);
  points->add(points->context, middle, f.n);
}

/* An edge of length 0 is a particle. */
static void name(char text[48], const uint32_t *id, const uint32_t *v, int count) {
  if (count == 3)
    snprintf(text, 48, "triangle %u %u %u", id[v[0]], id[v[1]], id[v[2]]);
  else if (count == 2 && v[0] != v[1])
    snprintf(text, 48, "edge %u %u", id[v[0]], id[v[1]]);
  else
    snprintf(text, 48, "particle %u", id[v[0]]);
}

hk_pair_names hk_pair_names_of(const hk_feature_pair *pair, const uint32_t *id) {
  hk_pair_names names;
  int split = hk_pair_split(pair->kind);
  name(names.one, id, pair->vertex, split);
  name(names.other, id, pair->vertex + split, 4 - split);
  return names;
}
