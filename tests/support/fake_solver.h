/* What an implicit method asks of a fake system: Jacobians, matrices, solutions. For a few particles. */
#ifndef HK_TEST_FAKE_SOLVER_H
#define HK_TEST_FAKE_SOLVER_H

#include "tests/support/fake_system.h"

typedef struct fake_solver {
  size_t *row_start, *exchange;
  uint32_t *column;
  double *K, *D, *A, *LU, *work; /* one allocation, at K */
} fake_solver;

void fake_solver_attach(fake_system *);
void fake_solver_detach(fake_system *);

#endif
