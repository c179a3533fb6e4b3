/* The loops of dense_path.h for vectors of LANES numbers (core/plugin/each_width.h), which are HK_REAL: tiles and a
 * block of a front's columns here, what goes into a front in front_loops.h, solutions in substitution_loops.h.
 *
 * Both factors of a product lie in tiles, in the order in which they are read, as Goto has them: rows in strips of
 * ROWS, columns in strips of WIDE with their sign changed, so that a tile costs fused operations and loads alone. What
 * is read where it lies misses the processor's cache of pages in every column. Goto and van de Geijn, ACM TOMS 34
 * (2008).
 *
 * The tiles of 2 vectors x 6 columns are 12 of 16 registers, those of 12 columns 24 of AVX-512's 32. Products are
 * rounded by themselves with WIDTH 2: the last digit may differ from that of processors with fused multiply-add. */

enum {
  NAME(PARTS) = HK_FRONT_VECTOR / (8 * WIDTH),
  NAME(TALL) = 2,                   /* vectors of a tile */
  NAME(WIDE) = WIDTH == 8 ? 12 : 6, /* its columns */
  NAME(ROWS) = NAME(TALL) * 8 * WIDTH / sizeof(HK_REAL)
};

typedef HK_REAL NAME(aligned) __attribute__((vector_size(8 * WIDTH), aligned(8 * WIDTH), may_alias));

/* Columns that are worked on together where so many are left; TILES calls f with that number as a constant. */
TARGET HK_INLINE size_t NAME(width)(size_t left) {
  return left >= NAME(WIDE) ? NAME(WIDE) : left >= 6 ? 6 : left >= 3 ? 3 : 1;
}

#define TILES(W, f, ...)                                                                                               \
  ((W) == NAME(WIDE) ? f(__VA_ARGS__, NAME(WIDE))                                                                      \
   : (W) == 6        ? f(__VA_ARGS__, 6)                                                                               \
   : (W) == 3        ? f(__VA_ARGS__, 3)                                                                               \
                     : f(__VA_ARGS__, 1))

/* A tile of T vectors x W columns of C += A B^T: rows of A, of which a column is `stride` numbers behind the one
 * before, as C's; rows of B, a strip, as C's columns. */
TARGET HK_INLINE void NAME(multiply)(NAME(aligned) * c, const HK_REAL *A, size_t stride, const HK_REAL *B, size_t depth,
                                     size_t T, size_t W) {
  for (size_t k = 0; k < depth; k++) {
    const NAME(aligned) *a = (const NAME(aligned) *)(A + stride * k);
    const HK_REAL *b = B + W * k;
    NAME(aligned) row[NAME(TALL)];
    for (size_t i = 0; i < T; i++) row[i] = a[i];
    for (size_t j = 0; j < W; j++) {
      NAME(aligned) all = b[j] - (NAME(aligned)){0};
      for (size_t i = 0; i < T; i++) c[T * j + i] = FMA(row[i], all, c[T * j + i]);
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

/* X L^T = C for the triangle of W columns, whose sign is changed. */
TARGET HK_INLINE void NAME(divide_tile)(NAME(aligned) * c, const HK_REAL *triangle, const HK_REAL *inverse, size_t T,
                                        size_t W) {
  for (size_t j = 0; j < W; j++) {
    for (size_t k = 0; k < j; k++)
      for (size_t i = 0; i < T; i++)
        c[T * j + i] = FMA(c[T * k + i], triangle[W * j + k] - (NAME(aligned)){0}, c[T * j + i]);
    for (size_t i = 0; i < T; i++) c[T * j + i] *= inverse[j];
  }
}

TARGET HK_INLINE void NAME(add_tile)(HK_REAL *C, size_t ldc, const HK_REAL *A, size_t stride, const HK_REAL *B,
                                     size_t depth, bool first, size_t T, size_t W) {
  NAME(aligned) c[NAME(TALL) * NAME(WIDE)];
  if (first)
    for (size_t e = 0; e < T * W; e++) c[e] = (NAME(aligned)){0};
  else
    NAME(load_tile)(c, C, ldc, T, W);
  NAME(multiply)(c, A, stride, B, depth, T, W);
  NAME(store_tile)(c, C, ldc, T, W);
}

/* W rows of `depth` columns, from row `row` on, become a strip of B. */
TARGET HK_INLINE void NAME(pack)(const HK_REAL *panel, size_t ld, size_t row, size_t depth, HK_REAL *B, size_t W) {
  for (size_t k = 0; k < depth; k++)
    for (size_t j = 0; j < W; j++) B[W * k + j] = 0 - panel[ld * k + row + j];
}

/* ---- the square ---- */

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

/* Subtracts from rows [r, r + T vectors) of W columns the products of the `depth` before, whose strip is B, and divides
 * by the triangle. */
TARGET HK_INLINE void NAME(finish_tile)(HK_REAL *panel, size_t ld, size_t j, size_t r, size_t depth, const HK_REAL *B,
                                        const HK_REAL *triangle, const HK_REAL *inverse, size_t T, size_t W) {
  NAME(aligned) c[NAME(TALL) * NAME(WIDE)];
  NAME(load_tile)(c, panel + ld * j + r, ld, T, W);
  NAME(multiply)(c, panel + r, ld, B, depth, T, W);
  NAME(divide_tile)(c, triangle, inverse, T, W);
  NAME(store_tile)(c, panel + ld * j + r, ld, T, W);
}

/* W columns of the square, from column j on, with the rows to `end`. B gets their strip of the columns before, and
 * behind it their own triangle, both with their sign changed. Returns the number of columns with good pivots. */
TARGET HK_INLINE size_t NAME(strip)(HK_REAL *panel, size_t ld, size_t top, size_t end, size_t j, HK_REAL *inverse,
                                    HK_REAL *B, size_t W) {
  HK_REAL triangle[NAME(WIDE) * NAME(WIDE)], *C = panel + ld * j, *minus = B + W * j;
  size_t diagonal = top + j, first = diagonal / LANES * LANES, last = (diagonal + W + LANES - 1) / LANES * LANES;
  NAME(pack)(panel, ld, diagonal, j, B, W);
  for (size_t r = first; r < last; r += LANES) NAME(add_tile)(C + r, ld, panel + r, ld, B, j, false, 1, W);
  size_t good = NAME(triangle)(C + diagonal, ld, triangle, inverse + j, W), r = first;
  if (good < W) return j + good;
  for (size_t k = 0; k < W; k++)
    for (size_t i = k; i < W; i++) minus[W * i + k] = 0 - triangle[W * i + k];
  for (; r < last; r += LANES) NAME(finish_tile)(panel, ld, j, r, 0, B, minus, inverse + j, 1, W);
  for (; r + NAME(ROWS) <= end; r += NAME(ROWS))
    NAME(finish_tile)(panel, ld, j, r, j, B, minus, inverse + j, NAME(TALL), W);
  for (; r < end; r += LANES) NAME(finish_tile)(panel, ld, j, r, j, B, minus, inverse + j, 1, W);
  for (size_t k = 0; k < W; k++)
    for (size_t i = k; i < W; i++) C[ld * k + diagonal + i] = triangle[W * i + k];
  return j + W;
}

TARGET static size_t NAME(factorize)(const hk_front_block *f) {
  size_t j = 0, next = 0, W;
  HK_REAL *panel = f->panel, *square = f->square, *inverse = f->inverse;
  for (; j < f->columns && next == j; j += W) {
    W = NAME(width)(f->columns - j);
    next = TILES(W, NAME(strip), panel, f->ld, f->top, f->top + f->columns, j, inverse, square + HK_FRONT_DEPTH * j);
  }
  return next;
}

/* ---- the rows below ---- */

/* W columns of rows [r, r + T vectors) below the square, from column j on, into A and the panel. */
TARGET HK_INLINE void NAME(divide)(const hk_front_block *f, size_t r, size_t j, size_t T, size_t W) {
  const HK_REAL *B = (const HK_REAL *)f->square + HK_FRONT_DEPTH * j;
  HK_REAL *C = (HK_REAL *)f->panel + f->ld * j + f->begin + r, *A = (HK_REAL *)f->A + f->columns * r;
  NAME(aligned) c[NAME(TALL) * NAME(WIDE)];
  NAME(load_tile)(c, C, f->ld, T, W);
  NAME(multiply)(c, A, NAME(ROWS), B, j, T, W);
  NAME(divide_tile)(c, B + W * j, (const HK_REAL *)f->inverse + j, T, W);
  NAME(store_tile)(c, A + NAME(ROWS) * j, NAME(ROWS), T, W);
  NAME(store_tile)(c, C, f->ld, T, W);
}

/* Strips of rows after each other, as their tiles do not wait for each other. */
TARGET HK_INLINE void NAME(divide_all)(const hk_front_block *f, size_t begin, size_t end, size_t j, size_t W) {
  size_t r = begin;
  for (; r + NAME(ROWS) <= end; r += NAME(ROWS)) NAME(divide)(f, r, j, NAME(TALL), W);
  if (r < end) NAME(divide)(f, r, j, 1, W);
}

TARGET static void NAME(solve_rows)(const hk_front_block *f, size_t begin, size_t end) {
  for (size_t j = 0, W; j < f->columns; j += W) {
    W = NAME(width)(f->columns - j);
    TILES(W, NAME(divide_all), f, begin, end, j);
  }
}

TARGET static void NAME(pack_columns)(const hk_front_block *f, size_t begin, size_t end) {
  for (size_t j = begin, W; j < end; j += W) {
    W = NAME(width)(end - j);
    TILES(W, NAME(pack), f->panel, f->ld, f->begin + j, f->columns, (HK_REAL *)f->B + f->columns * j);
  }
}

/* Rows [r, end) of W columns, of which the first is the row j, from the diagonal on. */
TARGET HK_INLINE void NAME(subtract)(const hk_front_block *f, HK_REAL *C, size_t ldc, bool first, size_t j, size_t r,
                                     size_t end, size_t W) {
  const HK_REAL *A = f->A, *B = (const HK_REAL *)f->B + f->columns * j;
  size_t d = f->columns;
  if (j > r) r = j / LANES * LANES;
  if (r % NAME(ROWS) && r < end) {
    NAME(add_tile)(C + r, ldc, A + d * (r - LANES) + LANES, NAME(ROWS), B, d, first, 1, W);
    r += LANES;
  }
  for (; r + NAME(ROWS) <= end; r += NAME(ROWS))
    NAME(add_tile)(C + r, ldc, A + d * r, NAME(ROWS), B, d, first, NAME(TALL), W);
  if (r < end) NAME(add_tile)(C + r, ldc, A + d * r, NAME(ROWS), B, d, first, 1, W);
}

TARGET static void NAME(update)(const hk_front_block *f, size_t begin, size_t end) {
  size_t j = 0, W, most = f->inner + f->outer < end ? f->inner + f->outer : end;
  for (; j < f->inner && j < end; j += W) {
    W = NAME(width)(f->inner - j);
    HK_REAL *C = (HK_REAL *)f->panel + f->ld * (f->columns + j) + f->begin;
    TILES(W, NAME(subtract), f, C, f->ld, false, j, begin, end);
  }
  for (; j < most; j += W) {
    W = NAME(width)(f->inner + f->outer - j);
    HK_REAL *C = (HK_REAL *)f->update + f->ldu * (j - f->inner) - f->inner;
    TILES(W, NAME(subtract), f, C, f->ldu, f->first, j, begin, end);
  }
}

#undef TILES

#include "plugins/common/supernodal/front_loops.h"
#include "plugins/common/supernodal/substitution_loops.h"

static const hk_dense_path NAME(path)[] = {{WIDTH == 8   ? "AVX-512"
                                            : WIDTH == 4 ? "AVX2"
                                                         : "narrow",
                                            sizeof(HK_REAL), NAME(factorize), NAME(solve_rows), NAME(pack_columns),
                                            NAME(update), NAME(begin), NAME(extend_panel), NAME(extend_update),
                                            NAME(load), NAME(store), NAME(forward), NAME(backward), NAME(pass_on)}};
