/* The neighbours within the kernel with the weights of their pairs, listed once for many sums at the same positions:
 * what Jacobi's iterations of a pressure go through again and again.
 *
 * A pair weighs s = w_i w_j (1 - t)^3/w0^2, t = r/R, w0 = density spacing^3: with S = steepness w0^2 (sph_kernel.h)
 *     w_i w_j grad W = -S s d,   d = x_i - x_j,
 * which is the same number for both of a pair. It is kept in single precision, off by at most 6e-8 of itself, while
 * d is taken from the positions: what a pair does to one of it is then what it does to the other with the opposite
 * sign, and along d, so that momenta are kept as with doubles, in a quarter of the memory of gradients in doubles.
 *
 * Rows are padded to fours with the particle itself, whose d is 0. */
#ifndef HK_SPH_LIST_H
#define HK_SPH_LIST_H

#include "plugins/common/sph/sph_sums.h"

enum { HK_SPH_FOUR = 4 };

typedef struct hk_sph_list {
  double (*point)[4]; /* n, as hk_sph.point: what the list is of */
  size_t n;           /* 0: of nothing */
  double *density;    /* n, kg/m^3; of what is not liquid 0, as the diagonal */
  double *diagonal;   /* n, kg/m^6: |sum w_j grad W|^2/m_i + sum over the liquid of w_j^2 |grad W|^2/m_j */
  size_t *start;      /* n: of the row */
  uint32_t *count;    /* n: of its entries, a multiple of 4; 0 of what is neither liquid nor a wall that moves */
  uint32_t *other;
  float *weight;
  size_t point_room, density_room, diagonal_room, start_room, count_room, other_room, weight_room;
} hk_sph_list;

/* The list of these rows, after hk_sph_begin; nothing is done where it is that of the same positions and masses, as at
 * the start of a step that goes on where the last one ended. HK_NO_MEMORY */
hk_status hk_sph_list_make(hk_sph_list *, const hk_sph_rows *, const hk_view *view);
/* To be called when roles or pins may have changed. */
static inline void hk_sph_list_forget(hk_sph_list *l) { l->n = 0; }

/* S, kg^2/m^5. */
static inline double hk_sph_list_scale(const hk_sph *s) {
  double w0 = s->density * s->spacing * s->spacing * s->spacing;
  return s->kernel.steepness * w0 * w0;
}

#endif
