#include "plugins/common/camera/framing.h"

#include "plugins/common/colour/range.h"
#include "plugins/common/frame_data/radii.h"
#include "plugins/common/camera/trim.h"

#include <stdlib.h>
#include <string.h>

enum { SAMPLES = HK_SAMPLES };

typedef struct sample {
  float *number; /* SAMPLES */
  size_t count, stride, skipped;
} sample;

static int by_size(const void *a, const void *b) {
  float x = *(const float *)a, y = *(const float *)b;
  return (x > y) - (x < y);
}

static void begin_box(hk_view_setup *setup) {
  for (int c = 0; c < 3; c++) setup->low[c] = INFINITY, setup->high[c] = -INFINITY;
}

static void add_box(hk_view_setup *setup, const float low[3], const float high[3]) {
  for (int c = 0; c < 3; c++) {
    setup->low[c] = fmin(setup->low[c], (double)low[c]);
    setup->high[c] = fmax(setup->high[c], (double)high[c]);
  }
}

static void end_box(hk_view_setup *setup) {
  double sum = 0;
  for (int c = 0; c < 3; c++) {
    if (setup->low[c] > setup->high[c]) setup->low[c] = setup->high[c] = 0;
    double side = setup->high[c] - setup->low[c];
    sum += side * side;
  }
  setup->size = sum > 0 ? sqrt(sum) / 2 : 0.5;
  for (int c = 0; c < 3; c++) setup->middle[c] = (setup->low[c] + setup->high[c]) / 2;
}

/* The median of the frames' reach, without frames whose particles are all at the origin, since they give no size. */
static double median_reach(const hk_frame_spool *spool, float *scratch) {
  size_t count = 0, step = spool->count / SAMPLES + 1;
  for (size_t k = 0; k < spool->count; k += step)
    if (spool->entry[k].reach > 0) scratch[count++] = spool->entry[k].reach;
  qsort(scratch, count, sizeof *scratch, by_size);
  return count ? (double)scratch[(count - 1) / 2] : 0;
}

/* Chooses radii: points on springs are a little thicker than the springs; the radius of points without springs depends
 * on their number and the size. Discs that fade towards their edge are larger than spheres that look as large; what
 * leaves a streak is thin. Pins have the size of points, unless those are as large as each of them is heavy. */
static void choose_radii(const hk_framing *framing, const hk_appearance *appearance, size_t n, size_t lines,
                         hk_view_setup *setup) {
  static const double larger[] = {[HK_STYLE_SPHERE] = 1, [HK_STYLE_SOFT] = 1.8, [HK_STYLE_GLOW] = 2.6};
  setup->tube = hk_drawn_tube(setup->size, (double)lines);
  if (!isnan(framing->tube)) setup->tube = framing->tube;
  setup->point = lines ? hk_drawn.on_tubes * setup->tube : hk_drawn_loose(setup->size, (double)n);
  setup->point *= larger[setup->sprites.style] * (setup->streak > 0 ? 0.5 : 1);
  if (!isnan(framing->radius)) setup->point = framing->radius;
  setup->pin = hk_drawn.pin * setup->size;
  if (lines)
    setup->pin =
        hk_drawn.pin_on_tubes * (appearance->sizes == HK_SIZE_SAME ? setup->point : hk_drawn.on_tubes * setup->tube);
}

/* Sets the radius that the snapshots' number 1 stands for. `largest`: of those numbers in the motion. */
static void choose_unit(const hk_appearance *appearance, double largest, hk_view_setup *setup) {
  setup->point_unit = appearance->sizes == HK_SIZE_CHANNEL ? 1 : largest > 0 ? setup->point / largest : 0;
}

/* The height of the highest level plane among the solids; NAN: there is none. */
static double level_plane(const hk_snapshot3d *s) {
  double height = NAN;
  for (size_t k = 0; k < s->solids; k++) {
    const hk_frame_solid *plane = s->solid + k;
    const double *n = plane->axis[2];
    if (plane->kind == HK_SHAPE_PLANE && n[2] > 0 && sqrt(n[0] * n[0] + n[1] * n[1]) < 1e-9 * n[2])
      height = fmax(height, plane->centre[2]);
  }
  return height;
}

/* Chooses the floor: a level plane that the scene has, z = 0 for a scene whose lowest point is there or a little above,
 * otherwise just below the lowest point. Spheres with their middle at z = 0 would be cut in half there. */
static void choose_floor(const hk_framing *framing, const hk_snapshot3d *snapshot, bool spheres, hk_view_setup *setup) {
  const double *origin = snapshot->origin;
  double plane = level_plane(snapshot);
  double lowest = setup->low[2] + origin[2];
  setup->floor = framing->floor;
  setup->height = setup->low[2] - fmax(0.06 * setup->size, setup->point);
  if (lowest > (spheres ? 1e-3 : -1e-3) * setup->size && lowest < 0.4 * setup->size) setup->height = -origin[2];
  if (!isnan(plane)) setup->height = plane - origin[2];
  if (!isnan(framing->height)) setup->height = framing->height - origin[2];
  setup->offset[0] = origin[0], setup->offset[1] = origin[1];
}

static void move_camera(hk_camera *camera, const hk_camera_place *to, const double origin[3]) {
  for (int c = 0; c < 3; c++) {
    if (!isnan(to->eye[c])) camera->eye[c] = to->eye[c] - origin[c];
    if (!isnan(to->target[c])) camera->target[c] = to->target[c] - origin[c];
  }
}

/* Where it is given, or in the direction from which it will be fitted. */
static void aim_camera(const hk_framing *framing, hk_viewport *port, const double origin[3],
                       const hk_view_setup *setup) {
  hk_camera *camera = &port->camera;
  *camera = (hk_camera){.fov = framing->fov, .aspect = framing->aspect};
  hk_camera_aim(camera, setup->low, setup->high);
  for (int c = 0; c < 3 && !port->own; c++) camera->eye[c] = camera->target[c] + port->direction[c];
  move_camera(camera, &port->given, origin);
}

static double distance_between(const double a[3], const double b[3]) {
  double sum = 0;
  for (int c = 0; c < 3; c++) sum += (a[c] - b[c]) * (a[c] - b[c]);
  return sqrt(sum);
}

/* Fog fills what the size says of the depth. */
static void set_fog(hk_view_setup *setup, double distance) {
  setup->sprites.clear = fmax(distance - setup->size, 0), setup->sprites.thick = distance + setup->size;
}

/* Sets near and far: the depth buffer's 24 bits suffice for a ratio of some thousands. What is near need not belong to
 * the motion: obstacles may be anywhere. */
static void set_depths(hk_view_setup *setup) {
  double distance = distance_between(setup->camera.eye, setup->middle);
  setup->camera.near = 0.01 * (distance + setup->size);
  setup->camera.far = distance + 12 * setup->size;
  set_fog(setup, distance);
}

static void take_samples(sample *s, const hk_snapshot3d *snapshot) {
  for (size_t i = 0; i < snapshot->n; i++) {
    if (++s->skipped < s->stride) continue;
    s->skipped = 0;
    if (s->count < SAMPLES && isfinite(snapshot->colour[i].number)) s->number[s->count++] = snapshot->colour[i].number;
  }
}

static double most(const float *value, size_t count) {
  float largest = 0;
  for (size_t i = 0; value && i < count; i++) largest = fmaxf(largest, value[i]);
  return (double)largest;
}

/* The larger of the radius and a margin that keeps small particles off the edge. */
static void fit_particles(hk_fit *fit, const hk_snapshot3d *s, double radius, double margin) {
  const float *own = s->appearance->sizes == HK_SIZE_CHANNEL ? s->extra[HK_EXTRA_SIZE] : NULL;
  for (size_t i = 0; i < s->n; i++)
    if (!isnan(s->x[i][0])) hk_fit_add(fit, s->x[i], fmax(own ? (double)own[i] : radius, margin));
}

static bool is_fitted(const hk_viewport *port) { return isnan(port->given.eye[0]); }

typedef struct survey { /* what needs every particle of every frame */
  double limit;         /* of the frames' reach */
  bool fitted, trimmed; /* fitted: cameras of some viewports; trimmed: to a sample of the points */
  hk_fit fit[HK_VIEWPORTS];
  sample numbers;
  double largest;                     /* number of hk_appearance.sizes */
  double solid_low[3], solid_high[3]; /* low > high when there are none */
} survey;

static hk_status survey_frames(survey *v, const hk_framing *framing, const hk_frame_spool *spool,
                               hk_snapshot3d *snapshot, const hk_view_setup *setup) {
  bool sampled = framing->counted && isnan(framing->scale.low), fitted = v->fitted && !v->trimmed;
  bool sized = snapshot->appearance->sizes != HK_SIZE_SAME;
  for (size_t k = 0; k < spool->count && (fitted || sampled || sized); k++) {
    if ((double)spool->entry[k].reach > v->limit) continue;
    hk_status status = hk_frame_spool_read(spool, k, snapshot);
    if (status != HK_OK) return status;
    for (size_t p = 0; fitted && p < framing->viewports; p++)
      if (is_fitted(framing->viewport + p)) fit_particles(v->fit + p, snapshot, setup->point, 0.02 * setup->size);
    if (sampled) take_samples(&v->numbers, snapshot);
    if (sized) v->largest = fmax(v->largest, most(snapshot->extra[HK_EXTRA_SIZE], snapshot->n));
  }
  return HK_OK;
}

/* Takes the points of frames beyond the limit out of the sample. */
static void drop_wild(hk_frame_spool *spool, double limit) {
  hk_point_sample *s = &spool->points;
  size_t kept = 0;
  for (size_t k = 0; k < s->count; k++) {
    if ((double)spool->entry[s->frame[k]].reach > limit) continue;
    memmove(s->x[kept], s->x[k], sizeof s->x[0]);
    s->frame[kept++] = s->frame[k];
  }
  s->count = kept;
}

/* Enlarges the box by the solids but for a liquid, which is where its particles are, as far as they do not make the
 * particles less than half as large, and notes what of it they are. */
static void add_solids(survey *v, hk_view_setup *setup, const hk_snapshot3d *snapshot) {
  for (int c = 0; c < 3; c++) v->solid_low[c] = INFINITY, v->solid_high[c] = -INFINITY;
  for (size_t k = 0; k + snapshot->liquid < snapshot->solids; k++)
    hk_solid_box(snapshot->solid + k, v->solid_low, v->solid_high);
  double spare = distance_between(setup->low, setup->high) / 2;
  if (!(v->solid_low[0] <= v->solid_high[0])) return;
  for (int c = 0; c < 3; c++) {
    bool empty = setup->low[c] > setup->high[c];
    v->solid_low[c] -= snapshot->origin[c], v->solid_high[c] -= snapshot->origin[c];
    if (!empty) v->solid_low[c] = fmax(v->solid_low[c], setup->low[c] - spare);
    if (!empty) v->solid_high[c] = fmin(v->solid_high[c], setup->high[c] + spare);
    setup->low[c] = fmin(setup->low[c], v->solid_low[c]);
    setup->high[c] = fmax(setup->high[c], v->solid_high[c]);
  }
}

static void fit_solids(const survey *v, hk_fit *fit) {
  if (!(v->solid_low[0] <= v->solid_high[0])) return;
  for (int corner = 0; corner < 8; corner++) {
    float point[3];
    for (int c = 0; c < 3; c++) point[c] = (float)(corner >> c & 1 ? v->solid_high : v->solid_low)[c];
    hk_fit_add(fit, point, 0);
  }
}

/* The box of the motion and what follows from it and from the numbers of particles and springs. */
static void choose_box(survey *v, const hk_framing *framing, const hk_frame_spool *spool, const hk_snapshot3d *snapshot,
                       hk_view_setup *setup) {
  size_t n = 0, lines = 0, triangles = 0, total = 0;
  begin_box(setup);
  for (size_t k = 0; k < spool->count; k++) {
    const hk_frame_spool_entry *e = spool->entry + k;
    n = e->n > n ? e->n : n, lines = e->lines > lines ? e->lines : lines;
    triangles += e->triangles, total += e->n;
    if ((double)e->reach <= v->limit) add_box(setup, e->low, e->high);
  }
  v->trimmed = hk_trim_box(&spool->points, framing->outliers, v->numbers.number, setup->low, setup->high);
  v->numbers.stride = total / SAMPLES + 1;
  add_solids(v, setup, snapshot);
  end_box(setup);
  choose_radii(framing, snapshot->appearance, n, lines, setup);
  choose_floor(framing, snapshot, triangles == 0, setup);
}

/* What does not take every particle of every frame. */
static void begin_fits(survey *v, hk_framing *framing, const hk_frame_spool *spool, const double origin[3],
                       const hk_view_setup *setup) {
  for (size_t p = 0; p < framing->viewports; p++) {
    hk_viewport *port = framing->viewport + p;
    aim_camera(framing, port, origin, setup);
    hk_fit_begin(v->fit + p, &port->camera, 5. / 6);
    v->fitted |= is_fitted(port);
    fit_solids(v, v->fit + p);
    if (v->trimmed)
      hk_trim_fit(&spool->points, framing->outliers, fmax(setup->point, 0.02 * setup->size), v->numbers.number,
                  v->fit + p);
  }
}

static void end_fits(const survey *v, hk_framing *framing) {
  for (size_t p = 0; p < framing->viewports; p++)
    if (is_fitted(framing->viewport + p)) hk_fit_end(v->fit + p, &framing->viewport[p].camera);
}

static hk_status choose_all(survey *v, hk_framing *framing, const hk_frame_spool *spool, hk_snapshot3d *snapshot,
                            hk_view_setup *setup) {
  choose_box(v, framing, spool, snapshot, setup);
  begin_fits(v, framing, spool, snapshot->origin, setup);
  hk_status status = survey_frames(v, framing, spool, snapshot, setup);
  if (status != HK_OK) return status;
  end_fits(v, framing);
  choose_unit(snapshot->appearance, v->largest, setup);
  if (framing->counted && isnan(framing->scale.low) &&
      !hk_range_choose(&framing->scale, v->numbers.number, v->numbers.count, framing->centred))
    spool->host->warn(spool->host, "color: there is no %snumber for a scale of colours",
                      framing->scale.log ? "positive " : "");
  return HK_OK;
}

hk_status hk_framing_motion(hk_framing *framing, hk_frame_spool *spool, hk_snapshot3d *snapshot, double wild,
                            hk_view_setup *setup) {
  const hk_host *host = spool->host;
  survey v = {.numbers = {.number = host->allocate(host, SAMPLES * sizeof(float))}};
  if (!v.numbers.number) return host->fail(host, HK_NO_MEMORY, "no memory to choose the range of colours");
  v.limit = wild * median_reach(spool, v.numbers.number);
  drop_wild(spool, v.limit);
  hk_status status = choose_all(&v, framing, spool, snapshot, setup);
  host->release(host, v.numbers.number);
  return status;
}

static void add_solid_box(hk_view_setup *setup, const hk_snapshot3d *snapshot) {
  double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
  for (size_t k = 0; k < snapshot->solids; k++) hk_solid_box(snapshot->solid + k, low, high);
  for (int c = 0; c < 3; c++) {
    setup->low[c] = fmin(setup->low[c], low[c] - snapshot->origin[c]);
    setup->high[c] = fmax(setup->high[c], high[c] - snapshot->origin[c]);
  }
}

/* The size is the extent that the camera sees at its target's distance; boxes may only grow to a multiple of it. */
void hk_framing_snapshot(hk_framing *framing, const hk_snapshot3d *snapshot, hk_view_setup *setup) {
  bool first = setup->size == 0;
  begin_box(setup);
  add_box(setup, snapshot->low, snapshot->high);
  add_solid_box(setup, snapshot);
  end_box(setup);
  if (first) aim_camera(framing, framing->viewport, snapshot->origin, setup);
  if (first) setup->camera = framing->viewport[0].camera;
  double distance = distance_between(setup->camera.eye, setup->camera.target);
  setup->size = fmax(distance, 1e-9) * tan(framing->fov / 2);
  for (int c = 0; c < 3; c++) {
    setup->middle[c] = setup->camera.target[c];
    setup->low[c] = fmax(setup->low[c], setup->middle[c] - 50 * setup->size);
    setup->high[c] = fmin(setup->high[c], setup->middle[c] + 50 * setup->size);
  }
  if (!first) return;
  choose_radii(framing, snapshot->appearance, snapshot->n, snapshot->lines, setup);
  choose_unit(snapshot->appearance, 0, setup);
  choose_floor(framing, snapshot, snapshot->triangles == 0, setup);
  setup->camera.near = 0.02 * distance, setup->camera.far = 60 * distance;
  set_fog(setup, distance);
}

void hk_framing_move(const hk_camera *camera, const hk_camera_place *place, const double origin[3],
                     hk_view_setup *setup) {
  hk_camera moved = *camera;
  move_camera(&moved, place, origin);
  bool same = memcmp(moved.eye, setup->camera.eye, sizeof moved.eye) == 0 &&
              memcmp(moved.target, setup->camera.target, sizeof moved.target) == 0;
  if (same) return;
  setup->camera = moved;
  set_depths(setup);
}
