/* Contact of surfaces, never passed: after each step the pairs that came near are looked at. Where a gap would close,
 * impulses along the normals, and Coulomb's friction across them, bring the step back to its law of impact
 * (plugins/common/impacts/impact.h), all impacts of a step together (sweeps.h), until every pair is proved to have
 * stayed apart on its way (meetings.h). A step of which that cannot be proved is taken back and halved. Pairs that are
 * far, and most of those that are near, cost nothing in most steps (nearby.h).
 *
 * Where several bodies hit each other in one step, the law of impact holds for every pair by its own speeds before;
 * what such a chain does beyond that (a row of balls) is not determined by restitution alone. What bounces, and by that
 * meets a surface again or another one, would lose bounces: where it moves by more than about half of the thickness in
 * a step, the step is taken back and halved, and where no halves are short enough, the run ends. Slower, what is lost
 * is less than that.
 *
 * Beside it, the force `contact` pushes before surfaces touch: methods of high order keep their accuracy with it, and
 * this corrector the last word. By itself the corrector is accurate to order 1 while contact lasts, as positions are
 * brought back at the ends of steps, and of order 2 in impacts that are apart. */
#include "plugins/common/impacts/closed_points.h"
#include "plugins/common/impacts/contact_account.h"
#include "plugins/common/impacts/contact_params.h"
#include "plugins/common/impacts/meetings.h"
#include "plugins/common/surfaces/surface_pair_names.h"

enum { ROUNDS = 6 /* of impacts and looks in a step */ };

/* Of the thickness: gaps may be closed by so much at the end of a step; and what sweeps leave. */
static const double slack = 0.01, left_by_sweeps = 1e-4;

/* Processor time so far, s, for benchmarks, which find it by the names of fields. */
typedef struct contact_times {
  double all, pairs, looks, impulses; /* all of it; hk_nearby_reach, with its searches; hk_meetings_look; solve */
} contact_times;

typedef struct contact {
  hk_contact_params params;
  double restitution;
  int64_t sweeps;
  int64_t began; /* the first step was looked at */
  hk_contact_account account;
  hk_nearby nearby;
  hk_meetings meetings;
  const hk_surfaces *surfaces;
  uint64_t *moved, *touched, now; /* for sweeps.h */
  contact_times seconds;
  const hk_host *host;
} contact;

/* clang-format off */
static const hk_param params[] = {
    HK_CONTACT_PARAM_ROWS(contact),
    {"restitution", "", "e, the part of the normal speed that an impact leaves",
     HK_NUMBER, {0}, 0, 1, offsetof(contact, restitution), 0, NULL},
    {"sweeps", "", "over the impacts of a step, at most; fewer where they change nothing more",
     HK_INTEGER, {100}, 1, 1e9, offsetof(contact, sweeps), 0, NULL},
    {0},
};

static const hk_field fields[] = {
    HK_CONTACT_ACCOUNT_ROWS(contact, account),
    {"began", HK_FIELD_INTEGER, 1, offsetof(contact, began), 0},
    {"seconds", HK_FIELD_NUMBER, 1, offsetof(contact, seconds.all), HK_SCRATCH},
    {"seconds_of_pairs", HK_FIELD_NUMBER, 1, offsetof(contact, seconds.pairs), HK_SCRATCH},
    {"seconds_of_searches", HK_FIELD_NUMBER, 1, offsetof(contact, nearby.seconds), HK_SCRATCH},
    {"seconds_of_looks", HK_FIELD_NUMBER, 1, offsetof(contact, seconds.looks), HK_SCRATCH},
    {"seconds_of_impulses", HK_FIELD_NUMBER, 1, offsetof(contact, seconds.impulses), HK_SCRATCH},
    {0},
};
/* clang-format on */

static hk_status topology(void *self, const hk_view *view) {
  contact *s = self;
  s->host->release(s->host, s->moved);
  s->host->release(s->host, s->touched);
  s->moved = s->host->allocate(s->host, (view->n + 1) * sizeof *s->moved);
  s->touched = s->host->allocate(s->host, (view->n + 1) * sizeof *s->touched);
  if (!s->moved || !s->touched) return s->host->fail(s->host, HK_NO_MEMORY, "no memory for %zu particles", view->n);
  hk_status status = hk_contact_account_open(&s->account, s->host, view->n);
  if (status != HK_OK) return status;
  return hk_nearby_open(&s->nearby, s->host, view, s->surfaces, hk_contact_skin(&s->params));
}

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  contact *s = self;
  hk_status status;
  s->host = host;
  hk_contact_account_begin(&s->account, view->t);
  s->surfaces = hk_contact_join(&s->params, host, view, &status);
  s->meetings.nearby = &s->nearby;
  s->meetings.restitution = s->restitution;
  s->meetings.slack = slack * hk_contact_scale(&s->params);
  return status == HK_OK ? topology(self, view) : status;
}

static hk_status refuse_slides(const contact *s, const hk_view *view, const hk_impacts *all) {
  for (size_t e = 0; e < all->count; e++)
    for (int i = 0; i < 4; i++) {
      uint32_t k = all->impact[e].vertex[i];
      bool slides = view->model->pin[k] == HK_PIN_LINE || view->model->pin[k] == HK_PIN_PLANE;
      if (slides && all->impact[e].w[i] != 0 && all->impact[e].place.push > 0)
        return s->host->fail(s->host, HK_FAILED,
                             "particle %u slides on a pin and meets a surface at t = %g s: the law of impact is for "
                             "particles that are free; keep it away, or name it in `leave`",
                             view->model->id[k], view->t);
    }
  return HK_OK;
}

static hk_status solve(contact *s, const hk_view *view, hk_correction *c, hk_step_move *move) {
  double begin = hk_own_time();
  hk_impacts impacts = {.friction = s->params.friction, .most = (size_t)s->sweeps};
  impacts.moved = s->moved, impacts.touched = s->touched, impacts.now = s->now;
  impacts.tolerance = left_by_sweeps * hk_contact_scale(&s->params);
  if (!c->changed) hk_contact_account_free(&s->account, view, c);
  hk_status status = hk_meetings_impacts(&s->meetings, move, HK_MEETINGS_ALL, &impacts);
  if (status != HK_OK) return status;
  hk_sweeps_done done = hk_impacts_solve(&impacts, move);
  s->meetings.touched = s->touched, s->meetings.since = s->now;
  s->now = impacts.now;
  hk_meetings_remember(&s->meetings, &impacts);
  c->changed |= done.pushing > 0;
  s->account.last.impulse += done.impulse;
  s->seconds.impulses += hk_own_time() - begin;
  return c->filter ? refuse_slides(s, view, &impacts) : HK_OK;
}

static hk_status look(contact *s, hk_step_move *move) {
  double begin = hk_own_time();
  hk_status status = hk_nearby_reach(&s->nearby, move->x_from, move->x);
  double between = hk_own_time();
  if (status == HK_OK) status = hk_meetings_look(&s->meetings, move);
  s->seconds.pairs += between - begin;
  s->seconds.looks += hk_own_time() - between;
  return status;
}

/* What starts nearer than its thickness is opened without a speed, so that no energy shows it. */
static void warn_of_start(contact *s, const hk_view *view) {
  hk_meetings_closed closed = hk_meetings_closed_at_start(&s->meetings);
  bool began = s->began;
  s->began = true;
  if (began || closed.count == 0) return;
  hk_surface_pair_names names = hk_surface_pair_name(closed.pair, view->model->id);
  s->host->warn(
      s->host,
      "%zu pairs start nearer than their thickness, by up to %.3g m (%s and %s): every step opens such a gap "
      "by half of what is missing, which no force does; start them apart, or make thickness or radius smaller",
      closed.count, closed.depth, names.one, names.other);
}

static hk_status keep_apart(contact *s, const hk_view *view, hk_correction *c) {
  hk_step_move move = {c->h, c->x_before, c->v_before, c->x, c->v, view->model->inverse_mass};
  hk_contact_account_step(&s->account, view->t, c->h);
  hk_nearby_begin(&s->nearby, c->x_before);
  hk_meetings_begin(&s->meetings);
  uint64_t began = s->now;
  hk_status status = look(s, &move);
  if (status == HK_OK) warn_of_start(s, view);
  for (int round = 0; status == HK_OK && !c->reject && round < ROUNDS && s->meetings.unsafe + s->meetings.unsolved > 0;
       round++) {
    status = solve(s, view, c, &move);
    if (status == HK_OK) status = look(s, &move);
    c->reject = s->restitution > 0 && hk_meetings_again(&s->meetings, &move, s->moved, began);
  }
  if (status != HK_OK) return status;
  c->reject |= s->meetings.unsafe > 0;
  hk_nearby_end(&s->nearby, c->x);
  s->account.last.closest = s->meetings.closest;
  if (c->changed) hk_contact_account_work(&s->account, view, c);
  return HK_OK;
}

static hk_status correct(void *self, const hk_view *view, hk_correction *c) {
  contact *s = self;
  double begin = hk_own_time();
  hk_status status = keep_apart(s, view, c);
  s->seconds.all += hk_own_time() - begin;
  return status;
}

static bool contacts(void *self, const hk_view *view, hk_contact_report *out) {
  contact *s = self;
  return hk_contact_account_report(&s->account, s->surfaces, view, out);
}

/* Pairs whose gap is closed, but for what the end of a step may leave on either side. */
static void contact_points(const void *self, const hk_view *view, const hk_contact_points *points) {
  const contact *s = self;
  hk_closed_points(&s->nearby, view->x, slack, points);
}

static const hk_corrector corrector = {.size = sizeof(hk_corrector),
                                       .flags = HK_WANTS_BEFORE | HK_REPORTS_WORK | HK_MAY_REJECT,
                                       .correct = correct,
                                       .contacts = contacts,
                                       .contact_points = contact_points};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_CORRECTOR,
    .name = "contact",
    .summary =
        "surfaces never pass each other: impulses by Newton's law of impact, v_n' = -e v_n, and Coulomb's friction",
    .reference =
        "Moreau 1988, Unilateral contact and dry friction in finite freedom dynamics; Chen and others 2025, "
        "Offset geometric contact, section 3.4; Li, Kaufman and Jiang 2021, Codimensional incremental potential "
        "contact, section 5",
    .instance_size = sizeof(contact),
    .params = params,
    .fields = fields,
    .create = create,
    .topology = topology,
    .corrector = &corrector,
};
