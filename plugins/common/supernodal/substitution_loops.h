/* Substitution, by strips of DEEP columns: as many sums of a strip backward fit the registers of every path. Sums are
 * of 64 bytes on every processor, in PARTS vectors, so that they have the same order. Included by dense_loops.h for
 * each width. */

enum { NAME(DEEP) = 6 };

TARGET HK_INLINE void NAME(forward_strip)(const HK_REAL *panel, size_t ld, size_t top, size_t j, const HK_REAL *inverse,
                                          HK_REAL *w, size_t W) {
  const size_t whole = NAME(PARTS) * LANES;
  size_t diagonal = top + j, r = (diagonal + W + whole - 1) / whole * whole;
  HK_REAL x[NAME(DEEP)];
  for (size_t k = 0; k < W; k++) {
    x[k] = w[diagonal + k] *= inverse[j + k];
    for (size_t i = diagonal + k + 1; i < r; i++) w[i] = FMA_ONE(-panel[ld * (j + k) + i], x[k], w[i]);
  }
  for (; r < ld; r += LANES) {
    NAME(aligned) sum = *(NAME(aligned) *)(w + r);
    for (size_t k = 0; k < W; k++)
      sum = FMA(*(const NAME(aligned) *)(panel + ld * (j + k) + r), (NAME(aligned)){0} - x[k], sum);
    *(NAME(aligned) *)(w + r) = sum;
  }
}

TARGET HK_INLINE void NAME(forward_panel)(const HK_REAL *panel, size_t ld, size_t top, size_t columns,
                                          const HK_REAL *inverse, HK_REAL *w) {
  size_t j = 0;
  for (; j + NAME(DEEP) <= columns; j += NAME(DEEP)) NAME(forward_strip)(panel, ld, top, j, inverse, w, NAME(DEEP));
  for (; j + 3 <= columns; j += 3) NAME(forward_strip)(panel, ld, top, j, inverse, w, 3);
  for (; j < columns; j++) NAME(forward_strip)(panel, ld, top, j, inverse, w, 1);
}

TARGET HK_INLINE HK_REAL NAME(total)(const NAME(aligned) * v) {
  HK_REAL sum[HK_FRONT_VECTOR / sizeof(HK_REAL)];
  for (size_t l = 0; l < NAME(PARTS) * LANES; l++) sum[l] = v[l / LANES][l % LANES];
  for (size_t half = NAME(PARTS) * LANES / 2; half > 0; half /= 2)
    for (size_t l = 0; l < half; l++) sum[l] += sum[l + half];
  return sum[0];
}

TARGET HK_INLINE void NAME(backward_strip)(const HK_REAL *panel, size_t ld, size_t top, size_t j,
                                           const HK_REAL *inverse, HK_REAL *w, size_t W) {
  const size_t whole = NAME(PARTS) * LANES;
  size_t diagonal = top + j, begin = (diagonal + W + whole - 1) / whole * whole;
  NAME(aligned) sum[NAME(DEEP)][NAME(PARTS)];
  for (size_t k = 0; k < W; k++)
    for (size_t p = 0; p < NAME(PARTS); p++) sum[k][p] = (NAME(aligned)){0};
  for (size_t r = begin; r < ld; r += whole)
    for (size_t k = 0; k < W; k++)
      for (size_t p = 0; p < NAME(PARTS); p++)
        sum[k][p] =
            FMA(((const NAME(aligned) *)(panel + ld * (j + k) + r))[p], ((const NAME(aligned) *)(w + r))[p], sum[k][p]);
  for (size_t k = W; k-- > 0;) {
    HK_REAL x = w[diagonal + k] - NAME(total)(sum[k]);
    for (size_t i = diagonal + k + 1; i < begin; i++) x = FMA_ONE(-panel[ld * (j + k) + i], w[i], x);
    w[diagonal + k] = x * inverse[j + k];
  }
}

TARGET HK_INLINE void NAME(backward_panel)(const HK_REAL *panel, size_t ld, size_t top, size_t columns,
                                           const HK_REAL *inverse, HK_REAL *w) {
  size_t deep = columns / NAME(DEEP) * NAME(DEEP), threes = deep + (columns - deep) / 3 * 3, j = columns;
  while (j > threes) j--, NAME(backward_strip)(panel, ld, top, j, inverse, w, 1);
  while (j > deep) j -= 3, NAME(backward_strip)(panel, ld, top, j, inverse, w, 3);
  while (j > 0) j -= NAME(DEEP), NAME(backward_strip)(panel, ld, top, j, inverse, w, NAME(DEEP));
}

TARGET static void NAME(load)(const hk_supernodes *s, const hk_supernode *n, const double *b, double scale,
                              void *vector) {
  size_t w = s->block;
  HK_REAL *to = (HK_REAL *)vector + w * n->first;
  for (size_t k = 0; k < n->columns; k++)
    for (size_t c = 0; c < w; c++) to[w * k + c] = (HK_REAL)(b[w * s->order[n->first + k] + c] * scale);
}

TARGET static void NAME(store)(const hk_supernodes *s, const hk_supernode *n, const void *vector, double scale,
                               double *x) {
  size_t w = s->block;
  const HK_REAL *from = (const HK_REAL *)vector + w * n->first;
  for (size_t k = 0; k < n->columns; k++)
    for (size_t c = 0; c < w; c++) x[w * s->order[n->first + k] + c] = (double)from[w * k + c] * scale;
}

TARGET static void NAME(forward)(const hk_supernodes *s, const hk_supernode *n, const void *panel, const void *inverse,
                                 void *vector, void *front) {
  size_t b = s->block, columns = b * n->columns;
  HK_REAL *x = (HK_REAL *)vector + b * n->first, *w = front, *below = w + n->top + columns;
  memset(w, 0, n->ld * sizeof *w);
  memcpy(w + n->top, x, columns * sizeof *w);
  NAME(forward_panel)(panel, n->ld, n->top, columns, inverse, w);
  memcpy(x, w + n->top, columns * sizeof *w);
  for (size_t r = 0; r < n->rows; r++)
    for (size_t c = 0; c < b; c++) ((HK_REAL *)vector)[b * s->row[n->list + r] + c] += below[b * r + c];
}

TARGET static void NAME(backward)(const hk_supernodes *s, const hk_supernode *n, const void *panel, const void *inverse,
                                  void *vector, void *front) {
  size_t b = s->block, columns = b * n->columns;
  HK_REAL *x = (HK_REAL *)vector + b * n->first, *w = front, *below = w + n->top + columns;
  memset(w, 0, n->ld * sizeof *w);
  memcpy(w + n->top, x, columns * sizeof *w);
  for (size_t r = 0; r < n->rows; r++)
    for (size_t c = 0; c < b; c++) below[b * r + c] = ((const HK_REAL *)vector)[b * s->row[n->list + r] + c];
  NAME(backward_panel)(panel, n->ld, n->top, columns, inverse, w);
  memcpy(x, w + n->top, columns * sizeof *w);
}

TARGET static void NAME(pass_on)(const hk_supernodes *s, const hk_supernode *n, void *from, void *to) {
  size_t b = s->block;
  for (size_t r = 0; r < n->rows; r++)
    for (size_t c = 0; c < b; c++) {
      HK_REAL *here = (HK_REAL *)from + b * s->row[n->list + r] + c;
      ((HK_REAL *)to)[b * s->row[n->list + r] + c] += *here;
      *here = 0;
    }
}
