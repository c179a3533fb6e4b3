/* server: the pages of a tool on this machine alone, by libmicrohttpd in a thread of its own. It knows documents, each
 * a name with a type, bytes and a version, and commands, which pages post; what they mean is the tool's business. It
 * has no files, so it can give none away (serving/documents.c); who may ask is decided in serving/answers.c.
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
#include "tools/native/serving/serving.h"

#include <errno.h>
#include <lauxlib.h>
#include <lua.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct server {
  hk_documents documents;
  hk_answers answers;
  char *policy;
} server;

static const char type_name[] = "hooke.server";

static server *self_at(lua_State *L) {
  server *s = luaL_checkudata(L, 1, type_name);
  if (!s->answers.daemon) luaL_error(L, "this server is closed");
  return s;
}

static hk_documents *lock(server *s) {
  pthread_mutex_lock(&s->documents.lock);
  return &s->documents;
}

static void unlock(server *s) { pthread_mutex_unlock(&s->documents.lock); }

static int put(lua_State *L) {
  server *s = self_at(L);
  size_t size;
  const char *name = luaL_checkstring(L, 2), *type = luaL_checkstring(L, 3), *data = luaL_checklstring(L, 4, &size);
  bool fine = hk_documents_put(lock(s), name, type, data, size);
  unlock(s);
  return fine ? 0 : luaL_error(L, "no memory for %s", name);
}

static int drop(lua_State *L) {
  server *s = self_at(L);
  const char *name = luaL_checkstring(L, 2);
  hk_documents_drop(lock(s), name);
  unlock(s);
  return 0;
}

static int take(lua_State *L) {
  server *s = self_at(L);
  char *text = hk_documents_take(lock(s));
  unlock(s);
  lua_pushstring(L, text);
  free(text);
  return 1;
}

static int descriptor(lua_State *L) {
  lua_pushinteger(L, self_at(L)->documents.bell[0]);
  return 1;
}

static int tick(lua_State *L) {
  server *s = self_at(L);
  hk_documents_resume(lock(s), hk_serving_now());
  unlock(s);
  return 0;
}

static int url(lua_State *L) {
  const server *s = self_at(L);
  lua_pushfstring(L, "http://%s/%s/", s->answers.host[0], s->answers.token);
  return 1;
}

static int close_server(lua_State *L) {
  server *s = luaL_checkudata(L, 1, type_name);
  if (!s->policy) return 0;
  hk_answers_close(&s->answers);
  hk_documents_close(&s->documents);
  free(s->policy);
  s->policy = NULL;
  return 0;
}

static int open_server(lua_State *L) {
  lua_Integer port = luaL_checkinteger(L, 1);
  const char *policy = luaL_checkstring(L, 2);
  luaL_argcheck(L, port >= 0 && port < 65536, 1, "no port");
  server *s = lua_newuserdatauv(L, sizeof *s, 0);
  *s = (server){.documents.bell = {-1, -1}};
  luaL_setmetatable(L, type_name);
  char *copy = strdup(policy);
  if (!copy || !hk_documents_open(&s->documents)) {
    free(copy);
    return luaL_error(L, "server: %s", strerror(errno));
  }
  s->policy = copy; /* from here on it is closed */
  s->answers = (hk_answers){.documents = &s->documents, .policy = copy};
  if (hk_answers_open(&s->answers, (uint16_t)port)) return 1;
  return luaL_error(L, "no server on 127.0.0.1:%d: %s%s", (int)port, strerror(errno),
                    port ? " (another program may have that port; 0 takes any that is free)" : "");
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
