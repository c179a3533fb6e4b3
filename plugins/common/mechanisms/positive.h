/* The part of a symmetric matrix without its negative eigenvalues. */
#ifndef HK_POSITIVE_H
#define HK_POSITIVE_H

enum { HK_POSITIVE_ROWS = 12 };

/* A, 12 x 12 by rows, becomes the nearest matrix that is positive semi-definite, by Frobenius' norm, by the cyclic
 * method of Jacobi (Golub and Van Loan, Matrix Computations, section 8.5; Higham, Linear Algebra Appl. 103 (1988) 103).
 */
void hk_without_negative(double *A);

#endif
