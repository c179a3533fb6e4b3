/* Eight springs at a time, in one pass, for x86-64 with AVX-512. A run of springs is read and written as three vectors
 * of eight numbers, in the layout of x. A number of springs that is not a multiple of eight ends with a step of four,
 * with the same operations on half of the lanes.
 *
 * Roots and reciprocals are the processor's own. An estimate (vrsqrt14pd) with Newton steps by fused multiply-add and a
 * last correction can be made to give the same bits, but costs more than it saves. Measured on Zen 5 with data in the
 * first-level cache: root and reciprocal take 0.38 ns by the divider, which works beside everything else, 0.31 by
 * estimates, 0.24 with an estimate for the root alone; but the multipliers are what a spring needs too, so that a
 * damped one takes 1.26 ns with the estimated root and 1.09 without. */
#include "plugins/common/springs/spring_path.h"

#if defined(__x86_64__)

#include <immintrin.h>

#define WIDE __attribute__((target("avx512f,avx512vl")))
#define INLINE WIDE __attribute__((always_inline)) static inline

typedef __m512d vector;
typedef __m256d half; /* one number of four springs */

#define PICK __builtin_shufflevector

enum { WIDTH = 8, ALL = 0xFF, LOW_HALF = 0x0F };

/* Lanes beyond the mask are 0. */
INLINE vector load(const double *p, __mmask8 lanes) {
  return lanes == ALL ? _mm512_loadu_pd(p) : _mm512_maskz_loadu_pd(lanes, p);
}

INLINE void add(double *p, __mmask8 lanes, vector value) {
  if (lanes == ALL)
    _mm512_storeu_pd(p, _mm512_loadu_pd(p) + value);
  else
    _mm512_mask_storeu_pd(p, lanes, _mm512_maskz_loadu_pd(lanes, p) + value);
}

/* The numbers that `count` springs of a run, 8 or 4, have in each of three vectors. */
typedef struct lanes {
  __mmask8 spring, r[3];
} lanes;

INLINE lanes lanes_of(size_t count) {
  return count == WIDTH ? (lanes){ALL, {ALL, ALL, ALL}} : (lanes){LOW_HALF, {ALL, LOW_HALF, 0}};
}

/* What a spring's scale is made of. */
typedef struct stretch {
  vector w, l, r; /* u.d, l, 1/l^2 */
} stretch;

/* Those that are not `here` count as of length 0. */
INLINE stretch stretch_of(vector l2, vector w, __mmask8 here) {
  const vector one = _mm512_set1_pd(1), tiny = _mm512_set1_pd(HK_SPRING_TINY);
  vector safe = _mm512_mask_mov_pd(one, _mm512_mask_cmp_pd_mask(here, l2, tiny, _CMP_GT_OQ), l2);
  return (stretch){w, _mm512_sqrt_pd(safe), one / safe};
}

/* s of springs e..; adds c w^2/l^2 to *part, four springs after four. */
INLINE vector scales(const hk_spring_numbers *q, size_t e, __mmask8 springs, __mmask8 here, const stretch *t,
                     half *part) {
  vector cwr = load(q->c + (e & q->each_c), springs) * t->w * t->r, p = cwr * t->w;
  *part += _mm512_castpd512_pd256(p);
  *part += _mm512_extractf64x4_pd(p, 1);
  vector elastic = load(q->k + (e & q->each_k), springs) * (t->l - load(q->L + (e & q->each_L), springs)) * t->l * t->r;
  return _mm512_maskz_add_pd(here, elastic, cwr);
}

INLINE double total(half part) { return (part[0] + part[1]) + (part[2] + part[3]); }

/* ---- runs ---- */

/* Sums of three neighbours, each as (x + y) + z: x, y and z are first collected in their lanes, then put in order. */
INLINE vector sum3(const vector q[3]) {
  vector ax = PICK(q[0], q[1], 0, 9, 2, 3, 12, 5, 6, 15), ay = PICK(q[0], q[1], 0, 1, 10, 3, 4, 13, 6, 7);
  vector az = PICK(q[0], q[1], 8, 1, 2, 11, 4, 5, 14, 7);
  vector x = PICK(PICK(ax, q[2], 0, 1, 10, 3, 4, 13, 6, 7), q[2], 0, 3, 6, 1, 4, 7, 2, 5);
  vector y = PICK(PICK(ay, q[2], 8, 1, 2, 11, 4, 5, 14, 7), q[2], 1, 4, 7, 2, 5, 0, 3, 6);
  vector z = PICK(PICK(az, q[2], 0, 9, 2, 3, 12, 5, 6, 15), q[2], 2, 5, 0, 3, 6, 1, 4, 7);
  return x + y + z;
}

typedef struct ends {
  const double *xi, *xj, *vi, *vj;
  const uint8_t *present;
} ends;

/* Springs e.. of a run on their way: d in the layout of x, and their roots and reciprocals. */
typedef struct step {
  vector d[3];
  stretch t;
  __mmask8 here;
} step;

INLINE step begin_step(const ends *at, size_t e, const lanes *m, bool damped) {
  step s;
  vector w = _mm512_setzero_pd(), p[3];
  for (size_t r = 0, k = 3 * e; r < 3; r++, k += WIDTH) s.d[r] = load(at->xj + k, m->r[r]) - load(at->xi + k, m->r[r]);
  if (damped) {
    for (size_t r = 0, k = 3 * e; r < 3; r++, k += WIDTH)
      p[r] = s.d[r] * (load(at->vj + k, m->r[r]) - load(at->vi + k, m->r[r]));
    w = sum3(p);
  }
  for (size_t r = 0; r < 3; r++) p[r] = s.d[r] * s.d[r];
  s.here = at->present[e / WIDTH];
  s.t = stretch_of(sum3(p), _mm512_maskz_mov_pd(s.here, w), s.here);
  return s;
}

/* Their forces on the first ends, which are added to these. */
INLINE void end_step(const hk_spring_numbers *q, size_t e, const lanes *m, const step *of, double *Fi, half *part,
                     vector f[3]) {
  hk_spring_fetch(q, e);
  vector s = scales(q, e, m->spring, of->here, &of->t, part);
  f[0] = of->d[0] * PICK(s, s, 0, 0, 0, 1, 1, 1, 2, 2);
  f[1] = of->d[1] * PICK(s, s, 2, 3, 3, 3, 4, 4, 4, 5);
  f[2] = of->d[2] * PICK(s, s, 5, 5, 6, 6, 6, 7, 7, 7);
  for (size_t r = 0; r < 3; r++) add(Fi + 3 * e + WIDTH * r, m->r[r], f[r]);
}

INLINE void end_far(const hk_spring_numbers *q, size_t e, size_t count, const step *of, double *Fi, double *Fj,
                    half *part) {
  const lanes m = lanes_of(count);
  vector f[3];
  end_step(q, e, &m, of, Fi, part, f);
  for (size_t r = 0; r < 3; r++) add(Fj + 3 * e + WIDTH * r, m.r[r], -f[r]);
}

/* A step begins before the one ahead of it ends: the processor does not see far enough ahead to find work while it
 * waits for roots and reciprocals. */
INLINE double far_springs(const hk_spring_numbers *q, size_t n, const uint8_t *present, const double *xi,
                          const double *xj, const double *vi, const double *vj, double *Fi, double *Fj, bool damped) {
  const ends at = {xi, xj, vi, vj, present};
  const lanes all = lanes_of(WIDTH), some = lanes_of(HK_SPRING_LANES);
  half part = {0};
  size_t e = 0;
  if (n >= WIDTH) {
    step next = begin_step(&at, 0, &all, damped);
    for (; e + 2 * WIDTH <= n; e += WIDTH) {
      const step now = next;
      next = begin_step(&at, e + WIDTH, &all, damped);
      end_far(q, e, WIDTH, &now, Fi, Fj, &part);
    }
    end_far(q, e, WIDTH, &next, Fi, Fj, &part);
    e += WIDTH;
  }
  if (e < n) {
    step last = begin_step(&at, e, &some, damped);
    end_far(q, e, HK_SPRING_LANES, &last, Fi, Fj, &part);
  }
  return total(part);
}

INLINE void end_near(const hk_spring_numbers *q, size_t e, size_t count, const step *of, double *Fi, double *buffer,
                     half *part) {
  const lanes m = lanes_of(count);
  vector f[3];
  end_step(q, e, &m, of, Fi, part, f);
  for (size_t r = 0; r < 3; r++) _mm512_storeu_pd(buffer + 3 * e + WIDTH * r, f[r]);
}

INLINE double near_springs(const hk_spring_numbers *q, size_t n, const uint8_t *present, const double *xi,
                           const double *xj, const double *vi, const double *vj, double *Fi, double *Fj, bool damped) {
  const ends at = {xi, xj, vi, vj, present};
  const lanes all = lanes_of(WIDTH), some = lanes_of(HK_SPRING_LANES);
  half part = {0};
  double f[3 * (HK_SPRING_BLOCK + WIDTH)] __attribute__((aligned(64)));
  size_t e = 0, k = 0;
  if (n >= WIDTH) {
    step next = begin_step(&at, 0, &all, damped);
    for (; e + 2 * WIDTH <= n; e += WIDTH) {
      const step now = next;
      next = begin_step(&at, e + WIDTH, &all, damped);
      end_near(q, e, WIDTH, &now, Fi, f, &part);
    }
    end_near(q, e, WIDTH, &next, Fi, f, &part);
    e += WIDTH;
  }
  if (e < n) {
    step last = begin_step(&at, e, &some, damped);
    end_near(q, e, HK_SPRING_LANES, &last, Fi, f, &part);
  }
  for (; k + WIDTH <= 3 * n; k += WIDTH) add(Fj + k, ALL, -load(f + k, ALL));
  if (k < 3 * n) add(Fj + k, LOW_HALF, -load(f + k, LOW_HALF));
  return total(part);
}

/* ---- lists ---- */

/* The rows of eight particles, three numbers and an unused one each, to columns; end: the first or the second of each
 * pair. */
INLINE void columns(const double *x, const uint32_t (*pair)[2], int end, vector column[3]) {
  vector r[4];
  for (size_t k = 0; k < 4; k++)
    r[k] = _mm512_insertf64x4(_mm512_castpd256_pd512(_mm256_loadu_pd(x + 3 * (size_t)pair[k][end])),
                              _mm256_loadu_pd(x + 3 * (size_t)pair[k + 4][end]), 1);
  vector a = PICK(r[0], r[1], 0, 8, 2, 10, 4, 12, 6, 14), b = PICK(r[2], r[3], 0, 8, 2, 10, 4, 12, 6, 14);
  vector c = PICK(r[0], r[1], 1, 9, 3, 11, 5, 13, 7, 15), d = PICK(r[2], r[3], 1, 9, 3, 11, 5, 13, 7, 15);
  column[0] = PICK(a, b, 0, 1, 8, 9, 4, 5, 12, 13);
  column[1] = PICK(c, d, 0, 1, 8, 9, 4, 5, 12, 13);
  column[2] = PICK(a, b, 2, 3, 10, 11, 6, 7, 14, 15);
}

/* The forces of eight springs, x and y as a pair, z alone. */
typedef struct pulls {
  double xy[WIDTH][2], z[WIDTH];
} __attribute__((aligned(64))) pulls;

INLINE void store_pulls(pulls *p, const vector f[3]) {
  _mm512_store_pd(p->xy[0], PICK(f[0], f[1], 0, 8, 1, 9, 2, 10, 3, 11));
  _mm512_store_pd(p->xy[4], PICK(f[0], f[1], 4, 12, 5, 13, 6, 14, 7, 15));
  _mm512_store_pd(p->z, f[2]);
}

/* Where the springs of a call are read from. */
typedef struct source {
  const hk_spring_numbers *q;
  const double *x, *v;
  bool damped;
} source;

/* The springs of a slot on their way: d from the first to the second ends, and their roots and reciprocals. */
typedef struct slot_step {
  vector d[3];
  stretch t;
} slot_step;

/* Of the slot that begins at `pair`, whose first ends are at x and v. Lanes beyond the slot have any numbers. */
INLINE slot_step begin_slot(const source *s, const uint32_t (*pair)[2], const vector x[3], const vector v[3]) {
  slot_step o;
  vector u[3], w = _mm512_setzero_pd();
  columns(s->x, pair, 1, o.d);
  for (size_t r = 0; r < 3; r++) o.d[r] -= x[r];
  if (s->damped) {
    columns(s->v, pair, 1, u);
    for (size_t r = 0; r < 3; r++) u[r] -= v[r];
    w = o.d[0] * u[0] + o.d[1] * u[1] + o.d[2] * u[2];
  }
  o.t = stretch_of(o.d[0] * o.d[0] + o.d[1] * o.d[1] + o.d[2] * o.d[2], w, ALL);
  return o;
}

/* The forces of its `count` springs e, ...: subtracted from those on the second ends, added to sum[], and c w^2/l^2 to
 * *part. */
INLINE void end_slot(const source *s, size_t e, const uint32_t (*pair)[2], size_t count, const slot_step *of, double *F,
                     vector sum[3], vector *part) {
  const __mmask8 here = (__mmask8)(ALL >> (WIDTH - count));
  const hk_spring_numbers *q = s->q;
  const stretch *b = &of->t;
  pulls p;
  vector f[3];
  __builtin_prefetch(pair + HK_SPRING_AHEAD);
  hk_spring_fetch(q, e);
  vector cwr = load(q->c + (e & q->each_c), ALL) * b->w * b->r;
  vector k = load(q->k + (e & q->each_k), ALL), L = load(q->L + (e & q->each_L), ALL);
  vector scale = k * (b->l - L) * b->l * b->r + cwr;
  *part += _mm512_maskz_mul_pd(here, cwr, b->w);
  for (size_t r = 0; r < 3; r++) f[r] = of->d[r] * scale;
  for (size_t r = 0; r < 3; r++) sum[r] = _mm512_mask_add_pd(sum[r], here, sum[r], f[r]);
  store_pulls(&p, f);
  if (count == WIDTH) /* an own loop: the compiler knows its length */
    for (size_t r = 0; r < WIDTH; r++) hk_spring_push(F + 3 * (size_t)pair[r][1], p.xy[r], p.z[r]);
  else
    for (size_t r = 0; r < count; r++) hk_spring_push(F + 3 * (size_t)pair[r][1], p.xy[r], p.z[r]);
}

/* As in a run, a slot begins before the one ahead of it ends: the processor then adds the forces of this one while it
 * waits for the roots of that. Returns the number of springs. */
INLINE size_t slice_step(const source *s, size_t e, const uint32_t (*pair)[2], const uint8_t *slot, double *F,
                         vector *part) {
  const uint32_t(*own)[2] = pair;
  const size_t bundles = slot[0];
  pulls p;
  vector x[3], v[3], sum[3];
  columns(s->x, pair, 0, x);
  if (s->damped) columns(s->v, pair, 0, v);
  for (size_t r = 0; r < 3; r++) sum[r] = _mm512_setzero_pd();
  slot_step next = begin_slot(s, pair, x, v);
  for (; slot[1]; e += *slot, pair += *slot, slot++) {
    const slot_step now = next;
    next = begin_slot(s, pair + slot[0], x, v);
    end_slot(s, e, pair, slot[0], &now, F, sum, part);
  }
  end_slot(s, e, pair, slot[0], &next, F, sum, part);
  store_pulls(&p, sum);
  for (size_t r = 0; r < bundles; r++) hk_spring_pull(F + 3 * (size_t)own[r][0], p.xy[r], p.z[r]);
  return (size_t)(pair - own) + slot[0];
}

INLINE double list_springs(const hk_spring_numbers *q, const hk_spring_list *list, const double *x, const double *v,
                           double *F, bool damped) {
  const source s = {q, x, v, damped};
  const uint8_t *slot = list->lanes;
  vector part = _mm512_setzero_pd();
  for (size_t e = 0; e < list->count; slot++) {
    e += slice_step(&s, e, list->pair + e, slot, F, &part);
    while (*slot) slot++;
  }
  return total(_mm512_castpd512_pd256(part) + _mm512_extractf64x4_pd(part, 1));
}

/* ---- each loop with and without damping ---- */

WIDE static double far_run(const hk_spring_numbers *q, size_t n, const uint8_t *present, const double *xi,
                           const double *xj, const double *vi, const double *vj, double *Fi, double *Fj, bool damped) {
  return damped ? far_springs(q, n, present, xi, xj, vi, vj, Fi, Fj, true)
                : far_springs(q, n, present, xi, xj, vi, vj, Fi, Fj, false);
}

WIDE static double near_run(const hk_spring_numbers *q, size_t n, const uint8_t *present, const double *xi,
                            const double *xj, const double *vi, const double *vj, double *Fi, double *Fj, bool damped) {
  return damped ? near_springs(q, n, present, xi, xj, vi, vj, Fi, Fj, true)
                : near_springs(q, n, present, xi, xj, vi, vj, Fi, Fj, false);
}

WIDE static double list(const hk_spring_numbers *q, const hk_spring_list *list, const double *x, const double *v,
                        double *F, bool damped) {
  return damped ? list_springs(q, list, x, v, F, true) : list_springs(q, list, x, v, F, false);
}

const hk_spring_path *hk_spring_wide8(void) {
  static const hk_spring_path path = {far_run, near_run, list};
  return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") ? &path : NULL;
}

#else

const hk_spring_path *hk_spring_wide8(void) { return NULL; }

#endif
