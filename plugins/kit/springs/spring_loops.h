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
  return HK_SPRING_TENSION(q[0], q[2], t->l) * t->l * t->r + cwr;
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

TARGET HK_INLINE NAME(hk_spring_reach) NAME(hk_spring_begin_step)(const hk_spring_ways *at, size_t e, bool damped) {
  NAME(hk_spring_reach) t = {.w = FILL(0.)};
  VECTOR p[3];
  for (size_t r = 0, k = 3 * e; r < 3; r++, k += WIDTH) t.d[r] = LOAD(at->xj + k) - LOAD(at->xi + k);
  for (size_t r = 0; r < 3; r++) p[r] = t.d[r] * t.d[r];
  t.l2 = NAME(hk_spring_sum3)(p);
  if (damped) {
    for (size_t r = 0, k = 3 * e; r < 3; r++, k += WIDTH) p[r] = t.d[r] * (LOAD(at->vj + k) - LOAD(at->vi + k));
    t.w = NAME(hk_spring_sum3)(p);
  }
  return t;
}

/* The forces are added to the first ends and subtracted from the second ones, or go to a buffer where both are near. */
TARGET HK_INLINE void NAME(hk_spring_end_step)(const hk_spring_ways *at, size_t e, const VECTOR q[3],
                                               const NAME(hk_spring_stretch) * t, bool damped, bool gaps,
                                               NAME(hk_spring_four) * part, double *buffer) {
  VECTOR power, f[3], s = NAME(hk_spring_scales)(q, t, damped, &power);
  if (gaps) {
    const LOGIC here = PRESENT(at, e);
    s = KEEP(here, s), power = KEEP(here, power);
  }
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
  NAME(hk_spring_reach) reach = NAME(hk_spring_begin_step)(at, e, damped);
  NAME(hk_spring_stretch) stretch = NAME(hk_spring_root)(&reach);
  if (e + WIDTH <= last) reach = NAME(hk_spring_begin_step)(at, e + WIDTH, damped);
  for (; e <= last; e += WIDTH) {
    if (each) NAME(hk_spring_coefficients)(&at->q, e, q);
    if (each && e % 8 == 0) hk_spring_fetch(&at->q, e);
    NAME(hk_spring_end_step)(at, e, q, &stretch, damped, gaps, part, buffer);
    for (size_t r = 0; r < 3 && buffer && e >= HK_SPRING_LAG; r++)
      NAME(hk_spring_add_near)(at, 3 * (e - HK_SPRING_LAG) + WIDTH * r, buffer);
    if (e + WIDTH <= last) stretch = NAME(hk_spring_root)(&reach);
    if (e + 2 * WIDTH <= last) reach = NAME(hk_spring_begin_step)(at, e + 2 * WIDTH, damped);
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

/* Springs of any pairs, sorted by their higher end and then the lower one. Vectors of four are taken on processors with
 * eight as well. Measured on Sapphire Rapids, ns a damped spring with four and eight lanes: in the first-level
 * cache 2.9 and 2.8, on meshes of 16,000 particles in random order, a third of whose springs are in runs, 3.5 and 3.4.
 * Not faster: slices of eight bundles of springs that share a particle, whose forces are summed in registers (3.5
 * and 3.1 in the cache, 4.5 and 3.8 on the mesh); sums in rows of four numbers, one store a force, which are added to F
 * at last (2.4 in the cache without that, 3.5 and 3.7 on the mesh); springs from four places of the list in turn (3.7);
 * a vector that begins before the one ahead ends. */

#if WIDTH < 8
/* WIDTH pairs on their way: the differences of their particles, x, y and z of each in a row (of WIDTH 2: x and y of
 * each, then z of both), and what their scales are made of. */
typedef struct NAME(hk_spring_pairs) {
  VECTOR row[4];
  NAME(hk_spring_stretch) of;
} NAME(hk_spring_pairs);

/* Differences of the ends of WIDTH pairs, as in hk_spring_pairs. One number beyond a particle may be read. */
TARGET HK_INLINE void NAME(hk_spring_rows)(const double *x, const uint32_t (*pair)[2], VECTOR row[4]) {
#define ROW(end, k) LOAD(x + 3 * (size_t)pair[k][end])
  for (size_t k = 0; k < WIDTH; k++) row[k] = ROW(1, k) - ROW(0, k);
#undef ROW
#if WIDTH == 2
  const double *a[2] = {x + 3 * (size_t)pair[0][0], x + 3 * (size_t)pair[1][0]};
  const double *b[2] = {x + 3 * (size_t)pair[0][1], x + 3 * (size_t)pair[1][1]};
  row[2] = (VECTOR){b[0][2], b[1][2]} - (VECTOR){a[0][2], a[1][2]};
#endif
}

/* x, y and z of the rows, each in a vector. */
TARGET HK_INLINE void NAME(hk_spring_columns)(const VECTOR row[4], VECTOR column[3]) {
#if WIDTH == 2
  column[0] = PICK(row[0], row[1], 0, 2), column[1] = PICK(row[0], row[1], 1, 3), column[2] = row[2];
#else
  VECTOR a = PICK(row[0], row[1], 0, 4, 2, 6), b = PICK(row[2], row[3], 0, 4, 2, 6);
  VECTOR c = PICK(row[0], row[1], 1, 5, 3, 7), d = PICK(row[2], row[3], 1, 5, 3, 7);
  column[0] = PICK(a, b, 0, 1, 4, 5), column[1] = PICK(c, d, 0, 1, 4, 5), column[2] = PICK(a, b, 2, 3, 6, 7);
#endif
}

TARGET HK_INLINE NAME(hk_spring_pairs)
    NAME(hk_spring_begin_pairs)(const hk_spring_ways *at, const uint32_t (*pair)[2], bool damped) {
  NAME(hk_spring_pairs) p;
  NAME(hk_spring_reach) t = {.w = FILL(0.)};
  VECTOR turn[4], u[3];
  NAME(hk_spring_rows)(at->xi, pair, p.row);
  NAME(hk_spring_columns)(p.row, t.d);
  t.l2 = t.d[0] * t.d[0] + t.d[1] * t.d[1] + t.d[2] * t.d[2];
  if (damped) {
    NAME(hk_spring_rows)(at->vi, pair, turn);
    NAME(hk_spring_columns)(turn, u);
    t.w = t.d[0] * u[0] + t.d[1] * u[1] + t.d[2] * u[2];
  }
  p.of = NAME(hk_spring_root)(&t);
  return p;
}

/* One spring after the other: two of them may have a particle in common. */
TARGET HK_INLINE void NAME(hk_spring_end_pairs)(const hk_spring_ways *at, size_t e, const uint32_t (*pair)[2],
                                                const NAME(hk_spring_pairs) * p, bool damped,
                                                NAME(hk_spring_four) * part) {
  VECTOR power, q[3];
  NAME(hk_spring_coefficients)(&at->q, e, q);
  const VECTOR s = NAME(hk_spring_scales)(q, &p->of, damped, &power);
  if (damped) NAME(hk_spring_add_power)(part, e, power);
#if WIDTH == 2
  const VECTOR z = p->row[2] * s, f[2] = {p->row[0] * PICK(s, s, 0, 0), p->row[1] * PICK(s, s, 1, 1)};
  for (size_t k = 0; k < 2; k++) hk_spring_pull(at->Fi, pair[k], (hk_spring_half)f[k], z[k]);
#else
  const VECTOR f[4] = {p->row[0] * PICK(s, s, 0, 0, 0, 0), p->row[1] * PICK(s, s, 1, 1, 1, 1),
                       p->row[2] * PICK(s, s, 2, 2, 2, 2), p->row[3] * PICK(s, s, 3, 3, 3, 3)};
  for (size_t k = 0; k < 4; k++) hk_spring_pull(at->Fi, pair[k], (hk_spring_half)PICK(f[k], f[k], 0, 1), f[k][2]);
#endif
}

TARGET HK_INLINE double NAME(hk_spring_list_pairs)(const hk_spring_ways *at, const uint32_t (*pair)[2], size_t n,
                                                   bool damped) {
  NAME(hk_spring_four) part[WIDTH == 2 ? 2 : 1] = {{0}};
  for (size_t e = 0; e < n; e += WIDTH) {
    if (e % 8 == 0) __builtin_prefetch(pair + e + HK_SPRING_PREFETCH), hk_spring_fetch(&at->q, e);
    const NAME(hk_spring_pairs) now = NAME(hk_spring_begin_pairs)(at, pair + e, damped);
    NAME(hk_spring_end_pairs)(at, e, pair + e, &now, damped, part);
  }
  return NAME(hk_spring_total)(part);
}
#define LIST_PAIRS NAME(hk_spring_list_pairs)
#else /* vectors of four here, too: */
#define LIST_PAIRS hk_spring_list_pairs_4
#endif

TARGET static inline double NAME(hk_spring_list_run)(const hk_spring_ways *at, const uint32_t (*pair)[2], size_t n,
                                                     bool damped) {
  const hk_spring_ways own = *at;
  return damped ? LIST_PAIRS(&own, pair, n, true) : LIST_PAIRS(&own, pair, n, false);
}

#undef LIST_PAIRS
#undef PRESENT
