/* A solver plugin together with the pattern it has analysed. */
#ifndef HK_LINEAR_SYSTEM_H
#define HK_LINEAR_SYSTEM_H

#include "core/dynamics/dynamics.h"

typedef struct hk_linear_system {
  hk_instance *solver;
  hk_instance *narrow; /* NULL, or one that is asked before `solver` whether it takes a pattern (HK_NARROW) */
  hk_instance *chosen; /* the one of both that has analysed the pattern */
  uint64_t pattern;    /* number or hash of the analysed pattern */
  bool analyzed;
  size_t rows; /* length of a right-hand side */
} hk_linear_system;

/* Analyses A when its pattern differs from the last one, then factorizes it. */
hk_status hk_linear_system_factorize(hk_dynamics *, hk_linear_system *, const hk_matrix *A);
hk_status hk_linear_system_solve(hk_dynamics *, hk_linear_system *, const double *b, double *x,
                                 hk_solve_info *info); /* info: or NULL */
hk_status hk_linear_system_solve_columns(hk_dynamics *, hk_linear_system *, const double *b, double *x, size_t columns);

#endif
