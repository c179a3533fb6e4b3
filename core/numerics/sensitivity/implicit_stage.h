/* Implicit stages, a_k = a(P + h^2 x_kk a_k, Q + h v_kk a_k): their solution where steps are taken again, and the
 * linear system by which tangents and adjoints pass through one. With A = M + h v_kk D + h^2 x_kk K at the stage's
 * point, the change of a_k is A^-1 M times that of the acceleration where its own terms are held fixed; backwards it is
 * M A^-T. */
#ifndef HK_IMPLICIT_STAGE_H
#define HK_IMPLICIT_STAGE_H

#include "core/numerics/implicit/implicit.h"
#include "core/numerics/sensitivity/sensitivity.h"

bool hk_implicit_stage_is(const hk_stages_facet *, size_t k);
/* One for a record; NULL: no memory. */
hk_implicit_stage *hk_implicit_stage_create(size_t n);
void hk_implicit_stage_free(hk_implicit_stage *);
/* X, 6n, has the point without its own terms, and then the whole; a: on entry a guess, then the acceleration, up to
 * rounding. */
hk_status hk_implicit_stage_settle(hk_sensitivity *, const hk_taken_step *, size_t k, double *X, double *a);
/* Sets A at the point of stage k, or its transpose, for `solve`. */
hk_status hk_implicit_stage_linearise(hk_sensitivity *, const hk_taken_step *, size_t k, bool transposed);
/* u (3n) of the accelerations becomes A^-1 M u; where A is transposed, M A^-T u. */
hk_status hk_implicit_stage_pass(hk_sensitivity *, double *u);

#endif
