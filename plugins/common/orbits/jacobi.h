/* Jacobi's coordinates of bodies in an order, the innermost first: of each its place relative to the centre of mass of
 * those before it, and of the first that of all. The kinetic energy stays a sum of squares, sum m_k' u_k^2/2 with
 * m_k' = m_k M_(k-1)/M_k and M_k = m_0 + ... + m_k, so that accelerations transform as places do. Wisdom and Holman
 * 1991, AJ 102, section 3; Rein and Tamayo 2015, MNRAS 452, section 3. */
#ifndef HK_JACOBI_H
#define HK_JACOBI_H

#include <stddef.h>
#include <stdint.h>

typedef struct hk_jacobi {
  size_t count;
  uint32_t *order; /* indices of particles */
  double *upto;    /* kg: M_k */
  double *part;    /* m_k/M_k */
} hk_jacobi;

/* From masses (kg, by particle) along `order`, which is filled. */
void hk_jacobi_weigh(hk_jacobi *, const double *mass);
/* of: 3 numbers for each particle of the scene; to: 3 for each of the `count` bodies. */
void hk_jacobi_from(const hk_jacobi *, const double *of, double *to);
/* Back: of those particles alone. */
void hk_jacobi_to(const hk_jacobi *, const double *of, double *to);

#endif
