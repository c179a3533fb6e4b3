/* The server of live pages: documents, for whose new versions pages wait; commands, which pages post; and the answers
 * to requests, given by a thread of libmicrohttpd. */
#ifndef HK_SERVING_H
#define HK_SERVING_H

#include <microhttpd.h>
#include <pthread.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum {
  HK_TOKEN = 32,        /* hexadecimal digits */
  HK_COMMAND = 4096,    /* bytes, the longest */
  HK_COMMANDS = 256,    /* that wait to be taken; more are refused, as is a page that posts without end */
  HK_CONNECTIONS = 128, /* ten pages hold some 60 */
  HK_STRANGERS = 32,    /* of these, without the token so far */
  HK_PATIENCE = 10      /* s, the longest wait for a new version */
};

/* ---- documents.c: every function but those that open and close is called under the lock ---- */

typedef struct hk_document {
  char *name, *type;
  void *data;
  size_t size;
  uint64_t version;
} hk_document;

typedef struct hk_documents {
  pthread_mutex_t lock;
  hk_document *document;
  size_t count, room; /* of documents */
  uint64_t version;
  struct MHD_Connection *waiting[HK_CONNECTIONS];
  double waits_until[HK_CONNECTIONS]; /* s */
  size_t waits;
  char *command[HK_COMMANDS];
  size_t first, commands;
  int bell[2]; /* a pipe that holds a byte while there are commands */
  bool closing;
} hk_documents;

bool hk_documents_open(hk_documents *); /* false: errno says why */
void hk_documents_close(hk_documents *);
const hk_document *hk_documents_find(const hk_documents *, const char *name); /* NULL: there is none */
bool hk_documents_put(hk_documents *, const char *name, const char *type, const void *data,
                      size_t size); /* false: no memory */
void hk_documents_drop(hk_documents *, const char *name);
/* Suspends the connection until something is put or the time has come, s. False: too many wait already. */
bool hk_documents_wait(hk_documents *, struct MHD_Connection *, double until);
void hk_documents_resume(hk_documents *, double t);          /* those that wait until t or before; INFINITY: all */
bool hk_documents_command(hk_documents *, const char *text); /* false: too many wait, or there is no memory */
char *hk_documents_take(hk_documents *);                     /* the next command in malloc's memory; NULL: none */
double hk_serving_now(void);                                 /* s */

/* ---- strangers.c: connections without the token, from their begin to their first request with it or their end ---- */

typedef struct hk_strangers {
  struct MHD_Connection *connection[HK_STRANGERS]; /* in the order in which they came */
  size_t count;
} hk_strangers;

void hk_strangers_enter(hk_strangers *, struct MHD_Connection *); /* the one that came first may have to go */
void hk_strangers_leave(hk_strangers *, const struct MHD_Connection *);

/* ---- answers.c ---- */

typedef struct hk_answers {
  struct MHD_Daemon *daemon; /* NULL: there is none */
  hk_documents *documents;
  hk_strangers strangers;
  const char *policy; /* of contents, in every answer */
  char token[HK_TOKEN + 1], host[2][32];
} hk_answers;

/* Listens on 127.0.0.1; port 0: any that is free. False: errno says why. What `answers` names outlives it. */
bool hk_answers_open(hk_answers *, uint16_t port);
void hk_answers_close(hk_answers *);

#endif
