/* A pool of threads for parallel_for: how a range is cut into chunks depends on its length and grain alone, and which
 * thread takes a chunk never shows in a result. */
#ifndef HK_THREADS_H
#define HK_THREADS_H

#include <stddef.h>

typedef struct hk_threads hk_threads;

hk_threads *hk_threads_create(int threads); /* 1: no further thread is started; NULL: no memory or no thread */
void hk_threads_destroy(hk_threads *);
int hk_threads_count(const hk_threads *);
void hk_threads_for(hk_threads *, size_t count, size_t grain,
                    void (*body)(void *context, size_t begin, size_t end, size_t chunk), void *context);

#endif
