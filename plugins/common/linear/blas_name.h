/* Which BLAS the libraries of a solver run on. The BLAS of netlib, the reference, has no kernels for the processor:
 * large factorizations take 3 to 4 times as long on it. */
#ifndef HK_BLAS_NAME_H
#define HK_BLAS_NAME_H

#include "core/plugin.h"

typedef struct hk_blas {
  char name[128];  /* "OpenBLAS 0.3.21", "reference BLAS"; of a library that is not known its file's name */
  char file[1024]; /* that dgemm_ is in, links followed; "" when no BLAS is loaded */
  bool reference;
} hk_blas;

/* The BLAS that this plugin sees. */
void hk_blas_loaded(hk_blas *);
/* The same from the file, links followed, and, for FlexiBLAS, which hands every call on, its backend; else NULL. */
void hk_blas_judge(hk_blas *, const char *file, const char *backend);
/* "LIBRARY, NAME", with a word on the reference BLAS: for hk_solver.describe. */
void hk_blas_describe(const char *library, char *text, size_t size);
/* Warns, through the host, when LIBRARY runs on the reference BLAS, and says what to install. */
void hk_blas_warn(const hk_host *, const char *library);

#endif
