/* The loops of dense_path.h. A file that includes this one defines before: REAL; INLINE and TARGET, attributes with its
 * instruction set; BYTES of a vector; TALL, vectors of a tile, and WIDE, its columns, a multiple of 3; FMA(a, b, c) =
 * a b + c of vectors and FMA1 of numbers; NAME(x), x with a suffix of its own. It undefines what depends on REAL. */
#include "plugins/common/supernodal/dense_path.h"

#include <string.h>

#define LANES (BYTES / sizeof(REAL))
#define PARTS                                                                                                          \
  (HK_FRONT_VECTOR / BYTES) /* sums are of 64 bytes on every processor, so that they have the same order               \
                             */
#define VECTOR NAME(vector)

typedef REAL VECTOR __attribute__((vector_size(BYTES), aligned(BYTES), may_alias));

/* A tile of T vectors x W columns of C -= A B^T: rows of A as C's, rows of B as C's columns. */
INLINE void NAME(multiply)(VECTOR *c, const REAL *A, const REAL *B, size_t ld, size_t depth, size_t T, size_t W) {
  for (size_t k = 0; k < depth; k++) {
    const VECTOR *a = (const VECTOR *)(A + ld * k);
    const REAL *b = B + ld * k;
    VECTOR row[TALL];
    for (size_t i = 0; i < T; i++) row[i] = a[i];
    for (size_t j = 0; j < W; j++) {
      VECTOR minus = (VECTOR){0} - b[j];
      for (size_t i = 0; i < T; i++) c[T * j + i] = FMA(row[i], minus, c[T * j + i]);
    }
  }
}

INLINE void NAME(load_tile)(VECTOR *c, const REAL *C, size_t ld, size_t T, size_t W) {
  for (size_t j = 0; j < W; j++)
    for (size_t i = 0; i < T; i++) c[T * j + i] = ((const VECTOR *)(C + ld * j))[i];
}

INLINE void NAME(store_tile)(const VECTOR *c, REAL *C, size_t ld, size_t T, size_t W) {
  for (size_t j = 0; j < W; j++)
    for (size_t i = 0; i < T; i++) ((VECTOR *)(C + ld * j))[i] = c[T * j + i];
}

/* X L^T = C for the triangle of W columns. */
INLINE void NAME(divide)(VECTOR *c, const REAL *triangle, const REAL *inverse, size_t T, size_t W) {
  for (size_t j = 0; j < W; j++) {
    for (size_t k = 0; k < j; k++)
      for (size_t i = 0; i < T; i++) c[T * j + i] = FMA(c[T * k + i], (VECTOR){0} - triangle[W * j + k], c[T * j + i]);
    for (size_t i = 0; i < T; i++) c[T * j + i] *= inverse[j];
  }
}

/* C = -A B^T. */
INLINE void NAME(product_tile)(REAL *C, size_t ldc, const REAL *A, const REAL *B, size_t ld, size_t depth, size_t T,
                               size_t W) {
  VECTOR c[TALL * WIDE];
  for (size_t e = 0; e < T * W; e++) c[e] = (VECTOR){0};
  NAME(multiply)(c, A, B, ld, depth, T, W);
  NAME(store_tile)(c, C, ldc, T, W);
}

INLINE void NAME(subtract_tile)(REAL *C, size_t ldc, const REAL *A, const REAL *B, size_t ld, size_t depth, size_t T,
                                size_t W) {
  VECTOR c[TALL * WIDE];
  NAME(load_tile)(c, C, ldc, T, W);
  NAME(multiply)(c, A, B, ld, depth, T, W);
  NAME(store_tile)(c, C, ldc, T, W);
}

INLINE void NAME(product)(REAL *C, size_t ldc, const REAL *A, const REAL *B, size_t ld, size_t rows, size_t depth,
                          size_t W) {
  size_t r = 0;
  for (; r + TALL * LANES <= rows; r += TALL * LANES) NAME(product_tile)(C + r, ldc, A + r, B, ld, depth, TALL, W);
  for (; r < rows; r += LANES) NAME(product_tile)(C + r, ldc, A + r, B, ld, depth, 1, W);
}

INLINE void NAME(finish_tile)(REAL *C, const REAL *A, const REAL *B, size_t ld, size_t depth, const REAL *triangle,
                              const REAL *inverse, size_t T, size_t W) {
  VECTOR c[TALL * WIDE];
  NAME(load_tile)(c, C, ld, T, W);
  NAME(multiply)(c, A, B, ld, depth, T, W);
  NAME(divide)(c, triangle, inverse, T, W);
  NAME(store_tile)(c, C, ld, T, W);
}

/* The factor of the W x W numbers on the diagonal; returns the number of good pivots. */
INLINE size_t NAME(triangle)(const REAL *C, size_t ld, REAL *triangle, REAL *inverse, size_t W) {
  for (size_t j = 0; j < W; j++) {
    REAL *row = triangle + W * j;
    for (size_t k = 0; k <= j; k++) {
      REAL sum = C[ld * k + j];
      for (size_t m = 0; m < k; m++) sum = FMA1(row[m], -triangle[W * k + m], sum);
      row[k] = k < j ? sum * inverse[k] : sum;
    }
    if (!(row[j] > 0)) return j;
    row[j] = ROOT(row[j]);
    inverse[j] = 1 / row[j];
  }
  return W;
}

/* W columns of a panel, from column j on: subtracts the products of those before, and divides by the triangle. */
INLINE size_t NAME(strip)(REAL *panel, size_t ld, size_t top, size_t j, REAL *inverse, size_t W) {
  REAL triangle[WIDE * WIDE], *C = panel + ld * j;
  size_t diagonal = top + j, first = diagonal / LANES * LANES, last = (diagonal + W + LANES - 1) / LANES * LANES;
  const REAL *B = panel + diagonal;
  for (size_t r = first; r < last; r += LANES) NAME(subtract_tile)(C + r, ld, panel + r, B, ld, j, 1, W);
  size_t good = NAME(triangle)(C + diagonal, ld, triangle, inverse + j, W);
  if (good < W) return j + good;
  size_t r = first;
  for (; r < last; r += LANES) NAME(finish_tile)(C + r, panel + r, B, ld, 0, triangle, inverse + j, 1, W);
  for (; r + TALL * LANES <= ld; r += TALL * LANES)
    NAME(finish_tile)(C + r, panel + r, B, ld, j, triangle, inverse + j, TALL, W);
  for (; r < ld; r += LANES) NAME(finish_tile)(C + r, panel + r, B, ld, j, triangle, inverse + j, 1, W);
  for (size_t k = 0; k < W; k++)
    for (size_t i = k; i < W; i++) C[ld * k + diagonal + i] = triangle[W * i + k];
  return j + W;
}

TARGET static size_t NAME(factorize)(void *panel, size_t ld, size_t top, size_t columns, void *inverse) {
  size_t j = 0, next = 0;
  while (j < columns) {
    size_t left = columns - j;
    if (left >= WIDE)
      next = NAME(strip)(panel, ld, top, j, inverse, WIDE);
    else if (left >= 3)
      next = NAME(strip)(panel, ld, top, j, inverse, 3);
    else
      next = NAME(strip)(panel, ld, top, j, inverse, 1);
    if (next < j + (left >= WIDE ? WIDE : left >= 3 ? 3 : 1)) break;
    j = next;
  }
  return next;
}

TARGET static void NAME(update)(void *U, size_t ldu, size_t begin, size_t end, const void *L, size_t ld,
                                size_t columns) {
  for (size_t j = begin, W; j < end; j += W) {
    size_t first = j / LANES * LANES, rows = ldu - first;
    REAL *C = (REAL *)U + ldu * j + first;
    const REAL *A = (const REAL *)L + first, *B = (const REAL *)L + j;
    W = end - j >= WIDE ? WIDE : end - j >= 3 ? 3 : 1;
    if (W == WIDE)
      NAME(product)(C, ldu, A, B, ld, rows, columns, WIDE);
    else if (W == 3)
      NAME(product)(C, ldu, A, B, ld, rows, columns, 3);
    else
      NAME(product)(C, ldu, A, B, ld, rows, columns, 1);
  }
}

/* ---- Fronts ---- */

TARGET static void NAME(begin)(const hk_supernodes *s, const hk_supernode *n, const double *value, void *panel) {
  size_t b = s->block;
  memset(panel, 0, n->ld * b * n->columns * sizeof(REAL));
  for (const hk_entry *e = s->entry + n->entry; e < s->entry + n->entry_end; e++) {
    const double *from = value + b * b * e->block;
    REAL *to = (REAL *)panel + e->to;
    for (size_t c = 0; c < b; c++)
      for (size_t r = 0; r < b; r++) to[n->ld * c + r] = (REAL)from[b * c + r];
  }
}

/* Adds the columns of a run, and those of the runs after it as rows. `to` points to the front's first row in the column
 * where the run begins. */
INLINE void NAME(extend_run)(const hk_run *run, const hk_run *end, size_t b, const REAL *from, size_t ld, REAL *to,
                             size_t ld_to) {
  for (size_t c = 0; c < b * run->count; c++) {
    const REAL *source = from + ld * (b * run->from + c);
    REAL *target = to + ld_to * c;
    for (const hk_run *rows = run; rows < end; rows++) {
      const REAL *add = source + b * rows->from;
      REAL *sum = target + b * rows->to;
      for (size_t r = rows == run ? c : 0; r < b * rows->count; r++) sum[r] += add[r];
    }
  }
}

TARGET static void NAME(extend_panel)(const hk_supernodes *s, const hk_supernode *child, const void *from,
                                      const hk_supernode *n, void *panel) {
  const hk_run *end = s->run + child->run_end, *run = s->run + child->run;
  for (; run < end && run->to < n->columns; run++)
    NAME(extend_run)(run, end, s->block, from, child->ldu, (REAL *)panel + n->ld * s->block * run->to + n->top, n->ld);
}

TARGET static void NAME(extend_update)(const hk_supernodes *s, const hk_supernode *child, const void *from,
                                       const hk_supernode *n, void *update) {
  const hk_run *end = s->run + child->run_end, *run = s->run + child->run;
  size_t inner = s->block * n->columns;
  while (run < end && run->to < n->columns) run++;
  for (; run < end; run++) NAME(extend_run)
  (run, end, s->block, from, child->ldu, (REAL *)update + n->ldu * (s->block * run->to - inner) - inner, n->ldu);
}

/* ---- Substitution, by strips of DEEP columns ---- */

enum { NAME(DEEP) = 6 };

INLINE void NAME(forward_strip)(const REAL *panel, size_t ld, size_t top, size_t j, const REAL *inverse, REAL *w,
                                size_t W) {
  const size_t whole = PARTS * LANES;
  size_t diagonal = top + j, r = (diagonal + W + whole - 1) / whole * whole;
  REAL x[NAME(DEEP)];
  for (size_t k = 0; k < W; k++) {
    x[k] = w[diagonal + k] *= inverse[j + k];
    for (size_t i = diagonal + k + 1; i < r; i++) w[i] = FMA1(-panel[ld * (j + k) + i], x[k], w[i]);
  }
  for (; r < ld; r += LANES) {
    VECTOR sum = *(VECTOR *)(w + r);
    for (size_t k = 0; k < W; k++) sum = FMA(*(const VECTOR *)(panel + ld * (j + k) + r), (VECTOR){0} - x[k], sum);
    *(VECTOR *)(w + r) = sum;
  }
}

INLINE void NAME(forward_panel)(const REAL *panel, size_t ld, size_t top, size_t columns, const REAL *inverse,
                                REAL *w) {
  size_t j = 0;
  for (; j + NAME(DEEP) <= columns; j += NAME(DEEP)) NAME(forward_strip)(panel, ld, top, j, inverse, w, NAME(DEEP));
  for (; j + 3 <= columns; j += 3) NAME(forward_strip)(panel, ld, top, j, inverse, w, 3);
  for (; j < columns; j++) NAME(forward_strip)(panel, ld, top, j, inverse, w, 1);
}

INLINE REAL NAME(total)(const VECTOR *v) {
  REAL sum[HK_FRONT_VECTOR / sizeof(REAL)];
  for (size_t l = 0; l < PARTS * LANES; l++) sum[l] = v[l / LANES][l % LANES];
  for (size_t half = PARTS * LANES / 2; half > 0; half /= 2)
    for (size_t l = 0; l < half; l++) sum[l] += sum[l + half];
  return sum[0];
}

INLINE void NAME(backward_strip)(const REAL *panel, size_t ld, size_t top, size_t j, const REAL *inverse, REAL *w,
                                 size_t W) {
  const size_t whole = PARTS * LANES;
  size_t diagonal = top + j, begin = (diagonal + W + whole - 1) / whole * whole;
  VECTOR sum[NAME(DEEP)][PARTS];
  for (size_t k = 0; k < W; k++)
    for (size_t p = 0; p < PARTS; p++) sum[k][p] = (VECTOR){0};
  for (size_t r = begin; r < ld; r += whole)
    for (size_t k = 0; k < W; k++)
      for (size_t p = 0; p < PARTS; p++)
        sum[k][p] = FMA(((const VECTOR *)(panel + ld * (j + k) + r))[p], ((const VECTOR *)(w + r))[p], sum[k][p]);
  for (size_t k = W; k-- > 0;) {
    REAL x = w[diagonal + k] - NAME(total)(sum[k]);
    for (size_t i = diagonal + k + 1; i < begin; i++) x = FMA1(-panel[ld * (j + k) + i], w[i], x);
    w[diagonal + k] = x * inverse[j + k];
  }
}

INLINE void NAME(backward_panel)(const REAL *panel, size_t ld, size_t top, size_t columns, const REAL *inverse,
                                 REAL *w) {
  size_t deep = columns / NAME(DEEP) * NAME(DEEP), threes = deep + (columns - deep) / 3 * 3, j = columns;
  while (j > threes) j--, NAME(backward_strip)(panel, ld, top, j, inverse, w, 1);
  while (j > deep) j -= 3, NAME(backward_strip)(panel, ld, top, j, inverse, w, 3);
  while (j > 0) j -= NAME(DEEP), NAME(backward_strip)(panel, ld, top, j, inverse, w, NAME(DEEP));
}

TARGET static void NAME(load)(const hk_supernodes *s, const hk_supernode *n, const double *b, double scale,
                              void *vector) {
  size_t w = s->block;
  REAL *to = (REAL *)vector + w * n->first;
  for (size_t k = 0; k < n->columns; k++)
    for (size_t c = 0; c < w; c++) to[w * k + c] = (REAL)(b[w * s->order[n->first + k] + c] * scale);
}

TARGET static void NAME(store)(const hk_supernodes *s, const hk_supernode *n, const void *vector, double scale,
                               double *x) {
  size_t w = s->block;
  const REAL *from = (const REAL *)vector + w * n->first;
  for (size_t k = 0; k < n->columns; k++)
    for (size_t c = 0; c < w; c++) x[w * s->order[n->first + k] + c] = (double)from[w * k + c] * scale;
}

TARGET static void NAME(forward)(const hk_supernodes *s, const hk_supernode *n, const void *panel, const void *inverse,
                                 void *vector, void *front) {
  size_t b = s->block, columns = b * n->columns;
  REAL *x = (REAL *)vector + b * n->first, *w = front, *below = w + n->top + columns;
  memset(w, 0, n->ld * sizeof *w);
  memcpy(w + n->top, x, columns * sizeof *w);
  NAME(forward_panel)(panel, n->ld, n->top, columns, inverse, w);
  memcpy(x, w + n->top, columns * sizeof *w);
  for (size_t r = 0; r < n->rows; r++)
    for (size_t c = 0; c < b; c++) ((REAL *)vector)[b * s->row[n->list + r] + c] += below[b * r + c];
}

TARGET static void NAME(backward)(const hk_supernodes *s, const hk_supernode *n, const void *panel, const void *inverse,
                                  void *vector, void *front) {
  size_t b = s->block, columns = b * n->columns;
  REAL *x = (REAL *)vector + b * n->first, *w = front, *below = w + n->top + columns;
  memset(w, 0, n->ld * sizeof *w);
  memcpy(w + n->top, x, columns * sizeof *w);
  for (size_t r = 0; r < n->rows; r++)
    for (size_t c = 0; c < b; c++) below[b * r + c] = ((const REAL *)vector)[b * s->row[n->list + r] + c];
  NAME(backward_panel)(panel, n->ld, n->top, columns, inverse, w);
  memcpy(x, w + n->top, columns * sizeof *w);
}

TARGET static void NAME(pass_on)(const hk_supernodes *s, const hk_supernode *n, void *from, void *to) {
  size_t b = s->block;
  for (size_t r = 0; r < n->rows; r++)
    for (size_t c = 0; c < b; c++) {
      REAL *here = (REAL *)from + b * s->row[n->list + r] + c;
      ((REAL *)to)[b * s->row[n->list + r] + c] += *here;
      *here = 0;
    }
}

static const hk_dense_path NAME(path) = {NAME_OF_PATH, sizeof(REAL),       NAME(factorize),     NAME(update),
                                         NAME(begin),  NAME(extend_panel), NAME(extend_update), NAME(load),
                                         NAME(store),  NAME(forward),      NAME(backward),      NAME(pass_on)};

#undef VECTOR
#undef LANES
#undef PARTS
#undef FMA
#undef FMA1
#undef ROOT
#undef REAL
#undef NAME
