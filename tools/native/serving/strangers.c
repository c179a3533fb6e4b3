/* Connections that have not shown the token yet: half of a request, or none. Anybody on this machine can open as many
 * as the server takes and keep them, so that pages wait. So there are few places for them, and who comes pushes out
 * who has been there longest: a page sends its request at once. All of it is called in the server's thread. */
#include "tools/native/serving/serving.h"

#include <string.h>
#include <sys/socket.h>

static void forget(hk_strangers *s, size_t k) {
  s->count--;
  memmove(s->connection + k, s->connection + k + 1, (s->count - k) * sizeof *s->connection);
}

void hk_strangers_leave(hk_strangers *s, const struct MHD_Connection *c) {
  for (size_t k = 0; k < s->count; k++)
    if (s->connection[k] == c) {
      forget(s, k);
      return;
    }
}

/* The server then reads its end, and closes it. */
static void push_out(struct MHD_Connection *c) {
  const union MHD_ConnectionInfo *info = MHD_get_connection_info(c, MHD_CONNECTION_INFO_CONNECTION_FD);
  if (info) shutdown(info->connect_fd, SHUT_RDWR);
}

void hk_strangers_enter(hk_strangers *s, struct MHD_Connection *c) {
  if (s->count == HK_STRANGERS) {
    push_out(s->connection[0]);
    forget(s, 0);
  }
  s->connection[s->count++] = c;
}
