/* 3 x 3 matrices, row-major, and what their decompositions are needed for: projections of Hessians. */
#ifndef HK_MATRIX3_H
#define HK_MATRIX3_H

/* F = U diag(s) V^T with orthogonal U and V, for any finite F, and s >= 0 in no order. */
void hk_matrix3_svd(const double F[9], double U[9], double s[3], double V[9]);

/* A = Q diag(value) Q^T for the symmetric A, of which the upper triangle is read; the columns of Q are orthonormal. */
void hk_matrix3_eigen(const double A[9], double value[3], double Q[9]);

/* The derivative of det F with respect to F, whose rows are cross products of the rows of F. Returns det F. */
double hk_matrix3_cofactor(const double F[9], double cofactor[9]);

#endif
