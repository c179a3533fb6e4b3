/* See viscous_coarse.h. Pieces are blocks of 6 cells along each axis, divided where the viscosity goes from one class
 * of two decades to another, so that no piece is held together by the stiff part of its neighbour. Their motions are
 * made orthonormal; of a piece that is a single face, or flat, fewer than six are left, and the others have rows of
 * their own with a 1. In sums of numbers that cancel, a rigid motion's small ones are left with rounding of the large
 * ones: the diagonal is raised by a part of these, which a preconditioner may be. */
#include "plugins/common/liquid_viscosity/viscous_coarse.h"
#include "plugins/common/cholesky/block_order.h"
#include "plugins/common/linear/upper_matrix.h"

#include <string.h>

enum { MODES = HK_RIGID_MODES, GRAIN = 16, CLASSES = 64, SIDE = HK_VISCOUS_PIECE };

static const double decades_of_class = 2;
static const double least_independent = 1e-6;               /* of a motion's square, what no other motion has */
static const double first_shift = 1e-12, last_shift = 1e-2; /* of the diagonal; a hundredfold in between */

/* ---- pieces ---- */

static int class_of(const hk_viscous_faces *f, size_t r) {
  if (!f->cell) return 0;
  double mu = fmax(f->cell[f->face[r]], f->cell[f->face[r] - f->grid->stride[f->axis[r]]]);
  if (!(mu > 0)) return 0;
  double k = floor(log10(mu) / decades_of_class) + CLASSES / 2;
  return (int)fmin(CLASSES - 1, fmax(0, k));
}

static size_t block_of(const hk_liquid_grid *g, size_t i, size_t blocks[3]) {
  size_t k[3];
  for (int c = 0; c < 3; c++) {
    k[c] = i / g->stride[c] % (g->cells[c] + 2) / SIDE;
    blocks[c] = (g->cells[c] + 2) / SIDE + 1;
  }
  return (k[0] * blocks[1] + k[1]) * blocks[2] + k[2];
}

static hk_status no_memory(const hk_viscous_coarse *s) {
  return s->host->fail(s->host, HK_NO_MEMORY, "no memory for the rigid motions of %zu faces", s->faces);
}

/* Numbers the pieces, in the order of their first faces. */
static hk_status find_pieces(hk_viscous_coarse *s, const hk_viscous_faces *f) {
  size_t blocks[3];
  block_of(f->grid, 0, blocks);
  size_t most = blocks[0] * blocks[1] * blocks[2] * CLASSES;
  uint32_t *number = s->host->allocate(s->host, most * sizeof *number);
  if (!number) return no_memory(s);
  memset(number, 0xff, most * sizeof *number);
  s->pieces = 0;
  for (size_t r = 0; r < s->faces; r++) {
    size_t key = block_of(f->grid, f->face[r], blocks) * CLASSES + (size_t)class_of(f, r);
    if (number[key] == UINT32_MAX) number[key] = (uint32_t)s->pieces++;
    s->piece[r] = number[key];
  }
  s->host->release(s->host, number);
  return HK_OK;
}

static void list_members(hk_viscous_coarse *s) {
  memset(s->start, 0, (s->pieces + 1) * sizeof *s->start);
  for (size_t r = 0; r < s->faces; r++) s->start[s->piece[r] + 1]++;
  for (size_t p = 0; p < s->pieces; p++) s->start[p + 1] += s->start[p];
  for (size_t r = 0; r < s->faces; r++) s->member[s->start[s->piece[r]]++] = (uint32_t)r;
  for (size_t p = s->pieces; p > 0; p--) s->start[p] = s->start[p - 1];
  s->start[0] = 0;
}

/* ---- their motions ---- */

static void motions_at(const hk_liquid_grid *g, const double x[3], int a, double mode[MODES]) {
  int b = (a + 1) % 3, c = (a + 2) % 3;
  memset(mode, 0, MODES * sizeof *mode);
  mode[a] = 1; /* (w x r)_a = w_b r_c - w_c r_b */
  if (!g->flat[c]) mode[3 + b] = x[c];
  if (!g->flat[b]) mode[3 + c] = -x[b];
}

/* Gram and Schmidt's set, twice for its rounding; what depends on those before becomes zero. */
static void make_orthonormal(hk_viscous_coarse *s, size_t p) {
  for (size_t m = 0; m < MODES; m++) {
    double first = 0, last = 0;
    for (size_t k = s->start[p]; k < s->start[p + 1]; k++) {
      double *row = s->mode + MODES * s->member[k];
      first += row[m] * row[m];
    }
    for (size_t pass = 0; pass < 2; pass++)
      for (size_t n = 0; n < m; n++) {
        double dot = 0;
        for (size_t k = s->start[p]; k < s->start[p + 1]; k++) {
          const double *row = s->mode + MODES * s->member[k];
          dot += row[m] * row[n];
        }
        for (size_t k = s->start[p]; k < s->start[p + 1]; k++) {
          double *row = s->mode + MODES * s->member[k];
          row[m] -= dot * row[n];
        }
      }
    for (size_t k = s->start[p]; k < s->start[p + 1]; k++) {
      double *row = s->mode + MODES * s->member[k];
      last += row[m] * row[m];
    }
    double scale = last > least_independent * first ? 1 / sqrt(last) : 0;
    for (size_t k = s->start[p]; k < s->start[p + 1]; k++) s->mode[MODES * s->member[k] + m] *= scale;
  }
}

typedef struct task {
  hk_viscous_coarse *s;
  const hk_viscous_faces *f;
  const hk_matrix *A;
  const double *r;
  double *z;
  double shift; /* of the diagonal, relative to it */
} task;

static void find_modes(void *context, size_t begin, size_t end, size_t chunk) {
  const task *t = context;
  hk_viscous_coarse *s = t->s;
  (void)chunk;
  for (size_t p = begin; p < end; p++) {
    double centre[3] = {0}, x[3];
    for (size_t k = s->start[p]; k < s->start[p + 1]; k++) {
      uint32_t r = s->member[k];
      hk_liquid_face_place(t->f->grid, t->f->face[r], t->f->axis[r], x);
      for (int c = 0; c < 3; c++) centre[c] += x[c] / (double)(s->start[p + 1] - s->start[p]);
    }
    for (size_t k = s->start[p]; k < s->start[p + 1]; k++) {
      uint32_t r = s->member[k];
      hk_liquid_face_place(t->f->grid, t->f->face[r], t->f->axis[r], x);
      for (int c = 0; c < 3; c++) x[c] -= centre[c];
      motions_at(t->f->grid, x, t->f->axis[r], s->mode + MODES * r);
    }
    make_orthonormal(s, p);
  }
}

/* ---- the coarse matrix ---- */

/* The pieces beside piece p, rising, p among them. mark: pieces, p + 1 where one was met. */
static size_t beside(const hk_viscous_coarse *s, const hk_matrix *A, size_t p, uint32_t *mark, uint32_t *list) {
  size_t count = 0;
  for (size_t k = s->start[p]; k < s->start[p + 1]; k++) {
    uint32_t r = s->member[k];
    for (size_t e = A->row_start[r]; e < A->row_start[r + 1]; e++) {
      if (A->column[e] >= s->faces) continue;
      uint32_t q = s->piece[A->column[e]];
      if (mark[q] == p + 1) continue;
      mark[q] = (uint32_t)p + 1;
      size_t to = count++;
      for (; list && to > 0 && list[to - 1] > q; to--) list[to] = list[to - 1];
      if (list) list[to] = q;
    }
  }
  return count;
}

/* Raises the diagonal of piece p by a part of what the diagonal of A says of its motions; of one that is none it is 1.
 */
static void add_shift(const task *t, size_t p, double shift) {
  const hk_viscous_coarse *s = t->s;
  const size_t *row = s->matrix.row_start + 2 * p;
  const uint32_t *column = s->matrix.column + row[0];
  double scale[MODES] = {0};
  size_t at = 0;
  while (column[at] != 2 * p) at += 2;
  for (size_t k = s->start[p]; k < s->start[p + 1]; k++) {
    uint32_t r = s->member[k];
    size_t e = hk_upper_first(t->A, r);
    for (size_t m = 0; m < MODES; m++) scale[m] += s->mode[MODES * r + m] * s->mode[MODES * r + m] * t->A->value[e];
  }
  for (size_t m = 0; m < MODES; m++)
    s->matrix.value[9 * (row[m / 3] + at + m / 3) + 4 * (m % 3)] += scale[m] > 0 ? shift * scale[m] : 1;
}

/* Adds what the face r of piece p says: its row of A between the motions of both pieces. */
static void add_face(const task *t, size_t p, uint32_t r) {
  const hk_viscous_coarse *s = t->s;
  const hk_matrix *A = t->A;
  const size_t *row = s->matrix.row_start + 2 * p, width = row[1] - row[0];
  const uint32_t *column = s->matrix.column + row[0];
  const double *own = s->mode + MODES * r;
  for (size_t e = A->row_start[r]; e < A->row_start[r + 1]; e++) {
    uint32_t c = A->column[e];
    if (c >= s->faces) continue;
    const double *other = s->mode + MODES * c;
    size_t at = 0;
    while (column[at] != 2 * s->piece[c]) at += 2;
    for (size_t i = 0; i < MODES; i++) {
      double *to = s->matrix.value + 9 * (row[0] + (i / 3) * width + at) + 3 * (i % 3), by = own[i] * A->value[e];
      for (size_t j = 0; j < MODES && by != 0; j++) to[9 * (j / 3) + j % 3] += by * other[j];
    }
  }
}

static void fill_pieces(void *context, size_t begin, size_t end, size_t chunk) {
  const task *t = context;
  (void)chunk;
  for (size_t p = begin; p < end; p++) {
    for (size_t k = t->s->start[p]; k < t->s->start[p + 1]; k++) add_face(t, p, t->s->member[k]);
    add_shift(t, p, t->shift);
  }
}

/* Where the rows of the pieces begin. False: there is no memory. */
static bool lay_rows(hk_viscous_coarse *s, const hk_matrix *A, uint32_t *mark) {
  const hk_host *host = s->host;
  size_t *start = host->allocate(host, (2 * s->pieces + 1) * sizeof *start);
  s->matrix = (hk_matrix){.rows = 2 * s->pieces, .block = 3, .row_start = start, .symmetric = true};
  if (!start) return false;
  memset(mark, 0, s->pieces * sizeof *mark);
  start[0] = 0;
  for (size_t p = 0; p < s->pieces; p++) {
    size_t width = 2 * beside(s, A, p, mark, NULL);
    start[2 * p + 1] = start[2 * p] + width;
    start[2 * p + 2] = start[2 * p + 1] + width;
  }
  s->column = host->allocate(host, start[2 * s->pieces] * sizeof *s->column);
  s->matrix.value = host->allocate(host, 9 * start[2 * s->pieces] * sizeof *s->matrix.value);
  s->matrix.column = s->column;
  return s->column && s->matrix.value;
}

static hk_status lay_matrix(hk_viscous_coarse *s, const hk_matrix *A) {
  const hk_host *host = s->host;
  uint32_t *mark = host->allocate(host, (2 * s->pieces + 1) * sizeof *mark);
  bool room = mark && lay_rows(s, A, mark);
  if (room) memset(mark, 0, s->pieces * sizeof *mark);
  for (size_t p = 0; room && p < s->pieces; p++) {
    size_t count = beside(s, A, p, mark, mark + s->pieces);
    const uint32_t *list = mark + s->pieces;
    for (size_t row = 2 * p; row < 2 * p + 2; row++)
      for (size_t k = 0; k < 2 * count; k++)
        s->column[s->matrix.row_start[row] + k] = 2 * list[k / 2] + (uint32_t)(k % 2);
  }
  host->release(host, mark);
  return room ? HK_OK : no_memory(s);
}

static void forget(hk_viscous_coarse *s) {
  void *all[] = {s->piece,  s->start,       s->member, s->mode, s->b, s->x, s->part, (void *)s->matrix.row_start,
                 s->column, s->matrix.value};
  for (size_t k = 0; k < sizeof all / sizeof *all; k++) s->host->release(s->host, all[k]);
  s->piece = s->member = s->column = NULL;
  s->start = NULL;
  s->mode = s->b = s->x = s->part = NULL;
  s->matrix = (hk_matrix){0};
}

hk_status hk_viscous_coarse_build(hk_viscous_coarse *s, const hk_host *host, const hk_viscous_faces *f,
                                  const hk_matrix *A) {
  if (!s->host && hk_supernodal_open(&s->factors, host, false) != HK_OK) return HK_NO_MEMORY;
  s->host = host;
  forget(s);
  s->faces = f->count;
  s->piece = host->allocate(host, (s->faces + 1) * sizeof *s->piece);
  s->member = host->allocate(host, (s->faces + 1) * sizeof *s->member);
  s->mode = host->allocate(host, MODES * (s->faces + 1) * sizeof *s->mode);
  hk_status status = s->piece && s->member && s->mode ? find_pieces(s, f) : no_memory(s);
  if (status != HK_OK) return status;
  s->start = host->allocate(host, (s->pieces + 1) * sizeof *s->start);
  s->b = host->allocate(host, MODES * (s->pieces + 1) * sizeof *s->b);
  s->x = host->allocate(host, MODES * (s->pieces + 1) * sizeof *s->x);
  s->part = host->allocate(host, (s->pieces + 1) * sizeof *s->part);
  if (!s->start || !s->b || !s->x || !s->part) return no_memory(s);
  list_members(s);
  task t = {.s = s, .f = f, .A = A, .shift = first_shift};
  host->parallel_for(host, s->pieces, GRAIN, find_modes, &t);
  status = lay_matrix(s, A);
  if (status != HK_OK) return status;
  status = hk_supernodal_analyze(&s->factors, &s->matrix, HK_ORDER_AMD);
  if (status != HK_OK) return status;
  do {
    memset(s->matrix.value, 0, 9 * s->matrix.row_start[2 * s->pieces] * sizeof(double));
    host->parallel_for(host, s->pieces, GRAIN, fill_pieces, &t);
    status = hk_supernodal_factorize(&s->factors, &s->matrix);
    t.shift *= 100;
  } while (status == HK_NOT_CONVERGED && t.shift <= last_shift);
  if (status == HK_NOT_CONVERGED)
    return host->fail(host, status, "the viscosity's equations of %zu faces are not finite: take shorter steps",
                      s->faces);
  return status;
}

/* ---- its use ---- */

static void restrict_to(void *context, size_t begin, size_t end, size_t chunk) {
  const task *t = context;
  const hk_viscous_coarse *s = t->s;
  (void)chunk;
  for (size_t p = begin; p < end; p++) {
    double sum[MODES] = {0};
    for (size_t k = s->start[p]; k < s->start[p + 1]; k++) {
      uint32_t r = s->member[k];
      for (size_t m = 0; m < MODES; m++) sum[m] += s->mode[MODES * r + m] * t->r[r];
    }
    memcpy(s->b + MODES * p, sum, sizeof sum);
  }
}

static void prolong(void *context, size_t begin, size_t end, size_t chunk) {
  const task *t = context;
  const hk_viscous_coarse *s = t->s;
  (void)chunk;
  for (size_t p = begin; p < end; p++) {
    const double *x = s->x + MODES * p, *b = s->b + MODES * p;
    double dot = 0;
    for (size_t m = 0; m < MODES; m++) dot += x[m] * b[m];
    s->part[p] = dot;
    for (size_t k = s->start[p]; k < s->start[p + 1]; k++) {
      uint32_t r = s->member[k];
      for (size_t m = 0; m < MODES; m++) t->z[r] += s->mode[MODES * r + m] * x[m];
    }
  }
}

double hk_viscous_coarse_add(hk_viscous_coarse *s, const double *r, double *z) {
  task t = {.s = s, .r = r, .z = z};
  double sum = 0;
  s->host->parallel_for(s->host, s->pieces, GRAIN, restrict_to, &t);
  hk_supernodal_solve(&s->factors, s->b, s->x);
  s->host->parallel_for(s->host, s->pieces, GRAIN, prolong, &t);
  for (size_t p = 0; p < s->pieces; p++) sum += s->part[p];
  return sum;
}

void hk_viscous_coarse_close(hk_viscous_coarse *s) {
  if (!s->host) return;
  forget(s);
  hk_supernodal_close(&s->factors);
  *s = (hk_viscous_coarse){0};
}
