/* The output of a run in a page: it tells what happens in the messages of a run that is watched
 * (plugins/common/live/messages.h), at every frame, and moves the user's hand. Pausing, single frames and the pace are
 * the page's own: between two frames it calls or does not. */
#include "plugins/common/frame_data/gatherer.h"
#include "plugins/common/hand/hand.h"
#include "plugins/common/live/messages.h"
#include "tools/browser/run.h"

typedef struct page {
  const hk_host *host;
  const hk_hand *hand;
  double origin[3]; /* m, of positions in messages; NAN: the middle of the start */
  hk_gatherer gatherer;
  hk_live_messages out;
} page;

static const hk_param params[] = {
    {"x", "m", "origin of the positions in messages; left out: the middle of the start",
     .number = HK_AT(page, origin[0]), .flags = HK_OPTIONAL},
    {"y", "m", "see x", .number = HK_AT(page, origin[1]), .flags = HK_OPTIONAL},
    {"z", "m", "see x", .number = HK_AT(page, origin[2]), .flags = HK_OPTIONAL},
    {0},
};

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  page *p = self;
  p->host = host;
  p->hand = host->query(host, HK_HAND_INTERFACE);
  return p->hand ? hk_gatherer_choose(&p->gatherer, host, view->model, NULL) : HK_FAILED;
}

static hk_status open(void *self, const hk_view *view, const hk_frame *frame) {
  page *p = self;
  if (!hk_live_open(&p->out, 0, p->origin)) return p->host->fail(p->host, HK_NO_MEMORY, "no memory for the messages");
  hk_status status = hk_gatherer_open(&p->gatherer, view, frame, &(hk_tuples){0}, false);
  if (status == HK_OK) hk_live_send_run(&p->out, &p->gatherer.data, frame);
  p->gatherer.dirty = true; /* its topology is told with its first frame */
  return status;
}

static hk_status topology(void *self, const hk_view *view) {
  (void)view;
  ((page *)self)->gatherer.dirty = true;
  return HK_OK;
}

static hk_status frame(void *self, const hk_view *view, const hk_frame *frame) {
  page *p = self;
  hk_status status = hk_gatherer_frame(&p->gatherer, view, frame, &(hk_tuples){0});
  if (status != HK_OK) return status;
  if (p->gatherer.changed) hk_live_send_topology(&p->out, &p->gatherer.data);
  hk_live_send_numbers(&p->out, &p->gatherer.data, frame);
  status = hk_gatherer_forces(&p->gatherer, view, frame);
  if (status != HK_OK) return status;
  hk_live_send_state(&p->out, &p->gatherer.data, frame);
  const hk_page_hand *h = hk_page_hand_now();
  p->hand->move(p->hand->self, view, 1 / frame->fps, h->id, h->place, h->strength);
  return HK_OK;
}

static hk_status close(void *self, hk_verdict verdict) {
  (void)verdict; /* the summary has it */
  hk_live_close(&((page *)self)->out);
  return HK_OK;
}

static void destroy(void *self, const hk_host *host) {
  page *p = self;
  (void)host;
  hk_live_close(&p->out);
  hk_gatherer_free(&p->gatherer);
}

static const hk_output output = {.size = sizeof(hk_output), .open = open, .frame = frame, .close = close};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_OUTPUT,
    .name = "page",
    .summary = "tells the page that runs the scene what happens",
    .reference = "",
    .instance_size = sizeof(page),
    .params = params,
    .create = create,
    .destroy = destroy,
    .topology = topology,
    .output = &output,
};
