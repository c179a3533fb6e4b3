/* server: the pages of a tool on this machine alone, by libmicrohttpd in a thread of its own. It knows documents, each
 * a name with a type, bytes and a version, and commands, which pages post; what they mean is the tool's business. It
 * has no files, so it can give none away.
 *
 * Only 127.0.0.1 is listened on. Others on this machine, and pages of other sites in the user's browser, are kept out
 * by a token of 128 random bits that is part of every address, by the Host header (a name that another site lets point
 * to 127.0.0.1 is not ours), and for commands by the Origin header, which a browser sets and a page cannot.
 *
 *     server.open(port, policy) -> s     port 0: any that is free; policy: the Content-Security-Policy of all answers
 *     s:url()                            the address of the document ""
 *     s:put(name, type, bytes)           the document's new content; requests that wait for it are answered
 *     s:drop(name)
 *     s:take() -> text or nil            the next command
 *     s:descriptor()                     can be read (poll) when there are commands
 *     s:tick()                           at least once a second: requests that have waited for long are answered
 *     s:close()
 *
 * GET URL/NAME gives the document, with its version in the header Version. GET URL/NAME?after=V waits while the version
 * is V, some seconds: 204, and the page asks again. So a page has what is new when it is ready for it; nobody waits for
 * a page. POST URL/command, application/json, at most 4 kB: a command. */
#include <arpa/inet.h>
#include <errno.h>
#include <fcntl.h>
#include <lauxlib.h>
#include <lua.h>
#include <math.h>
#include <microhttpd.h>
#include <pthread.h>
#include <signal.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/random.h>
#include <time.h>
#include <unistd.h>

enum {
  TOKEN = 32,        /* hexadecimal digits */
  COMMAND = 4096,    /* bytes, the longest */
  COMMANDS = 256,    /* that wait to be taken; more are refused, as is a page that posts without end */
  CONNECTIONS = 128, /* ten pages hold some 60 */
  MEMORY = 32768,    /* bytes for the headers of one */
  SECONDS = 20,      /* an idle connection stays */
  PATIENCE = 10      /* s, the longest wait for a new version */
};

typedef struct document {
  char *name, *type;
  void *data;
  size_t size;
  uint64_t version;
} document;

typedef struct request { /* of one connection, from its headers to its answer */
  char body[COMMAND + 1];
  size_t length;
  double until; /* s, the end of its patience; 0: it has not waited */
} request;

typedef struct server {
  struct MHD_Daemon *daemon;
  pthread_mutex_t lock;
  char token[TOKEN + 1], host[2][32], *policy;
  document *document;
  size_t documents, room;
  uint64_t version;
  struct MHD_Connection *waiting[CONNECTIONS];
  double waits_until[CONNECTIONS];
  size_t waits;
  char *command[COMMANDS];
  size_t first, commands;
  int bell[2]; /* a pipe that holds a byte while there are commands */
  bool closing;
} server;

static double now(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* ---- answers: in the server's thread ---- */

static enum MHD_Result answer(const server *s, struct MHD_Connection *c, unsigned code, struct MHD_Response *r) {
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

static enum MHD_Result answer_empty(const server *s, struct MHD_Connection *c, unsigned code) {
  return answer(s, c, code, MHD_create_response_from_buffer(0, NULL, MHD_RESPMEM_PERSISTENT));
}

static enum MHD_Result answer_document(const server *s, struct MHD_Connection *c, const document *d) {
  struct MHD_Response *r = MHD_create_response_from_buffer(d->size, d->data, MHD_RESPMEM_MUST_COPY);
  char version[24];
  snprintf(version, sizeof version, "%llu", (unsigned long long)d->version);
  if (r) MHD_add_response_header(r, "Content-Type", d->type);
  if (r) MHD_add_response_header(r, "Version", version);
  return answer(s, c, MHD_HTTP_OK, r);
}

static document *find(const server *s, const char *name) {
  for (size_t k = s->documents; k-- > 0;) /* what is new is asked for most */
    if (strcmp(s->document[k].name, name) == 0) return &s->document[k];
  return NULL;
}

/* True: the request now waits, and is looked at again when something is new. */
static bool wait_for_news(server *s, struct MHD_Connection *c, request *q, const document *d) {
  const char *after = MHD_lookup_connection_value(c, MHD_GET_ARGUMENT_KIND, "after");
  if (!after || strtoull(after, NULL, 10) != d->version || s->closing) return false;
  if (q->until == 0) q->until = now() + PATIENCE;
  if (now() >= q->until || s->waits == CONNECTIONS) return false;
  s->waits_until[s->waits] = q->until;
  s->waiting[s->waits++] = c;
  MHD_suspend_connection(c);
  return true;
}

static enum MHD_Result get(server *s, struct MHD_Connection *c, const char *name, request *q) {
  const document *d = find(s, name);
  if (!d) return answer_empty(s, c, MHD_HTTP_NOT_FOUND);
  if (wait_for_news(s, c, q, d)) return MHD_YES;
  return q->until > 0 && now() >= q->until ? answer_empty(s, c, MHD_HTTP_NO_CONTENT) : answer_document(s, c, d);
}

static bool equals(const char *value, const char *wanted) { return value && strcmp(value, wanted) == 0; }

static const char *header_of(struct MHD_Connection *c, const char *name) {
  return MHD_lookup_connection_value(c, MHD_HEADER_KIND, name);
}

static bool is_ours(const server *s, const char *host) { return equals(host, s->host[0]) || equals(host, s->host[1]); }

/* The status with which a command is refused before its body is read; 0: it is not. */
static unsigned refuse_command(const server *s, struct MHD_Connection *c) {
  const char *origin = header_of(c, "Origin"), *type = header_of(c, "Content-Type"),
             *length = header_of(c, "Content-Length");
  if (!origin || strncmp(origin, "http://", 7) != 0 || !is_ours(s, origin + 7)) return MHD_HTTP_FORBIDDEN;
  if (!equals(type, "application/json")) return MHD_HTTP_UNSUPPORTED_MEDIA_TYPE; /* of no form of another site */
  if (!length) return MHD_HTTP_LENGTH_REQUIRED;
  return strtoull(length, NULL, 10) > COMMAND ? MHD_HTTP_CONTENT_TOO_LARGE : 0;
}

static enum MHD_Result post(server *s, struct MHD_Connection *c, request *q) {
  char *text = s->commands < COMMANDS ? strdup(q->body) : NULL;
  if (!text) return answer_empty(s, c, MHD_HTTP_SERVICE_UNAVAILABLE);
  s->command[(s->first + s->commands++) % COMMANDS] = text;
  bool rang = write(s->bell[1], "", 1) == 1 || errno == EAGAIN; /* full: it rings already */
  return answer_empty(s, c, rang ? MHD_HTTP_NO_CONTENT : MHD_HTTP_INTERNAL_SERVER_ERROR);
}

/* The name behind "/TOKEN/"; NULL: the token is wrong. How long that takes does not depend on where it is wrong. */
static const char *name_in(const server *s, const char *path) {
  unsigned char differs = 0;
  if (strlen(path) < TOKEN + 2 || path[0] != '/' || path[TOKEN + 1] != '/') return NULL;
  for (size_t k = 0; k < TOKEN; k++) differs |= (unsigned char)(path[k + 1] ^ s->token[k]);
  return differs ? NULL : path + TOKEN + 2;
}

/* Everything that is wrong with a request is known from its headers; the body is not even read then. */
static unsigned refuse(const server *s, struct MHD_Connection *c, const char *path, const char *method) {
  const char *name = name_in(s, path);
  if (!is_ours(s, header_of(c, "Host"))) return MHD_HTTP_FORBIDDEN;
  if (!name) return MHD_HTTP_NOT_FOUND;
  if (strcmp(name, "command") == 0)
    return strcmp(method, "POST") == 0 ? refuse_command(s, c) : MHD_HTTP_METHOD_NOT_ALLOWED;
  return strcmp(method, "GET") == 0 ? 0 : MHD_HTTP_METHOD_NOT_ALLOWED;
}

static enum MHD_Result handle(void *context, struct MHD_Connection *c, const char *path, const char *method,
                              const char *version, const char *data, size_t *size, void **state) {
  server *s = context;
  request *q = *state;
  (void)version;
  if (!q) { /* the headers are there */
    unsigned refused = refuse(s, c, path, method);
    if (refused) return answer_empty(s, c, refused);
    *state = calloc(1, sizeof *q);
    return *state ? MHD_YES : MHD_NO;
  }
  if (*size > 0) {
    if (*size > COMMAND - q->length) return MHD_NO; /* more than its Content-Length */
    memcpy(q->body + q->length, data, *size);
    q->length += *size;
    *size = 0;
    return MHD_YES;
  }
  pthread_mutex_lock(&s->lock);
  enum MHD_Result result = strcmp(method, "POST") == 0 ? post(s, c, q) : get(s, c, name_in(s, path), q);
  pthread_mutex_unlock(&s->lock);
  return result;
}

static void completed(void *context, struct MHD_Connection *c, void **state, enum MHD_RequestTerminationCode how) {
  (void)context, (void)c, (void)how;
  free(*state);
  *state = NULL;
}

/* ---- the tool's side ---- */

static const char type_name[] = "hooke.server";

static server *self_at(lua_State *L) {
  server *s = luaL_checkudata(L, 1, type_name);
  if (!s->daemon) luaL_error(L, "this server is closed");
  return s;
}

/* Those whose patience has ended by t, or all. Under the lock. */
static void resume(server *s, double t) {
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

static document *make(server *s, const char *name) {
  if (s->documents == s->room) {
    size_t room = 2 * s->room + 16;
    document *more = realloc(s->document, room * sizeof *more);
    if (!more) return NULL;
    s->document = more;
    s->room = room;
  }
  document *d = &s->document[s->documents];
  *d = (document){.name = strdup(name)};
  if (!d->name) return NULL;
  s->documents++;
  return d;
}

static bool set(server *s, const char *name, const char *type, const void *data, size_t size) {
  document *d = find(s, name);
  void *copy = malloc(size + 1);
  char *kind = strdup(type);
  if (!d) d = make(s, name);
  if (!d || !copy || !kind) {
    free(copy);
    free(kind);
    return false;
  }
  memcpy(copy, data, size);
  free(d->data);
  free(d->type);
  *d = (document){d->name, kind, copy, size, ++s->version};
  return true;
}

static int put(lua_State *L) {
  server *s = self_at(L);
  size_t size;
  const char *name = luaL_checkstring(L, 2), *type = luaL_checkstring(L, 3), *data = luaL_checklstring(L, 4, &size);
  pthread_mutex_lock(&s->lock);
  bool fine = set(s, name, type, data, size);
  resume(s, INFINITY);
  pthread_mutex_unlock(&s->lock);
  return fine ? 0 : luaL_error(L, "no memory for %s", name);
}

static void forget(document *d) {
  free(d->name);
  free(d->type);
  free(d->data);
}

static int drop(lua_State *L) {
  server *s = self_at(L);
  const char *name = luaL_checkstring(L, 2);
  pthread_mutex_lock(&s->lock);
  document *d = find(s, name);
  if (d) {
    forget(d);
    size_t at = (size_t)(d - s->document);
    memmove(d, d + 1, (--s->documents - at) * sizeof *d);
  }
  pthread_mutex_unlock(&s->lock);
  return 0;
}

static int take(lua_State *L) {
  server *s = self_at(L);
  char *text = NULL, byte[64];
  pthread_mutex_lock(&s->lock);
  if (s->commands > 0) {
    text = s->command[s->first];
    s->first = (s->first + 1) % COMMANDS;
    s->commands--;
  }
  if (s->commands == 0)
    while (read(s->bell[0], byte, sizeof byte) > 0) continue;
  pthread_mutex_unlock(&s->lock);
  lua_pushstring(L, text);
  free(text);
  return 1;
}

static int descriptor(lua_State *L) {
  lua_pushinteger(L, self_at(L)->bell[0]);
  return 1;
}

static int tick(lua_State *L) {
  server *s = self_at(L);
  pthread_mutex_lock(&s->lock);
  resume(s, now());
  pthread_mutex_unlock(&s->lock);
  return 0;
}

static int url(lua_State *L) {
  const server *s = self_at(L);
  lua_pushfstring(L, "http://%s/%s/", s->host[0], s->token);
  return 1;
}

static void release(server *s) {
  if (s->daemon) {
    pthread_mutex_lock(&s->lock);
    s->closing = true;
    resume(s, INFINITY);
    pthread_mutex_unlock(&s->lock);
    MHD_stop_daemon(s->daemon);
    pthread_mutex_destroy(&s->lock);
  }
  s->daemon = NULL;
  for (size_t k = 0; k < s->documents; k++) forget(&s->document[k]);
  for (; s->commands > 0; s->commands--, s->first = (s->first + 1) % COMMANDS) free(s->command[s->first]);
  free(s->document);
  free(s->policy);
  for (int k = 0; k < 2; k++)
    if (s->bell[k] >= 0) close(s->bell[k]);
  *s = (server){.bell = {-1, -1}};
}

static int close_server(lua_State *L) {
  release(luaL_checkudata(L, 1, type_name));
  return 0;
}

/* ---- opening ---- */

static bool draw_token(char token[TOKEN + 1]) {
  unsigned char random[TOKEN / 2];
  if (getrandom(random, sizeof random, 0) != (ssize_t)sizeof random) return false;
  for (size_t k = 0; k < sizeof random; k++) snprintf(token + 2 * k, 3, "%02x", random[k]);
  return true;
}

static bool open_bell(int bell[2]) {
  if (pipe(bell) != 0) return false;
  for (int k = 0; k < 2; k++)
    if (fcntl(bell[k], F_SETFL, O_NONBLOCK) != 0 || fcntl(bell[k], F_SETFD, FD_CLOEXEC) != 0) return false;
  return true;
}

/* Signals are for the tool's thread. */
static void start(server *s, uint16_t port) {
  struct sockaddr_in address = {.sin_family = AF_INET, .sin_port = htons(port)};
  sigset_t all, before;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  s->daemon = MHD_start_daemon(MHD_USE_AUTO_INTERNAL_THREAD | MHD_ALLOW_SUSPEND_RESUME, port, NULL, NULL, handle, s,
                               MHD_OPTION_SOCK_ADDR, (struct sockaddr *)&address, MHD_OPTION_CONNECTION_LIMIT,
                               (unsigned)CONNECTIONS, MHD_OPTION_CONNECTION_TIMEOUT, (unsigned)SECONDS,
                               MHD_OPTION_CONNECTION_MEMORY_LIMIT, (size_t)MEMORY, MHD_OPTION_NOTIFY_COMPLETED,
                               completed, NULL, MHD_OPTION_END);
  pthread_sigmask(SIG_SETMASK, &before, NULL);
}

static int open_server(lua_State *L) {
  lua_Integer port = luaL_checkinteger(L, 1);
  const char *policy = luaL_checkstring(L, 2);
  luaL_argcheck(L, port >= 0 && port < 65536, 1, "no port");
  server *s = lua_newuserdatauv(L, sizeof *s, 0);
  *s = (server){.bell = {-1, -1}};
  luaL_setmetatable(L, type_name);
  s->policy = strdup(policy);
  if (!s->policy || !draw_token(s->token) || !open_bell(s->bell)) return luaL_error(L, "server: %s", strerror(errno));
  pthread_mutex_init(&s->lock, NULL);
  start(s, (uint16_t)port);
  if (!s->daemon)
    return luaL_error(L, "no server on 127.0.0.1:%d: %s%s", (int)port, strerror(errno),
                      port ? " (another program may have that port; 0 takes any that is free)" : "");
  unsigned bound = MHD_get_daemon_info(s->daemon, MHD_DAEMON_INFO_BIND_PORT)->port;
  snprintf(s->host[0], sizeof s->host[0], "127.0.0.1:%u", bound);
  snprintf(s->host[1], sizeof s->host[1], "localhost:%u", bound);
  return 1;
}

__attribute__((visibility("default"))) int luaopen_server(lua_State *L);

int luaopen_server(lua_State *L) {
  static const luaL_Reg methods[] = {
      {"put", put},   {"drop", drop}, {"take", take},          {"descriptor", descriptor},
      {"tick", tick}, {"url", url},   {"close", close_server}, {NULL, NULL}};
  static const luaL_Reg functions[] = {{"open", open_server}, {NULL, NULL}};
  luaL_newmetatable(L, type_name);
  luaL_newlib(L, methods);
  lua_setfield(L, -2, "__index");
  lua_pushcfunction(L, close_server);
  lua_setfield(L, -2, "__gc");
  lua_pop(L, 1);
  luaL_newlib(L, functions);
  return 1;
}
