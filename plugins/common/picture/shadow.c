/* The shadow of a directional light: all objects are projected along it onto the floor, filled on a small raster, and
 * blurred three times by box filters with running sums (nearly a Gaussian). On the processor this takes a fraction of
 * the time of OpenGL in software. */
#include "plugins/common/picture/shadow.h"

#include <string.h>

enum { SIZE = HK_SHADOW_SIZE, REACH = 3, PASSES = 3 };

typedef struct caster {
  unsigned char *shade;
  float lean[2];       /* displacement of the shadow along the floor per height, m/m */
  float corner[2];     /* corner of the patch */
  float height, scale; /* height of the floor; texels per metre */
} caster;

static void project(const caster *c, const float x[3], float out[2]) {
  for (int k = 0; k < 2; k++) out[k] = (x[k] - c->lean[k] * (x[2] - c->height) - c->corner[k]) * c->scale;
}

static int clamp(float at) { return at < 0 ? 0 : at > SIZE - 1 ? SIZE - 1 : (int)at; }

/* Fills the texels whose middle is inside the triangle; corners in texels. */
static void fill_triangle(const caster *c, const float p[3][2]) {
  float low[2], high[2], slope[3][2], edge[3];
  for (int k = 0; k < 2; k++) {
    low[k] = fminf(p[0][k], fminf(p[1][k], p[2][k])), high[k] = fmaxf(p[0][k], fmaxf(p[1][k], p[2][k]));
    if (!(high[k] >= 0) || !(low[k] < SIZE)) return;
  }
  float area = (p[1][0] - p[0][0]) * (p[2][1] - p[0][1]) - (p[1][1] - p[0][1]) * (p[2][0] - p[0][0]);
  float turn = area < 0 ? -1 : 1;
  int left = clamp(low[0]), right = clamp(high[0]), bottom = clamp(low[1]), top = clamp(high[1]);
  for (int k = 0; k < 3; k++) {
    const float *a = p[k], *b = p[(k + 1) % 3];
    slope[k][0] = turn * (a[1] - b[1]), slope[k][1] = turn * (b[0] - a[0]);
    edge[k] = slope[k][0] * ((float)left + 0.5f - a[0]) + slope[k][1] * ((float)bottom + 0.5f - a[1]);
  }
  for (int y = bottom; y <= top; y++) {
    float e[3] = {edge[0], edge[1], edge[2]};
    for (int x = left; x <= right; x++) {
      if (e[0] >= 0 && e[1] >= 0 && e[2] >= 0) c->shade[y * SIZE + x] = 255;
      for (int k = 0; k < 3; k++) e[k] += slope[k][0];
    }
    for (int k = 0; k < 3; k++) edge[k] += slope[k][1];
  }
}

/* Fills the shadow of a tube, at least about one texel wide. */
static void fill_tube(const caster *c, const hk_tube *tube, double radius) {
  float a[2], b[2], half = fmaxf((float)radius * c->scale, 0.6f);
  project(c, tube->a, a);
  project(c, tube->b, b);
  float along[2] = {b[0] - a[0], b[1] - a[1]}, length = sqrtf(along[0] * along[0] + along[1] * along[1]);
  if (!(length > 0)) return;
  float side[2] = {-along[1] / length * half, along[0] / length * half};
  float p[4][2];
  for (int k = 0; k < 2; k++) {
    p[0][k] = a[k] - side[k], p[1][k] = a[k] + side[k];
    p[2][k] = b[k] + side[k], p[3][k] = b[k] - side[k];
  }
  fill_triangle(c, (const float[3][2]){{p[0][0], p[0][1]}, {p[1][0], p[1][1]}, {p[2][0], p[2][1]}});
  fill_triangle(c, (const float[3][2]){{p[0][0], p[0][1]}, {p[2][0], p[2][1]}, {p[3][0], p[3][1]}});
}

/* What is not opaque darkens by its opacity, one after the other. */
static void fill_bead(const caster *c, const hk_bead *bead, double opacity) {
  int dark = (int)fmin(opacity * bead->colour[3] + 0.5, 255);
  float p[2], r = fmaxf(bead->radius * c->scale, 0.75f);
  project(c, bead->centre, p);
  if (!(p[0] + r >= 0 && p[0] - r < SIZE && p[1] + r >= 0 && p[1] - r < SIZE)) return;
  for (int y = clamp(p[1] - r); y <= clamp(p[1] + r); y++)
    for (int x = clamp(p[0] - r); x <= clamp(p[0] + r); x++) {
      float dx = (float)x + 0.5f - p[0], dy = (float)y + 0.5f - p[1];
      unsigned char *at = c->shade + y * SIZE + x;
      if (dx * dx + dy * dy <= r * r) *at = (unsigned char)(*at + dark < 255 ? *at + dark : 255);
    }
}

/* One box filter along rows; the result is transposed, so that the next works along columns. */
static void blur(const unsigned char *from, unsigned char *to) {
  for (int y = 0; y < SIZE; y++) {
    const unsigned char *row = from + y * SIZE;
    int sum = 0;
    for (int x = 0; x < REACH; x++) sum += row[x];
    for (int x = 0; x < SIZE; x++) {
      if (x + REACH < SIZE) sum += row[x + REACH];
      if (x > REACH) sum -= row[x - REACH - 1];
      to[x * SIZE + y] = (unsigned char)(sum / (2 * REACH + 1));
    }
  }
}

/* The square that contains the shadow of the motion's box and a margin for the blur. */
static void place_patch(const hk_view_setup *setup, const double key[3], float patch[3]) {
  double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
  for (int corner = 0; corner < 8; corner++)
    for (int c = 0; c < 2; c++) {
      double z = (corner & 4 ? setup->high : setup->low)[2] - setup->height;
      double at = (corner >> c & 1 ? setup->high : setup->low)[c] - key[c] / key[2] * z;
      low[c] = fmin(low[c], at), high[c] = fmax(high[c], at);
    }
  for (int c = 0; c < 2; c++) patch[c] = (float)((low[c] + high[c]) / 2);
  patch[2] = (float)(0.53 * fmax(high[0] - low[0], high[1] - low[1]) + 0.1 * setup->size + setup->bead);
}

void hk_shadow_cast(hk_painter *p, const hk_view_setup *setup, const double key[3], float patch[3]) {
  place_patch(setup, key, patch);
  caster c = {.shade = p->shade, .height = (float)setup->height, .scale = SIZE / (2 * patch[2])};
  for (int k = 0; k < 2; k++) c.lean[k] = (float)(key[k] / key[2]), c.corner[k] = patch[k] - patch[2];
  memset(p->shade, 0, SIZE * SIZE);
  for (size_t k = 0; k < p->opaque; k++) {
    float corner[3][2];
    for (int i = 0; i < 3; i++) project(&c, p->vertex[p->triangle[k][i]].x, corner[i]);
    fill_triangle(&c, (const float(*)[2])corner);
  }
  for (size_t k = 0; k < p->tubes; k++) fill_tube(&c, p->tube + k, setup->tube);
  for (size_t k = 0; k < p->beads && setup->sprites.style != HK_STYLE_GLOW; k++)
    fill_bead(&c, p->bead + k, setup->sprites.opacity);
  for (int k = 0; k < 2 * PASSES; k++) blur(p->shade + (k % 2 ? SIZE * SIZE : 0), p->shade + (k % 2 ? 0 : SIZE * SIZE));
}
