/* One pass over the neighbours of each particle, in their order, for the mean and the covariance, whose axes are those
 * of the kernel. */
#include "plugins/common/particle_surface/particle_kernels.h"
#include "plugins/common/solids/matrix3.h"

#include <string.h>

enum { GRAIN = 64 };

static const double full = 0.15; /* the covariance of a full liquid, parts of reach^2 */

typedef struct task {
  const hk_particle_field *near; /* lists of the particles within reach */
  const hk_particle_surface_options *o;
  const hk_particle_kernels *to;
  double (*mean)[3]; /* n x 3, m: from each particle to the weighted mean of what is within its reach */
} task;

/* Of the covariance the upper triangle is there. */
typedef struct moments {
  double mean[3], covariance[9]; /* m from the particle; m^2 */
  size_t neighbours;
} moments;

/* The weight of a particle at squared distance `square`, m^2, as a part of reach^2; 0 beyond reach. */
static double weight(double square) { return square < 1 ? 1 - square * sqrt(square) : 0; }

static void take_moments(const hk_particle_field *f, size_t i, moments *m) {
  const double *x = f->x[i];
  size_t block = hk_particle_field_block(f, x);
  double sum = 0, scale = 1 / (f->o.reach * f->o.reach);
  memset(m, 0, sizeof *m);
  for (size_t n = f->start[block]; n < f->start[block + 1]; n++) {
    const double *p = f->x[f->list[n]];
    double d[3] = {p[0] - x[0], p[1] - x[1], p[2] - x[2]};
    double w = weight((d[0] * d[0] + d[1] * d[1] + d[2] * d[2]) * scale);
    if (w == 0) continue;
    m->neighbours += f->list[n] != i;
    sum += w;
    for (int a = 0; a < 3; a++) {
      m->mean[a] += w * d[a];
      for (int b = a; b < 3; b++) m->covariance[3 * a + b] += w * d[a] * d[b];
    }
  }
  for (int a = 0; a < 3; a++) m->mean[a] /= sum;
  for (int a = 0; a < 3; a++)
    for (int b = a; b < 3; b++) m->covariance[3 * a + b] = m->covariance[3 * a + b] / sum - m->mean[a] * m->mean[b];
}

/* The centre of particle i: its own mean, less the average of its neighbours'. */
static void place_centre(const task *t, size_t i) {
  const hk_particle_field *f = t->near;
  const double *x = f->x[i];
  size_t block = hk_particle_field_block(f, x);
  double sum = 0, average[3] = {0}, scale = 1 / (f->o.reach * f->o.reach), part = fmax(t->o->position_smoothing, 0);
  for (size_t n = f->start[block]; n < f->start[block + 1]; n++) {
    const double *p = f->x[f->list[n]], *mean = t->mean[f->list[n]];
    double d[3] = {p[0] - x[0], p[1] - x[1], p[2] - x[2]};
    double w = weight((d[0] * d[0] + d[1] * d[1] + d[2] * d[2]) * scale);
    sum += w;
    for (int c = 0; c < 3 && w > 0; c++) average[c] += w * mean[c];
  }
  for (int c = 0; c < 3; c++) t->to->centre[i][c] = x[c] + part * (t->mean[i][c] - average[c] / sum);
}

/* ---- kernels ---- */

/* Amplitudes are such that the sum over a full lattice is 1: V / (pi h^3 s1 s2 s3) with V = (2 radius)^3 and h =
 * reach / 2. */
static void set_kernel(hk_particle_kernel *k, const hk_particle_surface_options *o, const double axis[3],
                       const double V[9]) {
  static const int first[6] = {0, 1, 2, 1, 0, 0}, second[6] = {0, 1, 2, 2, 2, 1};
  double h = o->reach / 2, ratio = 2 * o->radius / h, largest = fmax(axis[0], fmax(axis[1], axis[2]));
  for (int e = 0; e < 6; e++) {
    k->form[e] = 0;
    for (int c = 0; c < 3; c++) k->form[e] += V[3 * first[e] + c] * V[3 * second[e] + c] / (axis[c] * axis[c] * h * h);
  }
  k->amplitude = ratio * ratio * ratio / (3.14159265358979323846 * axis[0] * axis[1] * axis[2]);
  k->reach = o->reach * largest;
}

static void make_kernel(const task *t, size_t i) {
  const hk_particle_surface_options *o = t->o;
  double V[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, axis[3] = {o->lone, o->lone, o->lone}, square[3];
  moments m;
  take_moments(t->near, i, &m);
  memcpy(t->mean[i], m.mean, sizeof m.mean);
  if (m.neighbours > o->few) {
    hk_matrix3_eigen(m.covariance, square, V);
    double largest = o->lone, unit = full * o->reach * o->reach;
    for (int c = 0; c < 3; c++) largest = fmax(largest, square[c] / unit);
    for (int c = 0; c < 3; c++) axis[c] = fmax(square[c] / unit, largest / o->stretch);
  }
  set_kernel(&t->to->kernel[i], o, axis, V);
}

static void make_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  (void)chunk;
  for (size_t i = begin; i < end; i++) make_kernel(context, i);
}

static void place_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  (void)chunk;
  for (size_t i = begin; i < end; i++) place_centre(context, i);
}

hk_status hk_particle_kernels_make(hk_particle_kernels *k, const hk_host *host, const double (*x)[3], size_t n,
                                   const hk_particle_surface_options *options) {
  hk_particle_field near = {.host = host, .x = x, .n = n, .o = {.radius = options->radius, .reach = options->reach}};
  task t = {&near, options, k, NULL};
  near.o.cell = near.o.reach / 8; /* blocks of one reach */
  near.o.most_bytes = options->most_bytes;
  hk_status status = hk_particle_field_open(&near);
  double bytes = (double)n * (double)(2 * sizeof *k->centre + sizeof *k->kernel);
  bool allowed = options->most_bytes == 0 || bytes <= (double)options->most_bytes;
  if (status == HK_OK && allowed) {
    k->centre = host->allocate(host, n * sizeof *k->centre);
    k->kernel = host->allocate(host, n * sizeof *k->kernel);
    t.mean = host->allocate(host, n * sizeof *t.mean);
  }
  if (status == HK_OK && !(k->centre && k->kernel && t.mean))
    status =
        host->fail(host, HK_NO_MEMORY, "surface of particles: no memory for %zu kernels (%.3g MB)", n, 1e-6 * bytes);
  if (status == HK_OK) host->parallel_for(host, n, GRAIN, make_chunk, &t);
  if (status == HK_OK) host->parallel_for(host, n, GRAIN, place_chunk, &t);
  host->release(host, t.mean);
  hk_particle_field_close(&near);
  return status;
}

void hk_particle_kernels_free(hk_particle_kernels *k, const hk_host *host) {
  host->release(host, k->centre);
  host->release(host, k->kernel);
  *k = (hk_particle_kernels){0};
}
