/* The name of the BLAS that the libraries of a solver use. The reference BLAS of netlib has no kernels optimised for
 * the processor: large factorizations take 3 to 4 times as long with it. */
#ifndef HK_BLAS_NAME_H
#define HK_BLAS_NAME_H

#include "core/plugin.h"

typedef struct hk_blas {
  char name[128];  /* "OpenBLAS 0.3.21", "reference BLAS"; for an unknown library the name of its file */
  char file[1024]; /* file of dgemm_, with links resolved; "" when no BLAS is loaded */
  bool reference;
} hk_blas;

/* Finds the BLAS that is loaded with this plugin. */
void hk_blas_loaded(hk_blas *);
/* The same by the resolved file name and, for FlexiBLAS, which passes every call on, the name of its backend; otherwise
 * NULL. */
void hk_blas_judge(hk_blas *, const char *file, const char *backend);
/* "LIBRARY, NAME", with a remark on the reference BLAS; for hk_solver.describe. */
void hk_blas_describe(const char *library, char *text, size_t size);
/* Warns through the host when LIBRARY uses the reference BLAS, and names the package to install. */
void hk_blas_warn(const hk_host *, const char *library);

#endif
