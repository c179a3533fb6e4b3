#include "plugins/common/sprites/projection.h"

#include <string.h>

enum { GRAIN = 8192 };

typedef struct job {
  const hk_lens *lens;
  const hk_sprite_shading *shading;
  float half[2]; /* half the picture, pixels */
  const hk_point_sprite *point;
  hk_sprite *sprite;
} job;

float hk_sprite_half(float radius) { return (radius > 1.5f ? radius : 1.5f) + 0.5f; }

/* Places a point; false: it is not in front of the eye. */
static bool place(const job *j, const float x[3], float out[2], float *depth) {
  const float *v = j->lens->view, *p = j->lens->projection;
  float e[3];
  for (int c = 0; c < 3; c++) e[c] = v[c] * x[0] + v[4 + c] * x[1] + v[8 + c] * x[2] + v[12 + c];
  *depth = -e[2];
  if (!(*depth > 0)) return false;
  out[0] = j->half[0] * (1 + p[0] * e[0] / *depth);
  out[1] = j->half[1] * (1 + p[5] * e[1] / *depth);
  return true;
}

static float fog_at(const hk_sprite_shading *shading, float depth) {
  double share = ((double)depth - shading->clear) / fmax(shading->thick - shading->clear, 1e-30);
  return (float)(shading->fog * fmin(fmax(share, 0), 1));
}

/* Is any of it on the picture? */
static bool in_sight(const job *j, const hk_sprite *s) {
  float half = hk_sprite_half(s->radius);
  for (int c = 0; c < 2; c++) {
    float at = c ? s->y : s->x, end = at + s->tail[c];
    if (!(hk_max(at, end) + half > 0) || !(hk_min(at, end) - half < 2 * j->half[c])) return false;
  }
  return true;
}

static void project(const job *j, const hk_point_sprite *b, hk_sprite *s) {
  float at[2], end[2], far_end[3], depth;
  memset(s, 0, sizeof *s);
  if (!place(j, b->centre, at, &s->depth) || s->depth - b->radius <= 0) return;
  s->x = at[0], s->y = at[1], s->reach = b->radius;
  s->radius = hk_max(b->radius * j->half[1] * j->lens->projection[5] / s->depth, (float)j->shading->least);
  for (int c = 0; c < 3; c++) far_end[c] = b->centre[c] - b->tail[c];
  if ((b->tail[0] != 0 || b->tail[1] != 0 || b->tail[2] != 0) && place(j, far_end, end, &depth))
    for (int c = 0; c < 2; c++) s->tail[c] = end[c] - at[c];
  s->fog = fog_at(j->shading, s->depth);
  memcpy(s->colour, b->colour, sizeof s->colour);
  if (!in_sight(j, s)) s->radius = 0;
}

static void project_some(void *context, size_t begin, size_t end, size_t chunk) {
  const job *j = context;
  (void)chunk;
  for (size_t k = begin; k < end; k++) project(j, j->point + k, j->sprite + k);
}

void hk_project_points(const hk_host *host, const hk_lens *lens, const hk_sprite_shading *shading, int width,
                       int height, const hk_point_sprite *point, size_t count, hk_sprite *sprite) {
  job j = {lens, shading, {(float)width / 2, (float)height / 2}, point, sprite};
  host->parallel_for(host, count, GRAIN, project_some, &j);
}
