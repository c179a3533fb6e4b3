/* Sums over the particles of a block: rows of its points along x that a particle reaches, nine points and three more to
 * fill vectors. A particle adds exactly 0 to points beyond its reach, so that a point has the same bits in any block.
 */
#include "plugins/common/particle_surface/particle_field.h"

#include <string.h>

enum { SIDE = 9, ROW = 12, ROWS = SIDE * SIDE };

static const double wider = 1 + 1e-9; /* of a squared reach, so that rounding leaves none out */

typedef struct sums {
  double x[ROW], y[SIDE], z[SIDE];
  double w[ROWS][ROW], wx[ROWS][ROW], wy[ROWS][ROW], wz[ROWS][ROW]; /* of the density w alone */
} sums;

/* ---- Zhu and Bridson ---- */

HK_INLINE void add_row(sums *s, int row, const double p[3], double dy, double dz, double part, double scale) {
  double *w = s->w[row], *wx = s->wx[row], *wy = s->wy[row], *wz = s->wz[row];
  for (int i = 0; i < ROW; i++) {
    double dx = s->x[i] - p[0], q = part - dx * dx * scale;
    q = q > 0 ? q : 0;
    double k = q * q * q;
    w[i] += k, wx[i] += k * dx, wy[i] += k * dy, wz[i] += k * dz;
  }
}

HK_INLINE void add_each(sums *s, const hk_particle_field *f, const uint32_t *list, size_t count) {
  double scale = 1 / (f->o.reach * f->o.reach);
  for (size_t n = 0; n < count; n++) {
    const double *p = f->x[list[n]];
    for (int k = 0; k < SIDE; k++) {
      double dz = s->z[k] - p[2], rest = 1 - dz * dz * scale;
      if (rest <= 0) continue;
      for (int j = 0; j < SIDE; j++) {
        double dy = s->y[j] - p[1], part = rest - dy * dy * scale;
        if (part > 0) add_row(s, k * SIDE + j, p, dy, dz, part, scale);
      }
    }
  }
}

/* Where no particle is within reach, the value is that at its edge. */
static double distance_value(const hk_particle_field *f, double w, const double sum[3]) {
  if (!(w > 0)) return f->o.radius - f->o.reach;
  return f->o.radius - sqrt(sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]) / w;
}

/* ---- density ---- */

/* The cubic spline, times V: with q = d / (reach / 2), 1/(pi h^3) (1 - 3/2 q^2 + 3/4 q^3) for q < 1, (2 - q)^3 / 4 for
 * q < 2. */
HK_INLINE double spline(double q) {
  double far = q < 2 ? 2 - q : 0, near = q < 1 ? 1 - q : 0;
  return 0.25 * (far * far * far) - near * near * near;
}

static double spline_scale(const hk_particle_field *f) {
  double ratio = 2 * f->o.radius / (f->o.reach / 2);
  return ratio * ratio * ratio / 3.14159265358979323846;
}

HK_INLINE void add_density_row(sums *s, int row, const double p[3], double square, double scale, double most) {
  double *w = s->w[row];
  for (int i = 0; i < ROW; i++) {
    double dx = s->x[i] - p[0];
    w[i] += most * spline(sqrt(square + dx * dx) * scale);
  }
}

HK_INLINE void add_each_density(sums *s, const hk_particle_field *f, const uint32_t *list, size_t count) {
  double most = spline_scale(f), scale = 2 / f->o.reach, reach2 = f->o.reach * f->o.reach;
  for (size_t n = 0; n < count; n++) {
    const double *p = f->x[list[n]];
    for (int k = 0; k < SIDE; k++) {
      double dz = s->z[k] - p[2], square = dz * dz;
      if (square >= reach2) continue;
      for (int j = 0; j < SIDE; j++) {
        double dy = s->y[j] - p[1], both = square + dy * dy;
        if (both < reach2) add_density_row(s, k * SIDE + j, p, both, scale, most);
      }
    }
  }
}

/* ---- anisotropic kernels ---- */

/* Along a row the form is form[0] (dx + shift)^2 + rest. */
HK_INLINE void add_kernel_row(sums *s, int row, const double p[3], const hk_particle_kernel *k, double shift,
                              double rest) {
  double *w = s->w[row];
  for (int i = 0; i < ROW; i++) {
    double dx = s->x[i] - p[0] + shift;
    w[i] += k->amplitude * spline(sqrt(rest + k->form[0] * (dx * dx)));
  }
}

HK_INLINE void add_each_kernel(sums *s, const hk_particle_field *f, const uint32_t *list, size_t count) {
  for (size_t n = 0; n < count; n++) {
    const double *p = f->x[list[n]];
    const hk_particle_kernel *kernel = &f->kernel[list[n]];
    const double *a = kernel->form;
    for (int k = 0; k < SIDE; k++) {
      double dz = s->z[k] - p[2];
      for (int j = 0; j < SIDE; j++) {
        double dy = s->y[j] - p[1], shift = (a[5] * dy + a[4] * dz) / a[0];
        double rest = a[1] * dy * dy + a[2] * dz * dz + 2 * a[3] * dy * dz - a[0] * shift * shift;
        if (rest < 4) add_kernel_row(s, k * SIDE + j, p, kernel, shift, rest > 0 ? rest : 0);
      }
    }
  }
}

static double kernel_at(const hk_particle_kernel *k, const double d[3]) {
  const double *a = k->form;
  double square = a[0] * d[0] * d[0] + a[1] * d[1] * d[1] + a[2] * d[2] * d[2] +
                  2 * (a[3] * d[1] * d[2] + a[4] * d[0] * d[2] + a[5] * d[0] * d[1]);
  return k->amplitude * spline(sqrt(square > 0 ? square : 0));
}

HK_VERSIONS(static void, add_distances, (sums * s, const hk_particle_field *f, const uint32_t *list, size_t count),
            add_each(s, f, list, count))
HK_VERSIONS(static void, add_densities, (sums * s, const hk_particle_field *f, const uint32_t *list, size_t count),
            add_each_density(s, f, list, count))
HK_VERSIONS(static void, add_kernels, (sums * s, const hk_particle_field *f, const uint32_t *list, size_t count),
            add_each_kernel(s, f, list, count))

/* ---- a block, and places ---- */

static void open_sums(sums *s, const double x[SIDE], const double y[SIDE], const double z[SIDE], bool density) {
  for (int i = 0; i < ROW; i++) s->x[i] = x[i < SIDE ? i : SIDE - 1];
  memcpy(s->y, y, sizeof s->y);
  memcpy(s->z, z, sizeof s->z);
  memset(s->w, 0, density ? sizeof s->w : sizeof s->w + sizeof s->wx + sizeof s->wy + sizeof s->wz);
}

void hk_particle_field_lattice(const void *self, const double x[9], const double y[9], const double z[9],
                               double value[729]) {
  const hk_particle_field *f = self;
  bool density = f->o.kind != HK_ZHU_BRIDSON;
  size_t block = hk_particle_field_block(f, (const double[3]){x[SIDE / 2], y[SIDE / 2], z[SIDE / 2]});
  const uint32_t *list = f->list + f->start[block];
  size_t count = f->start[block + 1] - f->start[block];
  sums s;
  open_sums(&s, x, y, z, density);
  if (f->kernel)
    HK_WIDEST(f->host->lanes, add_kernels)(&s, f, list, count);
  else if (density)
    HK_WIDEST(f->host->lanes, add_densities)(&s, f, list, count);
  else
    HK_WIDEST(f->host->lanes, add_distances)(&s, f, list, count);
  for (int k = 0; k < ROWS * SIDE; k++) {
    int row = k / SIDE, i = k % SIDE;
    value[k] = density ? s.w[row][i] - f->o.threshold
                       : distance_value(f, s.w[row][i], (const double[3]){s.wx[row][i], s.wy[row][i], s.wz[row][i]});
  }
}

static double value_at(const hk_particle_field *f, const double x[3]) {
  size_t block = hk_particle_field_block(f, x);
  double w = 0, sum[3] = {0}, scale = 1 / (f->o.reach * f->o.reach), most = spline_scale(f);
  bool density = f->o.kind != HK_ZHU_BRIDSON;
  for (size_t n = f->start[block]; n < f->start[block + 1]; n++) {
    const double *p = f->x[f->list[n]];
    double d[3] = {x[0] - p[0], x[1] - p[1], x[2] - p[2]}, square = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
    double reach = f->kernel ? f->kernel[f->list[n]].reach : f->o.reach;
    if (square >= reach * reach * wider) continue; /* it adds 0 */
    double q = 1 - square * scale, k = q > 0 ? q * q * q : 0;
    if (f->kernel)
      k = kernel_at(&f->kernel[f->list[n]], d);
    else if (density)
      k = most * spline(sqrt(square) * 2 / f->o.reach);
    w += k;
    for (int c = 0; c < 3; c++) sum[c] += k * d[c];
  }
  return density ? w - f->o.threshold : distance_value(f, w, sum);
}

void hk_particle_field_evaluate(const void *self, const double (*x)[3], size_t count, double *value) {
  for (size_t k = 0; k < count; k++) value[k] = value_at(self, x[k]);
}
