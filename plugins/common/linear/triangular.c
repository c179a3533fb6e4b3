/* Forward and backward substitution with a sparse Cholesky factor, four right-hand sides at a time.
 *
 * The factor is copied into panels of 8, 4, 2 or 1 columns: the reciprocals of the diagonal, the triangle below it,
 * then every further row as 8, 4, 2 or 1 neighbouring numbers. Both substitutions read that copy once, one forwards and
 * one backwards, so that the second finds the end of the first in the cache. Right-hand sides are stored in rows of
 * four (missing ones are zero): a number of L is multiplied by four of them in one vector, and a panel's rows of x stay
 * in registers. One thread is used, since the factors fit a cache and sums keep one order. Results are bitwise equal on
 * every processor, as all paths do the same operations. George and Liu, Computer Solution of Large Sparse Positive
 * Definite Systems (1981), chapter 5; supernodes: Ashcraft and Grimes, ACM TOMS 15 (1989). */
#include "plugins/common/linear/triangular.h"

#include <string.h>

enum { LANES = 4, WIDEST = 8 };

typedef double lanes __attribute__((vector_size(32), aligned(32), may_alias));

typedef struct panel {
  uint32_t column, rows, width; /* first column; number of rows below the triangle; number of columns */
  size_t list, value;           /* first position of its rows and of its values */
} panel;

typedef void substitute(const hk_triangular *t, double *x);

struct hk_triangular {
  size_t n, panels;
  panel *panel;
  uint32_t *row;
  double *value;
  uint32_t *order; /* n */
  double *x;       /* n x LANES */
  substitute *both;
};

/* ---- Substitution. W is a constant in every call, so the loops over it are unrolled. ---- */

#define ROW(x, i) (*(lanes *)((x) + LANES * (size_t)(i)))

HK_INLINE void forward(const panel *p, const uint32_t *row, const double *value, double *x, size_t W) {
  lanes y[WIDEST];
  for (size_t j = 0; j < W; j++) {
    lanes sum = ROW(x, p->column + j);
    for (size_t k = 0; k < j; k++) sum -= value[W * j + k] * y[k];
    y[j] = sum * value[W * j + j];
    ROW(x, p->column + j) = y[j];
  }
  value += W * W;
  for (size_t r = 0; r < p->rows; r++, value += W) {
    lanes even = value[0] * y[0], odd = {0};
    for (size_t j = 1; j < W; j++) {
      if (j & 1)
        odd += value[j] * y[j];
      else
        even += value[j] * y[j];
    }
    ROW(x, row[r]) -= even + odd;
  }
}

HK_INLINE void backward(const panel *p, const uint32_t *row, const double *value, double *x, size_t W) {
  lanes y[WIDEST];
  const double *below = value + W * W;
  for (size_t j = 0; j < W; j++) y[j] = ROW(x, p->column + j);
  for (size_t r = 0; r < p->rows; r++, below += W) {
    lanes there = ROW(x, row[r]);
    for (size_t j = 0; j < W; j++) y[j] -= below[j] * there;
  }
  for (size_t j = W; j-- > 0;) {
    for (size_t k = j + 1; k < W; k++) y[j] -= value[W * k + j] * y[k];
    y[j] *= value[W * j + j];
    ROW(x, p->column + j) = y[j];
  }
}

#define EACH_WIDTH(what, p, t, x)                                                                                      \
  do {                                                                                                                 \
    const uint32_t *row_ = (t)->row + (p)->list;                                                                       \
    const double *value_ = (t)->value + (p)->value;                                                                    \
    switch ((p)->width) {                                                                                              \
    case 8:                                                                                                            \
      what(p, row_, value_, x, 8);                                                                                     \
      break;                                                                                                           \
    case 4:                                                                                                            \
      what(p, row_, value_, x, 4);                                                                                     \
      break;                                                                                                           \
    case 2:                                                                                                            \
      what(p, row_, value_, x, 2);                                                                                     \
      break;                                                                                                           \
    default:                                                                                                           \
      what(p, row_, value_, x, 1);                                                                                     \
    }                                                                                                                  \
  } while (0)

HK_INLINE void both(const hk_triangular *t, double *x) {
  for (size_t k = 0; k < t->panels; k++) EACH_WIDTH(forward, &t->panel[k], t, x);
  for (size_t k = t->panels; k-- > 0;) EACH_WIDTH(backward, &t->panel[k], t, x);
}

HK_VERSIONS(static void, both_solves, (const hk_triangular *t, double *x), both(t, x))

void hk_triangular_solve(hk_triangular *t, const double *b, double *x, size_t columns) {
  for (size_t first = 0; first < columns; first += LANES) {
    size_t width = columns - first < LANES ? columns - first : LANES;
    memset(t->x, 0, LANES * t->n * sizeof *t->x);
    for (size_t k = 0; k < t->n; k++)
      for (size_t c = 0; c < width; c++) t->x[LANES * k + c] = b[columns * t->order[k] + first + c];
    t->both(t, t->x);
    for (size_t k = 0; k < t->n; k++)
      for (size_t c = 0; c < width; c++) x[columns * t->order[k] + first + c] = t->x[LANES * k + c];
  }
}

/* ---- The copy ---- */

static size_t width_at(size_t left) { return left >= 8 ? 8 : left >= 4 ? 4 : left >= 2 ? 2 : 1; }

static void count(const hk_factor_view *f, size_t *panels, size_t *rows, size_t *values) {
  *panels = *rows = *values = 0;
  for (size_t s = 0; s < f->supernodes; s++) {
    size_t columns = (size_t)(f->first[s + 1] - f->first[s]), width;
    *rows += (size_t)f->rows[s];
    for (size_t c = 0; c < columns; c += width, (*panels)++) {
      width = width_at(columns - c);
      *values += width * ((size_t)f->rows[s] - c);
    }
  }
}

static void lay_out(hk_triangular *t, const hk_factor_view *f) {
  size_t at = 0, value = 0;
  panel *p = t->panel;
  for (size_t s = 0; s < f->supernodes; s++) {
    size_t columns = (size_t)(f->first[s + 1] - f->first[s]), rows = (size_t)f->rows[s], width;
    for (size_t r = 0; r < rows; r++) t->row[at + r] = (uint32_t)f->row[(size_t)f->list[s] + r];
    for (size_t c = 0; c < columns; c += width, p++) {
      width = width_at(columns - c);
      *p = (panel){(uint32_t)f->first[s] + (uint32_t)c, (uint32_t)(rows - c - width), (uint32_t)width, at + c + width,
                   value};
      value += width * (rows - c);
    }
    at += rows;
  }
}

hk_triangular *hk_triangular_create(const hk_host *host, const hk_factor_view *f) {
  size_t panels, rows, values;
  hk_triangular *t = host->allocate(host, sizeof *t);
  if (!t) return NULL;
  count(f, &panels, &rows, &values);
  *t = (hk_triangular){.n = f->n, .panels = panels, .both = HK_WIDEST(host->lanes, both_solves)};
  t->panel = host->allocate(host, (panels + 1) * sizeof *t->panel);
  t->row = host->allocate(host, (rows + 1) * sizeof *t->row);
  t->value = host->allocate(host, (values + 1) * sizeof *t->value);
  t->order = host->allocate(host, (f->n + 1) * sizeof *t->order);
  t->x = host->allocate(host, (LANES * f->n + 1) * sizeof *t->x);
  if (!t->panel || !t->row || !t->value || !t->order || !t->x) {
    hk_triangular_free(t, host);
    return NULL;
  }
  for (size_t k = 0; k < f->n; k++) t->order[k] = f->order ? (uint32_t)f->order[k] : (uint32_t)k;
  lay_out(t, f);
  return t;
}

void hk_triangular_free(hk_triangular *t, const hk_host *host) {
  if (!t) return;
  host->release(host, t->panel);
  host->release(host, t->row);
  host->release(host, t->value);
  host->release(host, t->order);
  host->release(host, t->x);
  host->release(host, t);
}

void hk_triangular_fill(hk_triangular *t, const hk_factor_view *f) {
  const panel *p = t->panel;
  for (size_t s = 0; s < f->supernodes; s++) {
    size_t rows = (size_t)f->rows[s];
    for (size_t begin = (size_t)f->first[s]; p < t->panel + t->panels && p->column < (size_t)f->first[s + 1]; p++) {
      size_t top = p->column - begin; /* the panel's first row in the list */
      double *to = t->value + p->value;
      for (size_t j = 0; j < p->width; j++) {
        const double *from = f->value + f->column[p->column + j] + top;
        to[p->width * j + j] = 1 / from[j];
        for (size_t r = j + 1; r < rows - top; r++) to[p->width * r + j] = from[r];
      }
    }
  }
}
