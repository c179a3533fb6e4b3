/* Joints one by one, for what is not in the inner loops; the formulas are those of rod_loops.h. */
#include "plugins/common/rods/rod_joint.h"
#include "plugins/kit/vector3.h"

enum { LANES = HK_ROD_LANES };

static void transport(const hk_rod_joint *j, const double a[3], double to[3]) {
  double along = hk_dot(a, j->t1) / j->chi;
  for (int c = 0; c < 3; c++) to[c] = a[c] - along * (j->t0[c] + j->t1[c]);
}

/* Directors for a rod whose sections have no sides: any. */
static void any_directors(hk_rod_joint *j) {
  double axis[3] = {0};
  int least = 0;
  for (int c = 1; c < 3; c++)
    if (fabs(j->t0[c]) < fabs(j->t0[least])) least = c;
  axis[least] = 1;
  hk_cross(j->d[0], j->t0, axis);
  double size = hk_length(j->d[0]);
  for (int c = 0; c < 3 && size > 0; c++) j->d[0][c] /= size;
  hk_cross(j->d[1], j->t0, j->d[0]);
}

static void halfway_directors(const hk_rod_rows *w, size_t at, double half, hk_rod_joint *j) {
  double a[3], b[3], s = sin(half), c = cos(half);
  for (int q = 0; q < 3; q++) a[q] = w->a[q][at];
  hk_cross(b, j->t0, a);
  for (int q = 0; q < 3; q++) j->d[0][q] = c * a[q] + s * b[q], j->d[1][q] = c * b[q] - s * a[q];
}

static void edge_at(const hk_rod_rows *w, size_t node, double t[3], double *inverse) {
  for (int c = 0; c < 3; c++) t[c] = w->x[c][node + LANES] - w->x[c][node];
  double l2 = hk_dot(t, t);
  *inverse = l2 > 1e-300 ? 1 / sqrt(l2) : 0;
  for (int c = 0; c < 3; c++) t[c] *= *inverse;
}

void hk_rod_joint_at(const hk_rods *r, const hk_rod_batch *b, size_t lane, size_t k, hk_rod_joint *j) {
  const hk_rod_rows *w = &r->rows;
  size_t first = b->first * LANES + lane, at = first + k * LANES, node = (b->first + b->number) * LANES + lane;
  size_t after = k + 1 < b->count[lane] ? k + 1 : 0, next = first + after * LANES;
  edge_at(w, node + k * LANES, j->t0, &j->inverse[0]);
  edge_at(w, node + after * LANES, j->t1, &j->inverse[1]);
  j->chi = fmax(1 + hk_dot(j->t0, j->t1), HK_ROD_FOLD);
  hk_cross(j->kb, j->t0, j->t1);
  for (int c = 0; c < 3; c++) j->kb[c] *= 2 / j->chi, j->mean[c] = (j->t0[c] + j->t1[c]) / j->chi;
  double angle1 = b->framed ? w->angle[next] + w->offset[at] : 0, angle0 = b->framed ? w->angle[at] : 0;
  if (b->framed)
    halfway_directors(w, at, (angle0 + angle1) / 2, j);
  else
    any_directors(j);
  j->k[0] = hk_dot(j->kb, j->d[1]);
  j->k[1] = -hk_dot(j->kb, j->d[0]);
  for (int c = 0; c < 2; c++) {
    transport(j, j->d[c], j->e[c]);
    j->bend[c] = w->bend[c][at];
    j->w[c] = j->bend[c] * (j->k[c] - w->rest[c][at]);
  }
  j->twist = b->framed ? w->twist[at] : 0;
  j->torque = j->twist * (angle1 - angle0 - w->rest_twist[at]);
}

void hk_rod_joint_damping(const hk_rods *r, size_t row, hk_rod_joint *j) {
  double twist = r->rows.twist[row] > 0 ? r->rows.twist[row] : (j->bend[0] + j->bend[1]) / 2;
  j->twist = r->retardation * twist;
  for (int c = 0; c < 2; c++) j->bend[c] *= r->retardation;
}

/* The derivatives of k_c and of the twist. */
void hk_rod_joint_gradients(const hk_rod_joint *j, double g[2][6], double m[6]) {
  for (int c = 0; c < 2; c++) {
    double D[3], one[3], two[3];
    for (int q = 0; q < 3; q++) D[q] = (c == 0 ? j->d[1][q] + j->e[1][q] : -j->d[0][q] - j->e[0][q]) / j->chi;
    hk_cross(one, j->t1, D);
    hk_cross(two, j->t0, D);
    for (int q = 0; q < 3; q++) {
      g[c][q] = j->inverse[0] * (one[q] - j->k[c] * j->mean[q]);
      g[c][3 + q] = -j->inverse[1] * (two[q] + j->k[c] * j->mean[q]);
    }
  }
  for (int q = 0; q < 6; q++) m[q] = j->inverse[q / 3] * j->kb[q % 3] / 2;
}
