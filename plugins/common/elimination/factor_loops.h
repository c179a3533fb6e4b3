/* The loops of a factorization A = L D L^T and of its solution, for one component (LANES 1) or for four with the same
 * graph side by side (LANES 4): NUMBER holds one number of each, and every lane does what one component alone does.
 * Included by factor.c once for each, with NAME(x) to tell them apart. Blocks have b x b numbers, b = 1 or 3,
 * row-major.
 *
 * In place of the diagonal of D its reciprocals are stored, at the diagonal of L, whose ones need no memory. */

/* The reciprocal of a pivot, which has to be positive; `fine` remembers whether all were. */
#define PIVOT(r, d, fine) ((r) = 1 / (d), (fine) = (fine) & ((r) > 0) & ((r) < INFINITY))

HK_INLINE void NAME(load)(const hk_elimination *s, const double *value, const uint32_t *origin, size_t b, double *to) {
  size_t bb = b * b;
  for (size_t e = 0; e < s->start[s->n]; e++, to += LANES * bb, origin += LANES)
    for (size_t l = 0; l < LANES; l++)
      for (size_t p = 0; p < bb; p++) to[LANES * p + l] = origin[l] == UINT32_MAX ? 0 : value[bb * origin[l] + p];
}

/* The diagonal block a, of which the lower triangle is read, becomes its L and the reciprocals of its D. */
HK_INLINE void NAME(pivot3)(NUMBER *a, MASK *fine) {
  NUMBER r0, r1, r2, l10, l20, l21, t21;
  PIVOT(r0, a[0], *fine);
  l10 = a[3] * r0;
  l20 = a[6] * r0;
  PIVOT(r1, a[4] - l10 * a[3], *fine);
  t21 = a[7] - l20 * a[3];
  l21 = t21 * r1;
  PIVOT(r2, a[8] - l20 * a[6] - l21 * t21, *fine);
  a[0] = r0, a[3] = l10, a[4] = r1, a[6] = l20, a[7] = l21, a[8] = r2;
}

/* z := z L^-T, with the L of the diagonal block a. */
HK_INLINE void NAME(reduce3)(const NUMBER *a, NUMBER *z) {
  for (int i = 0; i < 9; i += 3) {
    z[i + 1] -= z[i] * a[3];
    z[i + 2] -= z[i] * a[6] + z[i + 1] * a[7];
  }
}

/* l := z D^-1 */
HK_INLINE void NAME(scale3)(const NUMBER *a, const NUMBER *z, NUMBER *l) {
  for (int i = 0; i < 9; i += 3) {
    l[i] = z[i] * a[0];
    l[i + 1] = z[i + 1] * a[4];
    l[i + 2] = z[i + 2] * a[8];
  }
}

/* to -= z l^T */
HK_INLINE void NAME(update3)(const NUMBER *z, const NUMBER *l, NUMBER *to) {
  for (int i = 0; i < 9; i += 3)
    for (int j = 0; j < 3; j++) to[i + j] -= z[i] * l[3 * j] + z[i + 1] * l[3 * j + 1] + z[i + 2] * l[3 * j + 2];
}

HK_INLINE bool NAME(factorize3)(const hk_elimination *s, double *memory) {
  NUMBER *v = (NUMBER *)(void *)memory;
  const uint32_t *target = s->target;
  MASK fine = ALL_FINE;
  for (size_t j = 0; j < s->n; j++) {
    NUMBER *a = v + 9 * s->start[j], l[9];
    size_t end = s->start[j + 1];
    NAME(pivot3)(a, &fine);
    for (size_t p = s->start[j] + 1; p < end; p++) NAME(reduce3)(a, v + 9 * p);
    for (size_t q = s->start[j] + 1; q < end; q++) {
      NAME(scale3)(a, v + 9 * q, l);
      for (size_t p = q; p < end; p++) NAME(update3)(v + 9 * p, l, v + 9 * (size_t)*target++);
      for (int k = 0; k < 9; k++) v[9 * q + k] = l[k];
    }
  }
  return IS_FINE(fine);
}

HK_INLINE bool NAME(factorize1)(const hk_elimination *s, double *memory) {
  NUMBER *v = (NUMBER *)(void *)memory;
  const uint32_t *target = s->target;
  MASK fine = ALL_FINE;
  for (size_t j = 0; j < s->n; j++) {
    size_t end = s->start[j + 1];
    NUMBER r;
    PIVOT(r, v[s->start[j]], fine);
    v[s->start[j]] = r;
    for (size_t q = s->start[j] + 1; q < end; q++) {
      NUMBER l = v[q] * r;
      for (size_t p = q; p < end; p++) v[*target++] -= v[p] * l;
      v[q] = l;
    }
  }
  return IS_FINE(fine);
}

HK_INLINE void NAME(gather)(const hk_elimination *s, const uint32_t *row, size_t b, const double *from, double *y) {
  for (size_t j = 0; j < s->n; j++, y += LANES * b)
    for (size_t l = 0; l < LANES; l++)
      for (size_t c = 0; c < b; c++) y[LANES * c + l] = from[b * row[LANES * j + l] + c];
}

/* False: a number is not finite. */
HK_INLINE bool NAME(scatter)(const hk_elimination *s, const uint32_t *row, size_t b, const double *y, double *to) {
  double bad = 0;
  for (size_t j = 0; j < s->n; j++, y += LANES * b)
    for (size_t l = 0; l < LANES; l++)
      for (size_t c = 0; c < b; c++) {
        bad += y[LANES * c + l] * 0;
        to[b * row[LANES * j + l] + c] = y[LANES * c + l];
      }
  return bad == 0;
}

HK_INLINE void NAME(solve3)(const hk_elimination *s, const double *memory, double *solution) {
  const NUMBER *v = (const NUMBER *)(const void *)memory;
  NUMBER *y = (NUMBER *)(void *)solution;
  for (size_t j = 0; j < s->n; j++) {
    const NUMBER *a = v + 9 * s->start[j];
    NUMBER y0 = y[3 * j], y1 = y[3 * j + 1] - a[3] * y0, y2 = y[3 * j + 2] - a[6] * y0 - a[7] * y1;
    for (size_t p = s->start[j] + 1; p < s->start[j + 1]; p++) {
      const NUMBER *l = v + 9 * p;
      NUMBER *to = y + 3 * (size_t)s->row[p];
      for (int i = 0; i < 3; i++) to[i] -= l[3 * i] * y0 + l[3 * i + 1] * y1 + l[3 * i + 2] * y2;
    }
    y[3 * j] = y0 * a[0], y[3 * j + 1] = y1 * a[4], y[3 * j + 2] = y2 * a[8];
  }
  for (size_t j = s->n; j-- > 0;) {
    const NUMBER *a = v + 9 * s->start[j];
    NUMBER y0 = y[3 * j], y1 = y[3 * j + 1], y2 = y[3 * j + 2];
    for (size_t p = s->start[j] + 1; p < s->start[j + 1]; p++) {
      const NUMBER *l = v + 9 * p, *x = y + 3 * (size_t)s->row[p];
      y0 -= l[0] * x[0] + l[3] * x[1] + l[6] * x[2];
      y1 -= l[1] * x[0] + l[4] * x[1] + l[7] * x[2];
      y2 -= l[2] * x[0] + l[5] * x[1] + l[8] * x[2];
    }
    y1 -= a[7] * y2;
    y[3 * j] = y0 - a[3] * y1 - a[6] * y2, y[3 * j + 1] = y1, y[3 * j + 2] = y2;
  }
}

HK_INLINE void NAME(solve1)(const hk_elimination *s, const double *memory, double *solution) {
  const NUMBER *v = (const NUMBER *)(const void *)memory;
  NUMBER *y = (NUMBER *)(void *)solution;
  for (size_t j = 0; j < s->n; j++) {
    NUMBER here = y[j];
    for (size_t p = s->start[j] + 1; p < s->start[j + 1]; p++) y[s->row[p]] -= v[p] * here;
    y[j] = here * v[s->start[j]];
  }
  for (size_t j = s->n; j-- > 0;) {
    NUMBER here = y[j];
    for (size_t p = s->start[j] + 1; p < s->start[j + 1]; p++) here -= v[p] * y[s->row[p]];
    y[j] = here;
  }
}

HK_INLINE bool NAME(factorize)(const hk_bundle *bundle, size_t b, const double *value) {
  NAME(load)(bundle->elimination, value, bundle->origin, b, bundle->value);
  if (b == 1) return NAME(factorize1)(bundle->elimination, bundle->value);
  return NAME(factorize3)(bundle->elimination, bundle->value);
}

HK_INLINE bool NAME(solve)(const hk_bundle *bundle, size_t b, const double *rhs, double *x) {
  NAME(gather)(bundle->elimination, bundle->row, b, rhs, bundle->solution);
  if (b == 1)
    NAME(solve1)(bundle->elimination, bundle->value, bundle->solution);
  else
    NAME(solve3)(bundle->elimination, bundle->value, bundle->solution);
  return NAME(scatter)(bundle->elimination, bundle->row, b, bundle->solution, x);
}
#undef PIVOT
