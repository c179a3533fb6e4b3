/* The hand of a user who watches the run (plugins/common/hand/hand.h). */
#include "plugins/common/hand/hand.h"

#include <string.h>

typedef struct hand {
  hk_hand table;
  uint32_t id;
  double t, frame;    /* s: the frame of the last move, and the time to the next */
  double place[2][3]; /* m, at the two frames */
  double hold[2];     /* as well */
  double strength;
} hand;

/* The part of the time between the two frames that has passed. */
static double part(const hand *h, double t) { return h->frame > 0 ? fmin(fmax((t - h->t) / h->frame, 0), 1) : 1; }

static double between(const double ends[2], double part) { return ends[0] + (ends[1] - ends[0]) * part; }

static hk_grip grip(const void *self, double t) {
  const hand *h = self;
  double now = part(h, t);
  hk_grip g = {.id = h->id, .hold = between(h->hold, now), .strength = h->strength, .frame = h->frame};
  for (int c = 0; c < 3; c++) g.place[c] = between((double[2]){h->place[0][c], h->place[1][c]}, now);
  return g;
}

/* A particle that the hand did not hold before is taken where it is. */
static void take(hand *h, const hk_view *view, uint32_t id) {
  size_t i = hk_model_find(view->model, id);
  h->id = i < view->n ? id : 0;
  h->hold[0] = 0;
  if (h->id) memcpy(h->place[0], view->x + 3 * i, sizeof h->place[0]);
}

static void move(void *self, const hk_view *view, double frame, uint32_t id, const double place[3], double strength) {
  hand *h = self;
  hk_grip now = grip(h, view->t);
  memcpy(h->place[0], now.place, sizeof now.place);
  h->hold[0] = now.hold;
  h->t = view->t;
  h->frame = frame;
  if (id && id != h->id) take(h, view, id);
  h->hold[1] = id && h->id ? 1 : 0;
  if (!id && h->hold[0] == 0) h->id = 0; /* it has let go a frame ago */
  memcpy(h->place[1], id && h->id ? place : h->place[0], sizeof h->place[1]);
  if (id) h->strength = strength;
}

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  hand *h = self;
  (void)host, (void)view;
  h->table = (hk_hand){self, move, grip};
  return HK_OK;
}

static const void *table(void *self) { return &((hand *)self)->table; }

static const hk_service service = {.size = sizeof(hk_service), .interface = HK_HAND_INTERFACE, .table = table};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_SERVICE,
    .name = "grip",
    .summary = "the hand of a user who watches the run and may hold a particle",
    .reference = "",
    .instance_size = sizeof(hand),
    .create = create,
    .service = &service,
};
