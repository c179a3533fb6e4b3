/* See dense_front.h. Columns are worked on in blocks, right-looking: the square of a block, the rows below it, and at
 * once what the block takes from all columns behind it, so that every product has a depth of HK_FRONT_DEPTH at most and
 * its factors, in strips, stay in the caches (dense_loops.h). Every number is the sum of its products in their order,
 * whatever the blocks. Goto and van de Geijn, ACM TOMS 34 (2008). */
#include "plugins/common/supernodal/dense_front.h"

enum { UNIT = 48 }; /* of blocks: a multiple of vectors and of the widths of tiles */

static size_t in_units(size_t numbers, size_t unit) { return (numbers + unit - 1) / unit * unit; }

/* Columns of all blocks but the first, which has the rest. */
static size_t block_columns(size_t columns) {
  size_t blocks = (columns + HK_FRONT_DEPTH - 1) / HK_FRONT_DEPTH;
  return blocks < 2 ? columns : in_units((columns + blocks - 1) / blocks, UNIT);
}

static size_t deepest(size_t columns) { return columns < HK_FRONT_DEPTH ? columns : HK_FRONT_DEPTH; }

static size_t strip_numbers(size_t columns, size_t outer) {
  return in_units((in_units(columns + outer, HK_FRONT_VECTOR) + HK_FRONT_VECTOR) * deepest(columns), HK_FRONT_VECTOR);
}

static size_t square_numbers(size_t columns) { return in_units(HK_FRONT_DEPTH * deepest(columns), HK_FRONT_VECTOR); }

size_t hk_dense_front_work(size_t columns, size_t outer) {
  return square_numbers(columns) + 2 * strip_numbers(columns, outer);
}

typedef struct task {
  const hk_front_block *block;
  void (*work)(const hk_front_block *, size_t begin, size_t end);
} task;

static void do_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  const task *t = context;
  (void)chunk;
  t->work(t->block, begin, end);
}

static void each(const hk_dense_front *f, const hk_front_block *b, size_t count, size_t grain,
                 void (*work)(const hk_front_block *, size_t, size_t)) {
  task t = {b, work};
  if (f->on_all_threads)
    f->host->parallel_for(f->host, count, grain, do_chunk, &t);
  else
    for (size_t at = 0; at < count; at += grain) work(b, at, at + grain < count ? at + grain : count);
}

static void *at(const hk_dense_front *f, void *numbers, size_t position) {
  return (char *)numbers + position * f->path->number;
}

/* The block of columns [begin, end). */
static hk_front_block block_of(const hk_dense_front *f, size_t begin, size_t end) {
  size_t vector = HK_FRONT_VECTOR / f->path->number, square = square_numbers(f->columns);
  hk_front_block b = {.panel = at(f, f->panel, f->ld * begin),
                      .inverse = at(f, f->inverse, begin),
                      .ld = f->ld,
                      .top = f->top + begin,
                      .columns = end - begin,
                      .begin = f->top + end,
                      .inner = f->columns - end,
                      .outer = f->outer,
                      .update = f->update,
                      .ldu = f->ldu,
                      .first = begin == 0,
                      .square = f->work,
                      .A = at(f, f->work, square),
                      .B = at(f, f->work, square + strip_numbers(f->columns, f->outer))};
  b.rows = in_units(b.inner + b.outer, vector);
  return b;
}

size_t hk_dense_front_factorize(const hk_dense_front *f) {
  size_t step = block_columns(f->columns), end = f->columns;
  while (end > step) end -= step;
  for (size_t begin = 0; begin < f->columns; begin = end, end += step) {
    hk_front_block b = block_of(f, begin, end);
    size_t good = f->path->factorize(&b);
    if (good < b.columns) return begin + good;
    each(f, &b, b.rows, HK_FRONT_ROWS / 3, f->path->solve_rows);
    each(f, &b, b.inner + b.outer, HK_FRONT_ROWS, f->path->pack_columns);
    each(f, &b, b.rows, HK_FRONT_ROWS, f->path->update);
  }
  return f->columns;
}
