#include "plugins/common/frame_data/marks.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Marks that a picture can show side by side: more would take more room than particles. */
enum { MOST_ARROWS = 256, MOST_CONTACTS = 1000 };

static bool has_medium(const hk_frame *frame, size_t k) { return frame->flow && frame->flow(frame, k, NULL, 0, NULL); }

static hk_status no_memory(const hk_host *host) {
  return host->fail(host, HK_NO_MEMORY, "no memory for wind and contacts");
}

static bool add_list(hk_mark_lists *m, const char *name, size_t most, size_t force) {
  hk_frame_marks *list = &m->list[m->count++];
  *list = (hk_frame_marks){.force = force, .value = malloc(HK_MARK_NUMBERS * most * sizeof *list->value)};
  snprintf(list->name, sizeof list->name, "%s", name);
  return list->value != NULL;
}

hk_status hk_marks_open(hk_mark_lists *m, const hk_host *host, const hk_frame *frame) {
  m->list = calloc(frame->forces + 1, sizeof *m->list);
  bool fine = m->list != NULL;
  for (size_t k = 0; k < frame->forces && fine; k++)
    if (has_medium(frame, k)) fine = add_list(m, frame->force_name[k], MOST_ARROWS, k);
  if (fine && frame->contact_points && frame->contact_points(frame, NULL)) {
    fine = add_list(m, "contact", MOST_CONTACTS, 0);
    m->list[m->count - 1].contact = true;
  }
  return fine ? HK_OK : no_memory(host);
}

/* Velocities at every s-th particle; none while the force does not act. */
static void take_flow(hk_frame_marks *list, const hk_view *view, const hk_frame *frame) {
  size_t every = view->n / MOST_ARROWS + 1;
  list->count = list->total = 0;
  for (size_t i = 0; i < view->n; i += every) {
    double *to = list->value + HK_MARK_NUMBERS * list->count;
    memcpy(to, view->x + 3 * i, 3 * sizeof *to);
    if (!frame->flow(frame, list->force, to, 1, to + 3)) return;
    list->count++;
  }
  list->total = view->n;
}

typedef struct finding {
  hk_mark_lists *all;
  size_t count;
} finding;

static void find(void *context, const double x[3], const double n[3]) {
  finding *f = context;
  hk_mark_lists *m = f->all;
  if (f->count == m->room) {
    size_t room = 2 * m->room + MOST_CONTACTS;
    double *more = realloc(m->found, room * HK_MARK_NUMBERS * sizeof *more);
    m->short_of_memory = !more;
    if (!more) return;
    m->found = more, m->room = room;
  }
  double *to = m->found + HK_MARK_NUMBERS * f->count++;
  memcpy(to, x, 3 * sizeof *to);
  memcpy(to + 3, n, 3 * sizeof *to);
}

static void take_contacts(hk_mark_lists *m, hk_frame_marks *list, const hk_frame *frame) {
  finding f = {m, 0};
  frame->contact_points(frame, &(hk_contact_points){&f, find});
  size_t every = f.count ? (f.count - 1) / MOST_CONTACTS + 1 : 1;
  list->count = 0, list->total = f.count;
  for (size_t k = 0; k < f.count; k += every)
    memcpy(list->value + HK_MARK_NUMBERS * list->count++, m->found + HK_MARK_NUMBERS * k,
           HK_MARK_NUMBERS * sizeof *m->found);
}

hk_status hk_marks_take(hk_mark_lists *m, const hk_view *view, const hk_frame *frame) {
  m->short_of_memory = false;
  for (size_t k = 0; k < m->count; k++)
    if (m->list[k].contact)
      take_contacts(m, &m->list[k], frame);
    else
      take_flow(&m->list[k], view, frame);
  return m->short_of_memory ? no_memory(view->host) : HK_OK;
}

void hk_marks_free(hk_mark_lists *m) {
  for (size_t k = 0; k < m->count; k++) free(m->list[k].value);
  free(m->list);
  free(m->found);
  *m = (hk_mark_lists){0};
}
