/* Frees cloth that intersects itself, other cloth or bodies, at the start or during a run, without knowing how it came
 * about: global intersection analysis (Baraff, Witkin and Kass 2003). See plugins/common/untangling. */
#include "plugins/common/untangling/untangler.h"

typedef struct untangle {
  double thickness, body_thickness, radius, clearance;
  hk_tuples leave;
  int64_t rounds;
  double *mark; /* n, published */
  hk_untangler work;
  const hk_host *host;
} untangle;

/* clang-format off */
static const hk_param params[] = {
    {"thickness", "m", "thickness of cloth: that of the other plugins of contact in the scene",
     HK_NUMBER, {0}, 0, 1e6, offsetof(untangle, thickness), 0, NULL},
    {"body_thickness", "m", "thickness of surfaces that are pinned as a whole",
     HK_NUMBER, {0}, 0, 1e6, offsetof(untangle, body_thickness), 0, NULL},
    {"radius", "m", "radius of strands and lone particles", HK_NUMBER, {0}, 0, 1e6, offsetof(untangle, radius), 0, NULL},
    {"leave", "", "particles that have no part in contact", HK_PARTICLES, {0}, 0, 0, offsetof(untangle, leave), HK_OPTIONAL, NULL},
    {"clearance", "m", "how much further than their thickness surfaces are moved apart; by default a hundredth of the mean edge",
     HK_NUMBER, {0}, 0, 1e6, offsetof(untangle, clearance), HK_OPTIONAL, NULL},
    {"rounds", "", "moves that are tried after a step, at most", HK_INTEGER, {50}, 1, 1e6, offsetof(untangle, rounds), 0, NULL},
    {0},
};

static const hk_field fields[] = {
    {"mark", HK_FIELD_PER_PARTICLE, 1, offsetof(untangle, mark), HK_PUBLISHED},
    {0},
};
/* clang-format on */

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
  hk_surface_request request = {s->thickness, s->body_thickness, s->radius, &s->leave};
  hk_status status = surfaces->join(surfaces->self, &request, view);
  if (status != HK_OK) return status;
  const hk_surface_mesh *mesh = surfaces->mesh(surfaces->self);
  s->work.clearance = isnan(s->clearance) ? 0.01 * mean_edge(mesh, view->x) : s->clearance;
  status = hk_untangler_look(&s->work, view->model, view->x);
  if (status == HK_OK) hk_untangler_mark(&s->work, view->n, s->mark);
  return status;
}

static void destroy(void *self, const hk_host *host) {
  untangle *s = self;
  (void)host;
  if (s->host) hk_untangler_close(&s->work);
}

static hk_status correct(void *self, const hk_view *view, hk_correction *c) {
  untangle *s = self;
  hk_status status = hk_untangler_free(&s->work, view->model, c);
  if (status == HK_OK) hk_untangler_mark(&s->work, view->n, s->mark);
  return status;
}

static bool contacts(void *self, const hk_view *view, hk_contact_report *out) {
  untangle *s = self;
  const hk_surfaces *surfaces = s->work.surfaces;
  *out = (hk_contact_report){.closest = INFINITY, .impact_energy = NAN, .repairs = true};
  return surfaces->report(surfaces->self, view, out) == HK_OK;
}

static const hk_corrector corrector = {.size = sizeof(hk_corrector), .correct = correct, .contacts = contacts};

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
    .corrector = &corrector,
};
