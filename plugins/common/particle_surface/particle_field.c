/* The grid around particles, and which of them reach which blocks: counted, then listed, in the order of the particles.
 */
#include "plugins/common/particle_surface/particle_field.h"

enum { SIDE = 8 };

static const double most_cells = 1e8, wider = 1 + 1e-9; /* of an axis; of a reach, so that rounding leaves none out */

/* How far blocks list a particle: beside walls as far as its value two radii off them is used. */
static double reach_of(const hk_particle_field *f, size_t i) {
  double reach = f->kernel ? f->kernel[i].reach : f->o.reach;
  return f->o.walls ? fmax(reach, 5 * f->o.radius) : reach;
}

static hk_status choose_grid(hk_particle_field *f) {
  double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY}, h = f->o.cell, reach = 0;
  for (size_t i = 0; i < f->n; i++) {
    reach = fmax(reach, reach_of(f, i));
    for (int c = 0; c < 3; c++) {
      if (!(fabs(f->x[i][c]) <= 1e100))
        return f->host->fail(f->host, HK_NOT_FINITE, "surface of particles: particle %zu is at (%g, %g, %g) m", i + 1,
                             f->x[i][0], f->x[i][1], f->x[i][2]);
      low[c] = fmin(low[c], f->x[i][c]), high[c] = fmax(high[c], f->x[i][c]);
    }
  }
  for (int c = 0; c < 3; c++) {
    double first = floor((low[c] - reach) / h) - 1, last = ceil((high[c] + reach) / h) + 1;
    if (!(last - first < most_cells) || !(fabs(first) < 1e15))
      return f->host->fail(f->host, HK_BAD_PARAM,
                           "surface of particles: particles from %g m to %g m along %c in cells of %g m are too many "
                           "cells: take larger ones, or leave out what has flown away",
                           low[c], high[c], 'x' + c, h);
    f->grid.points[c] = (size_t)(last - first) + 1;
    f->grid.origin[c] = first * h;
    f->grid.spacing[c] = h;
    f->blocks[c] = (f->grid.points[c] + SIDE) / SIDE;
  }
  return HK_OK;
}

size_t hk_particle_field_block(const hk_particle_field *f, const double x[3]) {
  size_t at[3];
  for (int c = 0; c < 3; c++) {
    double b = floor(((x[c] - f->grid.origin[c]) / f->o.cell + 1) / SIDE);
    at[c] = b > 0 ? (size_t)b : 0;
    if (at[c] >= f->blocks[c]) at[c] = f->blocks[c] - 1;
  }
  return (at[2] * f->blocks[1] + at[1]) * f->blocks[0] + at[0];
}

/* The squared distance, in cells, of place u from block b of an axis. */
static double gap(double u, long b) {
  double low = (double)(SIDE * b), gap = u < low ? low - u : u > low + SIDE ? u - low - SIDE : 0;
  return gap * gap;
}

/* Counts particle i in its blocks, or, with a list, puts it there. */
static void visit(hk_particle_field *f, uint32_t i, size_t *next) {
  double reach = reach_of(f, i) / f->o.cell * wider, u[3];
  long first[3], last[3], b[3];
  for (int c = 0; c < 3; c++) {
    u[c] = (f->x[i][c] - f->grid.origin[c]) / f->o.cell + 1;
    first[c] = (long)fmax(0, ceil((u[c] - reach - SIDE) / SIDE));
    last[c] = (long)fmin((double)f->blocks[c] - 1, floor((u[c] + reach) / SIDE));
  }
  for (b[2] = first[2]; b[2] <= last[2]; b[2]++)
    for (b[1] = first[1]; b[1] <= last[1]; b[1]++) {
      double left = reach * reach - gap(u[2], b[2]) - gap(u[1], b[1]);
      size_t row = ((size_t)b[2] * f->blocks[1] + (size_t)b[1]) * f->blocks[0];
      for (b[0] = first[0]; b[0] <= last[0] && left >= 0; b[0]++) {
        if (gap(u[0], b[0]) > left) continue;
        size_t place = next[row + (size_t)b[0]]++;
        if (f->list) f->list[place] = i;
      }
    }
}

/* NULL beyond the limit, or what an address can hold. */
static hk_status allocate(const hk_particle_field *f, double count, size_t size, void **memory) {
  double most = f->o.most_bytes ? (double)f->o.most_bytes : 1e12;
  *memory = count * (double)size <= most ? f->host->allocate(f->host, (size_t)count * size) : NULL;
  if (*memory) return HK_OK;
  return f->host->fail(f->host, HK_NO_MEMORY,
                       "surface of particles: no memory for the particles of %zu x %zu x %zu blocks (%.3g MB): take "
                       "larger cells, or leave out what has flown away",
                       f->blocks[0], f->blocks[1], f->blocks[2], 1e-6 * count * (double)size);
}

/* start[b + 1] counts, then is where block b begins, then, when all are listed, where it ends. */
static hk_status list_particles(hk_particle_field *f) {
  double all = (double)f->blocks[0] * (double)f->blocks[1] * (double)f->blocks[2];
  size_t blocks = f->blocks[0] * f->blocks[1] * f->blocks[2], sum = 0;
  void *memory;
  hk_status status = allocate(f, all + 2, sizeof *f->start, &memory);
  if (status != HK_OK) return status;
  f->start = memory;
  for (size_t i = 0; i < f->n; i++) visit(f, (uint32_t)i, f->start + 1);
  for (size_t b = 0; b < blocks; b++) {
    size_t count = f->start[b + 1];
    f->start[b + 1] = sum;
    sum += count;
  }
  status = allocate(f, (double)sum + 1, sizeof *f->list, &memory);
  if (status != HK_OK) return status;
  f->list = memory;
  for (size_t i = 0; i < f->n; i++) visit(f, (uint32_t)i, f->start + 1);
  return HK_OK;
}

hk_status hk_particle_field_open(hk_particle_field *f) {
  hk_status status = hk_particle_options_complete(&f->o, f->host);
  if (status == HK_OK && f->n == 0)
    status = f->host->fail(f->host, HK_BAD_PARAM, "surface of particles: there are none");
  if (status == HK_OK) status = choose_grid(f);
  return status == HK_OK ? list_particles(f) : status;
}

void hk_particle_field_close(hk_particle_field *f) {
  f->host->release(f->host, f->start);
  f->host->release(f->host, f->list);
}
