/* The BLAS behind SuiteSparse: how many threads it takes, and that it stays loaded. */
#ifndef HK_BLAS_H
#define HK_BLAS_H

/* Of an OpenBLAS, and of SuiteSparse's own OpenMP; for the whole process. With another BLAS nothing happens. */
void hk_blas_threads(int threads);
/* OpenMP and the BLAS leave threads that wait inside their libraries, so these must never be unloaded: they stay as
 * long as the plugin that calls this, which is to the end of the process. */
void hk_blas_stay_loaded(void);

#endif
