/* The loops of spring_kernel.h for vectors of WIDTH springs (core/plugin/each_width.h).
 *
 * Roots and reciprocals are the processor's own. An estimate (vrsqrt14pd) with Newton steps by fused multiply-add and a
 * last correction can be made to give the same bits, but costs more than it saves. Measured on Zen 5 with data in the
 * first-level cache: root and reciprocal take 0.38 ns by the divider, which works beside everything else, 0.31 by
 * estimates, 0.24 with an estimate for the root alone; but the multipliers are what a spring needs too, so that a
 * damped one takes 1.26 ns with the estimated root and 1.09 without. */

#define AHEAD (WIDTH == 8) /* registers for it */

/* Four sums, in vectors of as many numbers as there are. */
#if WIDTH == 8
typedef vector_4 NAME(hk_spring_four);
#else
typedef VECTOR NAME(hk_spring_four);
#endif

/* Springs on their way: their vectors, and what the scale is made of. */
typedef struct NAME(hk_spring_stretch) {
  VECTOR d[3], w, l, r; /* w = u.d, l, 1/l^2 */
  LOGIC here;
} NAME(hk_spring_stretch);

TARGET HK_INLINE void NAME(hk_spring_set_stretch)(NAME(hk_spring_stretch) * t, VECTOR l2, VECTOR w, LOGIC here) {
  VECTOR safe = CHOOSE(BOTH(here, EXCEEDS(l2, FILL(HK_SPRING_TINY))), l2, FILL(1.));
  t->w = w, t->l = ROOT(safe), t->r = 1 / safe, t->here = here;
}

/* s of springs e..; their c w^2/l^2 goes to *power. */
TARGET HK_INLINE VECTOR NAME(hk_spring_scales)(const hk_spring_numbers *q, size_t e, const NAME(hk_spring_stretch) * t,
                                               VECTOR *power) {
  VECTOR cwr = LOAD(q->c + (e & q->each_c)) * t->w * t->r;
  *power = cwr * t->w;
  return LOAD(q->k + (e & q->each_k)) * (t->l - LOAD(q->L + (e & q->each_L))) * t->l * t->r + cwr;
}

/* Springs e, e + 4, ... are summed first. */
TARGET HK_INLINE void NAME(hk_spring_add_power)(NAME(hk_spring_four) * part, size_t e, VECTOR p) {
#if WIDTH == 8
  (void)e;
  part[0] += PICK(p, p, 0, 1, 2, 3);
  part[0] += PICK(p, p, 4, 5, 6, 7);
#else
  part[e / WIDTH % (4 / WIDTH)] += p;
#endif
}

TARGET HK_INLINE double NAME(hk_spring_total)(const NAME(hk_spring_four) * part) {
#if WIDTH == 2
  return (part[0][0] + part[0][1]) + (part[1][0] + part[1][1]);
#else
  return (part[0][0] + part[0][1]) + (part[0][2] + part[0][3]);
#endif
}

/* ---- runs ---- */

/* Sums of three neighbours, each as (x + y) + z: x, y and z are first collected in their lanes, then put in order. */
TARGET HK_INLINE VECTOR NAME(hk_spring_sum3)(const VECTOR q[3]) {
#if WIDTH == 2
  return PICK(q[0], q[1], 0, 3) + PICK(q[0], q[2], 1, 2) + PICK(q[1], q[2], 0, 3);
#elif WIDTH == 4
  VECTOR x = PICK(PICK(PICK(q[0], q[1], 0, 1, 6, 3), q[2], 0, 5, 2, 3), q[2], 0, 3, 2, 1);
  VECTOR y = PICK(PICK(PICK(q[1], q[0], 0, 5, 2, 3), q[2], 0, 1, 6, 3), q[2], 1, 0, 3, 2);
  VECTOR z = PICK(PICK(PICK(q[2], q[1], 0, 5, 2, 3), q[0], 0, 1, 6, 3), q[0], 2, 1, 0, 3);
  return x + y + z;
#else
  VECTOR ax = PICK(q[0], q[1], 0, 9, 2, 3, 12, 5, 6, 15), ay = PICK(q[0], q[1], 0, 1, 10, 3, 4, 13, 6, 7);
  VECTOR az = PICK(q[0], q[1], 8, 1, 2, 11, 4, 5, 14, 7);
  VECTOR x = PICK(PICK(ax, q[2], 0, 1, 10, 3, 4, 13, 6, 7), q[2], 0, 3, 6, 1, 4, 7, 2, 5);
  VECTOR y = PICK(PICK(ay, q[2], 8, 1, 2, 11, 4, 5, 14, 7), q[2], 1, 4, 7, 2, 5, 0, 3, 6);
  VECTOR z = PICK(PICK(az, q[2], 0, 9, 2, 3, 12, 5, 6, 15), q[2], 2, 5, 0, 3, 6, 1, 4, 7);
  return x + y + z;
#endif
}

TARGET HK_INLINE NAME(hk_spring_stretch) NAME(hk_spring_begin_step)(const hk_spring_ways *at, size_t e, bool damped) {
  NAME(hk_spring_stretch) t;
  VECTOR w = {0}, p[3];
  const LOGIC here = LANES_SET(at->present[e / 8] >> e % 8);
  for (size_t r = 0, k = 3 * e; r < 3; r++, k += WIDTH) t.d[r] = LOAD(at->xj + k) - LOAD(at->xi + k);
  if (damped) {
    for (size_t r = 0, k = 3 * e; r < 3; r++, k += WIDTH) p[r] = t.d[r] * (LOAD(at->vj + k) - LOAD(at->vi + k));
    w = KEEP(here, NAME(hk_spring_sum3)(p));
  }
  for (size_t r = 0; r < 3; r++) p[r] = t.d[r] * t.d[r];
  NAME(hk_spring_set_stretch)(&t, NAME(hk_spring_sum3)(p), w, here);
  return t;
}

/* The forces are added to the first ends, and f gets them. */
TARGET HK_INLINE void NAME(hk_spring_end_step)(const hk_spring_ways *at, size_t e, const NAME(hk_spring_stretch) * t,
                                               NAME(hk_spring_four) * part, VECTOR f[3]) {
  VECTOR power;
  if (e % 4 == 0) hk_spring_fetch(&at->q, e);
  const VECTOR s = KEEP(t->here, NAME(hk_spring_scales)(&at->q, e, t, &power));
  NAME(hk_spring_add_power)(part, e, power);
  for (size_t r = 0; r < 3; r++) {
    f[r] = t->d[r] * SPREAD(s, r);
    ADD(at->Fi + 3 * e + WIDTH * r, f[r]);
  }
}

/* Forces on the second ends go to them, or to a buffer where both ends are near. */
TARGET HK_INLINE void NAME(hk_spring_end_run)(const hk_spring_ways *at, size_t e, const NAME(hk_spring_stretch) * t,
                                              NAME(hk_spring_four) * part, double *buffer) {
  VECTOR f[3];
  NAME(hk_spring_end_step)(at, e, t, part, f);
  for (size_t r = 0; r < 3; r++)
    if (buffer)
      STORE(buffer + 3 * e + WIDTH * r, f[r]);
    else
      ADD(at->Fj + 3 * e + WIDTH * r, -f[r]);
}

/* Springs e... of n, whole vectors. With AHEAD a step begins before the one ahead of it ends: the processor does not
 * see far enough ahead to find work while it waits for roots and reciprocals. Returns how far it came. */
TARGET HK_INLINE size_t NAME(hk_spring_run_steps)(const hk_spring_ways *at, size_t e, size_t n, bool damped,
                                                  double *buffer, NAME(hk_spring_four) * part) {
  NAME(hk_spring_stretch) next;
  if (AHEAD && e + WIDTH <= n) next = NAME(hk_spring_begin_step)(at, e, damped);
  for (; e + WIDTH <= n; e += WIDTH) {
    const NAME(hk_spring_stretch) now = AHEAD ? next : NAME(hk_spring_begin_step)(at, e, damped);
    if (AHEAD && e + 2 * WIDTH <= n) next = NAME(hk_spring_begin_step)(at, e + WIDTH, damped);
    NAME(hk_spring_end_run)(at, e, &now, part, buffer);
  }
  return e;
}

TARGET HK_INLINE double NAME(hk_spring_run_springs)(const hk_spring_ways *at, size_t n, bool damped, double *buffer) {
  NAME(hk_spring_four) part[WIDTH == 2 ? 2 : 1] = {{0}};
  size_t e = NAME(hk_spring_run_steps)(at, 0, n, damped, buffer, part);
#if WIDTH == 8
  hk_spring_run_steps_4(at, e, n, damped, buffer, part);
#endif
  (void)e;
  size_t k = 0;
  for (; buffer && k + WIDTH <= 3 * n; k += WIDTH) ADD(at->Fj + k, -LOAD(buffer + k));
  if (buffer && k < 3 * n) *(NAME(hk_spring_four) *)(at->Fj + k) -= *(const NAME(hk_spring_four) *)(buffer + k);
  return NAME(hk_spring_total)(part);
}

/* With a copy of its own, whose numbers stay in registers whatever is stored. */
TARGET static inline double NAME(hk_spring_far_run)(const hk_spring_ways *at, size_t n, bool damped) {
  const hk_spring_ways own = *at;
  return damped ? NAME(hk_spring_run_springs)(&own, n, true, NULL) : NAME(hk_spring_run_springs)(&own, n, false, NULL);
}

TARGET static inline double NAME(hk_spring_near_run)(const hk_spring_ways *at, size_t n, bool damped) {
  const hk_spring_ways own = *at;
  double f[3 * HK_SPRING_BLOCK] __attribute__((aligned(64)));
  return damped ? NAME(hk_spring_run_springs)(&own, n, true, f) : NAME(hk_spring_run_springs)(&own, n, false, f);
}

/* ---- lists ---- */

/* The coordinates of the particles of WIDTH pairs in columns; end: the first or the second of each. One number beyond a
 * particle may be read. */
TARGET HK_INLINE void NAME(hk_spring_columns)(const double *x, const uint32_t (*pair)[2], int end, VECTOR column[3]) {
#define ROW(type, k) (*(const type *)(x + 3 * (size_t)pair[k][end]))
#if WIDTH == 2
  VECTOR a = ROW(VECTOR, 0), b = ROW(VECTOR, 1);
  column[0] = PICK(a, b, 0, 2), column[1] = PICK(a, b, 1, 3);
  column[2] = (VECTOR){(&ROW(double, 0))[2], (&ROW(double, 1))[2]};
#elif WIDTH == 4
  VECTOR a = PICK(ROW(VECTOR, 0), ROW(VECTOR, 1), 0, 4, 2, 6), b = PICK(ROW(VECTOR, 2), ROW(VECTOR, 3), 0, 4, 2, 6);
  VECTOR c = PICK(ROW(VECTOR, 0), ROW(VECTOR, 1), 1, 5, 3, 7), d = PICK(ROW(VECTOR, 2), ROW(VECTOR, 3), 1, 5, 3, 7);
  column[0] = PICK(a, b, 0, 1, 4, 5), column[1] = PICK(c, d, 0, 1, 4, 5), column[2] = PICK(a, b, 2, 3, 6, 7);
#else
  VECTOR r[4];
  for (size_t k = 0; k < 4; k++) r[k] = PICK(ROW(vector_4, k), ROW(vector_4, k + 4), 0, 1, 2, 3, 4, 5, 6, 7);
  VECTOR a = PICK(r[0], r[1], 0, 8, 2, 10, 4, 12, 6, 14), b = PICK(r[2], r[3], 0, 8, 2, 10, 4, 12, 6, 14);
  VECTOR c = PICK(r[0], r[1], 1, 9, 3, 11, 5, 13, 7, 15), d = PICK(r[2], r[3], 1, 9, 3, 11, 5, 13, 7, 15);
  column[0] = PICK(a, b, 0, 1, 8, 9, 4, 5, 12, 13);
  column[1] = PICK(c, d, 0, 1, 8, 9, 4, 5, 12, 13);
  column[2] = PICK(a, b, 2, 3, 10, 11, 6, 7, 14, 15);
#endif
#undef ROW
}

/* x and y of each as a pair, z alone. */
TARGET HK_INLINE void NAME(hk_spring_store_pulls)(double (*xy)[2], double *z, const VECTOR f[3]) {
#if WIDTH == 2
  STORE(xy[0], PICK(f[0], f[1], 0, 2));
  STORE(xy[1], PICK(f[0], f[1], 1, 3));
#elif WIDTH == 4
  STORE(xy[0], PICK(f[0], f[1], 0, 4, 1, 5));
  STORE(xy[2], PICK(f[0], f[1], 2, 6, 3, 7));
#else
  STORE(xy[0], PICK(f[0], f[1], 0, 8, 1, 9, 2, 10, 3, 11));
  STORE(xy[4], PICK(f[0], f[1], 4, 12, 5, 13, 6, 14, 7, 15));
#endif
  STORE(z, f[2]);
}

/* Springs of a slot from the bundle that `pair` belongs to, whose first ends are at x and v. Lanes beyond the slot have
 * any numbers. */
TARGET HK_INLINE NAME(hk_spring_stretch)
    NAME(hk_spring_begin_slot)(const hk_spring_ways *at, const uint32_t (*pair)[2], size_t count, const VECTOR x[3],
                               const VECTOR v[3], bool damped) {
  NAME(hk_spring_stretch) t;
  VECTOR u[3], w = {0};
  NAME(hk_spring_columns)(at->xi, pair, 1, t.d);
  for (size_t r = 0; r < 3; r++) t.d[r] -= x[r];
  if (damped) {
    NAME(hk_spring_columns)(at->vi, pair, 1, u);
    for (size_t r = 0; r < 3; r++) u[r] -= v[r];
    w = t.d[0] * u[0] + t.d[1] * u[1] + t.d[2] * u[2];
  }
  NAME(hk_spring_set_stretch)(&t, t.d[0] * t.d[0] + t.d[1] * t.d[1] + t.d[2] * t.d[2], w, LANES_SET(0xFF));
  t.here = LANES_SET(0xFF >> (count < WIDTH ? 8 - count : 8 - WIDTH));
  return t;
}

/* The forces of its springs e, ...: to `pulls`, added to sum[]; c w^2/l^2 to *part. */
TARGET HK_INLINE void NAME(hk_spring_end_slot)(const hk_spring_ways *at, size_t e, const NAME(hk_spring_stretch) * t,
                                               double (*xy)[2], double *z, VECTOR sum[3], VECTOR *part) {
  VECTOR power, f[3];
  const VECTOR s = NAME(hk_spring_scales)(&at->q, e, t, &power);
  *part += KEEP(t->here, power);
  for (size_t r = 0; r < 3; r++) f[r] = t->d[r] * s, sum[r] = ADD_KEPT(t->here, sum[r], f[r]);
  NAME(hk_spring_store_pulls)(xy, z, f);
}

/* Of a slice that begins at `pair` the bundles from number b on. With AHEAD as in a run. Where a vector has a whole
 * slot its forces are added at once: the processor does that while it waits for the roots of the next one. */
TARGET HK_INLINE void NAME(hk_spring_bundles)(const hk_spring_ways *at, size_t e, size_t b, const uint32_t (*pair)[2],
                                              const uint8_t *slot, bool damped, hk_spring_pulls *p, VECTOR *part) {
  const uint32_t(*own)[2] = pair + b;
  const bool whole = WIDTH == HK_SPRING_BUNDLES;
  VECTOR x[3], v[3], sum[3] = {{0}, {0}, {0}};
  NAME(hk_spring_columns)(at->xi, own, 0, x);
  if (damped) NAME(hk_spring_columns)(at->vi, own, 0, v);
  NAME(hk_spring_stretch) next;
  if (AHEAD) next = NAME(hk_spring_begin_slot)(at, own, slot[0] - b, x, v, damped);
  for (size_t t = 0; slot[t] > b; t++) {
    const size_t count = slot[t], row = whole ? 0 : t;
    const NAME(hk_spring_stretch) now =
        AHEAD ? next : NAME(hk_spring_begin_slot)(at, pair + b, count - b, x, v, damped);
    if (b == 0) __builtin_prefetch(pair + HK_SPRING_PREFETCH), hk_spring_fetch(&at->q, e);
    if (AHEAD && slot[t + 1] > b)
      next = NAME(hk_spring_begin_slot)(at, pair + count + b, slot[t + 1] - b, x, v, damped);
    NAME(hk_spring_end_slot)(at, e + b, &now, p->xy[row] + b, p->z[row] + b, sum, part);
    if (whole) hk_spring_slot_push(p, pair, count, at->Fi);
    e += count, pair += count;
  }
  NAME(hk_spring_store_pulls)(p->sum_xy + b, p->sum_z + b, sum);
}

TARGET HK_INLINE double NAME(hk_spring_list_springs)(const hk_spring_ways *at, const hk_spring_list *list,
                                                     bool damped) {
  VECTOR part[HK_SPRING_BUNDLES / WIDTH] = {{0}};
  double sum[HK_SPRING_BUNDLES];
  hk_spring_pulls p;
  const uint8_t *slot = list->lanes;
  for (size_t e = 0; e < list->count; slot++) {
    const uint32_t(*pair)[2] = list->pair + e;
    for (size_t b = 0; b < HK_SPRING_BUNDLES && b < slot[0]; b += WIDTH)
      NAME(hk_spring_bundles)(at, e, b, pair, slot, damped, &p, &part[b / WIDTH]);
    hk_spring_pulls_add(&p, pair, slot, WIDTH == HK_SPRING_BUNDLES, at->Fi);
    while (*slot) e += *slot++;
  }
  memcpy(sum, part, sizeof sum);
  return ((sum[0] + sum[4]) + (sum[1] + sum[5])) + ((sum[2] + sum[6]) + (sum[3] + sum[7]));
}

TARGET static inline double NAME(hk_spring_list_run)(const hk_spring_ways *at, const hk_spring_list *list,
                                                     bool damped) {
  const hk_spring_ways own = *at;
  return damped ? NAME(hk_spring_list_springs)(&own, list, true) : NAME(hk_spring_list_springs)(&own, list, false);
}

#undef AHEAD
