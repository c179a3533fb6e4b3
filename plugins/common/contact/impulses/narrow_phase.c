/* See narrow_phase.h. */
#include "plugins/common/contact/impulses/narrow_phase.h"

#include "plugins/kit/vector3.h"

/* Where a pair moves by more than this part of its distance, the instant of contact is searched. Else its shape at the
 * end is on the side on which it was, and good for the impact: a linear gap with the normal of the start would close
 * where features slide past each other, as edges of two meshes do that lie on each other. */
static const double fast = 0.5;

static hk_pair_frame frame_at(hk_pair_kind kind, const hk_pair_path *path, double when) {
  double x[12];
  for (int i = 0; i < 12; i++) x[i] = path->from[i] + when * (path->to[i] - path->from[i]);
  hk_nearest near = hk_nearest_of_pair(kind, x);
  return hk_pair_frame_of(&near);
}

/* Of the nearest points of the frame along its normal, or, for y = v, its rate. */
static double distance_along(const hk_pair_frame *f, const double y[12]) {
  double sum = 0;
  for (int i = 0; i < 4; i++) sum += f->w[i] * hk_dot(f->n, y + 3 * (size_t)i);
  return sum;
}

/* What slides over a surface meets its edges and corners from the side, at the thickness and as much below it as the
 * step falls before the surface holds it. As an impact of its own that would be a stop, by a normal which is not the
 * surface's: up to this part of the thickness it is left to the frame of the end, as of slow pairs. */
static const double grazing = 0.1;

static bool grazes(const hk_feature_pair *pair, const hk_pair_path *path) {
  double when, depth = grazing * pair->offset;
  return !hk_ccd(pair->kind, path->from, path->to, pair->offset - depth, 0.1 * depth, &when);
}

/* A fast pair, whose frame at the end may be that of another place: it collides, with the frame of the instant at which
 * its gap closes, or it is left alone, also where it only touches at that instant or grazes. Where impulses on others
 * turn it, the next narrow phase finds its new contact. */
static void examine_fast(const hk_feature_pair *pair, const hk_pair_path *path, double from, double motion,
                         hk_narrow_phase *p) {
  double least = hk_least_distance(pair->offset, from), to = p->gap_to + pair->offset, when;
  hk_narrow_phase there = *p;
  if (from > pair->offset) {
    if (!hk_comes_within(pair->kind, path, pair->offset, &when)) return;
    there.frame = frame_at(pair->kind, path, when);
    there.on_the_way = distance_along(&there.frame, path->to) < pair->offset;
    if (there.on_the_way && grazes(pair, path)) return;
  }
  if ((from + to - motion) / 2 <= least && hk_comes_within(pair->kind, path, least, &when)) {
    there.state = HK_PAIR_UNSAFE;
    if (!there.on_the_way) there.frame = frame_at(pair->kind, path, when);
  }
  if (there.on_the_way || there.state == HK_PAIR_UNSAFE) *p = there;
}

static hk_pair_state state_of(const hk_narrow_phase *p, double slack, double far, bool is_fast) {
  if (p->state == HK_PAIR_UNSAFE) return HK_PAIR_UNSAFE;
  if (p->gap_to < fmin(0, p->gap_from) / 2 - slack) return HK_PAIR_OVERLAPS;
  if (p->gap_to < 0 || p->on_the_way) return HK_PAIR_CLOSES;
  return is_fast || p->gap_to > far ? HK_PAIR_APART : HK_PAIR_MAY_CLOSE;
}

/* It is closed at the end, and that by more than a slow pair moves, or would be after a further step with the speed of
 * the end. Features that rest or slide on each other have no such speed. */
static bool goes_in(const hk_feature_pair *pair, const hk_pair_path *path, const hk_step_move *move,
                    const hk_pair_frame *f) {
  double v[12], gap = distance_along(f, path->to) - pair->offset;
  hk_pair_gather(pair, move->v, v);
  return gap < 0 && gap + fmin(0, move->h * distance_along(f, v)) < -fast * pair->offset;
}

hk_narrow_phase hk_narrow_phase_of(const hk_feature_pair *pair, const hk_step_move *move, double slack, double reach) {
  hk_pair_path path;
  hk_pair_path_of(&path, pair, move->x_from, move->x);
  double from = sqrt(hk_nearest_of_pair(pair->kind, path.from).squared), motion = hk_pair_motion(pair->kind, &path);
  hk_narrow_phase p = {.gap_from = from - pair->offset, .gap_to = INFINITY};
  if (p.gap_from > motion + reach) return p;
  hk_nearest end = hk_nearest_of_pair(pair->kind, path.to);
  bool is_fast = motion > fast * from;
  p.gap_to = sqrt(end.squared) - pair->offset;
  if (end.squared > 0) p.frame = hk_pair_frame_of(&end);
  if (is_fast) examine_fast(pair, &path, from, motion, &p);
  p.state = state_of(&p, slack, motion + reach, is_fast);
  p.enters = p.state == HK_PAIR_UNSAFE || goes_in(pair, &path, move, &p.frame);
  return p;
}
