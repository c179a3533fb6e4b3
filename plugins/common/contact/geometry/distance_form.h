/* The second derivatives of an energy of the squared distance of a pair, in a form from which the 3 x 3 block of any
 * two of its points is a few products: they live in five of the twelve dimensions (distance_energy.c), w (x) all of
 * space and two changes of the weights (x) n. H_ij = w_i w_j T + g_ij n n^T + w_j n q_i^T + w_i q_j n^T */
#ifndef HK_DISTANCE_FORM_H
#define HK_DISTANCE_FORM_H

#include "plugins/common/contact/geometry/distance.h"
#include "plugins/common/linear/block_vector.h"

typedef struct hk_distance_form {
  double w[4]; /* weights of the nearest points */
  double n[4]; /* the unit vector of d, and 0 */
  double g[4][4];
  double q[4][4]; /* at right angles to n, and 0 */
  double T[9];    /* across n, symmetric */
} hk_distance_form;

/* Of E(squared) with the derivatives E1 and E2, as hk_distance_energy_hessian. */
void hk_distance_energy_form(const hk_nearest *, const double x[12], double E1, double E2, bool definite,
                             hk_distance_form *);

/* Adds the blocks of point i and each of the four to B + 9 slot[j]. A block is taken as two vectors and a number. */
HK_INLINE void hk_distance_form_row(const hk_distance_form *f, int i, const size_t slot[4], double *B) {
  const vector n = LOAD(f->n), q = LOAD(f->q[i]), T0 = LOAD(f->T), T1 = LOAD(f->T + 4);
  const vector n0 = {n[0], n[1], n[2], n[0]}, n1 = {n[1], n[2], n[0], n[1]};
  const vector from0 = (vector){n[0], n[0], n[0], n[1]} * (vector){q[0], q[1], q[2], q[0]},
               from1 = (vector){n[1], n[1], n[2], n[2]} * (vector){q[1], q[2], q[0], q[1]};
  const double wi = f->w[i], from2 = n[2] * q[2], T2 = f->T[8], n2 = n[2];
  for (int j = 0; j < 4; j++) {
    const double wj = f->w[j], both = wi * wj;
    const vector along = f->g[i][j] * n + wi * LOAD(f->q[j]);
    const vector a0 = {along[0], along[0], along[0], along[1]}, a1 = {along[1], along[1], along[2], along[2]};
    double *to = B + 9 * slot[j];
    STORE(to, LOAD(to) + (both * T0 + a0 * n0 + wj * from0));
    STORE(to + 4, LOAD(to + 4) + (both * T1 + a1 * n1 + wj * from1));
    to[8] += both * T2 + along[2] * n2 + wj * from2;
  }
}

#endif
