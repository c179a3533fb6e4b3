/* What the process of an untrusted scene gives up before the scene's script runs: programs, the network, other
 * processes, and the files outside of what it needs. A scene that broke its sandbox would be as far as before. */
#ifndef HK_CONFINEMENT_H
#define HK_CONFINEMENT_H

#include <stdbool.h>

typedef struct hk_confinement {
  const char *scene;     /* its script: the folder may be read */
  const char *read[5];   /* further files and folders to read; NULL members are skipped */
  const char *search;    /* folders of plugins, separated by ':', or NULL */
  const char *libraries; /* LD_LIBRARY_PATH, likewise */
  const char *programs;  /* PATH: where ffmpeg is looked for, which outputs call */
  const char *output;    /* a folder to write in, made here where it is missing; NULL: none */
  bool named;            /* the user has named it */
  const char *cache;     /* the folder of tools/auto.lua, made here; NULL: none */
  const char *state;     /* a file to write, NULL: none */
} hk_confinement;

/* Closes the doors, for this thread and all later threads and processes. NULL: all are closed; otherwise a sentence
 * that says what this system cannot close. */
const char *hk_confine(const hk_confinement *);
/* Removes the folders that hk_confine made, where they are empty. */
void hk_confinement_end(void);

#endif
