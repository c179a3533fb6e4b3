/* Loops of parallel_for of several lengths, on one thread and on two, on a machine that is idle otherwise and beside
 * processes that take all they get. On P processors, T threads beside B such processes have a fair share of
 * P T / (T + B) processors, at most T. One and two threads take turns; each figure is a mean, stalls and all. What else
 * runs on the machine counts as a busy process too. */
#include "core/base/base.h"

#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

enum { ITEMS = 4096, REPEATS = 12, CHUNKS = 16, BUSY = 2 };

static double item[ITEMS], sum[CHUNKS];

/* Some ns an item: each operation waits for the one before. */
static void work(void *context, size_t begin, size_t end, size_t chunk) {
  double x = 0;
  (void)context;
  for (size_t k = begin; k < end; k++)
    for (int q = 0; q < 10; q++) x = 0.5 * x + item[k];
  sum[chunk] = x;
}

/* Seconds of a loop over `count` items, of as many loops as take some 20 ms. */
static double loop(hk_threads *threads, size_t count) {
  size_t loops = 1000000 / count;
  double start = hk_clock();
  for (size_t k = 0; k < loops; k++) hk_threads_for(threads, count, (count + CHUNKS - 1) / CHUNKS, work, NULL);
  return (hk_clock() - start) / (double)loops;
}

static void start_busy(pid_t busy[BUSY], int count) {
  for (int b = 0; b < count; b++)
    if ((busy[b] = fork()) == 0) {
      prctl(PR_SET_PDEATHSIG, SIGKILL);
      for (volatile double x = 0;; x = x + 1) {
      }
    }
}

static void end_busy(const pid_t busy[BUSY], int count) {
  for (int b = 0; b < count; b++) kill(busy[b], SIGKILL), waitpid(busy[b], NULL, 0);
}

static void measure(hk_threads *one, hk_threads *two, int busy, size_t count) {
  double ta = 0, tb = 0, P = (double)sysconf(_SC_NPROCESSORS_ONLN);
  for (int r = 0; r < REPEATS; r++) ta += loop(one, count) / REPEATS, tb += loop(two, count) / REPEATS;
  double share = fmin(2, 2 * P / (2 + busy)) / fmin(1, P / (1 + busy));
  printf("%d busy processes, loops of %4zu items: one thread %7.2f us, two %7.2f us: %.2fx; by the shares %.2fx\n",
         busy, count, 1e6 * ta, 1e6 * tb, ta / tb, share);
}

int main(void) {
  setvbuf(stdout, NULL, _IOLBF, 0);
  static const size_t count[] = {64, 256, 1024, ITEMS};
  pid_t busy[BUSY];
  for (size_t k = 0; k < ITEMS; k++) item[k] = sin((double)k);
  for (int b = 0; b <= BUSY; b++) {
    start_busy(busy, b);
    hk_threads *one = hk_threads_create(1), *two = hk_threads_create(2);
    for (size_t k = 0; k < sizeof count / sizeof *count; k++) measure(one, two, b, count[k]);
    hk_threads_destroy(one);
    hk_threads_destroy(two);
    end_busy(busy, b);
  }
  return isfinite(sum[0]) ? 0 : 1;
}
