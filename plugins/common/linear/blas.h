/* The BLAS behind SuiteSparse: its number of threads, and keeping it loaded. */
#ifndef HK_BLAS_H
#define HK_BLAS_H

/* Sets the number of threads of OpenBLAS and of SuiteSparse's own OpenMP for the whole process. Has no effect on
 * another BLAS. */
void hk_blas_threads(int threads);
/* OpenMP and the BLAS have threads that wait inside their libraries, so these must never be unloaded: this call keeps
 * them loaded until the end of the process, like the plugin itself. */
void hk_blas_stay_loaded(void);

#endif
