/* Two scenes by libhooke, in two threads at once: they give the bits that each gives by itself.
 * cc threads.c $(pkg-config --cflags --libs libhooke) -lpthread
 * usage: threads SCENE.lua SCENE.lua */
#include <hooke.h>

#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct job {
  const char *scene;
  size_t n;
  double *x; /* n x 3, m, at the end */
} job;

static void *run_job(void *context) {
  job *j = context;
  hooke_run *run = hooke_new();
  if (hooke_option(run, "until", "0.2") == HOOKE_OK && hooke_open(run, j->scene) == HOOKE_OK &&
      hooke_finish(run) == HOOKE_OK && (j->x = malloc(3 * hooke_count(run) * sizeof *j->x))) {
    j->n = hooke_count(run);
    memcpy(j->x, hooke_positions(run), 3 * j->n * sizeof *j->x);
  } else {
    fprintf(stderr, "%s: %s\n", j->scene, hooke_error(run));
  }
  hooke_free(run);
  return NULL;
}

static int same(const job *a, const job *b) {
  return a->n > 0 && a->n == b->n && memcmp(a->x, b->x, 3 * a->n * sizeof *a->x) == 0;
}

int main(int count, char **argument) {
  job alone[2] = {{0}}, beside[2] = {{0}};
  pthread_t thread[2];
  if (count != 3) return 2;
  for (int k = 0; k < 2; k++) {
    alone[k].scene = beside[k].scene = argument[k + 1];
    run_job(&alone[k]);
  }
  for (int k = 0; k < 2; k++)
    if (pthread_create(&thread[k], NULL, run_job, &beside[k]) != 0) return 2;
  for (int k = 0; k < 2; k++) pthread_join(thread[k], NULL);
  int fine = same(&alone[0], &beside[0]) && same(&alone[1], &beside[1]);
  printf("%zu and %zu particles: %s\n", alone[0].n, alone[1].n, fine ? "the same bits" : "other bits");
  for (int k = 0; k < 2; k++) {
    free(alone[k].x);
    free(beside[k].x);
  }
  return fine ? 0 : 1;
}
