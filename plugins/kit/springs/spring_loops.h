/* The loops of spring_kernel.h for vectors of WIDTH springs (core/plugin/each_width.h).
 *
 * Roots and reciprocals are the processor's own. An estimate (vrsqrt14pd) with Newton steps by fused multiply-add and a
 * last correction can be made to give the same bits, but costs more than it saves. Measured on Zen 5 with data in the
 * first-level cache: root and reciprocal take 0.38 ns by the divider, which works beside everything else, 0.31 by
 * estimates, 0.24 with an estimate for the root alone; but the multipliers are what a spring needs too, so that a
 * damped one takes 1.26 ns with the estimated root and 1.09 without. */

#define PRESENT(at, e) LANES_SET((at)->present[(e) / 8] >> (e) % 8)

/* Four sums, in vectors of as many numbers as there are. */
#if WIDTH == 8
typedef vector_4 NAME(hk_spring_four);
#else
typedef VECTOR NAME(hk_spring_four);
#endif

/* Springs on their way: their vectors, l^2 and w = u.d; then what the scale is made of, l and 1/l^2. */
typedef struct NAME(hk_spring_reach) {
  VECTOR d[3], l2, w;
} NAME(hk_spring_reach);

typedef struct NAME(hk_spring_stretch) {
  VECTOR d[3], w, l, r;
} NAME(hk_spring_stretch);

TARGET HK_INLINE NAME(hk_spring_stretch) NAME(hk_spring_root)(const NAME(hk_spring_reach) * t) {
  const VECTOR safe = CHOOSE(EXCEEDS(t->l2, FILL(HK_SPRING_TINY)), t->l2, FILL(1.));
  return (NAME(hk_spring_stretch)){{t->d[0], t->d[1], t->d[2]}, t->w, ROOT(safe), 1 / safe};
}

/* s for the coefficients k, c and L; c w^2/l^2 goes to *power. */
TARGET HK_INLINE VECTOR NAME(hk_spring_scales)(const VECTOR q[3], const NAME(hk_spring_stretch) * t, bool damped,
                                               VECTOR *power) {
  VECTOR cwr = FILL(0.);
  if (damped) cwr = q[1] * t->w * t->r;
  *power = cwr * t->w;
  return q[0] * (t->l - q[2]) * t->l * t->r + cwr;
}

/* k, c and L of springs e, ... */
TARGET HK_INLINE void NAME(hk_spring_coefficients)(const hk_spring_numbers *from, size_t e, VECTOR q[3]) {
  q[0] = LOAD(from->k + (e & from->each_k));
  q[1] = LOAD(from->c + (e & from->each_c));
  q[2] = LOAD(from->L + (e & from->each_L));
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
  VECTOR xy = HALVES(q[0], q[1]), zx = PICK(q[0], q[2], 2, 3, 4, 5), yz = HALVES(q[1], q[2]);
  return PICK(xy, zx, 0, 5, 2, 7) + PICK(xy, yz, 1, 4, 3, 6) + PICK(zx, yz, 0, 5, 2, 7);
#else
  VECTOR ax = PICK(q[0], q[1], 0, 9, 2, 3, 12, 5, 6, 15), ay = PICK(q[0], q[1], 0, 1, 10, 3, 4, 13, 6, 7);
  VECTOR az = PICK(q[0], q[1], 8, 1, 2, 11, 4, 5, 14, 7);
  VECTOR x = PICK(PICK(ax, q[2], 0, 1, 10, 3, 4, 13, 6, 7), q[2], 0, 3, 6, 1, 4, 7, 2, 5);
  VECTOR y = PICK(PICK(ay, q[2], 8, 1, 2, 11, 4, 5, 14, 7), q[2], 1, 4, 7, 2, 5, 0, 3, 6);
  VECTOR z = PICK(PICK(az, q[2], 0, 9, 2, 3, 12, 5, 6, 15), q[2], 2, 5, 0, 3, 6, 1, 4, 7);
  return x + y + z;
#endif
}

TARGET HK_INLINE NAME(hk_spring_reach)
    NAME(hk_spring_begin_step)(const hk_spring_ways *at, size_t e, bool damped, bool gaps) {
  NAME(hk_spring_reach) t = {.w = FILL(0.)};
  VECTOR p[3];
  for (size_t r = 0, k = 3 * e; r < 3; r++, k += WIDTH) t.d[r] = LOAD(at->xj + k) - LOAD(at->xi + k);
  for (size_t r = 0; r < 3; r++) p[r] = t.d[r] * t.d[r];
  t.l2 = NAME(hk_spring_sum3)(p);
  if (damped) {
    for (size_t r = 0, k = 3 * e; r < 3; r++, k += WIDTH) p[r] = t.d[r] * (LOAD(at->vj + k) - LOAD(at->vi + k));
    t.w = NAME(hk_spring_sum3)(p);
  }
  if (gaps) t.l2 = KEEP(PRESENT(at, e), t.l2), t.w = KEEP(PRESENT(at, e), t.w);
  return t;
}

/* The forces are added to the first ends and subtracted from the second ones, or go to a buffer where both are near. */
TARGET HK_INLINE void NAME(hk_spring_end_step)(const hk_spring_ways *at, size_t e, const VECTOR q[3],
                                               const NAME(hk_spring_stretch) * t, bool damped, bool gaps,
                                               NAME(hk_spring_four) * part, double *buffer) {
  VECTOR power, f[3], s = NAME(hk_spring_scales)(q, t, damped, &power);
  if (gaps) s = KEEP(PRESENT(at, e), s);
  if (damped) NAME(hk_spring_add_power)(part, e, power);
  for (size_t r = 0; r < 3; r++) {
    const size_t k = 3 * e + WIDTH * r;
    f[r] = t->d[r] * SPREAD(s, r);
    if (buffer)
      STORE(buffer + k, f[r]);
    else
      ADD(at->Fi + k, f[r]);
  }
  for (size_t r = 0; r < 3 && !buffer; r++) ADD(at->Fj + 3 * e + WIDTH * r, -f[r]);
}

/* Numbers k, ... of forces that are in a buffer, to first ends, and from those of them that are second ends as well the
 * forces on these; around the buffer there is a margin of zeros. */
TARGET HK_INLINE void NAME(hk_spring_add_near)(const hk_spring_ways *at, size_t k, const double *f) {
  STORE(at->Fi + k, LOAD(at->Fi + k) + LOAD(f + k) - LOAD(f + k - (at->Fj - at->Fi)));
}

/* Springs e... of n, whole vectors, of which there has to be one: three stages, each a vector ahead of the next, for
 * the processor does not see far enough ahead to find work while it waits for sums of products, and then for roots and
 * reciprocals. */
TARGET HK_INLINE void NAME(hk_spring_run_steps)(const hk_spring_ways *at, size_t e, size_t n, bool damped, bool each,
                                                bool gaps, double *buffer, NAME(hk_spring_four) * part) {
  const size_t last = n - WIDTH;
  VECTOR q[3];
  NAME(hk_spring_coefficients)(&at->q, 0, q);
  NAME(hk_spring_reach) reach = NAME(hk_spring_begin_step)(at, e, damped, gaps);
  NAME(hk_spring_stretch) stretch = NAME(hk_spring_root)(&reach);
  if (e + WIDTH <= last) reach = NAME(hk_spring_begin_step)(at, e + WIDTH, damped, gaps);
  for (; e <= last; e += WIDTH) {
    if (each) NAME(hk_spring_coefficients)(&at->q, e, q);
    if (each && e % 8 == 0) hk_spring_fetch(&at->q, e);
    NAME(hk_spring_end_step)(at, e, q, &stretch, damped, gaps, part, buffer);
    for (size_t r = 0; r < 3 && buffer && e >= HK_SPRING_LAG; r++)
      NAME(hk_spring_add_near)(at, 3 * (e - HK_SPRING_LAG) + WIDTH * r, buffer);
    if (e + WIDTH <= last) stretch = NAME(hk_spring_root)(&reach);
    if (e + 2 * WIDTH <= last) reach = NAME(hk_spring_begin_step)(at, e + 2 * WIDTH, damped, gaps);
  }
}

/* Whole vectors of n springs from e on, and of what eight are too wide for, one of four. */
TARGET HK_INLINE double NAME(hk_spring_run_springs)(const hk_spring_ways *at, size_t n, bool damped, bool each,
                                                    bool gaps, double *buffer) {
  NAME(hk_spring_four) part[WIDTH == 2 ? 2 : 1] = {{0}};
  const size_t whole = n / WIDTH * WIDTH;
  if (whole) NAME(hk_spring_run_steps)(at, 0, whole, damped, each, gaps, buffer, part);
#if WIDTH == 8
  if (whole < n) hk_spring_run_steps_4(at, whole, n, damped, each, gaps, buffer, part);
#endif
  return NAME(hk_spring_total)(part);
}

/* With a copy of its own, whose numbers stay in registers whatever is stored. */
TARGET HK_INLINE double NAME(hk_spring_any_run)(const hk_spring_ways *at, size_t n, bool damped, double *buffer) {
  const hk_spring_ways own = *at;
  const bool each = own.q.each_k | own.q.each_c | own.q.each_L, gaps = hk_spring_has_gaps(own.present, n);
  if (gaps) /* with masks for every vector: a branch is foreseen too seldom where rows are short */
    return damped ? NAME(hk_spring_run_springs)(&own, n, true, each, true, buffer)
                  : NAME(hk_spring_run_springs)(&own, n, false, each, true, buffer);
  if (each)
    return damped ? NAME(hk_spring_run_springs)(&own, n, true, true, false, buffer)
                  : NAME(hk_spring_run_springs)(&own, n, false, true, false, buffer);
  return damped ? NAME(hk_spring_run_springs)(&own, n, true, false, false, buffer)
                : NAME(hk_spring_run_springs)(&own, n, false, false, false, buffer);
}

TARGET static inline double NAME(hk_spring_far_run)(const hk_spring_ways *at, size_t n, bool damped) {
  return NAME(hk_spring_any_run)(at, n, damped, NULL);
}

TARGET static inline double NAME(hk_spring_near_run)(const hk_spring_ways *at, size_t n, bool damped) {
  double room[3 * HK_SPRING_BLOCK + 2 * HK_SPRING_MARGIN] __attribute__((aligned(64)));
  double *f = room + HK_SPRING_MARGIN;
  const ptrdiff_t ahead = at->Fj - at->Fi;
  const size_t apart = (size_t)(ahead < 0 ? -ahead : ahead), alone = apart < 3 * n ? apart : 3 * n;
  memset(room, 0, HK_SPRING_MARGIN * sizeof *room);
  memset(f + 3 * n, 0, HK_SPRING_MARGIN * sizeof *f);
  const double power = NAME(hk_spring_any_run)(at, n, damped, f);
  size_t k = n > HK_SPRING_LAG ? 3 * (n - HK_SPRING_LAG) : 0;
  for (; k + WIDTH <= 3 * n; k += WIDTH) NAME(hk_spring_add_near)(at, k, f);
  for (; k < 3 * n; k++) at->Fi[k] = at->Fi[k] + f[k] - f[(ptrdiff_t)k - ahead];
  for (k = ahead < 0 ? alone : 3 * n; k-- > (ahead < 0 ? 0 : 3 * n - alone);) at->Fj[k] -= f[k];
  return power;
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
TARGET HK_INLINE NAME(hk_spring_stretch) NAME(hk_spring_begin_slot)(const hk_spring_ways *at, const uint32_t (*pair)[2],
                                                                    const VECTOR x[3], const VECTOR v[3], bool damped) {
  NAME(hk_spring_reach) t = {.w = FILL(0.)};
  VECTOR u[3];
  NAME(hk_spring_columns)(at->xi, pair, 1, t.d);
  for (size_t r = 0; r < 3; r++) t.d[r] -= x[r];
  if (damped) {
    NAME(hk_spring_columns)(at->vi, pair, 1, u);
    for (size_t r = 0; r < 3; r++) u[r] -= v[r];
    t.w = t.d[0] * u[0] + t.d[1] * u[1] + t.d[2] * u[2];
  }
  t.l2 = t.d[0] * t.d[0] + t.d[1] * t.d[1] + t.d[2] * t.d[2];
  return NAME(hk_spring_root)(&t);
}

/* The forces of its springs e, ...: to `pulls`, added to sum[]; c w^2/l^2 to *part. */
TARGET HK_INLINE void NAME(hk_spring_end_slot)(const hk_spring_ways *at, size_t e, const NAME(hk_spring_stretch) * t,
                                               size_t count, bool damped, double (*xy)[2], double *z, VECTOR sum[3],
                                               VECTOR *part) {
  const LOGIC here = LANES_SET(0xFF >> (count < WIDTH ? 8 - count : 8 - WIDTH));
  VECTOR power, f[3], q[3];
  NAME(hk_spring_coefficients)(&at->q, e, q);
  const VECTOR s = NAME(hk_spring_scales)(q, t, damped, &power);
  *part += KEEP(here, power);
  for (size_t r = 0; r < 3; r++) f[r] = t->d[r] * s, sum[r] = ADD_KEPT(here, sum[r], f[r]);
  NAME(hk_spring_store_pulls)(xy, z, f);
}

/* Of a slice that begins at `pair` the bundles from number b on. A slot begins before the one ahead of it ends, as a
 * vector of a run does. Where a vector has a whole slot its forces are added at once: the processor does that while it
 * waits for the roots of the next one. */
TARGET HK_INLINE void NAME(hk_spring_bundles)(const hk_spring_ways *at, size_t e, size_t b, const uint32_t (*pair)[2],
                                              const uint8_t *slot, bool damped, hk_spring_pulls *p, VECTOR *part) {
  const uint32_t(*own)[2] = pair + b;
  const bool whole = WIDTH == HK_SPRING_BUNDLES;
  VECTOR x[3], v[3], sum[3] = {{0}, {0}, {0}};
  NAME(hk_spring_columns)(at->xi, own, 0, x);
  if (damped) NAME(hk_spring_columns)(at->vi, own, 0, v);
  NAME(hk_spring_stretch) next = NAME(hk_spring_begin_slot)(at, own, x, v, damped);
  for (size_t t = 0; slot[t] > b; t++) {
    const size_t count = slot[t], row = whole ? 0 : t;
    const NAME(hk_spring_stretch) now = next;
    if (b == 0) __builtin_prefetch(pair + HK_SPRING_PREFETCH), hk_spring_fetch(&at->q, e);
    if (slot[t + 1] > b) next = NAME(hk_spring_begin_slot)(at, pair + count + b, x, v, damped);
    NAME(hk_spring_end_slot)(at, e + b, &now, count - b, damped, p->xy[row] + b, p->z[row] + b, sum, part);
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

#undef PRESENT
