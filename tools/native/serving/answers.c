/* Answers to the requests of pages, in a thread of libmicrohttpd's. Only 127.0.0.1 is listened on. Others on this
 * machine, and pages of other sites in the user's browser, are kept out by a token of 128 random bits that is part of
 * every address, by the Host header (a name that another site lets point to 127.0.0.1 is not ours), and for commands by
 * the Origin header, which a browser sets and a page cannot. */
#include "tools/native/serving/serving.h"

#include <arpa/inet.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/random.h>

enum {
  MEMORY = 32768, /* bytes for the headers of one connection */
  SECONDS = 20    /* an idle connection stays */
};

typedef struct request { /* of one connection, from its headers to its answer */
  char body[HK_COMMAND + 1];
  size_t length;
  double until; /* s, the end of its patience; 0: it has not waited */
} request;

static enum MHD_Result answer(const hk_answers *s, struct MHD_Connection *c, unsigned code, struct MHD_Response *r) {
  const char *const header[][2] = {{"Content-Security-Policy", s->policy},
                                   {"X-Content-Type-Options", "nosniff"},
                                   {"X-Frame-Options", "DENY"},
                                   {"Cross-Origin-Resource-Policy", "same-origin"},
                                   {"Referrer-Policy", "no-referrer"},
                                   {"Cache-Control", "no-store"}};
  if (!r) return MHD_NO;
  for (size_t k = 0; k < sizeof header / sizeof *header; k++) MHD_add_response_header(r, header[k][0], header[k][1]);
  enum MHD_Result queued = MHD_queue_response(c, code, r);
  MHD_destroy_response(r);
  return queued;
}

static enum MHD_Result answer_empty(const hk_answers *s, struct MHD_Connection *c, unsigned code) {
  return answer(s, c, code, MHD_create_response_from_buffer(0, NULL, MHD_RESPMEM_PERSISTENT));
}

static enum MHD_Result answer_document(const hk_answers *s, struct MHD_Connection *c, const hk_document *d) {
  struct MHD_Response *r = MHD_create_response_from_buffer(d->size, d->data, MHD_RESPMEM_MUST_COPY);
  char version[24];
  snprintf(version, sizeof version, "%llu", (unsigned long long)d->version);
  if (r) MHD_add_response_header(r, "Content-Type", d->type);
  if (r) MHD_add_response_header(r, "Version", version);
  return answer(s, c, MHD_HTTP_OK, r);
}

/* True: the request now waits, and is looked at again when something is new. */
static bool wait_for_news(const hk_answers *s, struct MHD_Connection *c, request *q, const hk_document *d) {
  const char *after = MHD_lookup_connection_value(c, MHD_GET_ARGUMENT_KIND, "after");
  if (!after || strtoull(after, NULL, 10) != d->version) return false;
  if (q->until == 0) q->until = hk_serving_now() + HK_PATIENCE;
  return hk_serving_now() < q->until && hk_documents_wait(s->documents, c, q->until);
}

static enum MHD_Result get(const hk_answers *s, struct MHD_Connection *c, const char *name, request *q) {
  const hk_document *d = hk_documents_find(s->documents, name);
  if (!d) return answer_empty(s, c, MHD_HTTP_NOT_FOUND);
  if (wait_for_news(s, c, q, d)) return MHD_YES;
  return q->until > 0 && hk_serving_now() >= q->until ? answer_empty(s, c, MHD_HTTP_NO_CONTENT)
                                                      : answer_document(s, c, d);
}

static bool equals(const char *value, const char *wanted) { return value && strcmp(value, wanted) == 0; }

static const char *header_of(struct MHD_Connection *c, const char *name) {
  return MHD_lookup_connection_value(c, MHD_HEADER_KIND, name);
}

static bool is_ours(const hk_answers *s, const char *host) {
  return equals(host, s->host[0]) || equals(host, s->host[1]);
}

/* The status with which a command is refused before its body is read; 0: it is not. */
static unsigned refuse_command(const hk_answers *s, struct MHD_Connection *c) {
  const char *origin = header_of(c, "Origin"), *type = header_of(c, "Content-Type"),
             *length = header_of(c, "Content-Length");
  if (!origin || strncmp(origin, "http://", 7) != 0 || !is_ours(s, origin + 7)) return MHD_HTTP_FORBIDDEN;
  if (!equals(type, "application/json")) return MHD_HTTP_UNSUPPORTED_MEDIA_TYPE; /* of no form of another site */
  if (!length) return MHD_HTTP_LENGTH_REQUIRED;
  return strtoull(length, NULL, 10) > HK_COMMAND ? MHD_HTTP_CONTENT_TOO_LARGE : 0;
}

static enum MHD_Result post(const hk_answers *s, struct MHD_Connection *c, const request *q) {
  bool taken = hk_documents_command(s->documents, q->body);
  return answer_empty(s, c, taken ? MHD_HTTP_NO_CONTENT : MHD_HTTP_SERVICE_UNAVAILABLE);
}

/* The name behind "/TOKEN/"; NULL: the token is wrong. How long that takes does not depend on where it is wrong. */
static const char *name_in(const hk_answers *s, const char *path) {
  unsigned char differs = 0;
  if (strlen(path) < HK_TOKEN + 2 || path[0] != '/' || path[HK_TOKEN + 1] != '/') return NULL;
  for (size_t k = 0; k < HK_TOKEN; k++) differs |= (unsigned char)(path[k + 1] ^ s->token[k]);
  return differs ? NULL : path + HK_TOKEN + 2;
}

/* Everything that is wrong with a request is known from its headers; the body is not even read then. */
static unsigned refuse(const hk_answers *s, struct MHD_Connection *c, const char *path, const char *method) {
  const char *name = name_in(s, path);
  if (!is_ours(s, header_of(c, "Host"))) return MHD_HTTP_FORBIDDEN;
  if (!name) return MHD_HTTP_NOT_FOUND;
  if (strcmp(name, "command") == 0)
    return strcmp(method, "POST") == 0 ? refuse_command(s, c) : MHD_HTTP_METHOD_NOT_ALLOWED;
  return strcmp(method, "GET") == 0 ? 0 : MHD_HTTP_METHOD_NOT_ALLOWED;
}

static enum MHD_Result handle(void *context, struct MHD_Connection *c, const char *path, const char *method,
                              const char *version, const char *data, size_t *size, void **state) {
  hk_answers *s = context;
  request *q = *state;
  (void)version;
  if (!q) { /* the headers are there */
    unsigned refused = refuse(s, c, path, method);
    if (refused) return answer_empty(s, c, refused);
    hk_strangers_leave(&s->strangers, c);
    *state = calloc(1, sizeof *q);
    return *state ? MHD_YES : MHD_NO;
  }
  if (*size > 0) {
    if (*size > HK_COMMAND - q->length) return MHD_NO; /* more than its Content-Length */
    memcpy(q->body + q->length, data, *size);
    q->length += *size;
    *size = 0;
    return MHD_YES;
  }
  pthread_mutex_lock(&s->documents->lock);
  enum MHD_Result result = strcmp(method, "POST") == 0 ? post(s, c, q) : get(s, c, name_in(s, path), q);
  pthread_mutex_unlock(&s->documents->lock);
  return result;
}

static void completed(void *context, struct MHD_Connection *c, void **state, enum MHD_RequestTerminationCode how) {
  (void)context, (void)c, (void)how;
  free(*state);
  *state = NULL;
}

static void connected(void *context, struct MHD_Connection *c, void **own, enum MHD_ConnectionNotificationCode what) {
  hk_answers *s = context;
  (void)own;
  if (what == MHD_CONNECTION_NOTIFY_STARTED)
    hk_strangers_enter(&s->strangers, c);
  else
    hk_strangers_leave(&s->strangers, c);
}

/* ---- opening and closing ---- */

static bool draw_token(char token[HK_TOKEN + 1]) {
  unsigned char random[HK_TOKEN / 2];
  if (getrandom(random, sizeof random, 0) != (ssize_t)sizeof random) return false;
  for (size_t k = 0; k < sizeof random; k++) snprintf(token + 2 * k, 3, "%02x", random[k]);
  return true;
}

/* Signals are for the tool's thread. */
static void start(hk_answers *s, uint16_t port) {
  struct sockaddr_in address = {.sin_family = AF_INET, .sin_port = htons(port)};
  sigset_t all, before;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  s->daemon = MHD_start_daemon(MHD_USE_AUTO_INTERNAL_THREAD | MHD_ALLOW_SUSPEND_RESUME, port, NULL, NULL, handle, s,
                               MHD_OPTION_SOCK_ADDR, (struct sockaddr *)&address, MHD_OPTION_CONNECTION_LIMIT,
                               (unsigned)HK_CONNECTIONS, MHD_OPTION_CONNECTION_TIMEOUT, (unsigned)SECONDS,
                               MHD_OPTION_CONNECTION_MEMORY_LIMIT, (size_t)MEMORY, MHD_OPTION_NOTIFY_COMPLETED,
                               completed, NULL, MHD_OPTION_NOTIFY_CONNECTION, connected, s, MHD_OPTION_END);
  pthread_sigmask(SIG_SETMASK, &before, NULL);
}

bool hk_answers_open(hk_answers *s, uint16_t port) {
  if (!draw_token(s->token)) return false;
  start(s, port);
  if (!s->daemon) return false;
  unsigned bound = MHD_get_daemon_info(s->daemon, MHD_DAEMON_INFO_BIND_PORT)->port;
  snprintf(s->host[0], sizeof s->host[0], "127.0.0.1:%u", bound);
  snprintf(s->host[1], sizeof s->host[1], "localhost:%u", bound);
  return true;
}

void hk_answers_close(hk_answers *s) {
  if (!s->daemon) return;
  pthread_mutex_lock(&s->documents->lock);
  s->documents->closing = true;
  hk_documents_resume(s->documents, INFINITY);
  pthread_mutex_unlock(&s->documents->lock);
  MHD_stop_daemon(s->daemon);
  s->daemon = NULL;
}
