/* Where the liquid is: filled parts of cells, and the free surface between them. */
#include "plugins/common/liquid/liquid.h"

static const double nearest = 0.01;    /* of the way between two centres: the surface is no nearer to one of them */
static const double hardly_open = 0.2; /* of a face: below, the surface is the farther away the less is open */

/* Beside a flat surface at the distance s (in cells, negative in the liquid) the kernel 1 - |s| about a centre covers
 * the part 1/2 - s + s |s|/2 of liquid; this is the inverse. */
static double depth_of(double part) {
  if (part >= 1) return -1;
  if (part <= 0) return 1;
  return part > 0.5 ? sqrt(2 * (1 - part)) - 1 : 1 - sqrt(2 * part);
}

static void distance_rows(void *context, size_t begin, size_t end, size_t piece) {
  hk_liquid_grid *g = &((hk_liquid *)context)->grid;
  (void)piece;
  for (size_t k = begin; k < end; k++) {
    size_t first = hk_liquid_row_at(g, k, 0).first;
    for (size_t i = first; i < first + g->cells[hk_liquid_inner(g)]; i++) {
      if (g->room[i] < 1) g->filled[i] /= fabs(g->room[i]);
      if (g->room[i] < 0) continue;
      g->distance[i] = depth_of(g->filled[i]);
    }
  }
}

/* Whether cloth passes through the cell. */
static bool is_cut(const hk_liquid *l, size_t i) { return hk_thin_walls_beside(&l->thin, &l->grid, i, 0.5); }

/* Of a cell that cloth cuts a kernel covers both sides: its distance is that of the cells on its own side. */
static void extend_beside_cloth(hk_liquid *l, size_t i) {
  hk_liquid_grid *g = &l->grid;
  double sum = 0, count = 0;
  for (int f = 0; f < 6; f++) {
    size_t s = g->stride[f / 2], face = f & 1 ? i + s : i, beside = f & 1 ? i + s : i - s;
    if (!(g->open[f / 2][face] > 0) || !(g->room[beside] > 0) || is_cut(l, beside)) continue;
    sum += g->distance[beside];
    count++;
  }
  if (count > 0) g->distance[i] = sum / count;
}

/* Few particles are in a cell whose centre is in a wall, and say little: its distance is that of the cells beside it,
 * so that no wall is taken for air, and its density is right. */
static void extend_rows(void *context, size_t begin, size_t end, size_t piece) {
  hk_liquid *l = context;
  hk_liquid_grid *g = &l->grid;
  (void)piece;
  for (size_t k = begin; k < end; k++) {
    size_t first = hk_liquid_row_at(g, k, 0).first;
    for (size_t i = first; i < first + g->cells[hk_liquid_inner(g)]; i++) {
      double sum = 0, count = 0;
      if (!(g->room[i] < 0)) {
        if (l->thin.crossings && is_cut(l, i)) extend_beside_cloth(l, i);
        continue;
      }
      for (int c = 0; c < 3; c++) {
        size_t s = g->stride[c];
        if (g->room[i - s] > 0) sum += g->distance[i - s], count++;
        if (g->room[i + s] > 0) sum += g->distance[i + s], count++;
      }
      g->distance[i] = count > 0 ? sum / count : -1;
    }
  }
}

/* Whether a face of the cell is open. */
static bool is_open(const hk_liquid_grid *g, size_t i) {
  double sum = 0;
  for (int c = 0; c < 3; c++) sum += g->open[c][i] + g->open[c][i + g->stride[c]];
  return sum > 0;
}

void hk_liquid_number_cells(hk_liquid *l) {
  hk_liquid_grid *g = &l->grid;
  size_t length = g->cells[hk_liquid_inner(g)], rows = hk_liquid_rows(g, 0);
  uint32_t count = 0;
  for (size_t k = 0; k < rows; k++) {
    size_t first = hk_liquid_row_at(g, k, 0).first;
    for (size_t i = first; i < first + length; i++) {
      g->unknown[i] = HK_LIQUID_NONE;
      if (!(g->distance[i] < 0) || !is_open(g, i)) continue;
      g->unknown[i] = count;
      l->pressure.cell[count++] = (uint32_t)i;
    }
  }
  l->pressure.rows = count;
}

bool hk_liquid_is_within(const hk_liquid *l, size_t i) {
  const hk_liquid_grid *g = &l->grid;
  if (g->unknown[i] == HK_LIQUID_NONE || !(g->room[i] > 0) || hk_thin_walls_beside(&l->thin, g, i, 1)) return false;
  for (int c = 0; c < 3; c++) {
    size_t s = g->stride[c];
    if (g->open[c][i] > 0 && g->unknown[i - s] == HK_LIQUID_NONE) return false;
    if (g->open[c][i + s] > 0 && g->unknown[i + s] == HK_LIQUID_NONE) return false;
  }
  return true;
}

static void measure_density(hk_liquid *l) {
  const hk_liquid_grid *g = &l->grid;
  double sum = 0;
  l->inside = 0;
  for (size_t k = 0; k < l->pressure.rows; k++) {
    size_t i = l->pressure.cell[k];
    if (!hk_liquid_is_within(l, i)) continue;
    l->inside++;
    sum += g->filled[i];
  }
  l->mean = l->inside ? sum / (double)l->inside : NAN;
}

void hk_liquid_find_surface(hk_liquid *l) {
  l->host->parallel_for(l->host, hk_liquid_rows(&l->grid, 0), 16, distance_rows, l);
  l->host->parallel_for(l->host, hk_liquid_rows(&l->grid, 0), 16, extend_rows, l);
  hk_liquid_number_cells(l);
  measure_density(l);
}

double hk_liquid_part_to_surface(const hk_liquid_grid *g, int c, size_t i, size_t in) {
  double a = g->distance[in], b = g->distance[in == i ? i - g->stride[c] : i];
  return fmax(fmax(nearest, 1 - g->open[c][i] / hardly_open), fmin(1, b > 0 ? a / (a - b) : 1));
}

double hk_liquid_slope(const hk_liquid *l, int c, size_t i) {
  const hk_liquid_grid *g = &l->grid;
  size_t below = i - g->stride[c];
  uint32_t a = g->unknown[below], b = g->unknown[i];
  if (a != HK_LIQUID_NONE && b != HK_LIQUID_NONE) return (l->pressure.x[b] - l->pressure.x[a]) / g->spacing[c];
  if (b != HK_LIQUID_NONE) return l->pressure.x[b] / (hk_liquid_part_to_surface(g, c, i, i) * g->spacing[c]);
  if (a != HK_LIQUID_NONE) return -l->pressure.x[a] / (hk_liquid_part_to_surface(g, c, i, below) * g->spacing[c]);
  return 0;
}

/* ---- what is thin ---- */

static const double hardly_out = 0.25; /* cells: so far beyond the surface still counts */

enum { THICK = 3, PAD = THICK - 1 }; /* cells */

typedef struct blocks {
  size_t cells[3], stride[3], size; /* with PAD cells of wall on either side of what has depth */
  int pad[3];
  uint8_t *mark;
} blocks;

static size_t lay_blocks(const hk_liquid_grid *g, blocks *b) {
  b->size = 1;
  for (int c = 0; c < 3; c++) {
    b->pad[c] = g->flat[c] ? 0 : PAD;
    b->cells[c] = g->cells[c] + 2 * (size_t)b->pad[c];
    b->stride[c] = b->size;
    b->size *= b->cells[c];
  }
  return b->size;
}

/* Cell k of the blocks as one of the grid; SIZE_MAX: it is outside the box. */
static size_t cell_of(const hk_liquid_grid *g, const blocks *b, size_t k) {
  size_t i = 0;
  for (int c = 0; c < 3; c++) {
    size_t at = k / b->stride[c] % b->cells[c], pad = (size_t)b->pad[c];
    if (at < pad || at >= g->cells[c] + pad) return SIZE_MAX;
    i += (at - pad + 1) * g->stride[c];
  }
  return i;
}

/* Along each axis: a cell is marked where it and the next THICK - 1 are, or, `back`, where it or one of those before it
 * is. */
static void sweep(const blocks *b, bool back) {
  for (int c = 0; c < 3; c++) {
    if (b->pad[c] == 0) continue;
    for (size_t n = 0; n < b->size; n++) {
      size_t k = back ? b->size - 1 - n : n, at = k / b->stride[c] % b->cells[c];
      for (size_t e = 1; e < THICK; e++) {
        if (back && at >= e) b->mark[k] |= b->mark[k - e * b->stride[c]];
        if (!back) b->mark[k] &= at + e < b->cells[c] ? b->mark[k + e * b->stride[c]] : 0;
      }
    }
  }
}

double hk_liquid_thin_part(const hk_liquid *l) {
  const hk_liquid_grid *g = &l->grid;
  blocks b;
  b.mark = l->host->allocate(l->host, lay_blocks(g, &b));
  if (!b.mark) return NAN;
  for (size_t k = 0; k < b.size; k++) {
    size_t i = cell_of(g, &b, k);
    b.mark[k] = i == SIZE_MAX || g->distance[i] < hardly_out || g->room[i] < 0;
  }
  sweep(&b, false);
  sweep(&b, true);
  double thin = 0, all = 0;
  for (size_t k = 0; k < b.size; k++) {
    size_t i = cell_of(g, &b, k);
    if (i == SIZE_MAX || g->unknown[i] == HK_LIQUID_NONE) continue;
    all++;
    thin += !b.mark[k];
  }
  l->host->release(l->host, b.mark);
  return all > 0 ? thin / all : 0;
}
