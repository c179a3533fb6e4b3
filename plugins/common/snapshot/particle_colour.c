#include "plugins/common/snapshot/particle_colour.h"

#include "plugins/common/frame_data/strain.h"
#include "plugins/common/stress/stress.h"

#include <string.h>

static hk_status take_elements(hk_snapshot3d *s, const hk_view *view, const hk_frame *frame) {
  hk_paint paint = s->appearance->paint;
  hk_status status = HK_OK;
  if (paint == HK_PAINT_STRAIN)
    hk_particle_strains(view, NULL, view->n, s->strain);
  else
    status = hk_particle_stresses(view, frame, (hk_stress_kind)paint, NULL, view->n, s->strain);
  for (size_t i = 0; i < view->n; i++) s->colour[i].number = (float)s->strain[i];
  return status;
}

static double length(const double *value, size_t size) {
  double sum = 0;
  if (size == 1) return value[0];
  for (size_t c = 0; c < size; c++) sum += value[c] * value[c];
  return sqrt(sum);
}

static void take_colour(hk_particle_colour *one, const double rgb[3]) {
  for (int c = 0; c < 3; c++) one->colour[c] = (uint8_t)(255 * fmin(fmax(rgb[c], 0), 1) + 0.5);
  one->colour[3] = 255;
}

static const double *channel_of(const hk_view *view, size_t k) {
  return view->y + view->model->channel[k].offset * view->n;
}

static void take_group(hk_snapshot3d *s, const hk_view *view) {
  for (size_t i = 0; i < view->n; i++) memcpy(s->colour + i, &view->model->group[i], sizeof *s->colour);
}

static void take_channel(hk_snapshot3d *s, const hk_view *view) {
  const double *y = channel_of(view, s->appearance->channel);
  size_t size = view->model->channel[s->appearance->channel].size;
  for (size_t i = 0; i < view->n; i++) {
    if (s->appearance->paint == HK_PAINT_RGB)
      take_colour(s->colour + i, y + size * i);
    else
      s->colour[i].number = (float)length(y + size * i, size);
  }
}

static void take_number(hk_snapshot3d *s, const hk_view *view, const double *birth) {
  for (size_t i = 0; i < view->n; i++) {
    double number = s->appearance->paint == HK_PAINT_SPEED  ? length(view->v + 3 * i, 3)
                    : s->appearance->paint == HK_PAINT_AGE  ? view->t - (birth ? birth[i] : 0)
                    : s->appearance->paint == HK_PAINT_MASS ? view->model->mass[i]
                                                            : 0;
    s->colour[i].number = (float)number;
  }
}

static void take_sizes(hk_snapshot3d *s, const hk_view *view) {
  float *size = s->extra[HK_EXTRA_SIZE];
  const double *radius = s->appearance->sizes == HK_SIZE_CHANNEL ? channel_of(view, s->appearance->size_channel) : NULL;
  for (size_t i = 0; i < view->n; i++) {
    double r = radius ? radius[i] : pow(view->model->mass[i], 1.0 / 3);
    size[i] = isfinite(r) && r > 0 ? (float)r : 0;
  }
}

static double radius_of_group(const hk_appearance *appearance, uint32_t group) {
  for (size_t k = 0; k < appearance->tube_groups; k++)
    if (appearance->tube_group[k].group == group) return appearance->tube_group[k].radius;
  return 0;
}

static void take_tubes(hk_snapshot3d *s, const hk_view *view) {
  const hk_appearance *appearance = s->appearance;
  if (appearance->tube_groups) {
    for (size_t i = 0; i < view->n; i++)
      s->extra[HK_EXTRA_TUBE][i] = (float)radius_of_group(appearance, view->model->group[i]);
    return;
  }
  if (hk_strand_radii_any(&appearance->radii)) {
    for (size_t i = 0; i < view->n; i++)
      s->extra[HK_EXTRA_TUBE][i] = (float)hk_strand_radius(&appearance->radii, view->model, i);
    return;
  }
  const double *radius = channel_of(view, appearance->tube_channel);
  for (size_t i = 0; i < view->n; i++)
    s->extra[HK_EXTRA_TUBE][i] = radius && isfinite(radius[i]) && radius[i] > 0 ? (float)radius[i] : 0;
}

static void take_fade(hk_snapshot3d *s, const hk_view *view) {
  const double *y = channel_of(view, s->appearance->fade_channel);
  for (size_t i = 0; i < view->n; i++) s->extra[HK_EXTRA_FADE][i] = (float)fmin(fmax(y[i], 0), 1);
}

static void take_velocities(hk_snapshot3d *s, const hk_view *view) {
  for (size_t i = 0; i < view->n; i++) {
    double v[3];
    hk_to_z_up(s->appearance->y_up, view->v + 3 * i, v);
    for (size_t c = 0; c < 3; c++) s->extra[HK_EXTRA_VELOCITY][3 * i + c] = isfinite(v[c]) ? (float)v[c] : 0;
  }
}

hk_status hk_particle_colours_take(hk_snapshot3d *s, const hk_view *view, const hk_frame *frame, const double *birth) {
  hk_status status = HK_OK;
  if (hk_paints_elements(s->appearance->paint))
    status = take_elements(s, view, frame);
  else if (s->appearance->paint == HK_PAINT_GROUP)
    take_group(s, view);
  else if (s->appearance->paint == HK_PAINT_CHANNEL || s->appearance->paint == HK_PAINT_RGB)
    take_channel(s, view);
  else
    take_number(s, view, birth);
  if (s->appearance->sizes != HK_SIZE_SAME) take_sizes(s, view);
  if (s->appearance->tubes) take_tubes(s, view);
  if (s->appearance->fades) take_fade(s, view);
  if (s->appearance->streak > 0) take_velocities(s, view);
  return status;
}
