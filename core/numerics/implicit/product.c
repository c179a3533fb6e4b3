/* Products of the Jacobian with a vector, by the forces' blocks. */
#include "core/numerics/implicit/implicit.h"

#include <stdlib.h>
#include <string.h>

hk_status hk_implicit_product(hk_system *s, double t, const double *X, const double *dx, const double *dv, double *dF) {
  hk_dynamics *d = (hk_dynamics *)(void *)s;
  hk_matrix K, D;
  hk_implicit_matrix *m = hk_implicit_matrix_of(d);
  size_t bytes = d->state->size * sizeof *X;
  if (m && !m->X) m->X = malloc(bytes);
  if (!m || !m->X) return hk_error_set(d->error, HK_NO_MEMORY, "no memory for a product");
  memcpy(m->X, X, bytes); /* the assembly imposes the pins on it */
  hk_status status = hk_jacobian_assemble(s, t, m->X, 0, &K, &D);
  memset(dF, 0, 3 * s->n * sizeof *dF);
  for (size_t i = 0; i < s->n && status == HK_OK; i++)
    for (size_t e = K.row_start[i]; e < K.row_start[i + 1]; e++)
      for (int p = 0; p < 9; p++) {
        size_t at = 3 * (size_t)K.column[e] + (size_t)(p % 3);
        dF[3 * i + (size_t)(p / 3)] -= K.value[9 * e + p] * dx[at] + D.value[9 * e + p] * dv[at];
      }
  return status;
}
