/* A cell that a wall cuts, as what is open of its parts: PARTS along each axis, whose kernels are linear in them. */
#include "plugins/common/mac_grid/cut_cells.h"

#include <string.h>

enum { PARTS = 4 /* of a cell along each axis, that a wall leaves open or not */ };

typedef struct cut_cell {
  size_t i;
  double mean; /* the part of it that has been counted as open */
  double bend; /* m: by how much its centre is farther from the solid than its corners say */
  double axes; /* that it has a depth along */
  double size; /* m, of its parts */
} cut_cell;

double hk_cut_cell_distance(const hk_liquid_grid *g, size_t i) {
  double mean = 0;
  for (size_t b = 0; b < 8; b++)
    mean += g->solid[i + (b & 1) * g->stride[0] + (b >> 1 & 1) * g->stride[1] + (b >> 2) * g->stride[2]] / 8;
  return mean;
}

/* The integrals of the kernels of the cell before, of its own and of the cell behind over the parts of a cell along
 * axis c; where it is the first or the last one the box ends with it, and its own kernel is 1 as far as that. Kernels
 * are linear in a part, so the value in its middle is exact. */
static size_t kernel_parts(const hk_liquid_grid *g, int c, size_t at, double w[3][PARTS]) {
  size_t parts = g->flat[c] ? 1 : PARTS;
  for (size_t q = 0; q < parts; q++) {
    double middle = ((double)q + 0.5) / (double)parts - 0.5, before = fmax(0, -middle), behind = fmax(0, middle);
    bool none = g->flat[c] || (middle < 0 ? at == 1 : at == g->cells[c]);
    w[0][q] = none ? 0 : before / (double)parts;
    w[1][q] = none ? 1 / (double)parts : (1 - before - behind) / (double)parts;
    w[2][q] = none ? 0 : behind / (double)parts;
  }
  return parts;
}

/* By how much a part of it is more open than `mean`; f: where its middle is, along the axes. */
static double part_beyond(const hk_liquid_grid *g, const cut_cell *cut, const double f[3]) {
  double d = 0;
  for (size_t b = 0; b < 8; b++) {
    double weight = 1;
    size_t corner = cut->i;
    for (int c = 0; c < 3; c++) {
      bool far = b >> c & 1;
      weight *= far ? f[c] : 1 - f[c];
      corner += far ? g->stride[c] : 0;
    }
    d += weight * g->solid[corner];
  }
  for (int c = 0; c < 3; c++)
    if (!g->flat[c]) d += 4 / cut->axes * cut->bend * f[c] * (1 - f[c]);
  return fmin(1, fmax(0, 0.5 + d / cut->size)) - cut->mean;
}

void hk_cut_cell_add(hk_liquid_grid *g, const hk_liquid_row *row, size_t i, double mean, double centre) {
  cut_cell cut = {.i = i, .mean = mean, .bend = centre - hk_cut_cell_distance(g, i)};
  double w[3][3][PARTS], *room = g->room;
  size_t n[3];
  for (int c = 0; c < 3; c++) {
    cut.size += g->spacing[c] / (3 * PARTS);
    cut.axes += !g->flat[c];
    n[c] = kernel_parts(g, c, row->cell[c] + (c == hk_liquid_inner(g) ? i - row->first : 0), w[c]);
  }
  double line[3], plane[3][3], sum[3][3][3] = {0};
  for (size_t z = 0; z < n[2]; z++) {
    memset(plane, 0, sizeof plane);
    for (size_t y = 0; y < n[1]; y++) {
      memset(line, 0, sizeof line);
      for (size_t x = 0; x < n[0]; x++) {
        const double f[3] = {((double)x + 0.5) / (double)n[0], ((double)y + 0.5) / (double)n[1],
                             ((double)z + 0.5) / (double)n[2]};
        double beyond = part_beyond(g, &cut, f);
        for (int a = 0; a < 3; a++) line[a] += w[0][a][x] * beyond;
      }
      for (int k = 0; k < 9; k++) plane[k / 3][k % 3] += w[1][k / 3][y] * line[k % 3];
    }
    for (int k = 0; k < 27; k++) sum[k / 9][k / 3 % 3][k % 3] += w[2][k / 9][z] * plane[k / 3 % 3][k % 3];
  }
  for (size_t k = 0; k < 27; k++)
    room[i + k % 3 * g->stride[0] + k / 3 % 3 * g->stride[1] + k / 9 * g->stride[2] - g->stride[0] - g->stride[1] -
         g->stride[2]] += sum[k / 9][k / 3 % 3][k % 3];
}
