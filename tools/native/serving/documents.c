/* The documents of the server of live pages, each a name with a type, bytes and a version; the connections that wait
 * for a new version; and the commands that pages have posted. The tool's thread and the server's share them, under a
 * lock. */
#include "tools/native/serving/serving.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

double hk_serving_now(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* ---- documents ---- */

static hk_document *find(const hk_documents *s, const char *name) {
  for (size_t k = s->count; k-- > 0;) /* what is new is asked for most */
    if (strcmp(s->document[k].name, name) == 0) return &s->document[k];
  return NULL;
}

const hk_document *hk_documents_find(const hk_documents *s, const char *name) { return find(s, name); }

static hk_document *make(hk_documents *s, const char *name) {
  if (s->count == s->room) {
    size_t room = 2 * s->room + 16;
    hk_document *more = realloc(s->document, room * sizeof *more);
    if (!more) return NULL;
    s->document = more;
    s->room = room;
  }
  hk_document *d = &s->document[s->count];
  *d = (hk_document){.name = strdup(name)};
  if (!d->name) return NULL;
  s->count++;
  return d;
}

bool hk_documents_put(hk_documents *s, const char *name, const char *type, const void *data, size_t size) {
  hk_document *d = find(s, name);
  void *copy = malloc(size + 1);
  char *kind = strdup(type);
  if (!d && copy && kind) d = make(s, name);
  if (!d || !copy || !kind) {
    free(copy);
    free(kind);
    return false;
  }
  memcpy(copy, data, size);
  free(d->data);
  free(d->type);
  *d = (hk_document){d->name, kind, copy, size, ++s->version};
  hk_documents_resume(s, INFINITY);
  return true;
}

static void forget(hk_document *d) {
  free(d->name);
  free(d->type);
  free(d->data);
}

void hk_documents_drop(hk_documents *s, const char *name) {
  hk_document *d = find(s, name);
  if (!d) return;
  forget(d);
  size_t at = (size_t)(d - s->document);
  memmove(d, d + 1, (--s->count - at) * sizeof *d);
}

/* ---- who waits for them ---- */

bool hk_documents_wait(hk_documents *s, struct MHD_Connection *c, double until) {
  if (s->closing || s->waits == HK_CONNECTIONS) return false;
  s->waits_until[s->waits] = until;
  s->waiting[s->waits++] = c;
  MHD_suspend_connection(c);
  return true;
}

void hk_documents_resume(hk_documents *s, double t) {
  size_t left = 0;
  for (size_t k = 0; k < s->waits; k++) {
    if (s->waits_until[k] <= t) {
      MHD_resume_connection(s->waiting[k]);
      continue;
    }
    s->waiting[left] = s->waiting[k];
    s->waits_until[left++] = s->waits_until[k];
  }
  s->waits = left;
}

/* ---- commands ---- */

bool hk_documents_command(hk_documents *s, const char *text) {
  char *copy = s->commands < HK_COMMANDS ? strdup(text) : NULL;
  if (!copy) return false;
  s->command[(s->first + s->commands++) % HK_COMMANDS] = copy;
  return write(s->bell[1], "", 1) == 1 || errno == EAGAIN; /* full: it rings already */
}

char *hk_documents_take(hk_documents *s) {
  char *text = NULL, byte[64];
  if (s->commands > 0) {
    text = s->command[s->first];
    s->first = (s->first + 1) % HK_COMMANDS;
    s->commands--;
  }
  if (s->commands == 0)
    while (read(s->bell[0], byte, sizeof byte) > 0) continue;
  return text;
}

/* ---- opening and closing ---- */

static bool open_bell(int bell[2]) {
  if (pipe(bell) != 0) return false;
  for (int k = 0; k < 2; k++)
    if (fcntl(bell[k], F_SETFL, O_NONBLOCK) != 0 || fcntl(bell[k], F_SETFD, FD_CLOEXEC) != 0) return false;
  return true;
}

static void close_bell(int bell[2]) {
  for (int k = 0; k < 2; k++)
    if (bell[k] >= 0) close(bell[k]);
}

bool hk_documents_open(hk_documents *s) {
  *s = (hk_documents){.bell = {-1, -1}};
  if (open_bell(s->bell) && (errno = pthread_mutex_init(&s->lock, NULL)) == 0) return true;
  close_bell(s->bell);
  return false;
}

void hk_documents_close(hk_documents *s) {
  for (size_t k = 0; k < s->count; k++) forget(&s->document[k]);
  for (char *text; (text = hk_documents_take(s)) != NULL;) free(text);
  free(s->document);
  close_bell(s->bell);
  pthread_mutex_destroy(&s->lock);
  *s = (hk_documents){.bell = {-1, -1}};
}
