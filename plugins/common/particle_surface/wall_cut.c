#include "plugins/common/particle_surface/wall_cut.h"

enum { PUSHES = 4 }; /* out of a corner of three walls, and one more */

static const double steep = 10, band = 2, behind = 2; /* band: radii; behind: cells, beyond which no edge reaches */

double hk_wall_distance(const hk_particle_walls *w, const double x[3]) {
  double n[3];
  return w ? w->distance(w->self, x, n) : INFINITY;
}

/* The value of the field where it is two radii off the walls. */
static double value_off(const hk_particle_field *f, const double x[3]) {
  double p[1][3] = {{x[0], x[1], x[2]}}, n[3], value, far = band * f->o.radius;
  for (int k = 0; k < PUSHES; k++) {
    double s = f->o.walls->distance(f->o.walls->self, p[0], n);
    if (s >= far * (1 - 1e-9)) break;
    for (int c = 0; c < 3; c++) p[0][c] += (far - s) * n[c];
  }
  hk_particle_field_evaluate(f, (const double(*)[3])p, 1, &value);
  return value;
}

static double cut(const hk_particle_field *f, const double x[3], double value) {
  double scale = steep * (f->o.kind == HK_ZHU_BRIDSON ? 1 : f->o.radius), s = hk_wall_distance(f->o.walls, x);
  double full = scale * value;
  if (full < s && s < band * f->o.radius && s > -behind * f->o.cell) full = fmax(full, scale * value_off(f, x));
  return fmin(full, s);
}

void hk_walled_lattice(const void *self, const double x[9], const double y[9], const double z[9], double value[729]) {
  hk_particle_field_lattice(self, x, y, z, value);
  for (int k = 0; k < 729; k++) value[k] = cut(self, (const double[3]){x[k % 9], y[k / 9 % 9], z[k / 81]}, value[k]);
}

void hk_walled_evaluate(const void *self, const double (*x)[3], size_t count, double *value) {
  hk_particle_field_evaluate(self, x, count, value);
  for (size_t k = 0; k < count; k++) value[k] = cut(self, x[k], value[k]);
}
