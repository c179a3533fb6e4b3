/* Rays through a volume: in each piece of a ray smoke hides what is behind by exp(-extinction smoke length) and
 * scatters the light of lamp and sky, and hot gas adds its own, after Wien's law relative to 2000 K. Light is reckoned
 * in linear sRGB. */
#include "plugins/common/volume/volume.h"

#include <string.h>

static const double piece_of_cell = 0.5, least_through = 0.01;
static const double lamp = 0.9, sky = 0.1;   /* light that white smoke scatters to the eye */
static const double white_at = 2000;         /* K */
static const double radiation = 1.438777e-2; /* m K, second constant of radiation, h c/k */
static const double wave[3] = {650e-9, 550e-9, 450e-9};

static double to_linear(double c) { return c <= 0.04045 ? c / 12.92 : pow((c + 0.055) / 1.055, 2.4); }
static double to_srgb(double c) { return c <= 0.0031308 ? 12.92 * c : 1.055 * pow(c, 1 / 2.4) - 0.055; }

typedef struct march {
  const hk_volume_draw *draw;
  const double *light;
  unsigned char *rgba;
  double axis[3][3], tangent, step;
  bool hot;
} march;

/* Where the ray from the eye enters and leaves the box. */
static bool crosses(const hk_volume_draw *d, const double eye[3], const double way[3], double *in, double *out) {
  const hk_volume *v = d->volume;
  *in = 0, *out = INFINITY;
  for (int c = 0; c < 3; c++) {
    double high = v->low[c] + v->spacing[c] * (double)v->cells[c];
    double a = (v->low[c] - eye[c]) / way[c], b = (high - eye[c]) / way[c];
    if (way[c] == 0) {
      if (eye[c] < v->low[c] || eye[c] > high) return false;
      continue;
    }
    *in = fmax(*in, fmin(a, b)), *out = fmin(*out, fmax(a, b));
  }
  return *in < *out;
}

/* Adds the light of a piece of the length `length`, m, at x; returns the part that comes through it. */
static double pass(const march *m, const double x[3], double length, double through, double sum[3]) {
  const hk_volume *v = m->draw->volume;
  const hk_volume_optics *optics = m->draw->optics;
  double smoke = fmax(0, hk_volume_value(v, v->smoke, x)), part = exp(-optics->extinction * smoke * length);
  if (smoke > 0) {
    double scattered = through * (1 - part) * (sky + lamp * hk_volume_value(v, m->light, x));
    for (int c = 0; c < 3; c++) sum[c] += scattered;
  }
  double T = m->hot ? v->ambient + hk_volume_value(v, v->heat, x) : 0;
  if (T > 700) /* below, none is seen */
    for (int c = 0; c < 3; c++)
      sum[c] += through * optics->glow * length * exp(radiation / wave[c] * (1 / white_at - 1 / T));
  return part;
}

static void march_pixel(const march *m, int px, int py, double end, unsigned char *rgba) {
  const hk_volume_draw *d = m->draw;
  const hk_camera *camera = &d->setup->camera;
  double eye[3], way[3], in, out, sum[3] = {0}, through = 1, length = 0;
  double across = m->tangent * camera->aspect * (2 * (px + 0.5) / d->width - 1);
  double upward = m->tangent * (2 * (py + 0.5) / d->height - 1);
  for (int c = 0; c < 3; c++) {
    eye[c] = camera->eye[c] + d->origin[c];
    way[c] = across * m->axis[0][c] + upward * m->axis[1][c] - m->axis[2][c];
    length += way[c] * way[c];
  }
  if (!crosses(d, eye, way, &in, &out)) return;
  out = fmin(out, end);
  double ray = sqrt(length), step = m->step / ray;
  double next = in + step * (0.5 + (px * 7 + py * 13) % 16 / 16.0); /* pixels differ, so that there are no bands */
  for (double s = in; s < out && through > least_through; s = next, next += step) {
    double x[3], to = fmin(next, out);
    for (int c = 0; c < 3; c++) x[c] = eye[c] + (s + to) / 2 * way[c];
    through *= pass(m, x, (to - s) * ray, through, sum);
  }
  if (through == 1 && sum[0] == 0) return;
  for (int c = 0; c < 3; c++) {
    double value = to_srgb(fmin(1, sum[c] + through * to_linear(rgba[c] / 255.0)));
    rgba[c] = (unsigned char)(255 * value + 0.5);
  }
}

static void march_rows(void *context, size_t begin, size_t end, size_t piece) {
  const march *m = context;
  const hk_volume_draw *d = m->draw;
  const hk_patch *p = &d->patch;
  (void)piece;
  for (size_t y = begin; y < end; y++)
    for (int x = 0; x < p->width; x++) {
      int px = p->left + x, py = p->bottom + (int)y;
      size_t pixel = (size_t)py * (size_t)d->width + (size_t)px;
      march_pixel(m, px, py, d->distance[y * (size_t)p->width + (size_t)x], m->rgba + 4 * pixel);
    }
}

hk_patch hk_volume_patch(const hk_volume_draw *d, const hk_lens *lens) {
  hk_patch_maker maker;
  hk_patch_begin(&maker, lens, d->width, d->height);
  for (int b = 0; b < 8; b++) {
    float corner[3];
    for (int c = 0; c < 3; c++) {
      double length = d->volume->spacing[c] * (double)d->volume->cells[c];
      corner[c] = (float)(d->volume->low[c] - d->origin[c] + (b >> c & 1 ? length : 0));
    }
    hk_patch_add(&maker, corner, 0, 1);
  }
  return hk_patch_end(&maker);
}

hk_status hk_volume_draw_on(const hk_volume_draw *d, unsigned char *rgba) {
  const double *s = d->volume->spacing;
  march m = {.draw = d, .rgba = rgba, .step = piece_of_cell * fmin(s[0], fmin(s[1], s[2]))};
  double *light = d->host->allocate(d->host, d->volume->size * sizeof *light);
  if (!light) return d->host->fail(d->host, HK_NO_MEMORY, "no memory for the light in a gas");
  hk_volume_light(d, light);
  m.light = light;
  m.hot = d->optics->glow > 0;
  m.tangent = tan(d->setup->camera.fov / 2);
  hk_camera_axes(&d->setup->camera, m.axis[0], m.axis[1], m.axis[2]);
  if (!hk_patch_is_empty(&d->patch)) d->host->parallel_for(d->host, (size_t)d->patch.height, 4, march_rows, &m);
  d->host->release(d->host, light);
  return HK_OK;
}
