/* Frees cloth that intersects itself, other cloth or bodies, at the start or during a run, without knowing how it came
 * about: global intersection analysis (Baraff, Witkin and Kass 2003, plugins/common/contact/untangling). Curves along
 * which surfaces intersect are traced, what a closed curve encloses on both, or cuts off from the border of one, is
 * drawn back through the other, and curves that do neither become shorter. Positions move at once, with no work that
 * could be accounted for; velocities lose what drives surfaces further into each other. Intersections do not become
 * more.
 *
 * Vertices between two bodies that leave no room for them stick to both (flypaper.h). Contact leaves alone what is
 * tangled or sticks. */
#include "plugins/common/contact/untangling/crossing_points.h"
#include "plugins/common/contact/untangling/flypaper.h"
#include "plugins/common/contact/untangling/untangler.h"

typedef struct untangle {
  double thickness, body_thickness, radius, clearance;
  hk_tuples leave;
  double interval, next; /* s */
  int64_t rounds;
  bool flypaper;
  double *mark; /* n: HK_MARK_... */
  hk_flypaper paper;
  hk_untangler work;
  bool between_bodies;       /* there are two */
  int64_t at_first, at_last; /* intersections when they were first seen, and now */
  int64_t told, stuck;       /* messages; vertices that stick */
  const hk_host *host;
} untangle;

enum { TELLS = 2 };

static const hk_param params[] = {
    {"thickness", "m", "of cloth and soft bodies; the other plugins of contact have to have the same",
     .number = HK_AT(untangle, thickness), .initial = {1e-3}, .limits = HK_WITHIN(0, 1e6)},
    {"body_thickness", "m", "of obstacles, surfaces that are pinned as a whole; half of it is outside",
     .number = HK_AT(untangle, body_thickness), .limits = HK_WITHIN(0, 1e6)},
    {"radius", "m", "of strands, bars and isolated particles", .number = HK_AT(untangle, radius), .initial = {5e-4},
     .limits = HK_WITHIN(0, 1e6)},
    {"leave", "", "particles that have no part in contact", .particles = HK_AT(untangle, leave), .flags = HK_OPTIONAL},
    {"clearance", "m",
     "how much further than their thickness surfaces are moved apart; by default a hundredth of the mean edge",
     .number = HK_AT(untangle, clearance), .limits = HK_WITHIN(0, 1e6), .flags = HK_OPTIONAL},
    {"interval", "s", "time between two looks, while nothing intersects, or a look has not helped",
     .number = HK_AT(untangle, interval), .initial = {0.01}, .limits = HK_WITHIN(0, 1e6)},
    {"rounds", "", "moves that are tried after a step, at most", .integer = HK_AT(untangle, rounds), .initial = {100},
     .limits = HK_WITHIN(1, 1e6)},
    {"flypaper", "", "whether vertices stick to two bodies between which there is no room for them",
     .boolean = HK_AT(untangle, flypaper), .initial = {1}},
    {0},
};

static const hk_field fields[] = {
    {"mark", .per_particle = HK_AT(untangle, mark), .width = 1},
    {"next", .number = HK_AT(untangle, next)},
    {"at_first", .integer = HK_AT(untangle, at_first)},
    {"at_last", .integer = HK_AT(untangle, at_last)},
    {"told", .integer = HK_AT(untangle, told)},
    {"stuck", .integer = HK_AT(untangle, stuck)},
    {0},
};

static double mean_edge(const hk_surface_mesh *m, const double *x) {
  double sum = 0;
  for (size_t e = 0; e < m->edges; e++) {
    const double *a = x + 3 * (size_t)m->edge[e][0], *b = x + 3 * (size_t)m->edge[e][1];
    sum += sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2]));
  }
  return m->edges ? sum / (double)m->edges : 0;
}

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  untangle *s = self;
  s->host = host;
  s->work.host = host;
  s->work.rounds = s->rounds;
  s->work.surfaces = host->query(host, HK_SURFACES_INTERFACE);
  if (!s->work.surfaces) return HK_FAILED;
  const hk_surfaces *surfaces = s->work.surfaces;
  hk_surface_request request = {s->thickness, s->body_thickness, s->radius, &s->leave, NULL, 0};
  hk_status status = surfaces->join(surfaces->self, &request, view);
  if (status != HK_OK) return status;
  const hk_surface_mesh *mesh = surfaces->mesh(surfaces->self);
  s->work.clearance = isnan(s->clearance) ? 0.01 * mean_edge(mesh, view->x) : s->clearance;
  status = hk_untangler_analyse(&s->work, view->model, view->x);
  if (status != HK_OK) return status;
  hk_untangler_mark(&s->work, view->n, s->mark);
  s->at_first = s->at_last = (int64_t)s->work.intersections;
  s->between_bodies = s->flypaper && hk_flypaper_needed(mesh, view->model);
  surfaces->keep(surfaces->self, &s->mark);
  return HK_OK;
}

static hk_status topology(void *self, const hk_view *view) {
  untangle *s = self;
  s->between_bodies = s->flypaper && hk_flypaper_needed(s->work.surfaces->mesh(s->work.surfaces->self), view->model);
  return HK_OK;
}

static void destroy(void *self, const hk_host *host) {
  untangle *s = self;
  if (!s->host) return;
  hk_untangler_close(&s->work);
  hk_flypaper_free(&s->paper, host);
}

/* What was done, once it is done; a run that goes on in the same way says it TELLS times. */
static void say(untangle *s, double t) {
  const hk_untangler *work = &s->work;
  int64_t now = (int64_t)work->intersections;
  if (work->found > 0 && s->at_last == 0) s->at_first = (int64_t)work->found;
  s->at_last = now;
  if (now > 0 || work->found == 0 || s->told == TELLS) return;
  s->told++;
  s->host->warn(
      s->host,
      "%lld intersections of surfaces (curves: %zu closed, %zu from border to border, %zu to the tip of a fold, "
      "%zu others) are gone at t = %.6g s: %zu particles were moved, by up to %.3g m",
      (long long)s->at_first, work->seen[HK_CONTOUR_CLOSED], work->seen[HK_CONTOUR_BORDER], work->seen[HK_CONTOUR_LOOP],
      work->seen[HK_CONTOUR_BROKEN], t, work->moved, work->furthest);
}

static void say_stuck(untangle *s, const hk_view *view) {
  s->host->warn(s->host,
                "between bodies that leave no room for them %zu particles stick to both, the first of them %u, at t = "
                "%.6g s",
                s->paper.pinched, view->model->id[s->paper.hold[0].vertex], view->t);
}

/* A look that helped is followed by another one in the next step. */
static hk_status free_surfaces(untangle *s, const hk_view *view, hk_correction *c) {
  int64_t before = s->at_last;
  if (view->t < s->next) return HK_OK;
  hk_status status = hk_untangler_free(&s->work, view->model, c);
  if (status != HK_OK) return status;
  hk_untangler_mark(&s->work, view->n, s->mark);
  say(s, view->t);
  bool helped = s->at_last > 0 && (s->at_last < before || before == 0);
  s->next = helped ? view->t : view->t + s->interval * (1 - 1e-9); /* a step that ends there but for rounding counts */
  return HK_OK;
}

static hk_status hold_pinched(untangle *s, const hk_view *view, hk_correction *c) {
  for (size_t i = 0; i < view->n && s->stuck; i++)
    if (s->mark[i] >= HK_MARK_PINCHED) s->mark[i] -= HK_MARK_PINCHED;
  hk_status status = hk_flypaper_hold(&s->paper, s->host, s->work.surfaces, view->model, c, s->mark);
  if (status == HK_OK && s->paper.pinched && !s->stuck) say_stuck(s, view);
  s->stuck = (int64_t)s->paper.pinched;
  return status;
}

static hk_status correct(void *self, const hk_view *view, hk_correction *c) {
  untangle *s = self;
  hk_status status = free_surfaces(s, view, c);
  return status == HK_OK && s->between_bodies ? hold_pinched(s, view, c) : status;
}

static bool contacts(void *self, const hk_view *view, hk_contact_report *out) {
  untangle *s = self;
  const hk_surfaces *surfaces = s->work.surfaces;
  *out = (hk_contact_report){.closest = INFINITY, .impact_energy = NAN, .repairs = true};
  return surfaces->report(surfaces->self, view, out) == HK_OK;
}

/* Where surfaces pass through each other, of what the last look found. */
static void contact_points(const void *self, const hk_view *view, const hk_contact_points *points) {
  const untangle *s = self;
  hk_crossing_points(&s->work.contours, s->work.surfaces->mesh(s->work.surfaces->self), view->x, points);
}

static const hk_corrector corrector = {.size = sizeof(hk_corrector),
                                       .flags = HK_WANTS_BEFORE,
                                       .correct = correct,
                                       .contacts = contacts,
                                       .contact_points = contact_points};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_CORRECTOR,
    .name = "untangle",
    .summary = "frees surfaces that intersect: what closed intersection paths enclose is drawn back through",
    .reference =
        "Baraff, Witkin, Kass 2003, Untangling cloth, SIGGRAPH; Volino, Magnenat-Thalmann 2006, Resolving surface "
        "collisions through intersection contour minimization, SIGGRAPH",
    .instance_size = sizeof(untangle),
    .params = params,
    .fields = fields,
    .create = create,
    .destroy = destroy,
    .topology = topology,
    .corrector = &corrector,
};
