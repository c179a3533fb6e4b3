/* Rods with the vectors that every x86-64 and arm64 has; and the choice of the widest path. */
#include "plugins/common/rods/rod_path.h"

#include <math.h>

#define TARGET
#define INLINE static inline __attribute__((always_inline))
#define WIDTH 2
#define SPREAD(a) ((vector){(a), (a)})

typedef double vector __attribute__((vector_size(16), aligned(8), may_alias));
typedef int64_t mask __attribute__((vector_size(16), aligned(8), may_alias));
typedef uint64_t bits __attribute__((vector_size(16), aligned(8), may_alias));

INLINE vector root(vector a) { return (vector){sqrt(a[0]), sqrt(a[1])}; }
INLINE double sum(vector a) { return a[0] + a[1]; }

#include "plugins/common/rods/rod_loops.h"

/* The rows whose first two lanes are the last two of r. */
static hk_rod_rows last_two(const hk_rod_rows *r) {
  hk_rod_rows s = *r;
  double **const moved[] = {&s.bend[0], &s.bend[1], &s.twist, &s.rest[0], &s.rest[1], &s.rest_twist,
                            &s.held,    &s.inverse, &s.angle, &s.turn[0], &s.turn[1], &s.offset,
                            &s.pivot,   &s.lower,   &s.right, &s.column};
  for (size_t k = 0; k < sizeof moved / sizeof *moved; k++) *moved[k] += WIDTH;
  for (int c = 0; c < 3; c++) s.x[c] += WIDTH, s.f[c] += WIDTH, s.t[c] += WIDTH, s.a[c] += WIDTH;
  return s;
}

static bool sound_of_four(const hk_rod_rows *r, const hk_rod_batch *b) {
  hk_rod_rows s = last_two(r);
  return sound(r, b) && sound(&s, b);
}

static double plain_of_four(const hk_rod_rows *r, const hk_rod_batch *b) {
  hk_rod_rows s = last_two(r);
  double energy = plain(r, b);
  return energy + plain(&s, b);
}

static void frames_of_four(const hk_rod_rows *r, const hk_rod_batch *b) {
  hk_rod_rows s = last_two(r);
  frames(r, b);
  frames(&s, b);
}

static bool solve_of_four(const hk_rod_rows *r, const hk_rod_batch *b) {
  hk_rod_rows s = last_two(r);
  return solve(r, b) && solve(&s, b);
}

static double forces_of_four(const hk_rod_rows *r, const hk_rod_batch *b) {
  hk_rod_rows s = last_two(r);
  double energy = forces(r, b);
  return energy + forces(&s, b);
}

const hk_rod_path hk_rod_narrow = {"vectors of two", gather,        sound_of_four, plain_of_four,
                                   frames_of_four,   solve_of_four, forces_of_four};

const hk_rod_path *hk_rod_best(void) {
  const hk_rod_path *wide = hk_rod_wide();
  return wide ? wide : &hk_rod_narrow;
}
