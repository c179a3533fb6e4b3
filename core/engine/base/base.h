/* Basic services of the engine: errors, memory, threads, random numbers, the clock, warnings. */
#ifndef HK_BASE_H
#define HK_BASE_H

#include "core/plugin.h"

#include <stdarg.h>

/* ---- error.c: a status and one sentence, made where the cause is known ---- */

typedef struct hk_error {
  hk_status status;
  char text[1024];
} hk_error;

/* Fills `error`, unless it already contains an error (the first cause counts), and returns `status`. */
hk_status hk_error_set(hk_error *error, hk_status status, const char *format, ...) HK_PRINTF(3, 4);
static inline void hk_error_clear(hk_error *error) {
  error->status = HK_OK;
  error->text[0] = 0;
}
hk_status hk_error_setv(hk_error *error, hk_status status, const char *format, va_list arguments);

/* ---- memory.c: zeroed, 64-byte aligned blocks in a list, so that all memory of a plugin is freed with it ---- */

typedef struct hk_block hk_block;

void *hk_memory_get(hk_block **list, size_t bytes); /* NULL: no memory */
void hk_memory_put(hk_block **list, void *memory);  /* NULL is allowed */
size_t hk_memory_size(const void *memory);          /* bytes that were asked for; 0 for NULL */
void hk_memory_clear(hk_block **list);

/* Grows an array to hold at least `wanted` items of `size` bytes, doubling. Returns 0, or -1 without changing the
 * array. */
int hk_array_reserve(void **array, size_t *capacity, size_t wanted, size_t size);
/* Moves n items of `size` bytes to their places by a map that keeps their order (UINT32_MAX: dropped). The memory of
 * `to` and `from` may overlap; `from` is void afterwards. Returns the number of places up to the last one taken. */
size_t hk_array_move(void *to, void *from, size_t size, const uint32_t *map, size_t n);
char *hk_string_copy(const char *text); /* NULL when text is NULL or without memory */

/* ---- threads.c: a pool for parallel_for. How a range is cut into chunks depends on its length and grain alone, and
 * which thread takes a chunk never shows in a result. A loop within a body runs in the body's thread ---- */

typedef struct hk_threads hk_threads;

hk_threads *hk_threads_create(int threads); /* 1: no further thread is started; NULL: no memory or no thread */
void hk_threads_destroy(hk_threads *);
int hk_threads_count(const hk_threads *);
/* `after` is called in every further thread, at the end of its part of a loop; NULL: nothing. Not while a loop runs. */
void hk_threads_watch(hk_threads *, void (*after)(void));
void hk_threads_for(hk_threads *, size_t count, size_t grain,
                    void (*body)(void *context, size_t begin, size_t end, size_t chunk), void *context);

/* ---- random.c: xoshiro256** 1.0 (Blackman and Vigna 2018, "Scrambled linear pseudorandom number generators"), seeded
 * by splitmix64. The four words of state are the random stream of an instance and are saved with it ---- */

void hk_random_seed(uint64_t state[4], uint64_t seed);
double hk_random_uniform(uint64_t state[4]); /* [0, 1), 53 bits */

/* ---- clock.c ---- */

double hk_clock(void); /* s, monotonic */

/* ---- processor.c ---- */

int hk_processor_lanes(void); /* doubles of the widest vectors that hooke has loops for: 2, 4 or 8 */

/* ---- warnings.c: each text is kept once for the summary and printed once on standard error unless `silent` ---- */

typedef struct hk_warnings {
  size_t count;
  char **text;
  bool silent;
} hk_warnings;

void hk_warn(hk_warnings *, const char *format, ...) HK_PRINTF(2, 3);
void hk_warnings_clear(hk_warnings *);

/* ---- hk_system.queries: what the engine itself asks of a system, beside what methods see ---- */

typedef struct hk_system_queries {
  unsigned flags; /* HK_DEPENDS_ON_... of all forces together */
  /* block[i] as in a force's stiffness_bound, summed over the acting forces that state one. `stiffening`: of those with
   * HK_STIFFENS only. False: there are constraints, or an acting force that depends on x states no bound, whose blocks
   * are not touched; of HK_DAMPING_WHOLE: one that depends on v, and the blocks are those of the others. */
  bool (*stiffness_bound)(hk_system *, hk_stiffness_part part, bool stiffening, double (*block)[6]);
  /* Where no two particles are coupled: F (n x 3, or NULL) and the blocks K and D of the particles begin to end - 1 at
   * x and v (n x 3), with the time's parameters as `impose` left them; K[0] is that of `begin`. False: a force couples
   * particles, has no blocks, or fails, or there are constraints. NULL: not known. */
  bool (*uncoupled)(hk_system *, const double *x, const double *v, size_t begin, size_t end, double *F, double (*K)[9],
                    double (*D)[9]);
  /* Removes from velocities (n x 3) the part that constraints forbid at X, v -= W J^T (J W J^T)^-1 J v. NULL: there are
   * none that could. */
  hk_status (*project_velocity)(hk_system *, double *vector);
} hk_system_queries;

#endif
