/* y = A x from the upper triangle of A, which is read once: each block contributes to its row and, transposed, to the
 * row of its column. A chunk copies the values of x that it uses into three arrays by component, accumulates y there,
 * and adds the result to its own rows and, through `halo`, to those of other chunks. The order of sums is fixed by
 * chunks and slots, so results are bitwise equal for any number of threads and any vector width. */
#include "plugins/common/linear/block_vector.h"
#include "plugins/common/linear/upper_matrix.h"

#include <string.h>

#define PICK __builtin_shufflevector

enum { LANES = HK_UPPER_LANES };

typedef struct product_task {
  const hk_upper *m;
  const double *x;
  double *y;
  int lanes;
} product_task;

/* Local copies of the x and y that a chunk uses, component by component: component c of x is at `memory + c stride`, y
 * follows x. */
typedef struct local {
  double *memory;
  size_t stride, touched, rows; /* touched: rounded up to whole vectors; rows: rounded up to whole groups */
  size_t places;
  const uint32_t *place_row;
  double *halo;
} local;

/* Sets padding entries of x, which belong to no row, and all of y to zero. */
static void clear(const local *l, size_t block, size_t rows) {
  for (size_t c = 0; c < block; c++) {
    double *x = l->memory + c * l->stride;
    for (size_t k = rows; k < l->rows; k++) x[k] = 0;
    for (size_t k = l->rows + l->places; k < l->touched + LANES; k++) x[k] = 0;
    memset(x + block * l->stride, 0, (l->touched + LANES) * sizeof *x);
  }
}

static inline void one_in(const product_task *t, const local *l, size_t row, size_t k) {
  size_t b = t->m->block;
  for (size_t c = 0; c < b; c++) l->memory[c * l->stride + k] = t->x[b * row + c];
}

static inline void one_out(const local *l, size_t k, size_t block, double *to) {
  for (size_t c = 0; c < block; c++) to[c] = l->memory[(block + c) * l->stride + k];
}

/* ---- Blocks of three ------------------------------------------------------------------------------------------- */

/* Converts four successive rows of three numbers, at p, to components, at k. */
#define FOUR_IN(p, l, k)                                                                                               \
  do {                                                                                                                 \
    vector a_ = LOAD(p), b_ = LOAD((p) + 4), c_ = LOAD((p) + 8);                                                       \
    vector u_ = PICK(PICK(a_, b_, 0, 1, 6, 3), c_, 0, 5, 2, 3), v_ = PICK(PICK(b_, a_, 0, 5, 2, 3), c_, 0, 1, 6, 3);   \
    vector w_ = PICK(PICK(c_, b_, 0, 5, 2, 3), a_, 0, 1, 6, 3);                                                        \
    STORE((l)->memory + (k), PICK(u_, u_, 0, 3, 2, 1));                                                                \
    STORE((l)->memory + (l)->stride + (k), PICK(v_, v_, 1, 0, 3, 2));                                                  \
    STORE((l)->memory + 2 * (l)->stride + (k), PICK(w_, w_, 2, 1, 0, 3));                                              \
  } while (0)

/* The reverse conversion. */
#define FOUR_OUT(p, l, k)                                                                                              \
  do {                                                                                                                 \
    vector u_ = LOAD((l)->memory + 3 * (l)->stride + (k)), v_ = LOAD((l)->memory + 4 * (l)->stride + (k));             \
    vector w_ = LOAD((l)->memory + 5 * (l)->stride + (k));                                                             \
    u_ = PICK(u_, u_, 0, 3, 2, 1);                                                                                     \
    v_ = PICK(v_, v_, 1, 0, 3, 2);                                                                                     \
    w_ = PICK(w_, w_, 2, 1, 0, 3);                                                                                     \
    STORE(p, PICK(PICK(u_, v_, 0, 5, 2, 3), w_, 0, 1, 6, 3));                                                          \
    STORE((p) + 4, PICK(PICK(v_, w_, 0, 5, 2, 3), u_, 0, 1, 6, 3));                                                    \
    STORE((p) + 8, PICK(PICK(w_, u_, 0, 5, 2, 3), v_, 0, 1, 6, 3));                                                    \
  } while (0)

HK_INLINE void triples_in(const product_task *t, const local *l, size_t begin, size_t end) {
  size_t k = 0, p = 0;
  for (; begin + k + LANES <= end; k += LANES) FOUR_IN(t->x + 3 * (begin + k), l, k);
  for (; begin + k < end; k++) one_in(t, l, begin + k, k);
  while (p < l->places)
    if (p + LANES <= l->places && l->place_row[p + LANES - 1] - l->place_row[p] == LANES - 1) {
      FOUR_IN(t->x + 3 * (size_t)l->place_row[p], l, l->rows + p);
      p += LANES;
    } else {
      one_in(t, l, l->place_row[p], l->rows + p);
      p++;
    }
}

HK_INLINE void triples_out(const product_task *t, const local *l, size_t begin, size_t end) {
  size_t k = 0, p = 0;
  for (; begin + k + LANES <= end; k += LANES) FOUR_OUT(t->y + 3 * (begin + k), l, k);
  for (; begin + k < end; k++) one_out(l, k, 3, t->y + 3 * (begin + k));
  for (; p + LANES <= l->places; p += LANES) FOUR_OUT(l->halo + 3 * p, l, l->rows + p);
  for (; p < l->places; p++) one_out(l, l->rows + p, 3, l->halo + 3 * p);
}

/* Multiplies by the slot at B: adds to its rows (a, b, c) from X, Y, Z, and computes the contribution to its columns
 * (returned in X, Y, Z) from x0, x1, x2. A packed slot has xx, xy, xz, yy, yz, zz. */
#define MULTIPLY()                                                                                                     \
  do {                                                                                                                 \
    vector p_ = LOAD(B), q_ = LOAD(B + 4), r_ = LOAD(B + 8), u_, v_, w_, xy_ = q_, xz_ = r_;                           \
    a += p_ * X + q_ * Y + r_ * Z;                                                                                     \
    u_ = p_ * x0, v_ = q_ * x0, w_ = r_ * x0;                                                                          \
    p_ = packed ? xy_ : LOAD(B + 12);                                                                                  \
    q_ = packed ? LOAD(B + 12) : LOAD(B + 16);                                                                         \
    r_ = packed ? LOAD(B + 16) : LOAD(B + 20);                                                                         \
    b += p_ * X + q_ * Y + r_ * Z;                                                                                     \
    u_ += p_ * x1, v_ += q_ * x1, w_ += r_ * x1;                                                                       \
    p_ = packed ? xz_ : LOAD(B + 24);                                                                                  \
    q_ = packed ? r_ : LOAD(B + 28);                                                                                   \
    r_ = packed ? LOAD(B + 20) : LOAD(B + 32);                                                                         \
    c += p_ * X + q_ * Y + r_ * Z;                                                                                     \
    X = u_ + p_ * x2, Y = v_ + q_ * x2, Z = w_ + r_ * x2;                                                              \
    B += size;                                                                                                         \
  } while (0)

#define ADD(p, v) STORE(p, LOAD(p) + (v))
#define GATHER(p, i)                                                                                                   \
  { (p)[i[0]], (p)[i[1]], (p)[i[2]], (p)[i[3]] }
/* Adds lane by lane, since lanes may have the same column. */
#define SCATTER(p, i, v) (p)[i[0]] += v[0], (p)[i[1]] += v[1], (p)[i[2]] += v[2], (p)[i[3]] += v[3]

/* Returns the chunk's part of x.(A x): blocks right of the diagonal count twice. */
HK_INLINE double triple_groups(const hk_upper *m, const local *l, size_t begin, size_t end, bool packed) {
  const size_t size = packed ? 6 * LANES : 9 * LANES;
  const double *restrict xs = l->memory, *restrict ys = xs + l->stride, *restrict zs = ys + l->stride;
  double *restrict xt = l->memory + 3 * l->stride, *restrict yt = xt + l->stride, *restrict zt = yt + l->stride;
  const double *restrict B = m->value + 9 * LANES * m->slot_start[begin / LANES];
  const uint32_t *restrict index = m->index + m->index_start[begin / LANES];
  vector sum = {0};
  for (size_t g = begin / LANES, r = 0; LANES * g < end; g++, r += LANES) {
    size_t even = m->even[g], uneven = m->slot_start[g + 1] - m->slot_start[g] - 1 - even;
    vector x0 = LOAD(xs + r), x1 = LOAD(ys + r), x2 = LOAD(zs + r);
    vector a = {0}, b = {0}, c = {0};
    {
      vector X = x0, Y = x1, Z = x2; /* the contribution to the columns is not used */
      MULTIPLY();
    }
    vector diagonal = a * x0 + b * x1 + c * x2;
    for (const uint32_t *last = index + even; index < last; index++) {
      vector X = LOAD(xs + *index), Y = LOAD(ys + *index), Z = LOAD(zs + *index);
      MULTIPLY();
      ADD(xt + *index, X);
      ADD(yt + *index, Y);
      ADD(zt + *index, Z);
    }
    for (; uneven > 0; uneven--, index += LANES) {
      vector X = GATHER(xs, index), Y = GATHER(ys, index), Z = GATHER(zs, index);
      MULTIPLY();
      SCATTER(xt, index, X);
      SCATTER(yt, index, Y);
      SCATTER(zt, index, Z);
    }
    ADD(xt + r, a);
    ADD(yt + r, b);
    ADD(zt + r, c);
    sum += 2 * (a * x0 + b * x1 + c * x2) - diagonal;
  }
  return (sum[0] + sum[1]) + (sum[2] + sum[3]);
}

HK_INLINE double triple_chunk(const product_task *t, const local *l, size_t begin, size_t end, bool packed) {
  clear(l, 3, end - begin);
  triples_in(t, l, begin, end);
  double sum = packed ? triple_groups(t->m, l, begin, end, true) : triple_groups(t->m, l, begin, end, false);
  triples_out(t, l, begin, end);
  return sum;
}

HK_VERSIONS(static double, triple_part, (const product_task *t, const local *l, size_t begin, size_t end, bool packed),
            return triple_chunk(t, l, begin, end, packed))

/* ---- Blocks of one --------------------------------------------------------------------------------------------- */

static void single_groups(const hk_upper *m, const local *l, size_t begin, size_t end) {
  const double *x = l->memory, *B = m->value + LANES * m->slot_start[begin / LANES];
  double *y = l->memory + l->stride;
  const uint32_t *index = m->index + m->index_start[begin / LANES];
  for (size_t g = begin / LANES, r = 0; LANES * g < end; g++, r += LANES) {
    size_t even = m->even[g], slots = m->slot_start[g + 1] - m->slot_start[g];
    for (size_t lane = 0; lane < LANES; lane++) y[r + lane] += B[lane] * x[r + lane];
    B += LANES;
    for (size_t s = 1; s < slots; s++, B += LANES) {
      for (size_t lane = 0; lane < LANES; lane++) {
        size_t j = s <= even ? index[0] + lane : index[lane];
        y[r + lane] += B[lane] * x[j];
        y[j] += B[lane] * x[r + lane];
      }
      index += s <= even ? 1 : LANES;
    }
  }
}

/* The chunk's part of x.(A x), as four partial sums. */
static double dot(const local *l) {
  const double *x = l->memory, *y = x + l->stride;
  double sum[LANES] = {0};
  for (size_t k = 0; k < l->touched; k += LANES)
    for (size_t lane = 0; lane < LANES; lane++) sum[lane] += x[k + lane] * y[k + lane];
  return (sum[0] + sum[1]) + (sum[2] + sum[3]);
}

static double single_chunk(const product_task *t, const local *l, size_t begin, size_t end) {
  clear(l, 1, end - begin);
  for (size_t r = begin; r < end; r++) one_in(t, l, r, r - begin);
  for (size_t p = 0; p < l->places; p++) one_in(t, l, l->place_row[p], l->rows + p);
  single_groups(t->m, l, begin, end);
  for (size_t r = begin; r < end; r++) one_out(l, r - begin, 1, t->y + r);
  for (size_t p = 0; p < l->places; p++) one_out(l, l->rows + p, 1, l->halo + p);
  return dot(l);
}

/* ---- The product ----------------------------------------------------------------------------------------------- */

static void multiply_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  const product_task *t = context;
  const hk_upper *m = t->m;
  double stack[6 * (HK_UPPER_LOCAL + HK_UPPER_SPARE)] __attribute__((aligned(64)));
  size_t touched = hk_upper_touched(m, chunk), first = m->place_start[chunk];
  local l = {.memory = m->own[chunk] ? m->own[chunk] : stack,
             .stride = hk_upper_stride(touched),
             .touched = touched,
             .rows = (end - begin + LANES - 1) / LANES * LANES,
             .places = m->place_start[chunk + 1] - first,
             .place_row = m->place_row + first,
             .halo = m->halo + m->block * first};
  if (m->block == 1)
    m->part[chunk] = single_chunk(t, &l, begin, end);
  else
    m->part[chunk] = HK_WIDEST(t->lanes, triple_part)(t, &l, begin, end, m->packed[chunk]);
}

/* Adds the contributions of other chunks to the rows of this one. */
static void receive_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  const product_task *t = context;
  const hk_upper *m = t->m;
  size_t b = m->block;
  (void)begin, (void)end;
  for (size_t p = m->take_start[chunk]; p < m->take_start[chunk + 1]; p++) {
    const double *from = m->halo + b * m->take[p];
    double *to = t->y + b * m->place_row[m->take[p]];
    for (size_t c = 0; c < b; c++) to[c] += from[c];
  }
}

double hk_upper_product(const hk_upper *m, const hk_host *host, const double *x, double *y) {
  product_task task = {m, x, y, host->lanes};
  double sum = 0;
  host->parallel_for(host, m->rows, m->chunk, multiply_chunk, &task);
  if (m->place_start[m->chunks] > 0) host->parallel_for(host, m->rows, m->chunk, receive_chunk, &task);
  for (size_t k = 0; k < m->chunks; k++) sum += m->part[k];
  return sum;
}
