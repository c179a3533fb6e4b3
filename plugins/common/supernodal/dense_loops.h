/* The loops of dense_path.h for vectors of LANES numbers (core/plugin/each_width.h), which are HK_REAL. The tiles
 * of 2 vectors x 6 columns are 12 of 16 registers, those of 12 columns 24 of AVX-512's 32. Products are rounded by
 * themselves with WIDTH 2: the last digit may differ from that of processors with fused multiply-add. */

enum {
  NAME(PARTS) = HK_FRONT_VECTOR / (8 * WIDTH),
  NAME(TALL) = 2,                  /* vectors of a tile */
  NAME(WIDE) = WIDTH == 8 ? 12 : 6 /* its columns, a multiple of 3 */
};

typedef HK_REAL NAME(aligned) __attribute__((vector_size(8 * WIDTH), aligned(8 * WIDTH), may_alias));

/* A tile of T vectors x W columns of C -= A B^T: rows of A as C's, rows of B as C's columns. */
TARGET HK_INLINE void NAME(multiply)(NAME(aligned) * c, const HK_REAL *A, const HK_REAL *B, size_t ld, size_t depth,
                                     size_t T, size_t W) {
  for (size_t k = 0; k < depth; k++) {
    const NAME(aligned) *a = (const NAME(aligned) *)(A + ld * k);
    const HK_REAL *b = B + ld * k;
    NAME(aligned) row[NAME(TALL)];
    for (size_t i = 0; i < T; i++) row[i] = a[i];
    for (size_t j = 0; j < W; j++) {
      NAME(aligned) minus = (NAME(aligned)){0} - b[j];
      for (size_t i = 0; i < T; i++) c[T * j + i] = FMA(row[i], minus, c[T * j + i]);
    }
  }
}

TARGET HK_INLINE void NAME(load_tile)(NAME(aligned) * c, const HK_REAL *C, size_t ld, size_t T, size_t W) {
  for (size_t j = 0; j < W; j++)
    for (size_t i = 0; i < T; i++) c[T * j + i] = ((const NAME(aligned) *)(C + ld * j))[i];
}

TARGET HK_INLINE void NAME(store_tile)(const NAME(aligned) * c, HK_REAL *C, size_t ld, size_t T, size_t W) {
  for (size_t j = 0; j < W; j++)
    for (size_t i = 0; i < T; i++) ((NAME(aligned) *)(C + ld * j))[i] = c[T * j + i];
}

/* X L^T = C for the triangle of W columns. */
TARGET HK_INLINE void NAME(divide_tile)(NAME(aligned) * c, const HK_REAL *triangle, const HK_REAL *inverse, size_t T,
                                        size_t W) {
  for (size_t j = 0; j < W; j++) {
    for (size_t k = 0; k < j; k++)
      for (size_t i = 0; i < T; i++)
        c[T * j + i] = FMA(c[T * k + i], (NAME(aligned)){0} - triangle[W * j + k], c[T * j + i]);
    for (size_t i = 0; i < T; i++) c[T * j + i] *= inverse[j];
  }
}

/* C = -A B^T. */
TARGET HK_INLINE void NAME(product_tile)(HK_REAL *C, size_t ldc, const HK_REAL *A, const HK_REAL *B, size_t ld,
                                         size_t depth, size_t T, size_t W) {
  NAME(aligned) c[NAME(TALL) * NAME(WIDE)];
  for (size_t e = 0; e < T * W; e++) c[e] = (NAME(aligned)){0};
  NAME(multiply)(c, A, B, ld, depth, T, W);
  NAME(store_tile)(c, C, ldc, T, W);
}

TARGET HK_INLINE void NAME(subtract_tile)(HK_REAL *C, size_t ldc, const HK_REAL *A, const HK_REAL *B, size_t ld,
                                          size_t depth, size_t T, size_t W) {
  NAME(aligned) c[NAME(TALL) * NAME(WIDE)];
  NAME(load_tile)(c, C, ldc, T, W);
  NAME(multiply)(c, A, B, ld, depth, T, W);
  NAME(store_tile)(c, C, ldc, T, W);
}

TARGET HK_INLINE void NAME(product)(HK_REAL *C, size_t ldc, const HK_REAL *A, const HK_REAL *B, size_t ld, size_t rows,
                                    size_t depth, size_t W) {
  size_t r = 0;
  for (; r + NAME(TALL) * LANES <= rows; r += NAME(TALL) * LANES)
    NAME(product_tile)(C + r, ldc, A + r, B, ld, depth, NAME(TALL), W);
  for (; r < rows; r += LANES) NAME(product_tile)(C + r, ldc, A + r, B, ld, depth, 1, W);
}

TARGET HK_INLINE void NAME(finish_tile)(HK_REAL *C, const HK_REAL *A, const HK_REAL *B, size_t ld, size_t depth,
                                        const HK_REAL *triangle, const HK_REAL *inverse, size_t T, size_t W) {
  NAME(aligned) c[NAME(TALL) * NAME(WIDE)];
  NAME(load_tile)(c, C, ld, T, W);
  NAME(multiply)(c, A, B, ld, depth, T, W);
  NAME(divide_tile)(c, triangle, inverse, T, W);
  NAME(store_tile)(c, C, ld, T, W);
}

/* The factor of the W x W numbers on the diagonal; returns the number of good pivots. */
TARGET HK_INLINE size_t NAME(triangle)(const HK_REAL *C, size_t ld, HK_REAL *triangle, HK_REAL *inverse, size_t W) {
  for (size_t j = 0; j < W; j++) {
    HK_REAL *row = triangle + W * j;
    for (size_t k = 0; k <= j; k++) {
      HK_REAL sum = C[ld * k + j];
      for (size_t m = 0; m < k; m++) sum = FMA_ONE(row[m], -triangle[W * k + m], sum);
      row[k] = k < j ? sum * inverse[k] : sum;
    }
    if (!(row[j] > 0)) return j;
    row[j] = ROOT_OF(row[j]);
    inverse[j] = 1 / row[j];
  }
  return W;
}

/* Rows [r, end) of the W columns from column j on: subtracts the products of those before, and divides. */
TARGET HK_INLINE void NAME(finish)(HK_REAL *panel, size_t ld, size_t diagonal, size_t j, size_t r, size_t end,
                                   const HK_REAL *triangle, const HK_REAL *inverse, size_t W) {
  HK_REAL *C = panel + ld * j;
  const HK_REAL *B = panel + diagonal;
  for (; r + NAME(TALL) * LANES <= end; r += NAME(TALL) * LANES)
    NAME(finish_tile)(C + r, panel + r, B, ld, j, triangle, inverse + j, NAME(TALL), W);
  for (; r < end; r += LANES) NAME(finish_tile)(C + r, panel + r, B, ld, j, triangle, inverse + j, 1, W);
}

/* W columns of the triangle, from column j on, with the rows to `end`. Returns the number of columns with good pivots.
 */
TARGET HK_INLINE size_t NAME(strip)(HK_REAL *panel, size_t ld, size_t top, size_t end, size_t j, HK_REAL *inverse,
                                    size_t W) {
  HK_REAL triangle[NAME(WIDE) * NAME(WIDE)], *C = panel + ld * j;
  size_t diagonal = top + j, first = diagonal / LANES * LANES, last = (diagonal + W + LANES - 1) / LANES * LANES;
  for (size_t r = first; r < last; r += LANES) NAME(subtract_tile)(C + r, ld, panel + r, panel + diagonal, ld, j, 1, W);
  size_t good = NAME(triangle)(C + diagonal, ld, triangle, inverse + j, W);
  if (good < W) return j + good;
  for (size_t r = first; r < last; r += LANES)
    NAME(finish_tile)(C + r, panel + r, panel + diagonal, ld, 0, triangle, inverse + j, 1, W);
  NAME(finish)(panel, ld, diagonal, j, last, end, triangle, inverse, W);
  for (size_t k = 0; k < W; k++)
    for (size_t i = k; i < W; i++) C[ld * k + diagonal + i] = triangle[W * i + k];
  return j + W;
}

/* Columns that are worked on together where so many are left. */
TARGET HK_INLINE size_t NAME(width)(size_t left) { return left >= NAME(WIDE) ? NAME(WIDE) : left >= 3 ? 3 : 1; }

TARGET static size_t NAME(factorize)(void *panel, size_t ld, size_t top, size_t columns, void *inverse) {
  size_t j = 0, next = 0, W;
  for (; j < columns && next == j; j += W) {
    W = NAME(width)(columns - j);
    if (W == NAME(WIDE))
      next = NAME(strip)(panel, ld, top, top + columns, j, inverse, NAME(WIDE));
    else if (W == 3)
      next = NAME(strip)(panel, ld, top, top + columns, j, inverse, 3);
    else
      next = NAME(strip)(panel, ld, top, top + columns, j, inverse, 1);
  }
  return next;
}

TARGET HK_INLINE void NAME(divide_strip)(HK_REAL *panel, size_t ld, size_t top, size_t j, size_t begin, size_t end,
                                         const HK_REAL *inverse, size_t W) {
  HK_REAL triangle[NAME(WIDE) * NAME(WIDE)];
  for (size_t i = 0; i < W; i++)
    for (size_t k = 0; k < i; k++) triangle[W * i + k] = panel[ld * (j + k) + top + j + i];
  NAME(finish)(panel, ld, top + j, j, begin, end, triangle, inverse, W);
}

TARGET static void NAME(solve_rows)(void *panel, size_t ld, size_t top, size_t columns, const void *inverse,
                                    size_t begin, size_t end) {
  for (size_t j = 0, W; j < columns; j += W) {
    W = NAME(width)(columns - j);
    if (W == NAME(WIDE))
      NAME(divide_strip)(panel, ld, top, j, begin, end, inverse, NAME(WIDE));
    else if (W == 3)
      NAME(divide_strip)(panel, ld, top, j, begin, end, inverse, 3);
    else
      NAME(divide_strip)(panel, ld, top, j, begin, end, inverse, 1);
  }
}

TARGET static void NAME(update)(void *U, size_t ldu, size_t begin, size_t end, const void *L, size_t ld,
                                size_t columns) {
  for (size_t j = begin, W; j < end; j += W) {
    size_t first = j / LANES * LANES, rows = ldu - first;
    HK_REAL *C = (HK_REAL *)U + ldu * j + first;
    const HK_REAL *A = (const HK_REAL *)L + first, *B = (const HK_REAL *)L + j;
    W = NAME(width)(end - j);
    if (W == NAME(WIDE))
      NAME(product)(C, ldu, A, B, ld, rows, columns, NAME(WIDE));
    else if (W == 3)
      NAME(product)(C, ldu, A, B, ld, rows, columns, 3);
    else
      NAME(product)(C, ldu, A, B, ld, rows, columns, 1);
  }
}

/* ---- Fronts ---- */

TARGET static void NAME(begin)(const hk_supernodes *s, const hk_supernode *n, const double *value, void *panel) {
  size_t b = s->block;
  memset(panel, 0, n->ld * b * n->columns * sizeof(HK_REAL));
  for (const hk_entry *e = s->entry + n->entry; e < s->entry + n->entry_end; e++) {
    const double *from = value + b * b * e->block;
    HK_REAL *to = (HK_REAL *)panel + e->to;
    for (size_t c = 0; c < b; c++)
      for (size_t r = 0; r < b; r++) to[n->ld * c + r] = (HK_REAL)from[b * c + r];
  }
}

/* Adds the columns of a run, and those of the runs after it as rows. `to` points to the front's first row in the column
 * where the run begins. */
TARGET HK_INLINE void NAME(extend_run)(const hk_row_run *run, const hk_row_run *end, size_t b, const HK_REAL *from,
                                       size_t ld, HK_REAL *to, size_t ld_to) {
  for (size_t c = 0; c < b * run->count; c++) {
    const HK_REAL *source = from + ld * (b * run->from + c);
    HK_REAL *target = to + ld_to * c;
    for (const hk_row_run *rows = run; rows < end; rows++) {
      const HK_REAL *add = source + b * rows->from;
      HK_REAL *sum = target + b * rows->to;
      for (size_t r = rows == run ? c : 0; r < b * rows->count; r++) sum[r] += add[r];
    }
  }
}

TARGET static void NAME(extend_panel)(const hk_supernodes *s, const hk_supernode *child, const void *from,
                                      const hk_supernode *n, void *panel) {
  const hk_row_run *end = s->run + child->run_end, *run = s->run + child->run;
  for (; run < end && run->to < n->columns; run++) NAME(extend_run)
  (run, end, s->block, from, child->ldu, (HK_REAL *)panel + n->ld * s->block * run->to + n->top, n->ld);
}

TARGET static void NAME(extend_update)(const hk_supernodes *s, const hk_supernode *child, const void *from,
                                       const hk_supernode *n, void *update) {
  const hk_row_run *end = s->run + child->run_end, *run = s->run + child->run;
  size_t inner = s->block * n->columns;
  while (run < end && run->to < n->columns) run++;
  for (; run < end; run++) {
    size_t column = s->block * run->to - inner;
    NAME(extend_run)(run, end, s->block, from, child->ldu, (HK_REAL *)update + n->ldu * column - inner, n->ldu);
  }
}

/* ---- Substitution, by strips of DEEP columns: as many sums of a strip backward fit the registers of every path.
 * Sums are of 64 bytes on every processor, in PARTS vectors, so that they have the same order. ---- */

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

static const hk_dense_path NAME(path)[] = {{WIDTH == 8   ? "AVX-512"
                                            : WIDTH == 4 ? "AVX2"
                                                         : "narrow",
                                            sizeof(HK_REAL), NAME(factorize), NAME(solve_rows), NAME(update),
                                            NAME(begin), NAME(extend_panel), NAME(extend_update), NAME(load),
                                            NAME(store), NAME(forward), NAME(backward), NAME(pass_on)}};
