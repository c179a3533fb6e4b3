/* The second derivatives of an energy of the squared distance of a pair, in a form from which the 3 x 3 block of any
 * two of its points is a few products: they live in five of the twelve dimensions (distance_energy.c), w (x) all of
 * space and two changes of the weights (x) n. H_ij = w_i w_j T + g_ij n n^T + w_j n q_i^T + w_i q_j n^T */
#ifndef HK_DISTANCE_FORM_H
#define HK_DISTANCE_FORM_H

#include "plugins/common/collision/distance.h"

typedef struct hk_distance_form {
  double w[4]; /* weights of the nearest points */
  double n[3]; /* the unit vector of d */
  double g[4][4];
  double q[4][3]; /* at right angles to n */
  double T[9];    /* across n, symmetric */
} hk_distance_form;

/* Of E(squared) with the derivatives E1 and E2, as hk_distance_energy_hessian. */
void hk_distance_energy_form(const hk_nearest *, const double x[12], double E1, double E2, bool definite,
                             hk_distance_form *);

/* Adds the blocks of point i and each of the four, factor H_ij, to B + 9 slot[j]. */
static inline void hk_distance_form_row(const hk_distance_form *f, int i, double factor, const size_t slot[4],
                                        double *B) {
  double wi = factor * f->w[i], from[9];
  for (int e = 0; e < 9; e++) from[e] = factor * f->n[e / 3] * f->q[i][e % 3];
  for (int j = 0; j < 4; j++) {
    double *to = B + 9 * slot[j], along[3], shared = factor * f->g[i][j], both = wi * f->w[j], wj = f->w[j];
    for (int c = 0; c < 3; c++) along[c] = shared * f->n[c] + wi * f->q[j][c];
    for (int e = 0; e < 9; e++) to[e] += both * f->T[e] + along[e / 3] * f->n[e % 3] + wj * from[e];
  }
}

#endif
