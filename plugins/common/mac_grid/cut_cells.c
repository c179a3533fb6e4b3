/* A cell that a wall cuts, as what is open of its parts: PARTS along each axis, whose kernels are linear in them. */
#include "plugins/common/mac_grid/cut_cells.h"

enum { PARTS = 4 /* of a cell along each axis, that a wall leaves open or not */ };

typedef struct cut_cell {
  double mean; /* the part of it that has been counted as open */
  double bend; /* m: by how much its centre is farther from the solid than its corners say */
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

static double between(double a, double b, double part) { return a + part * (b - a); }

/* By how much the parts of a row along x are more open than `mean`, as the kernels weigh them; d: m, distances at both
 * ends of the row; bent: m, what they are curved across it. */
static void add_row(const cut_cell *cut, size_t parts, double w[3][PARTS], const double d[2], double bent,
                    double sum[3]) {
  for (size_t x = 0; x < parts; x++) {
    double part = ((double)x + 0.5) / (double)parts, bend = parts > 1 ? cut->bend * part * (1 - part) : 0;
    double beyond = fmin(1, fmax(0, 0.5 + (between(d[0], d[1], part) + bent + bend) / cut->size)) - cut->mean;
    for (int a = 0; a < 3; a++) sum[a] += w[a][x] * beyond;
  }
}

void hk_cut_cell_add(hk_liquid_grid *g, const hk_liquid_row *row, size_t i, double mean, double centre) {
  cut_cell cut = {mean, centre - hk_cut_cell_distance(g, i), 0};
  double w[3][3][PARTS], axes = 0, sum[3][3][3] = {0}, *room = g->room;
  const double *d = g->solid + i;
  const size_t *s = g->stride;
  size_t n[3];
  for (int c = 0; c < 3; c++) {
    cut.size += g->spacing[c] / (3 * PARTS);
    axes += !g->flat[c];
    n[c] = kernel_parts(g, c, row->cell[c] + (c == hk_liquid_inner(g) ? i - row->first : 0), w[c]);
  }
  cut.bend *= 4 / axes; /* of f (1 - f) along each axis, whose sum is axes/4 in the centre */
  for (size_t z = 0; z < n[2]; z++) {
    double up = ((double)z + 0.5) / (double)n[2], bent = n[2] > 1 ? cut.bend * up * (1 - up) : 0, plane[3][3] = {0};
    double low[2] = {between(d[0], d[s[2]], up), between(d[s[0]], d[s[0] + s[2]], up)};
    double high[2] = {between(d[s[1]], d[s[1] + s[2]], up), between(d[s[0] + s[1]], d[s[0] + s[1] + s[2]], up)};
    for (size_t y = 0; y < n[1]; y++) {
      double part = ((double)y + 0.5) / (double)n[1], bend = n[1] > 1 ? cut.bend * part * (1 - part) : 0, line[3] = {0};
      double ends[2] = {between(low[0], high[0], part), between(low[1], high[1], part)};
      add_row(&cut, n[0], w[0], ends, bent + bend, line);
      for (int k = 0; k < 9; k++) plane[k / 3][k % 3] += w[1][k / 3][y] * line[k % 3];
    }
    for (int k = 0; k < 27; k++) sum[k / 9][k / 3 % 3][k % 3] += w[2][k / 9][z] * plane[k / 3 % 3][k % 3];
  }
  for (size_t k = 0; k < 27; k++)
    room[i + k % 3 * s[0] + k / 3 % 3 * s[1] + k / 9 * s[2] - s[0] - s[1] - s[2]] += sum[k / 9][k / 3 % 3][k % 3];
}
